//! Writer of binary files.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::geometry::Point3;
use std::io::{self, Write};

/// Writes a surface as little-endian binary with doubles.
pub(in crate::surface) fn write(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    write_head(out, mesh.points.len(), mesh.triangles.len(), "")?;
    write_points(out, &mesh.points)?;
    mesh.triangles.iter().try_for_each(|triangle| out.write_all(&face(triangle)))
}

/// Writes a boundary in the binary format, with the patch of each face.
pub(in crate::surface) fn write_boundary(out: &mut impl Write, surface: &BoundarySurface) -> io::Result<()> {
    let counts = surface.counts();
    write_head(out, counts.points, counts.boundary, "property int patch\n")?;
    surface.each_points(|points| write_points(out, points))?;
    surface.each_faces(|piece| {
        piece.faces.iter().zip(piece.patches.iter()).try_for_each(|(triangle, patch)| {
            out.write_all(&face(triangle))?;
            out.write_all(&patch.to_le_bytes())
        })
    })
}

/// `more` declares additional face properties.
fn write_head(out: &mut impl Write, points: usize, faces: usize, more: &str) -> io::Result<()> {
    // Some programs do not support unsigned indices.
    let index = if i32::try_from(points).is_ok() { "int" } else { "uint" };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment anastomesh\nelement vertex {points}\n\
         property double x\nproperty double y\nproperty double z\nelement face {faces}\n\
         property list uchar {index} vertex_indices\n{more}end_header\n"
    )
}

fn write_points(out: &mut impl Write, points: &[Point3]) -> io::Result<()> {
    points.iter().flat_map(Point3::iter).try_for_each(|value| out.write_all(&value.to_le_bytes()))
}

fn face(triangle: &[u32; 3]) -> [u8; 13] {
    let mut bytes = [3; 13];
    let (corners, _) = bytes[1..].as_chunks_mut::<4>();
    for (place, corner) in corners.iter_mut().zip(triangle) {
        *place = corner.to_le_bytes();
    }
    bytes
}
