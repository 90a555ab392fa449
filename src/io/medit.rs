//! Medit's text format `.mesh`: keyworded lists of vertices, triangles and tetrahedra, each item with a reference.

use super::file_error::{FileError, read_bytes, unsound, write_whole};
use super::text::{TextFault, Words, shown};
use super::vtu_read::usual_name;
use crate::mesh::source::MeshSource;
use crate::mesh::{Patch, TetMesh, VolumeMesh};
use std::io::{self, Write};
use std::path::Path;

/// Why a Medit file could not be read or written.
pub type MeditFileError = FileError<MeditFault>;

/// Why the content of a file is no tetrahedral mesh of Medit's. Cells are numbered from 0 within their list.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeditFault {
    /// Its words are not those of the format.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// The file does not begin as every such file does.
    #[error("line {line}: '{found}' stands where MeshVersionFormatted has to be; is it a Medit text file?")]
    NotMedit {
        /// The line.
        line: usize,
        /// What is there.
        found: String,
    },
    /// Points are not in space.
    #[error("line {line}: the mesh has the dimension {dimension}; it has to be 3")]
    Dimension {
        /// The line.
        line: usize,
        /// The dimension.
        dimension: i64,
    },
    /// There are cells that are neither tetrahedra nor triangles.
    #[error("line {line}: there are {kind}; only tetrahedra and triangles are supported")]
    UnsupportedCells {
        /// The line.
        line: usize,
        /// Their keyword.
        kind: String,
    },
    /// A list comes a second time.
    #[error("line {line}: a second list of {kind}; there may be one")]
    Repeated {
        /// The line.
        line: usize,
        /// Its keyword.
        kind: &'static str,
    },
    /// A cell names a point that does not exist.
    #[error("{kind} {cell} names the point {index}, but the points are numbered from 1 to {points}")]
    BadIndex {
        /// The list of the cell.
        kind: &'static str,
        /// The first such cell.
        cell: usize,
        /// What it names.
        index: i64,
        /// How many points there are.
        points: usize,
    },
    /// Something that every mesh has is not there.
    #[error("the list of {what} is missing")]
    Missing {
        /// The list.
        what: &'static str,
    },
}

/// Reads a mesh from a file, whatever its extension.
///
/// # Errors
/// `Read` with the system's reason, `Empty`, or `Content` with what is wrong.
pub fn read_medit(path: &Path) -> Result<VolumeMesh, MeditFileError> {
    let bytes = read_bytes(path)?;
    read_medit_from(&bytes).map_err(|fault| FileError::Content { path: path.to_path_buf(), fault })
}

/// Reads a mesh from the bytes of a file. References of tetrahedra become blocks, those of triangles patches with their
/// usual names; the blocks under the boundary are not in the file and stay 0. Lists of other things are passed over.
///
/// # Errors
/// When the bytes are no such file, or it is incomplete, or holds other cells.
pub fn read_medit_from(bytes: &[u8]) -> Result<VolumeMesh, MeditFault> {
    let mut words = Words::new(bytes, true);
    let first = words.need("MeshVersionFormatted")?;
    if first != b"MeshVersionFormatted" {
        return Err(MeditFault::NotMedit { line: words.line(), found: shown(first) });
    }
    words.integer("the version")?;
    let mut lists = Lists::default();
    while let Some(keyword) = words.word() {
        match keyword {
            b"Dimension" => {
                let dimension = words.integer("the dimension")?;
                if dimension != 3 {
                    return Err(MeditFault::Dimension { line: words.line(), dimension });
                }
            }
            b"Vertices" => lists.read_vertices(&mut words)?,
            b"Triangles" => read_cells(&mut words, TRIANGLES, &mut lists.triangles)?,
            b"Tetrahedra" => read_cells(&mut words, TETRAHEDRA, &mut lists.tets)?,
            b"End" => break,
            _ if keyword.first().is_some_and(u8::is_ascii_alphabetic) => skip_list(&mut words, keyword)?,
            _ => return Err(TextFault::Surplus { line: words.line() }.into()),
        }
    }
    lists.into_volume()
}

const VERTICES: &str = "Vertices";
const TRIANGLES: &str = "Triangles";
const TETRAHEDRA: &str = "Tetrahedra";

/// Cells with their references, as numbered in the file.
type Cells<const N: usize> = Option<Vec<([i64; N], i32)>>;

#[derive(Default)]
struct Lists {
    vertices: Option<TetMesh>,
    triangles: Cells<3>,
    tets: Cells<4>,
}

impl Lists {
    fn read_vertices(&mut self, words: &mut Words) -> Result<(), MeditFault> {
        if self.vertices.is_some() {
            return Err(MeditFault::Repeated { line: words.line(), kind: VERTICES });
        }
        // "0 0 0 0\n"
        let count = words.count("the count of vertices", 8)?;
        let mut mesh = TetMesh { points: Vec::with_capacity(count), tets: Vec::new() };
        for _ in 0..count {
            mesh.points.push(words.point()?);
            words.integer("a vertex's reference")?;
        }
        self.vertices = Some(mesh);
        Ok(())
    }

    fn into_volume(self) -> Result<VolumeMesh, MeditFault> {
        let mesh = self.vertices.ok_or(MeditFault::Missing { what: VERTICES })?;
        let tets = self.tets.ok_or(MeditFault::Missing { what: TETRAHEDRA })?;
        let triangles = self.triangles.unwrap_or_default();
        let points = mesh.points.len();
        let mut volume = VolumeMesh { mesh, ..VolumeMesh::default() };
        volume.mesh.tets = indices(&tets, points, TETRAHEDRA)?;
        volume.tet_block = tets.iter().map(|&(_, reference)| reference).collect();
        volume.boundary = indices(&triangles, points, TRIANGLES)?;
        volume.boundary_patch = triangles.iter().map(|&(_, reference)| reference).collect();
        volume.boundary_block = vec![0; triangles.len()];
        let mut ids = volume.boundary_patch.clone();
        ids.sort_unstable();
        ids.dedup();
        volume.patches = ids.into_iter().map(|id| Patch { id, name: usual_name(id), cap: None }).collect();
        Ok(volume)
    }
}

fn read_cells<const N: usize>(words: &mut Words, kind: &'static str, cells: &mut Cells<N>) -> Result<(), MeditFault> {
    if cells.is_some() {
        return Err(MeditFault::Repeated { line: words.line(), kind });
    }
    let count = words.count("the count of a list", 2 * (N + 1))?;
    let list = cells.insert(Vec::with_capacity(count));
    for _ in 0..count {
        let mut corners = [0; N];
        for corner in &mut corners {
            *corner = words.integer("a corner of a cell")?;
        }
        let reference = words.need("a cell's reference")?;
        list.push((corners, words.as_marker(reference, "a cell's reference")?));
    }
    Ok(())
}

/// Passes over a list of something that bounds and fills nothing.
fn skip_list(words: &mut Words, keyword: &[u8]) -> Result<(), MeditFault> {
    let cells = [&b"Quadrilaterals"[..], b"Hexahedra", b"Hexaedra", b"Prisms", b"Pyramids"].contains(&keyword);
    if cells && words.peek() != Some(b"0") {
        return Err(MeditFault::UnsupportedCells { line: words.line(), kind: shown(keyword) });
    }
    while words.peek().is_some_and(|word| !word.first().is_some_and(u8::is_ascii_alphabetic)) {
        words.word();
    }
    Ok(())
}

fn indices<const N: usize>(
    cells: &[([i64; N], i32)],
    points: usize,
    kind: &'static str,
) -> Result<Vec<[u32; N]>, MeditFault> {
    let mut rows = Vec::with_capacity(cells.len());
    for (cell, (corners, _)) in cells.iter().enumerate() {
        let outside = |&&index: &&i64| index < 1 || index > points as i64;
        if let Some(&index) = corners.iter().find(outside) {
            return Err(MeditFault::BadIndex { kind, cell, index, points });
        }
        rows.push(corners.map(|index| (index - 1) as u32));
    }
    Ok(rows)
}

/// Writes a mesh to a file, which appears whole or not at all.
///
/// # Errors
/// `BadMesh` when a cell names a point that does not exist, or `Write` with the reason.
pub fn write_medit(path: &Path, mesh: &dyn MeshSource) -> Result<(), MeditFileError> {
    let unread = |source| FileError::Write { path: path.to_path_buf(), source };
    if let Some(cell) = unsound_cell(mesh).map_err(unread)? {
        return Err(FileError::BadMesh { path: path.to_path_buf(), cell });
    }
    write_whole(path, |out| write_medit_to(out, mesh))
}

/// The first cell, in its list, that names a point that does not exist.
fn unsound_cell(mesh: &dyn MeshSource) -> io::Result<Option<usize>> {
    let points = mesh.counts().points;
    let (mut found, mut before) = (None, 0);
    mesh.tets(&mut |piece| {
        found = found.or_else(|| unsound(piece.tets, points).map(|cell| before + cell));
        before += piece.tets.len();
        Ok(())
    })?;
    before = 0;
    mesh.boundary(&mut |piece| {
        found = found.or_else(|| unsound(piece.faces, points).map(|cell| before + cell));
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
pub fn write_medit_to(out: &mut impl Write, mesh: &dyn MeshSource) -> io::Result<()> {
    let counts = mesh.counts();
    writeln!(out, "MeshVersionFormatted 2\nDimension 3\n{VERTICES}\n{}", counts.points)?;
    mesh.points(&mut |points| points.iter().try_for_each(|p| writeln!(out, "{:?} {:?} {:?} 0", p.x, p.y, p.z)))?;
    writeln!(out, "{TRIANGLES}\n{}", counts.boundary)?;
    mesh.boundary(&mut |piece| write_cells(out, piece.faces, piece.patches))?;
    writeln!(out, "{TETRAHEDRA}\n{}", counts.tets)?;
    mesh.tets(&mut |piece| write_cells(out, piece.tets, piece.blocks))?;
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
