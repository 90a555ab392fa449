//! The flat disc in which two blocks meet, as the vessel alone gives it: its triangles are the same, bit for bit,
//! whichever block asks for them, so blocks owe each other nothing and are merged by the disc's vertices.

use super::SurfaceParams;
use super::disc::{MEAN_EDGE, corners, disc};
use anastomesh_mesh::geometry::{Point3, Section};
use anastomesh_skeleton::resolution::FOLLOW;

/// Edges of a wall at the radius of its thinnest vessel and at larger ones differ by 7 % in what is aimed at; a disc
/// does not know which its neighbours are.
const BETWEEN: f64 = 0.965;

/// A disc on a plane across a vessel.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedDisc {
    /// Its points; every block that ends in it has them in this order.
    pub points: Vec<Point3>,
    /// Its triangles, counter-clockwise about the outward axis it is seen along.
    pub triangles: Vec<[u32; 3]>,
    /// Its rim, counter-clockwise likewise.
    pub rim: Vec<u32>,
    /// The edge length that a wall is to have beside it.
    pub edge: f64,
}

impl SharedDisc {
    /// The disc at a section whose axis is in the direction of the branch, seen along it. Depends on the section and ρ
    /// alone. None if a disc of so many corners cannot be triangulated.
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

    /// The disc that ends the piece of a vessel on one `side` of a cut, seen along `outward`, the section's axis out of
    /// that piece: with the branch for side 0, against it for side 1.
    pub fn at_end(outward: &Section, side: u8, rho: f64) -> Option<Self> {
        if side == 0 {
            return Self::new(outward, rho);
        }
        Self::new(&Section { axis: -outward.axis, ..*outward }, rho).map(Self::turned)
    }

    /// The same disc seen from behind.
    #[must_use]
    pub fn turned(mut self) -> Self {
        self.rim.reverse();
        for t in &mut self.triangles {
            t.swap(1, 2);
        }
        self
    }
}
