//! Reader of tetrahedral meshes in file families: `.node`, `.ele` and optional `.face`.

use super::error::{TetgenFault, TetgenFileError};
use super::family::{member, sorted};
use super::nodes::{Nodes, read_nodes};
use crate::file::{FileError, read_bytes};
use crate::patches::usual_patches;
use crate::text::{TextFault, Words, from_first};
use anastomesh_mesh::adjacency::{NONE, face_vertices, tet_adjacency};
use anastomesh_mesh::{TetMesh, VolumeMesh};
use rustc_hash::FxHashMap;
use std::path::Path;

/// Reads a mesh from the files `base.node`, `base.ele` and `base.face`; `base` may have any of these extensions.
///
/// The first attribute of a tetrahedron becomes its block if it is an integer, else 0. Faces with a marker form the
/// boundary, those with marker 0 only if they lie on it. Boundary faces are oriented outwards; inner faces keep their
/// orientation. Without a `.face` file the boundary is empty.
///
/// # Errors
/// `Read` with the error of the operating system, `Empty`, or `Content` with the fault.
pub fn read_mesh(base: &Path) -> Result<VolumeMesh, TetgenFileError> {
    let nodes = read_nodes(&member(base, "node"))?;
    let path = member(base, "ele");
    let cells = tets(&read_bytes(&path)?, &nodes).map_err(FileError::content(&path))?;
    let path = member(base, "face");
    let listed = if path.exists() {
        face_list(&read_bytes(&path)?, &nodes).map_err(FileError::content(&path))?
    } else {
        Vec::new()
    };
    Ok(assemble(nodes, cells, listed))
}

/// Reads a mesh like [`crate::read_mesh`] from the bytes of the files. `face` is empty if there is no `.face` file.
///
/// # Errors
/// Returns the fault of one of the files.
pub fn read_mesh_from(node: &[u8], ele: &[u8], face: &[u8]) -> Result<VolumeMesh, TetgenFault> {
    let nodes = Nodes::parse(node)?;
    let cells = tets(ele, &nodes)?;
    let listed = if face.is_empty() { Vec::new() } else { face_list(face, &nodes)? };
    Ok(assemble(nodes, cells, listed))
}

fn assemble(nodes: Nodes, (tets, tet_block): Cells, listed: Vec<([u32; 3], i32)>) -> VolumeMesh {
    let mut volume = VolumeMesh { mesh: TetMesh { points: nodes.points, tets }, tet_block, ..VolumeMesh::default() };
    set_boundary(&mut volume, listed);
    volume
}

/// Tetrahedra with their blocks.
type Cells = (Vec<[u32; 4]>, Vec<i32>);

/// Parses `<count> <points each> <attributes>`, then `<number> <points> <attributes>`.
fn tets(bytes: &[u8], nodes: &Nodes) -> Result<Cells, TetgenFault> {
    let mut words = Words::new(bytes, true);
    // "0 0 0 0 0\n"
    let count = words.count("the count of tetrahedra", 10)?;
    let corners = match words.word_here() {
        Some(word) => words.as_integer(word, "how many points a tetrahedron has")?,
        None => 4,
    };
    if corners != 4 {
        return Err(TetgenFault::Order { line: words.line(), corners });
    }
    let attributes = words.count_here("the count of attributes", 2)?;
    words.skip_line();
    let (mut tets, mut blocks) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for cell in 0..count {
        tets.push(corners_of(&mut words, nodes, "tetrahedron", cell)?);
        blocks.push(if attributes > 0 { block(&mut words)? } else { 0 });
        words.skip_line();
    }
    words.expect_end()?;
    Ok((tets, blocks))
}

fn block(words: &mut Words) -> Result<i32, TextFault> {
    let value = words.float_here("an attribute")?;
    let integral = value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX);
    Ok(if integral { value as i32 } else { 0 })
}

/// Parses `<count> <markers 0 or 1>`, then `<number> <points> <marker>`.
fn face_list(bytes: &[u8], nodes: &Nodes) -> Result<Vec<([u32; 3], i32)>, TetgenFault> {
    let mut words = Words::new(bytes, true);
    // "0 0 0 0\n"
    let count = words.count("the count of faces", 8)?;
    let marked = words.flag_here("the number of markers (0 or 1)")?;
    words.skip_line();
    let mut faces = Vec::with_capacity(count);
    for cell in 0..count {
        let corners = corners_of(&mut words, nodes, "face", cell)?;
        faces.push((corners, if marked { words.marker_here("a marker")? } else { 0 }));
        words.skip_line();
    }
    words.expect_end()?;
    Ok(faces)
}

/// Parses the number of a cell, which is arbitrary, and its corners.
fn corners_of<const N: usize>(
    words: &mut Words,
    nodes: &Nodes,
    kind: &'static str,
    cell: usize,
) -> Result<[u32; N], TetgenFault> {
    words.integer("the number of a cell")?;
    let (points, first) = (nodes.points.len(), nodes.first);
    let mut corners = [0; N];
    for corner in &mut corners {
        let word = words.need_here("a corner of a cell")?;
        let index = words.as_integer(word, "a corner of a cell")?;
        let bad = || TetgenFault::BadCell { line: words.line(), kind, cell, index, points, first };
        *corner = from_first(index, first, points).ok_or_else(bad)?;
    }
    Ok(corners)
}

fn set_boundary(volume: &mut VolumeMesh, listed: Vec<([u32; 3], i32)>) {
    if listed.is_empty() {
        return;
    }
    let tets = &volume.mesh.tets;
    let mut outer: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    let adjacency = tet_adjacency(tets, volume.mesh.points.len());
    for (tet, sides) in adjacency.neighbors.iter().enumerate() {
        for (side, _) in sides.iter().enumerate().filter(|(_, neighbor)| **neighbor == NONE) {
            let handle = (4 * tet + side) as u32;
            outer.insert(sorted(face_vertices(tets, handle)), handle);
        }
    }
    for (face, marker) in listed {
        let handle = outer.get(&sorted(face)).copied();
        if handle.is_none() && marker == 0 {
            continue;
        }
        volume.boundary.push(handle.map_or(face, |handle| face_vertices(tets, handle)));
        volume.boundary_patch.push(marker);
        let block = handle.and_then(|handle| volume.tet_block.get(handle as usize / 4));
        volume.boundary_block.push(block.copied().unwrap_or(0));
    }
    volume.patches = usual_patches(&volume.boundary_patch);
}
