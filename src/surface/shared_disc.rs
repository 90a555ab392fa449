//! Flat disc between two blocks, derived from the vessel alone. Every block gets bit-identical triangles, so blocks are
//! independent and are merged at the vertices of the disc.

use super::SurfaceParams;
use super::disc::{MEAN_EDGE, corners, disc};
use anastomesh_mesh::geometry::{Point3, Section};
use anastomesh_skeleton::resolution::FOLLOW;

/// Factor on the edge length of a disc, between those of thin and wide vessels. Their targets differ by 7 %, and a disc
/// does not know its neighbours.
const BETWEEN: f64 = 0.965;

/// A disc on a plane across a vessel.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedDisc {
    /// Points, in the order used by every block that ends in the disc.
    pub points: Vec<Point3>,
    /// Triangles, counter-clockwise about the outward axis from which the disc is seen.
    pub triangles: Vec<[u32; 3]>,
    /// Boundary vertices, in counter-clockwise order.
    pub rim: Vec<u32>,
    /// Target edge length of the adjacent wall.
    pub edge: f64,
}

impl SharedDisc {
    /// Creates the disc at a section whose axis has the direction of the branch. The result depends on the section and
    /// ρ alone. Returns `None` if the disc cannot be triangulated.
    pub fn new(along: &Section, rho: f64) -> Option<Self> {
        let radius = along.radius;
        let wall = SurfaceParams { thin: radius, follow: FOLLOW, ..SurfaceParams::with_voxel(2.0 * radius / rho) };
        let corners = corners(radius, BETWEEN * wall.edge_at(radius));
        let flat = disc(radius, corners, 0.0)?;
        let (u, w) = along.frame();
        Some(Self {
            points: flat.points.iter().map(|&[x, y]| along.origin + u * x + w * y).collect(),
            triangles: flat.triangles,
            rim: (0..corners).collect(),
            edge: std::f64::consts::TAU * radius / (MEAN_EDGE * f64::from(corners)),
        })
    }

    /// Creates the disc at the end of the vessel piece on one `side` of a cut. The section's axis points out of that
    /// piece: along the branch for side 0, against it for side 1.
    pub fn at_end(outward: &Section, side: u8, rho: f64) -> Option<Self> {
        if side == 0 {
            return Self::new(outward, rho);
        }
        Self::new(&Section { axis: -outward.axis, ..*outward }, rho).map(Self::turned)
    }

    /// Returns the disc seen from behind.
    #[must_use]
    pub fn turned(mut self) -> Self {
        self.rim.reverse();
        for t in &mut self.triangles {
            t.swap(1, 2);
        }
        self
    }
}
