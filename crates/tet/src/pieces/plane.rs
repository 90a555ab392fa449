//! Planes that divide a surface into halves of about equal size.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Point3};

/// Planes per axis that are compared.
const BINS: usize = 256;

/// Least share of the triangles on each side of a plane.
const LEAST: f64 = 0.35;

/// Plane across an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plane {
    pub axis: usize,
    pub at: f64,
}

impl Plane {
    /// Signed distance of a point.
    pub fn distance(&self, p: &Point3) -> f64 {
        p[self.axis] - self.at
    }

    /// Point of the plane next to a point.
    pub fn project(&self, p: &Point3) -> Point3 {
        let mut on = *p;
        on[self.axis] = self.at;
        on
    }
}

/// Planes that divide a surface, those that meet few triangles first.
pub(super) fn planes(surface: &TriMesh) -> Vec<Plane> {
    let mut all: Vec<(usize, Plane)> = (0..3).flat_map(|axis| across(surface, axis)).collect();
    all.sort_by_key(|(met, _)| *met);
    let mut kept: Vec<Plane> = Vec::new();
    let bounds = Aabb::of_points(&surface.points);
    let width = |axis: usize| bounds.max[axis] - bounds.min[axis];
    for (_, plane) in all {
        let is_other = |k: &Plane| k.axis != plane.axis || (k.at - plane.at).abs() > 0.05 * width(plane.axis);
        if kept.iter().all(is_other) {
            kept.push(plane);
        }
    }
    kept
}

/// Planes across an axis, with the number of triangles that each meets.
fn across(surface: &TriMesh, axis: usize) -> Vec<(usize, Plane)> {
    let bounds = Aabb::of_points(&surface.points);
    let (low, width) = (bounds.min[axis], bounds.max[axis] - bounds.min[axis]);
    let bin = |x: f64| (((x - low) / width * BINS as f64) as usize).min(BINS - 1);
    // Triangles that begin and end in each bin.
    let (mut begin, mut end) = ([0; BINS], [0; BINS]);
    for t in &surface.triangles {
        let x = t.map(|v| surface.points[v as usize][axis]);
        begin[bin(x[0].min(x[1]).min(x[2]))] += 1;
        end[bin(x[0].max(x[1]).max(x[2]))] += 1;
    }
    let least = (LEAST * surface.triangles.len() as f64) as usize;
    let (mut begun, mut ended) = (0, 0);
    let mut found = Vec::new();
    for i in 0..BINS {
        begun += begin[i];
        let at = low + width * (i as f64 + 0.5) / BINS as f64;
        let met = begun - ended;
        ended += end[i];
        if ended >= least && surface.triangles.len() - begun >= least {
            found.push((met, Plane { axis, at }));
        }
    }
    found
}
