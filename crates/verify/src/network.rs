//! Readers of networks (SWC, VTP), and the distance of a wall from their vessels.

use crate::faces::Boundary;
use crate::labels::WALL;
use crate::mesh::{Cap, Mesh};
use crate::numbers::{DOUBLE, Numbers};
use crate::report::{Condition, Report};
use crate::space::{Bounds, Point, boxes, dot, minus};
use crate::xml::VtkFile;
use anyhow::{Context as _, Result, bail, ensure};
use itertools::Itertools as _;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Conical piece of a vessel.
pub struct Cone {
    ends: [Point; 2],
    radii: [f64; 2],
}

/// Position and radius of a node.
type Node = (Point, f64);

impl Cone {
    fn between((p, r): Node, (q, s): Node) -> Self {
        Self { ends: [p, q], radii: [r, s] }
    }

    /// Distance of a point from the surface, negative inside, and radius of the vessel beside it. The surface is that of
    /// all balls along the axis.
    fn distance(&self, p: &Point) -> [f64; 2] {
        let [a, b] = &self.ends;
        let (axis, from) = (minus(*b, *a), minus(*p, *a));
        let length = dot(axis, axis).sqrt();
        let per_length = |x: f64| if length > 0.0 { x / length } else { 0.0 };
        let (along, slope) = (per_length(dot(axis, from)), per_length(self.radii[1] - self.radii[0]));
        let across = (dot(from, from) - along * along).max(0.0).sqrt();
        // The nearest ball is not beside the point if the vessel tapers.
        let shift = across * slope / (1.0 - slope * slope).max(1e-300).sqrt();
        let at = match slope {
            1.0.. => length,
            ..=-1.0 => 0.0,
            _ => (along + shift).clamp(0.0, length),
        };
        let radius = self.radii[0] + slope * at;
        [across.hypot(along - at) - radius, radius]
    }

    fn bounds(&self, tolerance: f64) -> Bounds {
        let reach = self.radii[0].max(self.radii[1]) * (1.0 + tolerance);
        let [low, high] = [-reach, reach].map(|by| self.ends.map(|p| p.map(|x| x + by)));
        Bounds::from_points(low.iter().chain(&high))
    }

    fn is_finite(&self) -> bool {
        self.ends.as_flattened().iter().chain(&self.radii).all(|x| x.is_finite())
    }
}

/// Reads a network; the extension selects the format.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Vec<Cone>> {
    let cones = match path.extension().and_then(|e| e.to_str()).unwrap_or_default() {
        "swc" => swc(&String::from_utf8_lossy(bytes)),
        "vtp" => vtp(bytes),
        other => bail!("networks '.{other}' are not supported; use .swc or .vtp"),
    }?;
    ensure!(!cones.is_empty(), "the network has no vessels");
    ensure!(cones.iter().all(Cone::is_finite), "the network has a position or a radius that is not finite");
    Ok(cones)
}

fn swc(text: &str) -> Result<Vec<Cone>> {
    let mut nodes: HashMap<i64, Node> = HashMap::new();
    let mut links = Vec::new();
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let row = Numbers::text(line).array(DOUBLE).ok().with_context(|| format!("bad row '{line}'"))?;
        let [id, _, x, y, z, radius, parent] = row;
        nodes.insert(id as i64, ([x, y, z], radius));
        links.push([id as i64, parent as i64]);
    }
    let cone = |[a, b]: [i64; 2]| Some(Cone::between(*nodes.get(&a)?, *nodes.get(&b)?));
    Ok(links.into_iter().filter_map(cone).collect())
}

fn vtp(bytes: &[u8]) -> Result<Vec<Cone>> {
    let file = VtkFile::parse(bytes)?;
    let points = file.required("Points", "")?;
    let points: &[Point] = points.as_chunks().0;
    let of = |name| file.required::<i64>("Lines", name);
    let (vertices, ends) = (of("connectivity")?, of("offsets")?);
    let names = file.names("PointData");
    let name = names.iter().find(|name| name.to_ascii_lowercase().contains("radius"));
    let name = name.context("the points have no radii")?;
    let radii: Vec<f64> = file.required("PointData", name)?;
    let (mut cones, mut start) = (Vec::new(), 0);
    for end in ends {
        let end = usize::try_from(end).unwrap_or(usize::MAX);
        let line = vertices.get(start..end).context("a line has a bad offset")?;
        start = end;
        let node = |&v: &i64| usize::try_from(v).ok().and_then(|v| Some((*points.get(v)?, *radii.get(v)?)));
        let nodes: Option<Vec<_>> = line.iter().map(node).collect();
        let nodes = nodes.context("a line has a missing point or radius")?;
        cones.extend(nodes.windows(2).map(|pair| Cone::between(pair[0], pair[1])));
    }
    Ok(cones)
}

/// Adds the condition that wall vertices are within a tolerance of the nearest vessel's surface, in radii of the vessel.
pub fn check(cones: &[Cone], tolerance: f64, mesh: &Mesh, boundary: &Boundary, report: &mut Report) {
    let (wall, caps): (Vec<_>, Vec<_>) = mesh.labelled().partition(|(_, label)| *label == WALL);
    let vertices = |own: Vec<([u32; 3], i64)>| own.into_iter().flat_map(|(face, _)| face);
    let (mut wall, mut on_caps) = (vertices(wall).collect_vec(), vertices(caps).collect::<HashSet<u32>>());
    // Without labels, every boundary vertex belongs to the wall, except those in the plane of a cap and near it.
    if mesh.triangles.is_empty() {
        let is_on = |p: &Point, cap: &Cap| {
            let from = minus(*p, cap.center);
            let height = dot(from, cap.normal).abs();
            height <= 1e-6 * cap.radius && dot(from, from) <= 2.0 * cap.radius * cap.radius
        };
        wall.extend(boundary.faces.as_flattened());
        on_caps.extend(wall.iter().filter(|&&v| mesh.caps.iter().any(|cap| is_on(&mesh.points[v as usize], cap))));
    }
    let tree = boxes(cones.iter().map(|cone| cone.bounds(tolerance)));
    let is_far = |&v: &u32| {
        let Some(point) = mesh.points.get(v as usize) else { return true };
        let near = tree.locate_in_envelope_intersecting(Bounds::from_point(*point));
        let distances = near.map(|own| cones[own.data as usize].distance(point)).filter(|found| !found[0].is_nan());
        let nearest = distances.min_by(|a, b| a[0].total_cmp(&b[0]));
        nearest.is_none_or(|[distance, radius]| distance.abs() > tolerance * radius)
    };
    report.add(
        Condition::WallDistance,
        wall.into_iter().sorted_unstable().dedup().filter(|v| !on_caps.contains(v)).filter(is_far),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(found: [f64; 2], expected: [f64; 2]) -> bool {
        found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-12)
    }

    /// Vessel along a line that is parallel to no axis, and a function of positions along and across it.
    fn vessel(length: f64, radii: [f64; 2]) -> (Cone, impl Fn(f64, f64) -> [f64; 3]) {
        let (start, axis, side) = ([1., 2., 3.], [2. / 3., -1. / 3., 2. / 3.], [1. / 3., -2. / 3., -2. / 3.]);
        let at = move |along: f64, across: f64| [0, 1, 2].map(|k| start[k] + along * axis[k] + across * side[k]);
        (Cone { ends: [start, at(length, 0.0)], radii }, at)
    }

    #[test]
    fn distances_are_from_the_surface_of_all_balls() {
        let root = 0.75_f64.sqrt();
        for (length, radii, along, across, expected) in [
            // A cylinder: beside it, inside, and beyond both ends.
            (4.0, [2.0, 2.0], 1.0, 5.0, [3.0, 2.0]),
            (4.0, [2.0, 2.0], 1.0, 0.5, [-1.5, 2.0]),
            (4.0, [2.0, 2.0], 7.0, 4.0, [3.0, 2.0]),
            (4.0, [2.0, 2.0], -3.0, 4.0, [3.0, 2.0]),
            // A taper by half: its side has the normal (1/2, √3/2).
            (2.0, [1.0, 0.0], 1.0, 1.0, [root + 0.5 - 1.0, 1.0 - 0.5 * (1.0 - 0.5 / root)]),
            (2.0, [0.0, 1.0], 1.0, 1.0, [root + 0.5 - 1.0, 0.5 * (1.0 + 0.5 / root)]),
            // Off the side, the ball at an end is nearest.
            (2.0, [1.0, 0.0], 0.0, 3.0, [2.0, 1.0]),
            (2.0, [0.0, 1.0], 2.0, 3.0, [2.0, 1.0]),
            // A ball that contains the other.
            (1.0, [1.0, 3.0], 0.5, 0.0, [-2.5, 3.0]),
            (1.0, [3.0, 1.0], 0.5, 0.0, [-2.5, 3.0]),
            (1.0, [1.0, 2.0], 0.5, 0.0, [-1.5, 2.0]),
            (1.0, [2.0, 1.0], 0.5, 0.0, [-1.5, 2.0]),
            // A ball alone.
            (0.0, [1.5, 1.5], 3.0, 4.0, [3.5, 1.5]),
        ] {
            let (cone, at) = vessel(length, radii);
            let found = cone.distance(&at(along, across));
            assert!(is_near(found, expected), "{length} {radii:?} {along} {across}: {found:?}, expected {expected:?}");
        }
    }

    #[test]
    fn a_ball_that_touches_the_larger_from_inside_has_no_side() {
        for radii in [[1., 2.], [2., 1.]] {
            let cone = Cone { ends: [[0.; 3], [1., 0., 0.]], radii };
            assert_eq!(cone.distance(&[0.5, 0., 0.]), [-1.5, 2.0], "{radii:?}");
        }
    }

    #[test]
    fn bounds_reach_beyond_the_balls_by_the_tolerance() {
        let cone = Cone { ends: [[1., 5., 3.], [4., 2., 3.]], radii: [1.0, 2.0] };
        assert_eq!(cone.bounds(0.5), Bounds::from_corners([-2., -1., 0.], [7., 8., 6.]));
    }

    /// Number of points far from the vessels.
    fn far(mesh: &Mesh, cones: &[Cone], tolerance: f64) -> usize {
        let mut report = Report::default();
        let boundary = crate::faces::check(mesh, &mut report).expect("a boundary");
        check(cones, tolerance, mesh, &boundary, &mut report);
        report.outcomes.last().map_or(0, |outcome| outcome.count)
    }

    #[test]
    fn the_tolerance_is_in_radii_of_the_nearest_vessel() {
        let ball = |x: f64, radius: f64| Cone { ends: [[x, 0., 0.]; 2], radii: [radius; 2] };
        let points = vec![[2., 0., 0.], [0., 2., 0.], [0., 0., 2.], [-2., 0., 0.]];
        let mesh = Mesh { points, tets: vec![[0, 1, 2, 3]], ..Mesh::default() };
        let mesh = |labels: &[i64]| {
            let triangles = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]][..labels.len()].to_vec();
            Mesh { triangles, labels: labels.to_vec(), ..mesh.clone() }
        };
        assert_eq!((far(&mesh(&[]), &[ball(0., 1.)], 1.0), far(&mesh(&[]), &[ball(0., 1.)], 0.99)), (0, 4));
        assert_eq!((far(&mesh(&[]), &[ball(0., 3.)], 0.34), far(&mesh(&[]), &[ball(0., 3.)], 0.33)), (0, 4));
        // A vessel that is larger and farther away does not count.
        let both = [ball(2., 0.1), ball(-100., 90.)];
        assert_eq!((far(&mesh(&[]), &both, 1.01), far(&mesh(&[]), &both, 0.99)), (0, 1));
        // Vertices of caps are not compared, nor are those of no face.
        assert_eq!(far(&mesh(&[1, 1, 1, 1]), &[], 1.0), 4);
        assert_eq!(far(&mesh(&[1]), &[], 1.0), 3);
        assert_eq!(far(&mesh(&[1, 2]), &[], 1.0), 1);
    }

    #[test]
    fn vertices_in_the_plane_of_a_cap_and_near_it_are_on_it() {
        let points = vec![[5., -7., 2.], [6., -7., 2.], [5., -6., 2.], [5., -7., 3.]];
        let mut mesh = Mesh { points, tets: vec![[0, 1, 2, 3]], ..Mesh::default() };
        let mut count = |move_by: [f64; 3]| {
            let center = [0, 1, 2].map(|k| [5., -7., 2.][k] + move_by[k]);
            mesh.caps = vec![Cap { patch: 2, node: 0, center, normal: [0., 0., 1.], radius: 3.0 }];
            far(&mesh, &[], 1.0)
        };
        // The limits are 3e-6 along the normal and 3 √2 = 4.243 across it. The last vertex is at height 1.
        assert_eq!((count([0., 0., 2.9e-6]), count([0., 0., -2.9e-6]), count([0., 0., 3.1e-6])), (1, 1, 4));
        assert_eq!((count([-3.2, 0., 0.]), count([-3.3, 0., 0.])), (1, 2));
        assert_eq!((count([0., -3.2, 0.]), count([0., -3.3, 0.])), (1, 2));
        assert_eq!((count([4.2, 0., 0.]), count([4.3, 0., 0.]), count([9., 0., 0.])), (2, 3, 4));
    }

    fn cones(name: &str, text: &str) -> Result<Vec<[f64; 4]>, String> {
        let cones = read(Path::new(name), text.as_bytes()).map_err(|e| format!("{e:#}"))?;
        Ok(cones.iter().map(|cone| [cone.ends[0][0], cone.radii[0], cone.ends[1][0], cone.radii[1]]).collect())
    }

    #[test]
    fn rows_of_swc_link_nodes_with_parents() {
        let text = "# x is the number\n\n  2 3 20 0 0 0.2 1 extra\n1 3 10 0 0 0.1 -1\n3 3 30 0 0 0.3 2\n";
        assert_eq!(cones("n.swc", text), Ok(vec![[20., 0.2, 10., 0.1], [30., 0.3, 20., 0.2]]));
        assert_eq!(cones("n.swc", "1 3 10 0 0 0.1 -1\n"), Err("the network has no vessels".into()));
        assert_eq!(cones("n.swc", "1 3 10 0 0 0.1\n"), Err("bad row '1 3 10 0 0 0.1'".into()));
        for number in ["nan", "inf"] {
            let text = text.replace("0.3", number);
            assert_eq!(cones("n.swc", &text), Err("the network has a position or a radius that is not finite".into()));
        }
        assert_eq!(cones("n.vtk", ""), Err("networks '.vtk' are not supported; use .swc or .vtp".into()));
    }

    #[test]
    fn polylines_of_vtp_are_vessels() {
        let array = |kind: &str, name: &str, text: &str| {
            format!("<DataArray type='{kind}' Name='{name}' format='ascii'>{text}</DataArray>")
        };
        let file = |name: &str, radii: &str, connectivity: &str, offsets: &str| {
            let (ids, radii) = (array("Float64", "id", "5 6 7 8"), array("Float64", name, radii));
            let points = array("Float64", "p", "10 0 0 20 0 0 30 0 0 40 0 0");
            let lines = array("Int32", "connectivity", connectivity) + &array("Int32", "offsets", offsets);
            format!(
                "<VTKFile type='PolyData'><PointData>{ids}{radii}</PointData><Points>{points}</Points><Lines>{lines}</Lines>"
            )
        };
        let radii = "1 2 3 4";
        let expected = vec![[10., 1., 20., 2.], [20., 2., 30., 3.], [10., 1., 40., 4.]];
        assert_eq!(cones("n.vtp", &file("MaxRadius", radii, "0 1 2 0 3", "3 5")), Ok(expected));
        for (name, radii, connectivity, offsets, reason) in [
            ("width", radii, "0 1", "2", "the points have no radii"),
            ("radius", radii, "0 1", "3", "a line has a bad offset"),
            ("radius", radii, "0 1", "-1", "a line has a bad offset"),
            ("radius", radii, "0 4", "2", "a line has a missing point or radius"),
            ("radius", radii, "0 -1", "2", "a line has a missing point or radius"),
            ("radius", "1 2 3", "0 3", "2", "a line has a missing point or radius"),
            ("radius", radii, "0 1", "1 2", "the network has no vessels"),
        ] {
            assert_eq!(cones("n.vtp", &file(name, radii, connectivity, offsets)), Err(reason.into()));
        }
    }
}
