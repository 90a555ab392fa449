//! Writer of Medit files.

use super::names::{PATCH, REGION, TETRAHEDRA, TRIANGLES, VERTICES};
use crate::volume::content::MeshNotes;
use anastomesh_mesh::source::MeshSource;
use std::io::{self, Write};

/// Writes a mesh to a stream. Regions and patches have their names in comments if there are regions. Blocks and patches become references; points have reference 0. The mesh is read in one
/// pass, and memory does not grow with it.
///
/// # Errors
/// The stream or the mesh source fails.
pub(in crate::volume) fn write(out: &mut impl Write, mesh: &dyn MeshSource, notes: &MeshNotes) -> io::Result<()> {
    let counts = mesh.counts();
    writeln!(out, "MeshVersionFormatted 2\nDimension 3")?;
    if !notes.regions.is_empty() {
        notes.regions.iter().try_for_each(|region| writeln!(out, "{REGION}{} {}", region.id, in_line(&region.name)))?;
        mesh.patches().iter().try_for_each(|patch| writeln!(out, "{PATCH}{} {}", patch.id, in_line(&patch.name)))?;
    }
    writeln!(out, "{VERTICES}\n{}", counts.points)?;
    mesh.each_points(|points| points.iter().try_for_each(|p| writeln!(out, "{:?} {:?} {:?} 0", p.x, p.y, p.z)))?;
    writeln!(out, "{TRIANGLES}\n{}", counts.boundary)?;
    mesh.each_faces(|piece| write_cells(out, &piece.faces, &piece.patches))?;
    writeln!(out, "{TETRAHEDRA}\n{}", counts.tets)?;
    mesh.each_tets(|piece| write_cells(out, &piece.tets, &piece.blocks))?;
    writeln!(out, "End")
}

/// Name without line breaks.
fn in_line(name: &str) -> String {
    name.replace(['\n', '\r'], " ")
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
