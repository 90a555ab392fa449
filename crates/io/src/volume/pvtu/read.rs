//! Reads a mesh in pieces: the index, then every piece, and unites the points that pieces share.

use super::error::PvtuFault;
use crate::file::{FileError, read_bytes};
use crate::volume::content::MeshFile;
use crate::volume::vtu::GridReader;
use crate::vtk_xml::VtkXml;
use anastomesh_mesh::VolumeMesh;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Reads a mesh in pieces. Points are united by their global ids, and are in the order of these; when a piece has none,
/// points that pieces share stay apart. Cells that a piece has only as ghosts are left out.
///
/// # Errors
/// `Read` with the system's reason, `Empty`, or `Content` with what is wrong, all with the path of the index or piece.
pub(in crate::volume) fn read(path: &Path) -> Result<MeshFile, FileError<PvtuFault>> {
    let sources = sources(&read_bytes(path)?).map_err(FileError::content(path))?;
    if sources.is_empty() {
        return Err(FileError::content(path)(PvtuFault::Missing { what: "Piece" }));
    }
    let mut reader = GridReader::default();
    for source in sources {
        let piece = path.with_file_name(source);
        reader.read(&read_bytes(&piece)?).map_err(FileError::content(&piece))?;
    }
    let (mut file, ids) = reader.finish();
    unite(&mut file.volume, &ids).map_err(FileError::content(path))?;
    Ok(file)
}

/// Unites the points that are the same by their global ids, if there are such: afterwards points are in the order of these.
fn unite(volume: &mut VolumeMesh, ids: &[i64]) -> Result<(), PvtuFault> {
    if ids.is_empty() {
        return Ok(());
    }
    let mut distinct = ids.to_vec();
    distinct.par_sort_unstable();
    distinct.dedup();
    let index_of: Vec<u32> =
        ids.par_iter().map(|id| distinct.binary_search(id).map_or(u32::MAX, |i| i as u32)).collect();
    let mesh = &mut volume.mesh;
    let mut points = vec![None; distinct.len()];
    for ((&index, &p), &id) in index_of.iter().zip(&mesh.points).zip(ids) {
        if let Some(place) = points.get_mut(index as usize)
            && place.replace(p).is_some_and(|other| other != p)
        {
            return Err(PvtuFault::PointsDiffer { id });
        }
    }
    mesh.points = points.into_iter().flatten().collect();
    let united = |v: &mut u32| *v = index_of.get(*v as usize).copied().unwrap_or(u32::MAX);
    mesh.tets.as_flattened_mut().par_iter_mut().for_each(united);
    volume.boundary.as_flattened_mut().par_iter_mut().for_each(united);
    Ok(())
}

/// Paths of the pieces, from the folder of the index.
fn sources(bytes: &[u8]) -> Result<Vec<PathBuf>, PvtuFault> {
    let xml = VtkXml::parse(bytes, "PUnstructuredGrid")?;
    let grid = xml.child(VtkXml::ROOT, "PUnstructuredGrid");
    let grid = grid.ok_or(PvtuFault::Missing { what: "PUnstructuredGrid" })?;
    let source = |piece| xml.attribute(piece, "Source").ok_or(PvtuFault::Missing { what: "Source" });
    xml.children(grid, "Piece").map(|piece| source(piece).map(PathBuf::from)).collect()
}
