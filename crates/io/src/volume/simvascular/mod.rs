//! `SimVascular` folder `mesh-complete` for `svMultiPhysics`: tetrahedra, whole boundary, patches, flow rates of
//! inlets, and `solver.xml`.
//! All numbers count from 1 in 32 bits.

#[cfg(test)]
mod case_tests;
mod inflow;
mod layout;
mod sheet;
mod solver;
mod spool;
mod steps;
#[cfg(test)]
mod tests;

use super::content::MeshNotes;
use super::vtu::arrays::{ArrayLocation, ArrayWriter, INT32, Width, cell_arrays, points_array};
use super::vtu::{Recounted, file::File};
use crate::file::{Asked, AtomicFile, AtomicFolder};
use crate::flow::plain;
use crate::patches::usual_name;
use crate::vtk_xml::Blocks;
use anastomesh_mesh::WALL;
use anastomesh_mesh::faces::OuterFace;
use anastomesh_mesh::progress::{Progress, ask};
use anastomesh_mesh::source::MeshSource;
use layout::{EXTERIOR, MESH, SOLVER, WALLS, is_ours, surface_path};
use sheet::{CapSheet, Sheet, WideSheet, used};
use spool::Spool;
use std::collections::BTreeMap;
use std::io::{self, Cursor, Seek, Write};
use std::path::Path;
use steps::Steps;

/// Checks that the folder can be created or replaced, without side effects.
pub(super) fn ensure_writable(path: &Path) -> io::Result<()> {
    AtomicFolder::create(path, is_ours).map(drop)
}

/// Writes a folder atomically.
///
/// The boundary is stored in a temporary file, with the tetrahedron at each face, and read from it. Memory holds the
/// faces of inlets and outlets, those between parts of the mesh, and a bit per point.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidData` if the labelled faces are not its boundary.
pub(super) fn write(path: &Path, mesh: &dyn MeshSource, notes: &MeshNotes, progress: &dyn Progress) -> io::Result<()> {
    ensure_countable(mesh)?;
    let folder = AtomicFolder::create(path, is_ours)?;
    let spool = Spool::of(mesh, path, progress)?;
    put(&folder, MESH, progress, &|out| write_tets(out, mesh))?;
    put_wide(&folder, EXTERIOR, mesh, &spool, |_| true, progress)?;
    let names: BTreeMap<i32, String> = mesh.patches().iter().map(|p| (p.id, plain(&p.name))).collect();
    let surface = |id: i32| surface_path(names.get(&id).map_or(&usual_name(id), |name| name));
    put_wide(&folder, WALLS, mesh, &spool, |face| face.patch == WALL, progress)?;
    folder.copy(WALLS, &surface(WALL))?;
    let caps = caps(&spool)?;
    let mut edges = BTreeMap::new();
    for (&id, faces) in &caps {
        let cap = CapSheet::new(mesh, faces)?;
        edges.insert(id, cap.edge());
        let mut bytes = Cursor::new(Vec::new());
        write_sheet(&mut bytes, &cap)?;
        folder.put(&surface(id), bytes.get_ref())?;
        ask(progress)?;
    }
    let flow = &notes.flow_of(mesh.patches());
    let steps = Steps::of(mesh.patches(), flow, &edges);
    for patch in mesh.patches().iter().filter(|patch| patch.is_inlet()) {
        let cap = CapSheet::new(mesh, caps.get(&patch.id).map_or(&[], Vec::as_slice))?;
        if let Some((name, text)) = inflow::file(patch, &cap, flow, &steps) {
            folder.put(&name, text.as_bytes())?;
        }
        ask(progress)?;
    }
    folder.put(SOLVER, solver::text(mesh.patches(), flow, &steps).as_bytes())?;
    folder.commit()
}

type SheetOutput<'a> = Asked<'a, &'a mut AtomicFile>;

/// Writes a file of the folder.
fn put(
    folder: &AtomicFolder,
    name: &str,
    progress: &dyn Progress,
    write: &dyn Fn(&mut SheetOutput) -> io::Result<()>,
) -> io::Result<()> {
    let mut file = folder.file(name)?;
    write(&mut Asked { out: &mut file, progress })?;
    file.commit()
}

/// Writes a file with the selected faces.
fn put_wide(
    folder: &AtomicFolder,
    name: &str,
    mesh: &dyn MeshSource,
    spool: &Spool,
    has: fn(&OuterFace) -> bool,
    progress: &dyn Progress,
) -> io::Result<()> {
    let (used, faces) = used(mesh, spool, has)?;
    let sheet = WideSheet { mesh, spool, has, used: &used, ranks: used.ranks(), faces };
    put(folder, name, progress, &|out| write_sheet(out, &sheet))
}

/// Faces of every patch except the wall.
fn caps(spool: &Spool) -> io::Result<BTreeMap<i32, Vec<OuterFace>>> {
    let mut caps: BTreeMap<i32, Vec<OuterFace>> = BTreeMap::new();
    spool.each(|faces| {
        for &face in faces.iter().filter(|face| face.patch != WALL) {
            caps.entry(face.patch).or_default().push(face);
        }
        Ok(())
    })?;
    Ok(caps)
}

/// Checks that all counts fit into 32 bits, as the readers require.
fn ensure_countable(mesh: &dyn MeshSource) -> io::Result<()> {
    let counts = mesh.counts();
    if Width::of(counts) == Width::Int32 {
        return Ok(());
    }
    let text = format!(
        "{} tetrahedra are more than SimVascular's numbers of 32 bits allow; mesh parts, or use a smaller rho",
        counts.tets
    );
    Err(io::Error::new(io::ErrorKind::InvalidInput, text))
}

/// Writes tetrahedra only, as the solver accepts no other cells.
fn write_tets(out: &mut (impl Write + Seek), mesh: &dyn MeshSource) -> io::Result<()> {
    let mesh: &dyn MeshSource = &Recounted::without_boundary(mesh);
    let counts = mesh.counts();
    let (points, tets) = (counts.points, counts.tets);
    let mut arrays = vec![points_array(points, false, |each| mesh.each_points(each))];
    arrays.extend(cell_arrays(mesh, Width::Int32));
    let from_one = |place, name, count| {
        let fill = move |out: &mut Blocks| out.push(count, |i| (i as u32 + 1).to_le_bytes());
        uncompressed(ArrayWriter::new(place, name, INT32, count, fill))
    };
    arrays.push(from_one(ArrayLocation::PointData, "GlobalNodeID", points));
    arrays.push(from_one(ArrayLocation::CellData, "GlobalElementID", tets));
    arrays.push(ArrayWriter::new(ArrayLocation::CellData, "ModelRegionID", INT32, tets, move |out| {
        out.push(tets, |_| 1_u32.to_le_bytes())
    }));
    let counts = format!("NumberOfPoints=\"{points}\" NumberOfCells=\"{tets}\"");
    File { kind: "UnstructuredGrid", counts, arrays, raw: false }.write(out)
}

/// Array that is stored raw. Compression of ascending numbers saves little space for its time.
fn uncompressed(array: ArrayWriter) -> ArrayWriter {
    ArrayWriter { shrinks: false, ..array }
}

/// Writes a surface with the mesh numbers of its points and adjacent tetrahedra.
fn write_sheet(out: &mut (impl Write + Seek), sheet: &dyn Sheet) -> io::Result<()> {
    let (points, faces) = sheet.counts();
    let corners = ArrayWriter::new(ArrayLocation::Polys, "connectivity", INT32, 3 * faces, |out| {
        sheet.each_faces(&mut |some| out.push(some.len(), |i| corners_of(sheet, &some[i])))
    });
    let offsets = move |out: &mut Blocks| out.push(faces, |face| (3 * (face as u32 + 1)).to_le_bytes());
    let label = |name, of: fn(&OuterFace) -> u32| {
        ArrayWriter::new(ArrayLocation::CellData, name, INT32, faces, move |out| {
            sheet.each_faces(&mut |some| out.push(some.len(), |i| of(&some[i]).to_le_bytes()))
        })
    };
    let nodes = ArrayWriter::new(ArrayLocation::PointData, "GlobalNodeID", INT32, points, |out| {
        sheet.each_ids(&mut |ids| out.push(ids.len(), |i| (ids[i] + 1).to_le_bytes()))
    });
    let arrays = vec![
        uncompressed(nodes),
        points_array(points, false, |mut each| sheet.each_points(&mut each)),
        uncompressed(corners),
        uncompressed(ArrayWriter::new(ArrayLocation::Polys, "offsets", INT32, faces, offsets)),
        uncompressed(label("GlobalElementID", |face| face.tet + 1)),
        label("ModelRegionID", |_| 1),
        label("ModelFaceID", |face| face.patch as u32),
    ];
    let counts = format!("NumberOfPoints=\"{points}\" NumberOfPolys=\"{faces}\"");
    File { kind: "PolyData", counts, arrays, raw: false }.write(out)
}

fn corners_of(sheet: &dyn Sheet, face: &OuterFace) -> [u8; 12] {
    let mut bytes = [0; 12];
    let (words, _) = bytes.as_chunks_mut::<4>();
    for (word, v) in words.iter_mut().zip(face.vertices) {
        *word = sheet.own_number(v).to_le_bytes();
    }
    bytes
}
