//! The mesh: points, faces, and the cell on either side of each face. Binary, so that each face has its place before those
//! before it are written: patches are bunched without being held.

use super::boundary::Boundary;
use super::head;
use crate::file::{Asked, AtomicFile, AtomicFolder};
use anastomesh_mesh::faces::{Faces, OuterFace};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::{MeshSource, miscounted};
use std::collections::BTreeMap;
use std::io::{self, Seek, SeekFrom, Write};

pub(super) const FILES: [&str; 4] = [POINTS, FACES, OWNER, NEIGHBOUR];
const POINTS: &str = "constant/polyMesh/points";
const FACES: &str = "constant/polyMesh/faces";
const OWNER: &str = "constant/polyMesh/owner";
const NEIGHBOUR: &str = "constant/polyMesh/neighbour";

/// The largest number of a label of 32 bits, the usual ones.
const LARGEST: u64 = i32::MAX as u64;

/// Writes points, faces, owners and neighbours. Faces inside come first, ascending by the lower cell, which owns them, then
/// by the other one: upper-triangular order; then those of each patch by their cell.
pub(super) fn write(
    folder: &AtomicFolder,
    mesh: &dyn MeshSource,
    boundary: &Boundary,
    progress: &dyn Progress,
) -> io::Result<()> {
    let faces = boundary.inner + boundary.outer;
    if 3 * faces > LARGEST || mesh.counts().points as u64 > LARGEST {
        let text = format!(
            "the mesh has {faces} faces, more than labels of 32 bits can count; mesh its parts, or use a smaller rho"
        );
        return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
    }
    write_points(folder, mesh, progress)?;
    let counts = mesh.counts();
    let note =
        format!("nPoints:{}  nCells:{}  nFaces:{faces}  nInternalFaces:{}", counts.points, counts.tets, boundary.inner);
    let mut lists = Lists {
        corners: corner_list(folder, &note, faces, progress)?,
        owner: label_list(folder, OWNER, &note, faces)?,
        neighbour: label_list(folder, NEIGHBOUR, &note, boundary.inner)?,
    };
    let mut inner = 0;
    let mut places: BTreeMap<i32, u64> = boundary.patches.iter().map(|p| (p.patch.id, p.first)).collect();
    Faces::of(mesh)?.each(|part| {
        anastomesh_mesh::progress::ask(progress)?;
        let corners: Vec<[u32; 3]> = part.inner.iter().map(|face| face.vertices).collect();
        lists.corners.put(inner, corners.as_flattened())?;
        lists.owner.put(inner, &part.inner.iter().map(|face| face.tets[0]).collect::<Vec<_>>())?;
        lists.neighbour.put(inner, &part.inner.iter().map(|face| face.tets[1]).collect::<Vec<_>>())?;
        inner += part.inner.len() as u64;
        let mut outer = part.outer.clone();
        outer.sort_by_key(|face| face.patch);
        for same in outer.chunk_by(|a, b| a.patch == b.patch) {
            let place = places.get_mut(&same[0].patch).ok_or_else(miscounted)?;
            lists.put_outer(*place, same)?;
            *place += same.len() as u64;
        }
        Ok(())
    })?;
    [lists.corners, lists.owner, lists.neighbour].into_iter().try_for_each(List::finish)
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

/// The lists that are written side by side.
struct Lists {
    corners: List,
    owner: List,
    neighbour: List,
}

impl Lists {
    /// Faces of one patch, from the place of the first.
    fn put_outer(&mut self, place: u64, faces: &[OuterFace]) -> io::Result<()> {
        let corners: Vec<[u32; 3]> = faces.iter().map(|face| face.vertices).collect();
        self.corners.put(place, corners.as_flattened())?;
        self.owner.put(place, &faces.iter().map(|face| face.tet).collect::<Vec<_>>())
    }
}

/// A list of labels in a file, so many for each face, which are put where they belong.
struct List {
    file: AtomicFile,
    /// Where the first label is.
    start: u64,
    /// Where the last one ends.
    end: u64,
    /// Labels of a face.
    width: u64,
    /// Where the file is.
    at: u64,
}

impl List {
    fn begin(mut file: AtomicFile, width: u64, faces: u64) -> io::Result<Self> {
        write!(file, "{}\n(", width * faces)?;
        let start = file.stream_position()?;
        Ok(Self { file, start, end: start + 4 * width * faces, width, at: start })
    }

    /// Puts the labels of some faces, which follow each other.
    fn put(&mut self, face: u64, labels: &[u32]) -> io::Result<()> {
        let place = self.start + 4 * self.width * face;
        if place != self.at {
            self.file.seek(SeekFrom::Start(place))?;
        }
        let bytes: Vec<u8> = labels.iter().flat_map(|label| label.to_le_bytes()).collect();
        self.at = place + bytes.len() as u64;
        self.file.write_all(&bytes)
    }

    fn finish(mut self) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(b")\n")?;
        self.file.commit()
    }
}

fn label_list(folder: &AtomicFolder, path: &str, note: &str, faces: u64) -> io::Result<List> {
    let mut file = folder.file(path)?;
    file.write_all(head::binary("labelList", path, note).as_bytes())?;
    List::begin(file, 1, faces)
}

/// The corners of all faces, after the list of where those of each face begin.
fn corner_list(folder: &AtomicFolder, note: &str, faces: u64, progress: &dyn Progress) -> io::Result<List> {
    /// Labels that are written at a time.
    const AT_A_TIME: u32 = 1 << 16;
    let mut file = folder.file(FACES)?;
    let out = &mut Asked { out: &mut file, progress };
    write!(out, "{}{}\n(", head::binary("faceCompactList", FACES, note), faces + 1)?;
    let faces_32 = faces as u32;
    for first in (0..=faces_32).step_by(AT_A_TIME as usize) {
        let some = first..=faces_32.min(first + AT_A_TIME - 1);
        out.write_all(&some.flat_map(|face| (3 * face).to_le_bytes()).collect::<Vec<u8>>())?;
    }
    out.write_all(b")\n")?;
    List::begin(file, 3, faces)
}
