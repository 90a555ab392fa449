//! Files of a case.

use super::assemble::{Fields, assemble};
use super::data::Scanner;
use super::dictionary::{Dictionary, entries, header};
use super::poly_mesh::{PolyMesh, faces, labels, patches, points};
use crate::file::{FileError, read_bytes};
use crate::results::content::FlowResult;
use crate::results::error::{ResultError, ResultFault};
use flate2::read::GzDecoder;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Reads the latest time of a case.
pub(in crate::results) fn read(folder: &Path) -> Result<FlowResult, ResultError> {
    let mesh = read_mesh(&folder.join("constant/polyMesh"))?;
    let time = latest(folder)?;
    let needed = |name: &str| field(&time.join(name));
    let optional = |name: &str| if found(&time.join(name)).is_some() { needed(name).map(Some) } else { Ok(None) };
    let fields = Fields {
        velocity: needed("U")?,
        pressure: needed("p")?,
        flux: optional("phi")?,
        shear: optional("wallShearStress")?,
    };
    let name = time.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok(assemble(&mesh, &fields, name).map_err(FileError::content(&time))?)
}

fn read_mesh(folder: &Path) -> Result<PolyMesh, ResultError> {
    let [at_points, at_faces, at_owner, at_neighbour, at_boundary] =
        ["points", "faces", "owner", "neighbour", "boundary"].map(|name| folder.join(name));
    let points = points(&bytes(&at_points)?).map_err(FileError::content(&at_points))?;
    let faces = faces(&bytes(&at_faces)?, points.len()).map_err(FileError::content(&at_faces))?;
    let owner = labels(&bytes(&at_owner)?, "owner").map_err(FileError::content(&at_owner))?;
    let neighbour = labels(&bytes(&at_neighbour)?, "neighbour").map_err(FileError::content(&at_neighbour))?;
    let patches = patches(&bytes(&at_boundary)?).map_err(FileError::content(&at_boundary))?;
    Ok(PolyMesh::new(&points, &faces, owner, neighbour, patches).map_err(FileError::content(folder))?)
}

/// The latest time folder with a velocity, other than the initial one.
fn latest(folder: &Path) -> Result<PathBuf, ResultError> {
    let inside = std::fs::read_dir(folder).map_err(FileError::read(folder))?;
    let paths: Vec<PathBuf> = inside.flatten().map(|entry| entry.path()).collect();
    let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let times = paths.iter().filter_map(|path| Some((name(path).parse::<f64>().ok()?, path)));
    let times = times.filter(|(time, path)| *time > 0.0 && time.is_finite() && found(&path.join("U")).is_some());
    let decomposed = paths.iter().any(|path| name(path).starts_with("processor"));
    let last = times.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, path)| path.clone());
    last.ok_or_else(|| ResultError::NoTime { path: folder.to_path_buf(), decomposed })
}

fn field(path: &Path) -> Result<Dictionary, ResultError> {
    let bytes = bytes(path)?;
    let mut scanner = Scanner::new(&bytes);
    let read = header(&mut scanner).and_then(|_| entries(&mut scanner, false, 0));
    Ok(read.map_err(FileError::content(path))?)
}

/// Path of a file, or of its compressed form.
fn found(path: &Path) -> Option<PathBuf> {
    let mut compressed = path.as_os_str().to_owned();
    compressed.push(".gz");
    [path.to_path_buf(), compressed.into()].into_iter().find(|path| path.is_file())
}

fn bytes(path: &Path) -> Result<Vec<u8>, ResultError> {
    let path = found(path).unwrap_or_else(|| path.to_path_buf());
    let bytes = read_bytes::<ResultFault>(&path)?;
    if path.extension().is_none_or(|extension| extension != "gz") {
        return Ok(bytes);
    }
    let mut plain = Vec::new();
    GzDecoder::new(&bytes[..]).read_to_end(&mut plain).map_err(FileError::read(&path))?;
    Ok(plain)
}
