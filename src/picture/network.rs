//! Rendering of networks as cones and balls.

use super::canvas::{Canvas, Facet};
use super::colours::{Colour, Legend, MARKED, Rgb, WALL_COLOURS, of_block};
use super::outline::Outline;
use anastomesh_mesh::geometry::{Point3, Section, Tube, Vec3};
use anastomesh_network::flow::{NotConverged, Orders};
use anastomesh_skeleton::{EdgeId, NodeId, Skeleton};
use std::f64::consts::TAU;

/// Minimum drawn radius of a vessel, in samples.
const THINNEST: f64 = 0.75;

/// Displayed quantity of a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    pub colour: Colour,
    /// Scale of the values, if the colour shows any.
    pub legend: Option<Legend>,
}

/// Network to render.
pub struct NetworkPicture<'a> {
    network: &'a Skeleton,
    /// Colours of each edge at its two ends.
    colours: Vec<[Rgb; 2]>,
    shown: Shown,
}

impl<'a> NetworkPicture<'a> {
    /// Prepares a network. Mesh-only colours (patches, quality) fall back to plain, blocks to branches.
    pub fn by_radius(network: &'a Skeleton) -> Self {
        let radii = || network.edges.iter().map(|e| e.radii);
        let legend = Legend::of(radii().flatten(), true);
        let colours = radii().map(|r| r.map(|x| legend.colour(x))).collect();
        Self { network, colours, shown: Shown { colour: Colour::Radius, legend: Some(legend) } }
    }

    /// Of a network. What concerns meshes alone (patches, quality) is drawn plain, blocks as branches.
    ///
    /// # Errors
    /// Its Strahler orders cannot be found.
    pub fn new(network: &'a Skeleton, colour: Colour, roots: &[NodeId]) -> Result<Self, NotConverged> {
        let (legend, colours) = match colour {
            Colour::Radius => return Ok(Self::by_radius(network)),
            Colour::Order => {
                let orders = Orders::from_inlets(network, roots.iter().copied())?.strahler;
                let legend = Legend::of(orders.iter().map(|&o| f64::from(o)), false);
                (Some(legend), orders.iter().map(|&o| [legend.colour(f64::from(o)); 2]).collect())
            }
            Colour::Block => {
                let branches = network.branches(&network.adjacency());
                (None, branches.of_edge.iter().map(|(branch, _)| [of_block(branch.0 as i32); 2]).collect())
            }
            Colour::Plain | Colour::Patch | Colour::Quality | Colour::Values => {
                (None, vec![[WALL_COLOURS[0]; 2]; network.edges.len()])
            }
        };
        Ok(Self { network, colours, shown: Shown { colour, legend } })
    }

    /// Prepares a network with values at both ends of its edges.
    pub fn by_values(network: &'a Skeleton, values: &[[f64; 2]], legend: Legend) -> Self {
        let colours = values.iter().map(|ends| ends.map(|x| legend.colour(x))).collect();
        Self { network, colours, shown: Shown { colour: Colour::Values, legend: Some(legend) } }
    }

    /// Draws some edges in the marker colour.
    pub fn mark(&mut self, edges: &[EdgeId]) {
        for edge in edges {
            self.colours[edge.index()] = [MARKED; 2];
        }
    }

    /// Displayed quantity and its scale.
    pub fn shown(&self) -> Shown {
        self.shown
    }

    /// Extent of the network.
    pub fn outline(&self) -> Outline {
        let mut outline = Outline::for_points(6 * self.network.nodes.len());
        for node in &self.network.nodes {
            for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
                outline.add(&(node.position + axis * node.radius));
                outline.add(&(node.position - axis * node.radius));
            }
        }
        outline
    }

    /// Renders the network.
    pub fn draw(&self, canvas: &mut Canvas) {
        let thinnest = THINNEST / canvas.camera.scale;
        for (id, colours) in self.network.edge_ids().zip(&self.colours) {
            let Tube { a, b, ra, rb } = self.network.tube(id);
            let tube = Tube { a, b, ra: ra.max(thinnest), rb: rb.max(thinnest) };
            let sides = sides(canvas, tube.max_radius());
            if tube.length() > 0.0 {
                cone(canvas, &tube, sides, *colours);
            }
            // Balls at both ends close the joints and the ends.
            for (centre, radius, colour) in [(tube.a, tube.ra, colours[0]), (tube.b, tube.rb, colours[1])] {
                if canvas.pixels(radius) > 1.0 {
                    ball(canvas, &centre, radius, sides, colour);
                }
            }
        }
        canvas.flush();
    }
}

/// Number of sides of a cone that is visually sufficient.
fn sides(canvas: &Canvas, radius: f64) -> usize {
    (5.0 + 2.5 * canvas.pixels(radius).sqrt()).clamp(5.0, 48.0) as usize
}

/// Draws the lateral surface of a cone.
fn cone(canvas: &mut Canvas, tube: &Tube, sides: usize, colours: [Rgb; 2]) {
    let axis = (tube.b - tube.a) / tube.length();
    let (u, w) = Section::new(tube.a, axis, tube.ra).frame();
    // Normals of a cone are inclined towards its thin end.
    let lean = axis * ((tube.ra - tube.rb) / tube.length());
    let out = |i: usize| {
        let angle = TAU * i as f64 / sides as f64;
        u * libm::cos(angle) + w * libm::sin(angle)
    };
    // Colours change along the vessel in visible steps.
    let steps =
        if colours[0] == colours[1] { 1 } else { (canvas.pixels(tube.length()) / 6.0).clamp(1.0, 24.0) as usize };
    for step in 0..steps {
        let [t0, t1] = [step, step + 1].map(|s| s as f64 / steps as f64);
        let colour = mixed(colours, f64::midpoint(t0, t1));
        for i in 0..sides {
            let [p, q] = [out(i), out(i + 1)];
            let at = |t: f64, v: Vec3| tube.point(t) + v * tube.radius(t);
            let [n, m] = [p + lean, q + lean];
            let quad = [at(t0, p), at(t0, q), at(t1, q), at(t1, p)];
            facet(canvas, [quad[0], quad[1], quad[2]], [n, m, m], colour);
            facet(canvas, [quad[0], quad[2], quad[3]], [n, m, n], colour);
        }
    }
}

fn ball(canvas: &mut Canvas, centre: &Point3, radius: f64, sides: usize, colour: Rgb) {
    let rings = (sides / 2).max(3);
    let out = |ring: usize, i: usize| {
        let (polar, angle) = (TAU * ring as f64 / (2 * rings) as f64, TAU * i as f64 / sides as f64);
        Vec3::new(libm::sin(polar) * libm::cos(angle), libm::sin(polar) * libm::sin(angle), libm::cos(polar))
    };
    for ring in 0..rings {
        for i in 0..sides {
            let n = [out(ring, i), out(ring + 1, i), out(ring + 1, i + 1), out(ring, i + 1)];
            let at = n.map(|n| centre + n * radius);
            facet(canvas, [at[0], at[1], at[2]], [n[0], n[1], n[2]], colour);
            facet(canvas, [at[0], at[2], at[3]], [n[0], n[2], n[3]], colour);
        }
    }
}

fn facet(canvas: &mut Canvas, corners: [Point3; 3], normals: [Vec3; 3], colour: Rgb) {
    canvas.add(Facet { corners, normals, colour, inside: WALL_COLOURS[1], lined: false });
}

fn mixed([a, b]: [Rgb; 2], t: f64) -> Rgb {
    [0, 1, 2].map(|c| (f64::from(a[c]) * (1.0 - t) + f64::from(b[c]) * t).round() as u8)
}
