//! Writes Medit files.

use super::error::MeditFault;
use super::names::{TETRAHEDRA, TRIANGLES, VERTICES};
use crate::io::file::{FileError, unsound, write_whole};
use crate::mesh::source::MeshSource;
use std::io::{self, Write};
use std::path::Path;

/// Writes a mesh to a file, which appears whole or not at all.
///
/// # Errors
/// `BadMesh` when a cell names a point that does not exist, or `Write` with the reason.
pub fn write_medit(path: &Path, mesh: &dyn MeshSource) -> Result<(), FileError<MeditFault>> {
    if let Some(cell) = unsound_cell(mesh).map_err(FileError::write(path))? {
        return Err(FileError::BadMesh { path: path.to_path_buf(), cell });
    }
    write_whole(path, |out| write(out, mesh)).map_err(FileError::write(path))
}

/// The first cell, in its list, that names a point that does not exist.
fn unsound_cell(mesh: &dyn MeshSource) -> io::Result<Option<usize>> {
    let points = mesh.counts().points;
    let (mut found, mut before) = (None, 0);
    mesh.each_tets(|piece| {
        found = found.or_else(|| unsound(&piece.tets, points).map(|cell| before + cell));
        before += piece.tets.len();
        Ok(())
    })?;
    before = 0;
    mesh.each_faces(|piece| {
        found = found.or_else(|| unsound(&piece.faces, points).map(|cell| before + cell));
        before += piece.faces.len();
        Ok(())
    })?;
    Ok(found)
}

/// Writes a mesh to a stream: blocks and patches become references; points have the reference 0. Memory does not grow
/// with the mesh, which is read in one pass.
///
/// # Errors
/// What the stream or reading the mesh reports.
pub(in crate::io::volume) fn write(out: &mut impl Write, mesh: &dyn MeshSource) -> io::Result<()> {
    let counts = mesh.counts();
    writeln!(out, "MeshVersionFormatted 2\nDimension 3\n{VERTICES}\n{}", counts.points)?;
    mesh.each_points(|points| points.iter().try_for_each(|p| writeln!(out, "{:?} {:?} {:?} 0", p.x, p.y, p.z)))?;
    writeln!(out, "{TRIANGLES}\n{}", counts.boundary)?;
    mesh.each_faces(|piece| write_cells(out, &piece.faces, &piece.patches))?;
    writeln!(out, "{TETRAHEDRA}\n{}", counts.tets)?;
    mesh.each_tets(|piece| write_cells(out, &piece.tets, &piece.blocks))?;
    writeln!(out, "End")
}

fn write_cells<const N: usize>(out: &mut impl Write, cells: &[[u32; N]], references: &[i32]) -> io::Result<()> {
    for (i, corners) in cells.iter().enumerate() {
        for &v in corners {
            write!(out, "{} ", u64::from(v) + 1)?;
        }
        writeln!(out, "{}", references.get(i).unwrap_or(&0))?;
    }
    Ok(())
}
