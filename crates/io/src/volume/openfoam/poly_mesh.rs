//! Mesh files: points, faces, and the cells on both sides of each face. Binary faces have fixed positions, so patches
//! are grouped without being held in memory.

use super::boundary::Boundary;
use super::figures::{Figures, Sample};
use super::head;
use super::joined::{CellFaces, Polygon};
use super::lists::LabelList;
use super::spools::Spools;
use crate::file::{Asked, AtomicFile, AtomicFolder};
use anastomesh_mesh::faces::Faces;
use anastomesh_mesh::progress::{Progress, ask};
use anastomesh_mesh::source::{MeshSource, miscounted};
use anastomesh_mesh::stacks::Cells;
use std::collections::BTreeMap;
use std::io::{self, Write};

pub(super) const FILES: [&str; 4] = [POINTS, FACES, OWNER, NEIGHBOUR];
pub(super) const POINTS: &str = "constant/polyMesh/points";
pub(super) const FACES: &str = "constant/polyMesh/faces";
pub(super) const OWNER: &str = "constant/polyMesh/owner";
pub(super) const NEIGHBOUR: &str = "constant/polyMesh/neighbour";

/// Maximum value of a 32-bit label, the default size.
const LARGEST: u64 = i32::MAX as u64;

/// Writes points, faces, owners and neighbours, measures the mesh, and passes its faces on to `processors`. Inner faces come first in upper-triangular order:
/// by the lower cell, which owns them, then by the other. Those of each patch follow by their cell.
pub(super) fn write(
    folder: &AtomicFolder,
    mesh: &dyn MeshSource,
    faces: &Faces,
    cells: Option<&Cells>,
    boundary: &Boundary,
    mut processors: Option<&mut Spools>,
    progress: &dyn Progress,
) -> io::Result<Figures> {
    let count = boundary.inner + boundary.outer;
    if boundary.corners > LARGEST || mesh.counts().points as u64 > LARGEST {
        let text = format!(
            "the mesh has {count} faces, more than labels of 32 bits can count; mesh its parts, or use a smaller rho"
        );
        return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
    }
    write_points(folder, mesh, progress)?;
    let counts = mesh.counts();
    let note = format!(
        "nPoints:{}  nCells:{}  nFaces:{count}  nInternalFaces:{}",
        counts.points,
        cells.map_or(counts.tets, Cells::len),
        boundary.inner
    );
    let mut lists = FaceLists {
        corners: corner_list(folder, &note, boundary, progress)?,
        owner: LabelList::alone(folder.file(OWNER)?, OWNER, &note, count)?,
        neighbour: LabelList::alone(folder.file(NEIGHBOUR)?, NEIGHBOUR, &note, boundary.inner)?,
    };
    let (mut inner, mut corner) = (0, 0);
    let places = (0..).zip(&boundary.patches).map(|(i, p)| (p.patch.id, (i, [p.first, p.corners])));
    let mut places: BTreeMap<i32, (u32, [u64; 2])> = places.collect();
    let mut figures = Figures::default();
    let sample = Sample::of(mesh);
    faces.each_with(
        |part, first, faces| {
            let measured = sample.holds(part).then(|| Figures::of_part(mesh, part, first, faces, cells)).transpose()?;
            Ok((CellFaces::of(faces, cells), measured))
        },
        |_, (part, measured)| {
            ask(progress)?;
            figures.extend(measured.unwrap_or_default());
            if let Some(processors) = processors.as_deref_mut() {
                processors.put_inner(&part.inner, inner)?;
            }
            let corners = flattened(part.inner.iter().map(|face| &face.face));
            lists.corners.put(corner, &corners)?;
            lists.owner.put(inner, &part.inner.iter().map(|face| face.cells[0]).collect::<Vec<_>>())?;
            lists.neighbour.put(inner, &part.inner.iter().map(|face| face.cells[1]).collect::<Vec<_>>())?;
            inner += part.inner.len() as u64;
            corner += corners.len() as u64;
            for same in part.outer.chunk_by(|a, b| a.patch == b.patch) {
                let (patch, [first, corner]) = places.get_mut(&same[0].patch).ok_or_else(miscounted)?;
                if let Some(processors) = processors.as_deref_mut() {
                    processors.put_outer(same, *patch, *first)?;
                }
                let corners = flattened(same.iter().map(|face| &face.face));
                lists.corners.put(*corner, &corners)?;
                lists.owner.put(*first, &same.iter().map(|face| face.cell).collect::<Vec<_>>())?;
                *first += same.len() as u64;
                *corner += corners.len() as u64;
            }
            Ok(())
        },
    )?;
    [lists.corners, lists.owner, lists.neighbour].into_iter().try_for_each(|list| list.finish()?.commit())?;
    Ok(figures)
}

/// Vertices of faces, one after the other.
fn flattened<'a>(faces: impl Iterator<Item = &'a Polygon>) -> Vec<u32> {
    let mut corners = Vec::with_capacity(3 * faces.size_hint().0);
    faces.for_each(|face| corners.extend_from_slice(face.vertices()));
    corners
}

fn write_points(folder: &AtomicFolder, mesh: &dyn MeshSource, progress: &dyn Progress) -> io::Result<()> {
    let mut file = folder.file(POINTS)?;
    let out = &mut Asked { out: &mut file, progress };
    write!(out, "{}{}\n(", head::binary("vectorField", POINTS, ""), mesh.counts().points)?;
    mesh.each_points(|points| {
        let bytes: Vec<u8> = points.iter().flat_map(|p| [p.x, p.y, p.z]).flat_map(f64::to_le_bytes).collect();
        out.write_all(&bytes)
    })?;
    out.write_all(b")\n")?;
    file.commit()
}

/// Lists that are written in parallel.
struct FaceLists {
    corners: LabelList<AtomicFile>,
    owner: LabelList<AtomicFile>,
    neighbour: LabelList<AtomicFile>,
}

/// Corners of all faces, after the list of each face's offset.
fn corner_list(
    folder: &AtomicFolder,
    note: &str,
    boundary: &Boundary,
    progress: &dyn Progress,
) -> io::Result<LabelList<AtomicFile>> {
    ask(progress)?;
    let faces = boundary.inner + boundary.outer;
    let (file, sizes) = (folder.file(FACES)?, (faces, boundary.corners));
    match &boundary.quads {
        Some(quads) => LabelList::corners(file, (FACES, note), sizes, quads.vertices()),
        None => LabelList::corners(file, (FACES, note), sizes, (0..faces).map(|_| 3)),
    }
}
