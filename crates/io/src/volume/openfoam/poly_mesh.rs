//! Mesh files: points, faces, and the cells on both sides of each face. Binary faces have fixed positions, so patches
//! are grouped without being held in memory.

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

/// Maximum value of a 32-bit label, the default size.
const LARGEST: u64 = i32::MAX as u64;

/// Writes points, faces, owners and neighbours. Inner faces come first in upper-triangular order: by the lower cell,
/// which owns them, then by the other. Those of each patch follow by their cell.
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
    let mut lists = FaceLists {
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
    [lists.corners, lists.owner, lists.neighbour].into_iter().try_for_each(LabelList::finish)
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
    corners: LabelList,
    owner: LabelList,
    neighbour: LabelList,
}

impl FaceLists {
    /// Writes faces of one patch, starting at a given position.
    fn put_outer(&mut self, place: u64, faces: &[OuterFace]) -> io::Result<()> {
        let corners: Vec<[u32; 3]> = faces.iter().map(|face| face.vertices).collect();
        self.corners.put(place, corners.as_flattened())?;
        self.owner.put(place, &faces.iter().map(|face| face.tet).collect::<Vec<_>>())
    }
}

/// Label list in a file with random access, with a fixed number of labels per face.
struct LabelList {
    file: AtomicFile,
    /// Offset of the first label.
    start: u64,
    /// End of the last label.
    end: u64,
    /// Labels per face.
    width: u64,
    /// Current file offset.
    at: u64,
}

impl LabelList {
    fn begin(mut file: AtomicFile, width: u64, faces: u64) -> io::Result<Self> {
        write!(file, "{}\n(", width * faces)?;
        let start = file.stream_position()?;
        Ok(Self { file, start, end: start + 4 * width * faces, width, at: start })
    }

    /// Writes the labels of consecutive faces.
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

fn label_list(folder: &AtomicFolder, path: &str, note: &str, faces: u64) -> io::Result<LabelList> {
    let mut file = folder.file(path)?;
    file.write_all(head::binary("labelList", path, note).as_bytes())?;
    LabelList::begin(file, 1, faces)
}

/// Corners of all faces, after the list of each face's offset.
fn corner_list(folder: &AtomicFolder, note: &str, faces: u64, progress: &dyn Progress) -> io::Result<LabelList> {
    /// Number of labels per write.
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
    LabelList::begin(file, 3, faces)
}
