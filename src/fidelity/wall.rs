//! The wall held against the given tubes.

use super::spread::Spread;
use super::tubes::Tubes;
use anastomesh_mesh::WALL;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use rayon::prelude::*;
use std::io;

/// Parts that are read, at most, and points of the wall that are looked at, about.
const PARTS: u32 = 500;
const POINTS: usize = 50_000;

/// |d − r| / r at points of the wall, d the distance from the axis of the tube whose wall is nearest.
pub(super) fn spread(tubes: &Tubes, mesh: &dyn MeshSource) -> io::Result<Spread> {
    Ok(Spread::of(wall_points(mesh)?.par_iter().filter_map(|p| error(tubes, p)).collect()))
}

/// Some points of the wall.
pub(super) fn wall_points(mesh: &dyn MeshSource) -> io::Result<Vec<Point3>> {
    // The first of every so many parts, and of them each so many points: evenly over the mesh.
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
