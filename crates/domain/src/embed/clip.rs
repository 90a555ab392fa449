//! Course of a segment through the tetrahedra of a mesh.
//!
//! The point where the segment enters a tetrahedron is never computed. It is known by its carrier: the vertex, edge,
//! face or tetrahedron that has the point in its interior. Exact orientations of the two ends and of vertices determine
//! the next carrier, so that no roundoff can lead astray. Only the parameters along the segment are rounded.

use super::inside::{Stars, corners, side};
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::{orient3d, orient3d_accurate};

/// Smallest simplex of a mesh that contains a point: a vertex, edge, face or tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Carrier {
    vertices: [u32; 4],
    count: usize,
}

impl Carrier {
    /// Carrier with the vertices of a tetrahedron that are `used`.
    fn of(vertices: [u32; 4], used: impl Fn(usize) -> bool) -> Self {
        let mut carrier = Self { vertices, count: 0 };
        for corner in (0..4).filter(|&corner| used(corner)) {
            carrier.vertices[carrier.count] = vertices[corner];
            carrier.count += 1;
        }
        carrier
    }

    fn vertices(&self) -> &[u32] {
        &self.vertices[..self.count]
    }
}

/// Reason why a segment cannot be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lost {
    /// It leaves the mesh at this parameter.
    Leaves(f64),
    /// The tetrahedra overlap or are inverted.
    Invalid,
}

/// Mesh with the tetrahedra around its vertices.
#[derive(Debug)]
pub struct Cells<'a> {
    mesh: &'a TetMesh,
    stars: Stars,
}

/// Indices of the corners of the face opposite to a corner.
const OPPOSITE: [[usize; 3]; 4] = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

impl<'a> Cells<'a> {
    pub fn new(mesh: &'a TetMesh) -> Self {
        Self { stars: Stars::of(mesh), mesh }
    }

    /// Divides the segment from `p` to `q` between tetrahedra; `start` is one that contains `p`. Calls `piece` with each
    /// tetrahedron and the parameters of its part, in order. A part in several tetrahedra belongs to the first of them.
    pub fn follow(&self, [p, q]: [&Point3; 2], start: u32, mut piece: impl FnMut(u32, [f64; 2])) -> Result<(), Lost> {
        let at = corners(self.mesh, start);
        let mut carrier = Carrier::of(self.mesh.tets[start as usize], |corner| side(at, corner, p) > 0.0);
        let mut from = 0.0;
        // A segment enters a convex cell once.
        for _ in 0..=self.mesh.tets.len() {
            let tet = self.next(&carrier, q).ok_or(Lost::Leaves(from))?;
            let at = corners(self.mesh, tet);
            let sides: [f64; 4] = std::array::from_fn(|corner| side(at, corner, q));
            if sides.iter().all(|&s| s >= 0.0) {
                // Later parameters are at most 1 after rounding, so that only the last part may vanish.
                if from < 1.0 {
                    piece(tet, [from, 1.0]);
                }
                return Ok(());
            }
            let (corner, exit) = self.exit(tet, [p, q], sides).ok_or(Lost::Invalid)?;
            carrier = exit;
            let to = crossing(at, corner, [p, q]);
            if to.is_nan() {
                return Err(Lost::Invalid);
            }
            let to = to.clamp(from, 1.0);
            if to > from {
                piece(tet, [from, to]);
            }
            from = to;
        }
        Err(Lost::Invalid)
    }

    /// First tetrahedron at a carrier into which a segment from there to `q` leads.
    fn next(&self, carrier: &Carrier, q: &Point3) -> Option<u32> {
        let around = self.stars.of_vertex(*carrier.vertices().first()?);
        let leads_in = |&&tet: &&u32| {
            let vertices = self.mesh.tets[tet as usize];
            let at = corners(self.mesh, tet);
            carrier.vertices().iter().all(|v| vertices.contains(v))
                && (0..4).all(|i| carrier.vertices().contains(&vertices[i]) || side(at, i, q) >= 0.0)
        };
        around.iter().find(leads_in).copied()
    }

    /// Carrier of the point where a segment leaves a tetrahedron, and the corner opposite to a face with that point.
    /// `sides` are those of the end `q`.
    fn exit(&self, tet: u32, [p, q]: [&Point3; 2], sides: [f64; 4]) -> Option<(usize, Carrier)> {
        let at = corners(self.mesh, tet);
        (0..4).filter(|&corner| sides[corner] < 0.0).find_map(|corner| {
            let face = OPPOSITE[corner];
            // The side of the line on which an edge lies is the weight of the vertex opposite to the edge.
            let weight = |i: usize| orient3d(p, q, at[face[(i + 1) % 3]], at[face[(i + 2) % 3]]);
            let weights = [weight(0), weight(1), weight(2)];
            let inside = weights.iter().all(|&w| w >= 0.0) || weights.iter().all(|&w| w <= 0.0);
            let used = |i: usize| face.iter().zip(weights).any(|(&j, w)| i == j && w != 0.0);
            inside.then(|| (corner, Carrier::of(self.mesh.tets[tet as usize], used)))
        })
    }
}

/// Parameter at which a segment crosses the plane of the face opposite to a corner.
fn crossing([a, b, c, d]: [&Point3; 4], corner: usize, ends: [&Point3; 2]) -> f64 {
    let [from, to] = ends.map(|p| match corner {
        0 => orient3d_accurate(p, b, c, d),
        1 => orient3d_accurate(a, p, c, d),
        2 => orient3d_accurate(a, b, p, d),
        _ => orient3d_accurate(a, b, c, p),
    });
    from / (from - to)
}
