//! Validity check of a mesh in parts, without loading all of it.
//!
//! Parts meet only in joints: a joint is a disc of faces, the same faces in both parts. Each part is certified alone
//! ([`certify_with`]); the whole is checked from the certificates, the joints and the walls ([`check_parts`]). The verdict
//! equals that of [`check_volume`](super::check_volume) on the merged mesh.
//!
//! # Correctness
//!
//! Each part is checked as follows. Its arrays are valid. Its tetrahedra are positive, share faces in pairs from
//! opposite sides and use all points. Its boundary, including joints, is a closed manifold with single fans and no
//! self-intersection. Caps and joints consist of boundary faces, each in one of them. Joints are discs without common
//! vertices. The whole is checked as follows. No joint is connected twice. Connected joints have the same faces with
//! the same ids, opposite orientation, and bit-equal points. No id stands for two points except at connected joints.
//! Walls of different parts do not intersect. No boundary surface lies inside the mesh. Then, condition by condition:
//!
//! - *Valid arrays, positive and distinct tetrahedra, used points*: properties of single tetrahedra and points. Two
//!   equal tetrahedra of different parts would overlap, which is excluded below.
//! - *Faces shared by two, opposite sides*: a face inside a part or on its wall has the same tetrahedra as before. A
//!   face of a joint has one from either part, on opposite sides since the joints have opposite orientation.
//! - *Closed boundary, single fans*: at a vertex of the rim, the boundary of a part is one fan. The joint, a disc,
//!   takes one run of it, so the wall is one fan, too; the walls of both parts combine to one fan. Joints have no
//!   common vertex, so no vertex is in more than two parts. An edge outside the joint on both walls would be in four
//!   faces; the test of walls against each other searches for such edges.
//! - *No self-intersection*: faces of one wall are tested with their part, faces of two walls against each other.
//!   Contact of a wall with the joints of its part is excluded, too, since joints of a valid mesh are interior faces.
//! - *No duplicate points*: assume all other conditions. Over a point off the boundary, the number of tetrahedra is the
//!   winding number of the boundary, since all are positive. It is 0 or 1, as no surface lies inside the mesh. So no
//!   two tetrahedra overlap. The faces around an inner vertex are paired, so its tetrahedra fill at least the full
//!   solid angle, and no other point can be there. Two boundary points at one position would be an intersection. If a
//!   part has faults, its points are compared with each other; if walls intersect, those of the intersecting faces. If
//!   no equal points are found then, the condition counts as not checked.
//! - *Components*: those of the parts, connected by joints. *Loops*: the boundary surfaces of parts, connected by
//!   joints. A joint removes a disc (Euler number 1) on both sides, so the sum of Euler numbers decreases by 2 per
//!   joint.
//! - *Labels and caps*: faces in no cap are wall by construction, and every cap lies in one part.
//!
//! The check is stricter than that of a whole mesh. These are always faults:
//!
//! - two joints of one part with a common vertex
//! - a joint that is not a disc
//! - faces common to two parts without a joint
//!
//! [`Parts`] must give consistent ids; walls and joints are verified to be the certified ones.

mod boxes;
mod certificate;
mod chain;
mod changed;
mod glue;
mod ids;
mod image;
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
pub use chain::{Link, chained};
pub use changed::{Changed, meetings_of};
pub use image::certify_image;
pub use pieces::{PiecesError, Unfit, check_pieces};
pub(super) use sums::id_sums;
pub use whole::{Looked, check_parts};

use super::nested::Enclosed;
use super::result::{CheckReport, Intersection, Line, Offender};
use crate::geometry::{Aabb, Point3};
use crate::quality::QualityPiece;
use crate::{Cap, TetMesh};
use serde::{Deserialize, Serialize};
use std::io;

/// Input of a part's certificate.
#[derive(Clone, Copy, Debug)]
pub struct PartView<'a> {
    /// Points and tetrahedra; a hollow part has no tetrahedra.
    pub mesh: &'a TetMesh,
    /// Faces shared with other parts, one list per joint, oriented out of the part (local vertex numbers).
    pub joints: &'a [Vec<[u32; 3]>],
    /// Caps with their faces (local vertex numbers).
    pub caps: &'a [(Cap, Vec<[u32; 3]>)],
}

/// A condition violated by a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fault {
    /// The line.
    pub line: Line,
    /// Number of offenders.
    pub count: u64,
    /// First offenders, in the part's own numbering.
    pub offenders: Vec<Offender>,
}

/// Result of checking a part alone: some hundred bytes, including the histogram of its quality.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    points: u32,
    tets: u32,
    /// True if the arrays were unusable, so that nothing else was checked.
    unsound: bool,
    volume: f64,
    /// Bounding box of the boundary.
    bounds: [[f64; 3]; 2],
    /// Boundary faces outside joints.
    wall_faces: u32,
    wall_sum: u64,
    components: u32,
    surfaces: Vec<HeldSurface>,
    joints: Vec<HeldJoint>,
    caps: Vec<HeldCap>,
    quality: QualityPiece,
    faults: Vec<Fault>,
    /// First pairs of boundary faces that intersect improperly.
    intersections: Vec<Intersection>,
}

impl Certificate {
    /// True if every condition on the part alone holds, except the shapes of its caps.
    pub fn is_sound(&self) -> bool {
        self.faults.is_empty()
    }

    /// First violated condition.
    pub fn broken_line(&self) -> Option<Line> {
        self.faults.first().map(|fault| fault.line)
    }

    /// Bounding box of the boundary; empty if there is none.
    pub fn bounds(&self) -> Aabb {
        let [min, max] = self.bounds.map(Point3::from);
        if self.surfaces.is_empty() { Aabb::EMPTY } else { Aabb { min, max } }
    }

    /// Smallest radius ratio of the tetrahedra.
    pub fn worst_ratio(&self) -> f64 {
        self.quality.min()
    }

    /// Smallest dihedral angle of the tetrahedra, in degrees.
    pub fn least_dihedral(&self) -> f64 {
        self.quality.least_dihedral()
    }
}

/// A boundary surface of a part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct HeldSurface {
    /// Its smallest vertex with a face outside joints.
    vertex: u32,
    /// Euler number, including joints.
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
    /// Results of the conditions on its shape.
    shape: [bool; 5],
}

/// Faces of a part with a point array of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FacesApart {
    /// Positions of the points that the faces use.
    pub points: Vec<Point3>,
    /// Ids of the points in the whole.
    pub vertices: Vec<u32>,
    /// Faces, oriented out of the part, as indices into `points`.
    pub faces: Vec<[u32; 3]>,
}

/// Result of checking a mesh in parts.
#[derive(Clone, Debug, PartialEq)]
pub struct PartsCheck {
    /// Report on all conditions.
    pub report: CheckReport,
    /// Pairs of parts with walls that intersect elsewhere than at the rims of their joints, ascending.
    pub meeting: Vec<[u32; 2]>,
}

/// Access to parts in memory or on disk.
pub trait Parts: Sync {
    /// Number of parts.
    fn count(&self) -> usize;

    /// Certificate of a part.
    ///
    /// # Errors
    /// Errors of reading.
    fn certificate(&self, part: u32) -> io::Result<Certificate>;

    /// Boundary faces of the whole in a part: wall, caps, and joints without partner.
    ///
    /// # Errors
    /// Errors of reading.
    fn wall(&self, part: u32) -> io::Result<FacesApart>;

    /// Pairs of connected joints, as (part, joint).
    fn joined(&self) -> &[[(u32, u32); 2]];

    /// A joint of a part.
    ///
    /// # Errors
    /// Errors of reading.
    fn joint(&self, part: u32, joint: u32) -> io::Result<FacesApart>;

    /// Id in the whole of a part's vertex.
    fn vertex(&self, part: u32, local: u32) -> u32;

    /// Id in the whole of a part's tetrahedron.
    fn tet(&self, part: u32, local: u32) -> u64;

    /// Ids in the whole of all `points` vertices of a part, in order; called once per part.
    ///
    /// # Errors
    /// Errors of reading.
    fn vertices(&self, part: u32, points: u32) -> io::Result<Vec<u32>> {
        Ok((0..points).map(|local| self.vertex(part, local)).collect())
    }
}
