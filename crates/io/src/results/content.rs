//! Contents of a result.

use anastomesh_mesh::geometry::{Point3, Vec3};

/// Flow in a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct FlowResult {
    /// Name of the time step or file.
    pub name: String,
    /// Centres of the cells.
    pub cells: Vec<Point3>,
    /// Volumes of the cells.
    pub volumes: Vec<f64>,
    /// Mean pressures of the cells.
    pub pressures: Vec<f64>,
    /// Faces between cells.
    pub inner: Vec<InnerFlux>,
    /// Faces of the boundary.
    pub outer: Vec<OuterFlux>,
    /// True if velocities are those of nodes; else they are means of cells, and gradients at walls are those of the solver.
    pub is_nodal: bool,
    /// True if pressures and shear stresses are divided by the density, as in solvers of incompressible flow.
    pub is_kinematic: bool,
}

/// Face between two cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InnerFlux {
    /// Cells on both sides.
    pub cells: [u32; 2],
    /// Flow rate from the first to the second cell.
    pub flux: f64,
}

/// Face of the boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OuterFlux {
    /// Its cell.
    pub cell: u32,
    /// Centre.
    pub center: Point3,
    /// Area times the outward unit normal.
    pub area: Vec3,
    /// Flow rate out of the mesh.
    pub flux: f64,
    /// Pressure.
    pub pressure: f64,
    /// True on the wall, where the velocity is zero.
    pub is_wall: bool,
    /// Magnitude of the wall shear stress; `None` if the solver did not write it.
    pub shear: Option<f64>,
    /// Velocity beside the wall.
    pub near: Near,
}

/// Velocity near a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Near {
    /// Magnitude of the velocity along the wall.
    pub speed: f64,
    /// Distance from the wall.
    pub height: f64,
}

impl Near {
    /// Velocity at a distance from the plane of a face.
    pub(super) fn of(velocity: &Vec3, offset: &Vec3, area: &Vec3) -> Self {
        let length = area.norm();
        if length <= 0.0 {
            return Self::default();
        }
        let normal = area / length;
        Self { speed: (velocity - normal * velocity.dot(&normal)).norm(), height: offset.dot(&normal).abs() }
    }
}
