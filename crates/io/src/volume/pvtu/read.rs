//! Reader of meshes in pieces: reads the index and every piece, and merges shared points.

use super::error::PvtuFault;
use crate::file::{FileError, read_bytes};
use crate::volume::content::MeshFile;
use crate::volume::vtu::GridReader;
use crate::vtk_xml::VtkXml;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Reads a mesh in pieces. Points are merged and sorted by their global ids. If a piece has none, shared points stay
/// separate. Ghost cells are skipped.
///
/// # Errors
/// `Read` with the system's error, `Empty`, or `Content` with the fault, each with the path of index or piece.
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
    unite(&mut reader).map_err(FileError::content(path))?;
    reader.finish().map_err(FileError::content(path))
}

/// Merges points with equal global ids, if there are ids; points are then sorted by them.
fn unite(reader: &mut GridReader) -> Result<(), PvtuFault> {
    let (given, ids) = reader.points();
    if ids.is_empty() {
        return Ok(());
    }
    let mut distinct = ids.to_vec();
    distinct.par_sort_unstable();
    distinct.dedup();
    let index_of: Vec<u32> =
        ids.par_iter().map(|id| distinct.binary_search(id).map_or(u32::MAX, |i| i as u32)).collect();
    let mut points = vec![None; distinct.len()];
    for ((&index, &p), &id) in index_of.iter().zip(given).zip(ids) {
        if let Some(place) = points.get_mut(index as usize)
            && place.replace(p).is_some_and(|other| other != p)
        {
            return Err(PvtuFault::PointsDiffer { id });
        }
    }
    let points = points.into_iter().flatten().collect();
    reader.renumber(points, &index_of);
    Ok(())
}

/// Paths of the pieces, relative to the folder of the index.
fn sources(bytes: &[u8]) -> Result<Vec<PathBuf>, PvtuFault> {
    let xml = VtkXml::parse(bytes, "PUnstructuredGrid")?;
    let grid = xml.child(VtkXml::ROOT, "PUnstructuredGrid");
    let grid = grid.ok_or(PvtuFault::Missing { what: "PUnstructuredGrid" })?;
    let source = |piece| xml.attribute(piece, "Source").ok_or(PvtuFault::Missing { what: "Source" });
    xml.children(grid, "Piece").map(|piece| source(piece).map(PathBuf::from)).collect()
}
