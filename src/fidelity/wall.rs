//! Comparison of the mesh wall with the given tubes.

use super::spread::Spread;
use anastomesh_mesh::WALL;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::Tubes;
use rayon::prelude::*;
use std::io;

/// Maximum number of mesh parts read, and approximate number of wall points sampled.
const PARTS: u32 = 500;
const POINTS: usize = 50_000;

/// Distribution of |d − r| / r at wall points, where d is the distance from the axis of the tube with the nearest wall.
pub(super) fn spread(tubes: &Tubes, mesh: &dyn MeshSource) -> io::Result<Spread> {
    Ok(Spread::of(wall_points(mesh)?.par_iter().filter_map(|p| error(tubes, p)).collect()))
}

/// Sample points of the wall.
pub(super) fn wall_points(mesh: &dyn MeshSource) -> io::Result<Vec<Point3>> {
    // Strides over parts and points sample the mesh evenly.
    let stride = mesh.parts().div_ceil(PARTS).max(1);
    let looked_at = mesh.counts().points / stride as usize;
    let every = looked_at.div_ceil(POINTS).max(1);
    let parts: Vec<u32> = (0..mesh.parts()).step_by(stride as usize).collect();
    let found: Vec<Vec<Point3>> =
        parts.par_iter().map(|&part| of_part(mesh, part, every)).collect::<io::Result<_>>()?;
    Ok(found.concat())
}

fn of_part(mesh: &dyn MeshSource, part: u32, every: usize) -> io::Result<Vec<Point3>> {
    let boundary = mesh.boundary(part)?;
    let mut ids: Vec<u32> = Vec::new();
    for (i, face) in boundary.faces.iter().enumerate() {
        if boundary.patches.get(i).is_none_or(|&patch| patch == WALL) {
            ids.extend(face);
        }
    }
    ids.sort_unstable();
    ids.dedup();
    let ids: Vec<u32> = ids.into_iter().step_by(every).collect();
    mesh.points_of(&ids)
}

fn error(tubes: &Tubes, point: &Point3) -> Option<f32> {
    let near = tubes.nearest_wall(point)?;
    Some(((near.distance - near.radius).abs() / near.radius) as f32)
}
