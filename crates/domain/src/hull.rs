//! Hull of spheres at a distance: the organ's hull around a network.
//!
//! The body is the intersection of half-spaces, one for each of many directions. Each holds all spheres with a margin. The
//! body is convex, so that each ray from its centre leaves it once. A sphere's triangles moved along these rays give a
//! closed surface without self-intersections, which is then remeshed.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Point3, Vec3};
use anastomesh_mesh::nalgebra::Matrix3;
use anastomesh_mesh::shapes::sphere_surface;
use anastomesh_tet::TetError;
use anastomesh_tet::parts::{Watch, remesh_closed};
use rayon::prelude::*;

/// Levels of the subdivided icosahedron whose 2562 vertices are the directions. They are 4° apart.
const LEVEL: usize = 4;
/// Levels of the triangles that are moved. The last one has 327,680.
const LEVELS: [usize; 2] = [3, 7];
/// Maximum extent of the spheres in margins. At this ratio, edges of the last level are about two margins long.
pub const RATIO: f64 = 400.0;
/// Distances between the hull and its remeshed surface to try, relative to the margin. On the hull of `fixtures/tree_30.vtp`
/// the first one fails.
const TOLERANCES: [f64; 3] = [0.05, 0.045, 0.04];

/// Neighbouring spheres that are excluded together.
const GROUP: usize = 256;

/// Sphere: centre and radius.
pub type Sphere = (Point3, f64);

/// Closed surface around spheres, at a margin above 0. Edges have about this length, and less at bends. There is at least
/// one sphere.
///
/// # Errors
/// [`TetError::Cancelled`].
pub fn hull(spheres: &[Sphere], margin: f64, side: f64, watch: &Watch) -> Result<TriMesh, TetError> {
    let ways: Vec<Vec3> = sphere_surface(LEVEL).points.iter().map(|p| p.coords).collect();
    let extremes = extremes(spheres, &ways);
    watch.ask()?;
    let body = Body::new(&ways, &extremes, margin);
    let extent = Aabb::of_points(extremes.iter().map(|(p, _)| p)).diagonal();
    // An edge of level n is about 1.1 / 2^n radii long.
    let level = libm::log2(1.1 * extent / margin).ceil().clamp(LEVELS[0] as f64, LEVELS[1] as f64) as usize;
    let mut surface = sphere_surface(level);
    surface.points.par_iter_mut().for_each(|p| *p = body.exit(&p.coords));
    watch.ask()?;
    remeshed(surface, margin, side, watch)
}

/// Remeshes a hull. Where all tolerances fail, the surface stays.
fn remeshed(surface: TriMesh, margin: f64, side: f64, watch: &Watch) -> Result<TriMesh, TetError> {
    let markers = vec![0; surface.triangles.len()];
    for share in TOLERANCES {
        let (made, _) = remesh_closed(&surface, &markers, (Some(side), Some(share * margin)), watch)?;
        if made != surface {
            return Ok(made);
        }
    }
    Ok(surface)
}

/// Spheres that reach furthest in each direction. Neighbours in the list are mostly close to each other, so that most groups
/// of them are excluded as a whole.
fn extremes(spheres: &[Sphere], ways: &[Vec3]) -> Vec<Sphere> {
    let groups: Vec<(Sphere, &[Sphere])> = spheres.par_chunks(GROUP).map(|group| (around(group), group)).collect();
    let furthest = |way: &Vec3| {
        let bounds = || groups.iter().map(|(around, group)| (reach(around, way), *group));
        let (_, nearest) = bounds().max_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut best = *nearest.iter().max_by(|a, b| reach(a, way).total_cmp(&reach(b, way)))?;
        for (bound, group) in bounds() {
            if bound > reach(&best, way) {
                let further = |best: Sphere, s: &Sphere| if reach(s, way) > reach(&best, way) { *s } else { best };
                best = group.iter().fold(best, further);
            }
        }
        Some(best)
    };
    ways.par_iter().filter_map(furthest).collect()
}

/// Sphere around others, rounded up.
fn around(spheres: &[Sphere]) -> Sphere {
    let all = Aabb::of_points(spheres.iter().map(|(p, _)| p));
    let largest = spheres.iter().map(|(_, r)| *r).fold(0.0, f64::max);
    let centre = all.min + (all.max - all.min) * 0.5;
    let rounding = 1e-12 * (centre.coords.norm() + largest);
    (centre, 0.5 * all.diagonal() + largest + rounding)
}

/// Extent of a sphere in a direction.
fn reach((p, r): &Sphere, way: &Vec3) -> f64 {
    p.coords.dot(way) + r
}

/// Intersection of half-spaces.
struct Body {
    /// Point inside.
    centre: Point3,
    /// Outward normals with their distances from the centre.
    planes: Vec<(Vec3, f64)>,
    /// Map of the unit sphere to an ellipsoid as long and wide as the body, so that triangles are not stretched much.
    shape: Matrix3<f64>,
}

impl Body {
    /// Half-spaces across some directions that hold the extreme spheres of these directions with a margin.
    fn new(ways: &[Vec3], extremes: &[Sphere], margin: f64) -> Self {
        let sum: Vec3 = extremes.iter().map(|(p, _)| p.coords).sum();
        let centre = Point3::from(sum / extremes.len().max(1) as f64);
        let reach = |way: &Vec3| {
            let of = |(p, r): &Sphere| (p - centre).dot(way) + r;
            margin + extremes.iter().map(of).fold(0.0, f64::max)
        };
        let covariance: Matrix3<f64> = extremes.iter().map(|(p, _)| (p - centre) * (p - centre).transpose()).sum();
        let axes = covariance.symmetric_eigen().eigenvectors;
        let widths = Vec3::from_fn(|i, _| {
            let axis = axes.column(i).into_owned();
            reach(&axis).midpoint(reach(&-axis))
        });
        let planes = ways.iter().map(|way| (*way, reach(way))).collect();
        Self { centre, planes, shape: axes * Matrix3::from_diagonal(&widths) * axes.transpose() }
    }

    /// Place at which a ray from the centre leaves. `way` is a direction before the map to the ellipsoid.
    fn exit(&self, way: &Vec3) -> Point3 {
        let way = self.shape * way;
        let at = |(normal, distance): &(Vec3, f64)| {
            let slope = normal.dot(&way);
            if slope > 0.0 { distance / slope } else { f64::INFINITY }
        };
        self.centre + way * self.planes.iter().map(at).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::super::inside::Closed;
    use super::*;
    use anastomesh_tet::Tetrahedralizer;

    /// Distance of the nearest sphere from a surface.
    fn clearance(surface: &TriMesh, spheres: &[Sphere]) -> f64 {
        let corners = |t: &[u32; 3]| t.map(|v| surface.points[v as usize]);
        let distance = |(p, r): &Sphere| {
            let to = |t: &[u32; 3]| {
                let [a, b, c] = corners(t);
                anastomesh_mesh::geometry::point_triangle(p, [&a, &b, &c]).1 - r
            };
            surface.triangles.iter().map(to).fold(f64::INFINITY, f64::min)
        };
        spheres.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    /// Smallest angle of a triangle in degrees.
    fn smallest_angle([a, b, c]: [Point3; 3]) -> f64 {
        let at = |p: Point3, q: Point3, r: Point3| (q - p).angle(&(r - p)).to_degrees();
        at(a, b, c).min(at(b, c, a)).min(at(c, a, b))
    }

    #[test]
    fn hulls_are_closed_and_clear_by_the_margin() {
        let line: Vec<Sphere> = (0..9).map(|i| (Point3::new(f64::from(i), 0.0, 0.0), 0.3)).collect();
        let flat: Vec<Sphere> =
            (0..40).map(|i| (Point3::new(f64::from(i % 8), 0.0, f64::from(i / 8 * i % 7)), 0.1)).collect();
        let one = vec![(Point3::new(1e3, -2e3, 5.0), 0.5)];
        for (spheres, margin) in [(line, 0.2), (flat, 1.0), (one, 0.1)] {
            let surface = hull(&spheres, margin, 2.0 * margin, &Watch::NOBODY).expect("made");
            Tetrahedralizer::new().check(&surface).expect("closed");
            let closed = Closed::new(&surface);
            assert!(spheres.iter().all(|(p, _)| closed.contains(p)));
            let clear = clearance(&surface, &spheres);
            assert!((0.9..1.2).contains(&(clear / margin)), "{clear} {margin}");
            let longest = surface.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let longest = longest.map(|e| (surface.points[e[0] as usize] - surface.points[e[1] as usize]).norm());
            assert!(longest.fold(0.0, f64::max) < 4.0 * margin);
            let smallest = surface.triangles.iter().map(|t| smallest_angle(t.map(|v| surface.points[v as usize])));
            assert!(smallest.fold(f64::INFINITY, f64::min) > 15.0);
        }
    }

    #[test]
    fn hulls_of_many_vessels_are_remeshed() {
        let at = |i: u32, step: f64, most: f64| (f64::from(i) * step).fract() * most;
        let cloud: Vec<Sphere> =
            (0..60).map(|i| (Point3::new(at(i, 0.618, 40.0), at(i, 0.414, 30.0), at(i, 0.732, 20.0)), 0.4)).collect();
        let surface = hull(&cloud, 2.5, 2.5, &Watch::NOBODY).expect("made");
        let count = surface.triangles.len();
        assert!(count < 4000, "{count}");
        assert!(clearance(&surface, &cloud) > 0.9 * 2.5);
    }
}
