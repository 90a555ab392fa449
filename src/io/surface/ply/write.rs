//! Writes binary files.

use crate::geometry::Point3;
use crate::mesh::TriMesh;
use std::io::{self, Write};

/// Writes binary, little endian, with doubles.
pub(in crate::io::surface) fn write(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    // Some programs know no unsigned indices.
    let index = if i32::try_from(mesh.points.len()).is_ok() { "int" } else { "uint" };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment anastomesh\nelement vertex {}\n\
         property double x\nproperty double y\nproperty double z\nelement face {}\n\
         property list uchar {index} vertex_indices\nend_header\n",
        mesh.points.len(),
        mesh.triangles.len()
    )?;
    for value in mesh.points.iter().flat_map(Point3::iter) {
        out.write_all(&value.to_le_bytes())?;
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for corner in triangle {
            out.write_all(&corner.to_le_bytes())?;
        }
    }
    Ok(())
}
