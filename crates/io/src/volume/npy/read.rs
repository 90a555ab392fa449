//! Reader of meshes.

use super::names::{ARRAYS, NOTES, POINTS, TET_BLOCKS, TETS, TRIANGLE_BLOCKS, TRIANGLE_PATCHES, TRIANGLES};
use super::notes::Notes;
use crate::file::FileError;
use crate::npy::{Arrays, NpyError, NpyFault};
use crate::patches::usual_patches;
use crate::volume::content::{MeshFile, MeshNotes, separate_midpoints};
use anastomesh_mesh::{TetMesh, VolumeMesh};
use std::path::Path;

/// Reads a folder.
///
/// # Errors
/// `Read` with the error of the operating system, or `Content` with the array and row at fault.
pub(in crate::volume) fn read(folder: &Path) -> Result<MeshFile, FileError<NpyError>> {
    mesh_of(&Arrays::read(folder, &ARRAYS, Some(NOTES))?).map_err(FileError::content(folder))
}

/// Reads a mesh from the bytes of the files in a folder.
///
/// # Errors
/// Returns the array and row at fault.
pub fn read_mesh_arrays(files: &[(&str, &[u8])]) -> Result<MeshFile, NpyError> {
    mesh_of(&Arrays::of(files))
}

/// Second-order tetrahedra have 10 columns and triangles 6. Requires points and tetrahedra; everything else is optional. Patches without names get default names.
fn mesh_of(arrays: &Arrays) -> Result<MeshFile, NpyError> {
    let points = arrays.points(POINTS)?;
    let of_points = ("points.npy", points.len());
    let is_second = arrays.columns(TETS)? == 10;
    let tets_10 = if is_second { arrays.indices::<10>(TETS, of_points)? } else { Vec::new() };
    let tets = if is_second { corners(&tets_10) } else { arrays.indices::<4>(TETS, of_points)? };
    let tet_block = arrays.labels(TET_BLOCKS, ("tets.npy", tets.len()))?;
    let mut faces_6 = Vec::new();
    let boundary = if is_second {
        faces_6 = arrays.if_there(TRIANGLES, |arrays, name| arrays.indices::<6>(name, of_points))?;
        corners(&faces_6)
    } else {
        arrays.if_there(TRIANGLES, |arrays, name| arrays.indices::<3>(name, of_points))?
    };
    let of_faces = ("triangles.npy", boundary.len());
    let boundary_patch = arrays.labels(TRIANGLE_PATCHES, of_faces)?;
    let boundary_block = arrays.labels(TRIANGLE_BLOCKS, of_faces)?;
    let notes = arrays.other(NOTES).map(serde_json::from_slice::<Notes>).transpose();
    let notes = notes.map_err(|e| NpyFault::Json { reason: e.to_string() }.of(NOTES))?;
    let tet_block = tet_block.unwrap_or_else(|| vec![0; tets.len()]);
    let (notes, mut patches) =
        notes.map_or_else(|| (MeshNotes::default(), Vec::new()), |notes| notes.into_parts(&tet_block));
    let boundary_patch = boundary_patch.unwrap_or_else(|| vec![0; boundary.len()]);
    if patches.is_empty() {
        patches = usual_patches(&boundary_patch);
    }
    let mut volume = VolumeMesh {
        tet_block,
        boundary_block: boundary_block.unwrap_or_else(|| vec![0; boundary.len()]),
        mesh: TetMesh { points, tets },
        boundary,
        boundary_patch,
        patches,
    };
    let second_order = separate_midpoints(&mut volume, tets_10, faces_6);
    let second_order = second_order.expect("all nodes exist, and all cells have one order");
    Ok(MeshFile { labelled: !volume.boundary.is_empty(), volume, second_order, notes })
}

/// First nodes of second-order cells.
fn corners<const N: usize, const M: usize>(cells: &[[u32; M]]) -> Vec<[u32; N]> {
    cells.iter().map(|cell| std::array::from_fn(|i| cell[i])).collect()
}
