//! Boundary of a lumen as a surface with its own points.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{TriMesh, VolumeMesh, WALL};

/// Boundary of a lumen.
pub struct LumenSurface {
    /// Surface, oriented outwards.
    pub surface: TriMesh,
    /// Point of the mesh of each point of the surface.
    pub points: Vec<u32>,
    /// Patch of the cap of each triangle; `None` for the wall.
    pub caps: Vec<Option<u32>>,
}

impl LumenSurface {
    /// Boundary of a mesh.
    pub fn of(volume: &VolumeMesh) -> Self {
        let mut points: Vec<u32> = volume.boundary.as_flattened().to_vec();
        points.sort_unstable();
        points.dedup();
        let mut number = vec![u32::MAX; volume.mesh.points.len()];
        (0..).zip(&points).for_each(|(i, &v)| number[v as usize] = i);
        let triangles = volume.boundary.iter().map(|face| face.map(|v| number[v as usize])).collect();
        let places: Vec<Point3> = points.iter().map(|&v| volume.mesh.points[v as usize]).collect();
        let cap = |&patch: &i32| (patch != WALL).then_some(patch as u32);
        Self {
            surface: TriMesh { points: places, triangles },
            points,
            caps: volume.boundary_patch.iter().map(cap).collect(),
        }
    }
}
