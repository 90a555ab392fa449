//! The check of a mesh that is made of parts, without holding it.
//!
//! Parts meet in joints alone: a joint is a disc of faces, the same faces in both parts. Each part is certified alone
//! ([`certify_with`]); the whole is checked from the certificates, the joints and the walls ([`check_parts`]). The verdict is
//! that of [`check_volume`](super::check_volume) on the merged mesh.
//!
//! # Why that is enough
//!
//! Of a part is checked that its arrays are sound; that its tetrahedra are positive, share faces by two from opposite
//! sides and use all points; that its whole boundary, joints included, is a closed manifold with single fans that does not
//! meet itself; that caps and joints are made of boundary faces, each in one of them; that joints are discs and have no
//! vertex in common. Of the whole: that no joint is joined twice; that joined joints have the same faces with the same ids,
//! turned against each other, and bit-equal points; that no id stands for two points but where joints are joined; that
//! walls of different parts do not meet; that no boundary surface lies within the mesh. Then, line by line:
//!
//! - *Sound arrays, positive and distinct tetrahedra, used points*: properties of single tetrahedra and points. Two equal
//!   tetrahedra of different parts would lie over each other, which is excluded below.
//! - *Faces shared by two, opposite sides*: a face inside a part or on its wall has no other tetrahedra than before; a
//!   face of a joint has one from either part, on opposite sides as the joints are turned against each other.
//! - *Closed boundary, single fans*: at a vertex of the rim the wall of a part is one fan, for its boundary is one fan of
//!   which the joint (a disc) takes one run; the walls of both parts close to one fan again. As joints have no common
//!   vertex, no vertex is in more than two parts. An edge outside the joint that both parts' walls have would be in four
//!   faces; such edges are looked for where walls are tested against each other.
//! - *No self-intersection*: faces of one wall are tested with their part, faces of two walls against each other. That a
//!   wall does not touch the joints of its part either is no more than the line asks for: in a valid mesh joints are faces
//!   inside it.
//! - *No duplicate points*: let all else hold. Over a place that is on no boundary face lie as many tetrahedra as the
//!   boundary winds round it, for they are all positive; it winds 0 times or once, as no surface lies within the mesh.
//!   So no two tetrahedra overlap. The faces round a vertex inside the mesh pair up, so its tetrahedra fill at least the
//!   full solid angle; no other tetrahedron, and so no other point, is there. Two points on the boundary in one place
//!   would be an intersection. Where something fails in a part, its points are compared with each other; where walls meet,
//!   those of the faces that do. If no equal points are found so, the line counts as not checked.
//! - *Components*: those of the parts, joined by joints. *Loops*: the boundary surfaces of parts, joined by joints; a joint
//!   takes a disc (Euler number 1) off both sides, so Euler numbers add up less 2 for every joint.
//! - *Labels and caps*: what is in no cap is wall by construction, and every cap lies in one part.
//!
//! Stricter than the check of a whole mesh are: two joints of one part that share a vertex, a joint that is no disc, and
//! faces that two parts have in common although no joint says so are faults, whatever mesh would come of them.
//!
//! [`Parts`] must give the same ids everywhere; that walls and joints are those that were certified is checked.

mod boxes;
mod certificate;
mod changed;
mod glue;
mod ids;
mod joints;
mod nests;
mod pieces;
mod sums;
mod tallies;
mod walls;
mod whole;

#[cfg(test)]
mod tests;

pub use certificate::{certify_hollow, certify_with};
pub use changed::{Changed, meetings_of};
pub use pieces::{PiecesError, Unfit, check_pieces};
pub use whole::{Looked, check_parts};

use super::nested::Enclosed;
use super::result::{CheckReport, Intersection, Line, Offender};
use crate::geometry::{Aabb, Point3};
use crate::quality::QualityPiece;
use crate::{Cap, TetMesh};
use serde::{Deserialize, Serialize};
use std::io;

/// What a part is, for its certificate.
#[derive(Clone, Copy, Debug)]
pub struct PartView<'a> {
    /// Its points and tetrahedra; no tetrahedra where it is hollow.
    pub mesh: &'a TetMesh,
    /// Faces shared with other parts, one list per joint, oriented out of the part (local vertex numbers).
    pub joints: &'a [Vec<[u32; 3]>],
    /// Caps with their faces (local vertex numbers).
    pub caps: &'a [(Cap, Vec<[u32; 3]>)],
}

/// A line that a part breaks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// The line.
    pub line: Line,
    /// Number of offenders.
    pub count: u64,
    /// The first of them, in the part's own numbers.
    pub offenders: Vec<Offender>,
}

/// What is known of a part that was checked alone: some hundred bytes, the histogram of its quality among them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    points: u32,
    tets: u32,
    /// The arrays could not be used: nothing else was checked.
    unsound: bool,
    volume: f64,
    /// Box of the boundary.
    bounds: [[f64; 3]; 2],
    /// Boundary faces that are in no joint.
    wall_faces: u32,
    wall_sum: u64,
    components: u32,
    surfaces: Vec<HeldSurface>,
    joints: Vec<HeldJoint>,
    caps: Vec<HeldCap>,
    quality: QualityPiece,
    faults: Vec<Fault>,
    /// The first pairs of boundary faces that meet improperly.
    intersections: Vec<Intersection>,
}

impl Certificate {
    /// Whether every line that concerns the part alone holds (the shapes of its caps aside).
    pub fn is_sound(&self) -> bool {
        self.faults.is_empty()
    }

    /// The first line that does not hold.
    pub fn broken_line(&self) -> Option<Line> {
        self.faults.first().map(|fault| fault.line)
    }

    /// The box of the boundary; empty where there is none.
    pub fn bounds(&self) -> Aabb {
        let [min, max] = self.bounds.map(Point3::from);
        if self.surfaces.is_empty() { Aabb::EMPTY } else { Aabb { min, max } }
    }

    /// The smallest radius ratio of the tetrahedra.
    pub fn worst_ratio(&self) -> f64 {
        self.quality.min()
    }

    /// The smallest dihedral angle of the tetrahedra, in degrees.
    pub fn least_dihedral(&self) -> f64 {
        self.quality.least_dihedral()
    }
}

/// A boundary surface of a part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct HeldSurface {
    /// Its smallest vertex that has a face in no joint.
    vertex: u32,
    /// Euler number, joints included.
    euler: i32,
    enclosed: Enclosed,
}

/// A joint of a part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct HeldJoint {
    surface: u32,
    component: u32,
    faces: u32,
    vertices: u32,
    sum: u64,
}

/// A cap of a part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct HeldCap {
    node: u32,
    center: [f64; 3],
    normal: [f64; 3],
    radius: f64,
    faces: u32,
    /// Whether the lines about its shape hold.
    shape: [bool; 5],
}

/// Faces of a part with points of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FacesApart {
    /// Positions of the points that the faces use.
    pub points: Vec<Point3>,
    /// Their ids in the whole.
    pub vertices: Vec<u32>,
    /// Faces, oriented out of the part, as indices into `points`.
    pub faces: Vec<[u32; 3]>,
}

/// What was found in a mesh that is made of parts.
#[derive(Clone, Debug, PartialEq)]
pub struct PartsCheck {
    /// The lines.
    pub report: CheckReport,
    /// Pairs of parts whose walls meet elsewhere than at the rims of their joints, ascending.
    pub meeting: Vec<[u32; 2]>,
}

/// Where the parts are, in memory or on disk.
pub trait Parts: Sync {
    /// Number of parts.
    fn count(&self) -> usize;

    /// The certificate of a part.
    ///
    /// # Errors
    /// What reading fails with.
    fn certificate(&self, part: u32) -> io::Result<Certificate>;

    /// The boundary faces of the whole that a part has: wall, caps, and joints that are joined to nothing.
    ///
    /// # Errors
    /// What reading fails with.
    fn wall(&self, part: u32) -> io::Result<FacesApart>;

    /// Pairs of (part, joint) that are joined.
    fn joined(&self) -> &[[(u32, u32); 2]];

    /// A joint of a part.
    ///
    /// # Errors
    /// What reading fails with.
    fn joint(&self, part: u32, joint: u32) -> io::Result<FacesApart>;

    /// Id in the whole of a part's vertex.
    fn vertex(&self, part: u32, local: u32) -> u32;

    /// Id in the whole of a part's tetrahedron.
    fn tet(&self, part: u32, local: u32) -> u64;

    /// Ids in the whole of all `points` vertices of a part, in order; asked for once per part.
    ///
    /// # Errors
    /// What reading fails with.
    fn vertices(&self, part: u32, points: u32) -> io::Result<Vec<u32>> {
        Ok((0..points).map(|local| self.vertex(part, local)).collect())
    }
}
