//! Reads a mesh in pieces: the index, then every piece, and unites the points that pieces share.

use super::mesh_file::{ContentFault, MeshFile, MeshFileError};
use super::vtk_xml::VtkXml;
use super::vtu_read::GridReader;
use std::path::{Path, PathBuf};

/// Reads a mesh in pieces. Points are united by their global ids, and are in the order of these; when a piece has none,
/// points that pieces share stay apart. Cells that a piece has only as ghosts are left out.
///
/// # Errors
/// `Read` with the system's reason, `Empty`, or `Content` with what is wrong, all with the path of the index or piece.
pub fn read_pvtu(path: &Path) -> Result<MeshFile, MeshFileError> {
    let in_index = |fault| MeshFileError::Content { path: path.to_path_buf(), fault };
    let sources = sources(&read(path)?).map_err(in_index)?;
    if sources.is_empty() {
        return Err(in_index(ContentFault::Missing { what: "Piece" }));
    }
    let mut reader = GridReader::default();
    for source in sources {
        let piece = path.with_file_name(source);
        reader.read(&read(&piece)?).map_err(|fault| MeshFileError::Content { path: piece, fault })?;
    }
    reader.unite().map_err(in_index)?;
    Ok(reader.finish())
}

fn read(path: &Path) -> Result<Vec<u8>, MeshFileError> {
    let bytes = std::fs::read(path).map_err(|source| MeshFileError::Read { path: path.to_path_buf(), source })?;
    if bytes.trim_ascii().is_empty() {
        return Err(MeshFileError::Empty { path: path.to_path_buf() });
    }
    Ok(bytes)
}

/// Paths of the pieces, from the folder of the index.
fn sources(bytes: &[u8]) -> Result<Vec<PathBuf>, ContentFault> {
    let xml = VtkXml::parse(bytes, "PUnstructuredGrid")?;
    let grid = xml.child(xml.root(), "PUnstructuredGrid");
    let grid = grid.ok_or(ContentFault::Missing { what: "PUnstructuredGrid" })?;
    let source = |piece| xml.attribute(piece, "Source").ok_or(ContentFault::Missing { what: "Source" });
    xml.children(grid, "Piece").map(|piece| source(piece).map(PathBuf::from)).collect()
}
