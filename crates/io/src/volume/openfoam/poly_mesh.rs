//! Mesh files: points, faces, and the cells on both sides of each face. Binary faces have fixed positions, so patches
//! are grouped without being held in memory.

use super::boundary::Boundary;
use super::figures::{Figures, Sample};
use super::head;
use super::joined::{CellFaces, Polygon};
use crate::file::{Asked, AtomicFile, AtomicFolder};
use anastomesh_mesh::faces::Faces;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::{MeshSource, miscounted};
use anastomesh_mesh::stacks::Cells;
use std::collections::BTreeMap;
use std::io::{self, Seek, SeekFrom, Write};

pub(super) const FILES: [&str; 4] = [POINTS, FACES, OWNER, NEIGHBOUR];
const POINTS: &str = "constant/polyMesh/points";
const FACES: &str = "constant/polyMesh/faces";
const OWNER: &str = "constant/polyMesh/owner";
const NEIGHBOUR: &str = "constant/polyMesh/neighbour";

/// Maximum value of a 32-bit label, the default size.
const LARGEST: u64 = i32::MAX as u64;

/// Writes points, faces, owners and neighbours, and measures the mesh. Inner faces come first in upper-triangular order:
/// by the lower cell, which owns them, then by the other. Those of each patch follow by their cell.
pub(super) fn write(
    folder: &AtomicFolder,
    mesh: &dyn MeshSource,
    faces: &Faces,
    cells: Option<&Cells>,
    boundary: &Boundary,
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
        owner: label_list(folder, OWNER, &note, count)?,
        neighbour: label_list(folder, NEIGHBOUR, &note, boundary.inner)?,
    };
    let (mut inner, mut corner) = (0, 0);
    let places = boundary.patches.iter().map(|p| (p.patch.id, [p.first, p.corners]));
    let mut places: BTreeMap<i32, [u64; 2]> = places.collect();
    let mut figures = Figures::default();
    let sample = Sample::of(mesh);
    faces.each_with(
        |part, first, faces| {
            let measured = sample.holds(part).then(|| Figures::of_part(mesh, part, first, faces, cells)).transpose()?;
            Ok((CellFaces::of(faces, cells), measured))
        },
        |_, (part, measured)| {
            anastomesh_mesh::progress::ask(progress)?;
            figures.extend(measured.unwrap_or_default());
            let corners = flattened(part.inner.iter().map(|face| &face.face));
            lists.corners.put(corner, &corners)?;
            lists.owner.put(inner, &part.inner.iter().map(|face| face.cells[0]).collect::<Vec<_>>())?;
            lists.neighbour.put(inner, &part.inner.iter().map(|face| face.cells[1]).collect::<Vec<_>>())?;
            inner += part.inner.len() as u64;
            corner += corners.len() as u64;
            for same in part.outer.chunk_by(|a, b| a.patch == b.patch) {
                let [first, corner] = places.get_mut(&same[0].patch).ok_or_else(miscounted)?;
                let corners = flattened(same.iter().map(|face| &face.face));
                lists.corners.put(*corner, &corners)?;
                lists.owner.put(*first, &same.iter().map(|face| face.cell).collect::<Vec<_>>())?;
                *first += same.len() as u64;
                *corner += corners.len() as u64;
            }
            Ok(())
        },
    )?;
    [lists.corners, lists.owner, lists.neighbour].into_iter().try_for_each(LabelList::finish)?;
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
    corners: LabelList,
    owner: LabelList,
    neighbour: LabelList,
}

/// Label list in a file with random access.
struct LabelList {
    file: AtomicFile,
    /// Offset of the first label.
    start: u64,
    /// End of the last label.
    end: u64,
    /// Current file offset.
    at: u64,
    /// Bytes of the last labels, kept to use their memory again.
    bytes: Vec<u8>,
}

impl LabelList {
    fn begin(mut file: AtomicFile, labels: u64) -> io::Result<Self> {
        write!(file, "{labels}\n(")?;
        let start = file.stream_position()?;
        Ok(Self { file, start, end: start + 4 * labels, at: start, bytes: Vec::new() })
    }

    /// Writes consecutive labels from this position in the list.
    fn put(&mut self, first: u64, labels: &[u32]) -> io::Result<()> {
        let place = self.start + 4 * first;
        if place != self.at {
            self.file.seek(SeekFrom::Start(place))?;
        }
        self.bytes.clear();
        self.bytes.extend(labels.iter().flat_map(|label| label.to_le_bytes()));
        self.at = place + self.bytes.len() as u64;
        self.file.write_all(&self.bytes)
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
    LabelList::begin(file, faces)
}

/// Corners of all faces, after the list of each face's offset.
fn corner_list(
    folder: &AtomicFolder,
    note: &str,
    boundary: &Boundary,
    progress: &dyn Progress,
) -> io::Result<LabelList> {
    let faces = boundary.inner + boundary.outer;
    let mut file = folder.file(FACES)?;
    let out = &mut Asked { out: &mut file, progress };
    write!(out, "{}{}\n(", head::binary("faceCompactList", FACES, note), faces + 1)?;
    if let Some(quads) = &boundary.quads {
        let mut offset = 0;
        let offsets = quads.vertices().map(|vertices| {
            offset += vertices;
            offset
        });
        write_labels(out, std::iter::once(0).chain(offsets))?;
    } else {
        write_labels(out, (0..=faces as u32).map(|face| 3 * face))?;
    }
    out.write_all(b")\n")?;
    LabelList::begin(file, boundary.corners)
}

fn write_labels(out: &mut impl Write, labels: impl Iterator<Item = u32>) -> io::Result<()> {
    /// Number of bytes per write.
    const AT_A_TIME: usize = 1 << 18;
    let mut bytes = Vec::with_capacity(AT_A_TIME);
    for label in labels {
        bytes.extend_from_slice(&label.to_le_bytes());
        if bytes.len() >= AT_A_TIME {
            out.write_all(&bytes)?;
            bytes.clear();
        }
    }
    out.write_all(&bytes)
}
