//! Readers of networks (SWC, VTP), and the distance of a wall from their vessels.

use crate::faces::Boundary;
use crate::labels::WALL;
use crate::mesh::{Cap, Mesh, Read, fail, next_n};
use crate::report::{Condition, Report};
use crate::tree::Tree;
use crate::xml::VtkFile;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Conical piece of a vessel.
pub struct Cone {
    ends: [[f64; 3]; 2],
    radii: [f64; 2],
}

impl Cone {
    /// Distance of a point from the surface, negative inside, and radius of the vessel beside it. The surface is that of
    /// all balls along the axis.
    fn distance(&self, p: &[f64; 3]) -> [f64; 2] {
        let [a, b] = &self.ends;
        let axis = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let from = [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
        let dot = |u: &[f64; 3], v: &[f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let length = dot(&axis, &axis).sqrt();
        let along = if length > 0.0 { dot(&axis, &from) / length } else { 0.0 };
        let across = (dot(&from, &from) - along * along).max(0.0).sqrt();
        let slope = if length > 0.0 { (self.radii[1] - self.radii[0]) / length } else { 0.0 };
        // The nearest ball is not beside the point if the vessel tapers.
        let shift = across * slope / (1.0 - slope * slope).max(1e-300).sqrt();
        let at = if slope.abs() < 1.0 {
            (along + shift).clamp(0.0, length)
        } else if slope > 0.0 {
            length
        } else {
            0.0
        };
        let radius = self.radii[0] + slope * at;
        [across.hypot(along - at) - radius, radius]
    }

    fn bounds(&self, tolerance: f64) -> [[f64; 2]; 3] {
        let reach = self.radii[0].max(self.radii[1]) * (1.0 + tolerance);
        let [a, b] = &self.ends;
        [0, 1, 2].map(|k| [a[k].min(b[k]) - reach, a[k].max(b[k]) + reach])
    }
}

/// Reads a network; the extension selects the format.
pub fn read(path: &Path, bytes: &[u8]) -> Read<Vec<Cone>> {
    let cones = match path.extension().and_then(|e| e.to_str()).unwrap_or_default() {
        "swc" => swc(&String::from_utf8_lossy(bytes)),
        "vtp" => vtp(bytes),
        other => fail(format!("networks '.{other}' are not supported; use .swc or .vtp")),
    }?;
    if cones.is_empty() { fail("the network has no vessels") } else { Ok(cones) }
}

fn swc(text: &str) -> Read<Vec<Cone>> {
    let mut nodes: HashMap<i64, ([f64; 3], f64)> = HashMap::new();
    let mut links = Vec::new();
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let row: Option<[f64; 7]> = next_n(&mut line.split_ascii_whitespace());
        let Some([id, _, x, y, z, radius, parent]) = row else { return fail(format!("bad row '{line}'")) };
        nodes.insert(id as i64, ([x, y, z], radius));
        links.push([id as i64, parent as i64]);
    }
    let cone = |[a, b]: [i64; 2]| {
        let ((p, r), (q, s)) = (nodes.get(&a)?, nodes.get(&b)?);
        Some(Cone { ends: [*p, *q], radii: [*r, *s] })
    };
    Ok(links.into_iter().filter_map(cone).collect())
}

fn vtp(bytes: &[u8]) -> Read<Vec<Cone>> {
    let file = VtkFile::parse(bytes)?;
    let points = file.required("Points", "")?.real();
    let points: &[[f64; 3]] = points.as_chunks().0;
    let (vertices, ends) =
        (file.required("Lines", "connectivity")?.whole()?, file.required("Lines", "offsets")?.whole()?);
    let names = file.names("PointData");
    let Some(name) = names.iter().find(|name| name.to_ascii_lowercase().contains("radius")) else {
        return fail("the points have no radii");
    };
    let radii = file.required("PointData", name)?.real();
    let (mut cones, mut start) = (Vec::new(), 0);
    for end in ends {
        let end = usize::try_from(end).unwrap_or(usize::MAX);
        let Some(line) = vertices.get(start..end) else { return fail("a line has a bad offset") };
        start = end;
        for pair in line.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|v| {
                let v = usize::try_from(v).ok()?;
                Some((*points.get(v)?, *radii.get(v)?))
            });
            let (Some((p, r)), Some((q, s))) = (a, b) else { return fail("a line has a missing point or radius") };
            cones.push(Cone { ends: [p, q], radii: [r, s] });
        }
    }
    Ok(cones)
}

/// Adds the condition that wall vertices are within a tolerance of the nearest vessel's surface, in radii of the vessel.
pub fn check(cones: &[Cone], tolerance: f64, mesh: &Mesh, boundary: &Boundary, report: &mut Report) {
    let walls = mesh.triangles.iter().zip(&mesh.labels).filter(|(_, label)| **label == WALL).map(|(face, _)| face);
    let caps = mesh.triangles.iter().zip(&mesh.labels).filter(|(_, label)| **label != WALL).map(|(face, _)| face);
    let mut on_caps: HashSet<u32> = caps.flatten().copied().collect();
    // Without labels, every boundary vertex belongs to the wall, except those in the plane of a cap and near it.
    if mesh.triangles.is_empty() {
        let is_on = |p: &[f64; 3], cap: &Cap| {
            let from = [p[0] - cap.center[0], p[1] - cap.center[1], p[2] - cap.center[2]];
            let height: f64 = (0..3).map(|k| from[k] * cap.normal[k]).sum();
            let square: f64 = from.iter().map(|x| x * x).sum();
            height.abs() <= 1e-6 * cap.radius && square <= 2.0 * cap.radius * cap.radius
        };
        let vertices = boundary.faces.as_flattened().iter();
        on_caps.extend(vertices.filter(|&&v| mesh.caps.iter().any(|cap| is_on(&mesh.points[v as usize], cap))));
    }
    let faces: Vec<&[u32; 3]> =
        if mesh.triangles.is_empty() { boundary.faces.iter().collect() } else { walls.collect() };
    let mut vertices: Vec<u32> = faces.into_iter().flatten().copied().collect();
    vertices.sort_unstable();
    vertices.dedup();
    let tree = Tree::new(cones.iter().map(|cone| cone.bounds(tolerance)).collect());
    let is_far = |&v: &u32| {
        let Some(point) = mesh.points.get(v as usize) else { return true };
        let mut nearest = [f64::INFINITY, 1.0];
        tree.around(point, &mut |i| {
            let other = cones[i as usize].distance(point);
            nearest = if other[0] < nearest[0] { other } else { nearest };
        });
        nearest[0].abs() > tolerance * nearest[1]
    };
    report.add(Condition::WallDistance, vertices.into_iter().filter(|v| !on_caps.contains(v)).filter(is_far));
}
