//! Reader of Medit files.

use super::error::MeditFault;
use super::names::{PATCH, REGION, TETRAHEDRA, TRIANGLES, VERTICES};
use crate::patches::usual_patches;
use crate::text::{TextFault, Words, shown};
use crate::volume::content::MeshFile;
use anastomesh_mesh::region::{NamedRegion, label_faces};
use anastomesh_mesh::{TetMesh, VolumeMesh};

/// Reads a mesh from the bytes of a file. References of tetrahedra become blocks, those of triangles patches with
/// default names, or regions and patches with the names in comments of this program. Without regions, the blocks of
/// boundary faces are 0. Other lists are skipped.
///
/// # Errors
/// The bytes violate the format, are incomplete, or contain other cells.
pub(in crate::volume) fn read(bytes: &[u8]) -> Result<MeshFile, MeditFault> {
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
    let mut file = MeshFile::from(lists.into_volume()?);
    let mut regions: Vec<NamedRegion> =
        named(bytes, REGION).into_iter().map(|(id, name)| NamedRegion { id, name }).collect();
    regions.sort_by_key(|region| region.id);
    regions.dedup_by_key(|region| region.id);
    if !regions.is_empty() {
        file.notes.regions = regions;
        let names = named(bytes, PATCH);
        for patch in &mut file.volume.patches {
            if let Some((_, name)) = names.iter().find(|(id, _)| *id == patch.id) {
                patch.name.clone_from(name);
            }
        }
        label_faces(&mut file.volume);
    }
    Ok(file)
}

/// Names in comments before the points, with their references.
fn named(bytes: &[u8], comment: &str) -> Vec<(i32, String)> {
    let lines = bytes.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    let head = lines.take_while(|line| !line.starts_with(VERTICES.as_bytes()));
    let named = |line: &[u8]| {
        let (id, name) = str::from_utf8(line.strip_prefix(comment.as_bytes())?).ok()?.split_once(' ')?;
        Some((id.parse().ok()?, name.into()))
    };
    head.filter_map(named).collect()
}

/// Cells with their references, as numbered in the file.
type LabelledCells<const N: usize> = Option<Vec<([i64; N], i32)>>;

#[derive(Default)]
struct Lists {
    vertices: Option<TetMesh>,
    triangles: LabelledCells<3>,
    tets: LabelledCells<4>,
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
        volume.patches = usual_patches(&volume.boundary_patch);
        Ok(volume)
    }
}

fn read_cells<const N: usize>(
    words: &mut Words,
    kind: &'static str,
    cells: &mut LabelledCells<N>,
) -> Result<(), MeditFault> {
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

/// Skips a list of elements that are not cells.
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
