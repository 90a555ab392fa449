//! Smooth surfaces through the labelled faces of a mesh: normals at their corners, and offsets of their edges.
//!
//! Two faces of a patch belong to one surface at their common edge if the angle of their normals is below 40°. Around a
//! vertex, the faces between two creases have a common normal. Caps are flat.

use super::arc::arc_offset;
use super::edges::{Edges, FACE_EDGES};
use crate::VolumeMesh;
use crate::geometry::{DisjointSets, Point3, Vec3, unit_normal};
use rayon::prelude::*;

/// Cosine of the angle between the normals of two faces beyond which their common edge is a crease: 40°. Walls with nine points
/// around have this angle.
const CREASE: f64 = 0.766;

/// Angle between the normals of a face and of its corners, in radians, up to which the face is flat. 32-bit coordinates of planes
/// give up to about 1e-4. Rims leave the plane of such a face by at most this share of their offset.
const FLAT: f64 = 1e-3;

/// Side of a labelled face: the number of the edge, then `3 · face + side`.
type Side = (u32, u32);

/// Offsets from the midpoints of all edges to the smooth surfaces; zero for straight edges.
pub(super) fn offsets(volume: &VolumeMesh, edges: &Edges) -> Vec<Vec3> {
    let surface = Surface::new(volume, edges);
    let mut offsets = vec![Vec3::zeros(); edges.list().len()];
    let runs: Vec<&[Side]> = surface.sides.chunk_by(|a, b| a.0 == b.0).collect();
    let found: Vec<Vec3> = runs.par_iter().map(|run| surface.offset(run)).collect();
    for (run, offset) in runs.iter().zip(found) {
        offsets[run[0].0 as usize] = offset;
    }
    offsets
}

/// Face of the boundary under its curved face.
pub(super) struct Flat {
    pub normal: Vec3,
    pub area: f64,
    /// Mean height of the curved face above this one. Zero in caps and other planes, also with curved edges in the plane.
    pub height: f64,
}

/// Height of a curved face over the flat one, relative to its size, below which it is flat: rounding errors.
const LEAST_HEIGHT: f64 = 1e-9;

impl Flat {
    /// Faces of the boundary of a mesh, for these offsets of its edges.
    pub fn faces(volume: &VolumeMesh, edges: &Edges, offsets: &[Vec3]) -> Vec<Self> {
        let offset = |a: u32, b: u32| edges.find(a, b).map_or(Vec3::zeros(), |edge| offsets[edge as usize]);
        let of_face = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| volume.mesh.points[v as usize]);
            let (normal, area) = (unit_normal(a.coords, b.coords, c.coords), 0.5 * (b - a).cross(&(c - a)).norm());
            let height = FACE_EDGES.map(|[i, j]| offset(face[i], face[j]).dot(&normal)).iter().sum::<f64>() / 3.0;
            Self { normal, area, height: if height.abs() > LEAST_HEIGHT * area.sqrt() { height } else { 0.0 } }
        };
        volume.boundary.par_iter().map(of_face).collect()
    }
}

/// Labelled faces with the normals of the surfaces at their corners.
struct Surface<'a> {
    points: &'a [Point3],
    faces: &'a [[u32; 3]],
    /// Patch of each face.
    patches: &'a [i32],
    /// True for each face of a cap.
    is_cap: Vec<bool>,
    /// Unit normal of each face.
    normals: Vec<Vec3>,
    /// Unit normal of the surface at each corner `3 · face + i`.
    corners: Vec<Vec3>,
    /// Sides of all faces, ascending.
    sides: Vec<Side>,
}

impl<'a> Surface<'a> {
    fn new(volume: &'a VolumeMesh, edges: &Edges) -> Self {
        let caps: Vec<i32> = volume.patches.iter().filter(|patch| patch.cap.is_some()).map(|patch| patch.id).collect();
        let points = &volume.mesh.points;
        let faces = &volume.boundary;
        let normal = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| points[v as usize].coords);
            unit_normal(a, b, c)
        };
        let side = |i: usize| {
            let [a, b] = FACE_EDGES[i % 3].map(|corner| faces[i / 3][corner]);
            (edges.find(a, b).expect("the edges of all faces are listed"), i as u32)
        };
        let mut sides: Vec<Side> = (0..3 * faces.len()).into_par_iter().map(side).collect();
        sides.par_sort_unstable();
        let patch = |face: usize| volume.boundary_patch.get(face);
        let mut surface = Self {
            points,
            faces,
            patches: &volume.boundary_patch,
            is_cap: (0..faces.len()).map(|face| patch(face).is_some_and(|id| caps.binary_search(id).is_ok())).collect(),
            normals: faces.par_iter().map(normal).collect(),
            corners: Vec::new(),
            sides,
        };
        surface.corners = surface.corner_normals();
        surface
    }

    /// Normals at all corners: weighted means over the faces between two creases.
    fn corner_normals(&self) -> Vec<Vec3> {
        let mut sets = DisjointSets::new(3 * self.faces.len());
        for run in self.sides.chunk_by(|a, b| a.0 == b.0) {
            if let Some([first, second]) = self.smooth_pair(run) {
                // The faces run along the edge in opposite directions.
                for [i, j] in [[0, 1], [1, 0]] {
                    sets.join(Self::corner(first, i), Self::corner(second, j));
                }
            }
        }
        sets.flatten();
        let mut sums = vec![Vec3::zeros(); 3 * self.faces.len()];
        for corner in 0..sums.len() {
            sums[sets.find(corner as u32) as usize] += self.weighted_normal(corner);
        }
        let unit = |corner: usize| sums[sets.find(corner as u32) as usize].try_normalize(0.0).unwrap_or(Vec3::zeros());
        (0..sums.len()).into_par_iter().map(unit).collect()
    }

    /// Normal of a face, weighted at one of its corners. The weight is the sine of the angle over the lengths of both sides: N. Max,
    /// Weights for computing vertex normals from facet normals, Journal of Graphics Tools 4, 1999. The mean of such normals is exact on
    /// spheres, and on cylinders with points on common generators, for any lengths of the sides.
    fn weighted_normal(&self, corner: usize) -> Vec3 {
        let (face, i) = (self.faces[corner / 3], corner % 3);
        let [at, next, last] = [0, 1, 2].map(|step| self.points[face[(i + step) % 3] as usize]);
        let (u, v) = (next - at, last - at);
        let lengths2 = u.norm_squared() * v.norm_squared();
        let weight = u.cross(&v).norm() / lengths2;
        if weight.is_finite() { self.normals[corner / 3] * weight } else { Vec3::zeros() }
    }

    /// Corner `3 · face + i` at the start (0) or end (1) of a side.
    fn corner(side: u32, end: usize) -> u32 {
        side - side % 3 + FACE_EDGES[side as usize % 3][end] as u32
    }

    /// Vertex at the start (0) or end (1) of a side.
    fn vertex(&self, side: u32, end: usize) -> u32 {
        self.faces[side as usize / 3][FACE_EDGES[side as usize % 3][end]]
    }

    /// The two sides at an edge that continue one surface. Of more than two, those of one patch.
    fn smooth_pair(&self, run: &[Side]) -> Option<[u32; 2]> {
        let patch = |side: u32| self.patches.get(side as usize / 3).copied().unwrap_or(0);
        let mut found = None;
        for (i, &(_, first)) in run.iter().enumerate() {
            for &(_, second) in &run[i + 1..] {
                if (run.len() == 2 || patch(first) == patch(second)) && self.is_smooth([first, second]) {
                    if found.is_some() {
                        return None;
                    }
                    found = Some([first, second]);
                }
            }
        }
        found
    }

    /// True if two faces at an edge are oriented alike, both or neither in a cap, and below the angle of a crease.
    fn is_smooth(&self, [first, second]: [u32; 2]) -> bool {
        let faces = [first, second].map(|side| side as usize / 3);
        let [m, n] = faces.map(|face| self.normals[face]);
        self.vertex(first, 0) == self.vertex(second, 1)
            && self.is_cap[faces[0]] == self.is_cap[faces[1]]
            && m.dot(&n) > CREASE
    }

    /// Offset of an edge with these sides.
    fn offset(&self, run: &[Side]) -> Vec3 {
        if let Some([side, _]) = self.smooth_pair(run) {
            return if self.is_cap[side as usize / 3] { Vec3::zeros() } else { self.arc(side, None) };
        }
        // A rim stays in the plane of its flat faces, and follows its only curved one.
        let (flat, curved): (Vec<u32>, Vec<u32>) =
            run.iter().map(|&(_, side)| side).partition(|&side| self.is_flat(side));
        let planes: Vec<Vec3> = flat.iter().map(|&side| self.normals[side as usize / 3]).collect();
        match (&planes[..], &curved[..]) {
            ([plane, others @ ..], &[side]) if others.iter().all(|n| n.cross(plane).norm() < FLAT) => {
                self.arc(side, Some(*plane))
            }
            _ => Vec3::zeros(),
        }
    }

    /// Offset of a side by the normals of its own surface, projected into a plane if one is given.
    fn arc(&self, side: u32, plane: Option<Vec3>) -> Vec3 {
        let [a, b] = [0, 1].map(|end| self.points[self.vertex(side, end) as usize]);
        let [m, n] = [0, 1].map(|end| {
            let normal = self.corners[Self::corner(side, end) as usize];
            plane.map_or(normal, |plane| {
                (normal - plane * plane.dot(&normal)).try_normalize(LEAST_PROJECTION).unwrap_or(Vec3::zeros())
            })
        });
        arc_offset(b - a, m, n)
    }

    /// True if the surface of a side is flat at both ends of the side.
    fn is_flat(&self, side: u32) -> bool {
        let face = side as usize / 3;
        let along =
            |end: usize| self.normals[face].cross(&self.corners[Self::corner(side, end) as usize]).norm() < FLAT;
        self.is_cap[face] || (along(0) && along(1))
    }
}

/// Least length of a unit normal that is projected into the plane of a cap. Shorter ones belong to no rim.
const LEAST_PROJECTION: f64 = 0.1;
