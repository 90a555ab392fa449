//! Folders of processors: `processor0`, `processor1`, …, each with the mesh of a part and the initial fields, as
//! `decomposePar` writes them.

use super::boundary::Boundary;
use super::lists::LabelList;
use super::spools::{FaceList, ProcessorFace, Spools};
use super::{case, head, poly_mesh};
use crate::file::AtomicFolder;
use crate::volume::parts::Partition;
use anastomesh_mesh::bits::{Bits, Ranks};
use anastomesh_mesh::progress::{Progress, ask};
use anastomesh_mesh::source::MeshSource;
use std::collections::BTreeMap;
use std::io::{self, Write};

const BOUNDARY: &str = "constant/polyMesh/boundary";
const CELLS: &str = "constant/polyMesh/cellProcAddressing";
const POINTS: &str = "constant/polyMesh/pointProcAddressing";
const FACES: &str = "constant/polyMesh/faceProcAddressing";
const PATCHES: &str = "constant/polyMesh/boundaryProcAddressing";

/// True for a file of a processor's folder.
pub(super) fn is_ours(name: &str) -> bool {
    let inside = name.strip_prefix("processor").and_then(|rest| rest.split_once('/'));
    inside.is_some_and(|(number, file)| {
        let is_number = !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit());
        let own = [BOUNDARY, CELLS, POINTS, FACES, PATCHES, "0/U", "0/p"];
        is_number && (own.contains(&file) || poly_mesh::FILES.contains(&file))
    })
}

/// Writer of the folders.
pub(super) struct Processors<'a> {
    pub(super) mesh: &'a dyn MeshSource,
    pub(super) boundary: &'a Boundary,
    pub(super) partition: &'a Partition,
    pub(super) spools: Spools<'a>,
}

/// Position of the next face of each list: its number, and the number of vertices of all faces before it.
type Places = BTreeMap<FaceList, [u64; 2]>;

impl Processors<'_> {
    /// Writes the folders, one after the other. Memory holds a bit per point of the mesh and 4 bytes per point of a part.
    /// With layers it also holds a byte per face of the part.
    ///
    /// # Errors
    /// The operating system or the mesh source fails.
    pub(super) fn write(&self, folder: &AtomicFolder, fields: [&str; 2], progress: &dyn Progress) -> io::Result<()> {
        let mut used = Bits::new(self.mesh.counts().points);
        for part in 0..self.partition.parts() as u32 {
            let [velocity, pressure] = fields;
            folder.put(&format!("processor{part}/0/U"), velocity.as_bytes())?;
            folder.put(&format!("processor{part}/0/p"), pressure.as_bytes())?;
            used.clear();
            self.write_mesh(folder, part, &mut used, progress)?;
        }
        Ok(())
    }

    fn write_mesh(&self, folder: &AtomicFolder, part: u32, used: &mut Bits, progress: &dyn Progress) -> io::Result<()> {
        let places = self.places(part);
        let sizes = self.spools.sizes(part);
        let all = sizes.values().fold([0; 2], |sum: [u64; 2], size| [sum[0] + size[0], sum[1] + size[1]]);
        let inner = sizes.get(&FaceList::Inner).map_or(0, |size| size[0]);
        let quads = self.read_points(part, all, &places, used)?;
        let ids = used.ids();
        let cells = self.partition.cells_of(part);
        let note = format!("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{inner}", ids.len(), cells.len(), all[0]);
        let file = |path: &str| folder.quick_file(&format!("processor{part}/{path}"));
        self.write_points(&mut file(poly_mesh::POINTS)?, &ids, progress)?;
        let vertices = |i: u64| quads.get(i as usize).map_or(3, |&is_quad| 3 + u32::from(is_quad));
        let (path, vertices) = (poly_mesh::FACES, (0..all[0]).map(vertices));
        let mut lists = [
            LabelList::corners(file(path)?, (path, &note), (all[0], all[1]), vertices)?,
            LabelList::alone(file(poly_mesh::OWNER)?, poly_mesh::OWNER, &note, all[0])?,
            LabelList::alone(file(poly_mesh::NEIGHBOUR)?, poly_mesh::NEIGHBOUR, &note, inner)?,
            LabelList::alone(file(FACES)?, FACES, "", all[0])?,
        ];
        let ranks = used.ranks();
        let mut next = places.clone();
        self.spools.each(part, |mut faces| {
            ask(progress)?;
            faces.sort_by_key(|face| face.list);
            for same in faces.chunk_by(|a, b| a.list == b.list) {
                put(&mut lists, same, &ranks, next.entry(same[0].list).or_default())?;
            }
            Ok(())
        })?;
        lists.into_iter().try_for_each(|list| list.finish().map(drop))?;
        let put_list = |path: &str, labels: &[u32]| {
            let mut list = LabelList::alone(file(path)?, path, "", labels.len() as u64)?;
            list.put(0, labels)?;
            list.finish().map(drop)
        };
        put_list(CELLS, &cells)?;
        put_list(POINTS, &ids)?;
        let outer = sizes.keys().filter(|list| matches!(list, FaceList::Processor(_)));
        let none = outer.map(|_| u32::MAX);
        put_list(PATCHES, &(0..self.boundary.patches.len() as u32).chain(none).collect::<Vec<_>>())?;
        folder.put(&format!("processor{part}/{BOUNDARY}"), self.patches(part, &places).as_bytes())
    }

    /// First position of each list; patches without faces have one, too.
    fn places(&self, part: u32) -> Places {
        let sizes = self.spools.sizes(part);
        let patches = (0..self.boundary.patches.len() as u32).map(FaceList::Patch);
        let mut places: Places = patches.chain([FaceList::Inner]).map(|list| (list, [0; 2])).collect();
        places.extend(sizes.keys().map(|&list| (list, [0; 2])));
        let mut sum = [0; 2];
        for (list, place) in &mut places {
            *place = sum;
            let [faces, corners] = sizes.get(list).copied().unwrap_or_default();
            sum = [sum[0] + faces, sum[1] + corners];
        }
        places
    }

    /// Collects the points of a part, and true for each face with four vertices if there are any.
    fn read_points(
        &self,
        part: u32,
        [faces, corners]: [u64; 2],
        places: &Places,
        used: &mut Bits,
    ) -> io::Result<Vec<bool>> {
        let has_quads = corners != 3 * faces;
        let mut quads = if has_quads { vec![false; faces as usize] } else { Vec::new() };
        let mut next = places.clone();
        self.spools.each(part, |faces| {
            for face in &faces {
                for &v in face.vertices() {
                    used.insert(v);
                }
                if has_quads {
                    let [number, _] = next.entry(face.list).or_default();
                    quads[*number as usize] = face.vertices().len() == 4;
                    *number += 1;
                }
            }
            Ok(())
        })?;
        Ok(quads)
    }

    fn write_points(&self, out: &mut impl Write, ids: &[u32], progress: &dyn Progress) -> io::Result<()> {
        /// Number of points that are read at a time.
        const AT_A_TIME: usize = 1 << 20;
        write!(out, "{}{}\n(", head::binary("vectorField", poly_mesh::POINTS, ""), ids.len())?;
        for some in ids.chunks(AT_A_TIME) {
            ask(progress)?;
            let points = self.mesh.points_of(some)?;
            let bytes: Vec<u8> = points.iter().flat_map(|p| [p.x, p.y, p.z]).flat_map(f64::to_le_bytes).collect();
            out.write_all(&bytes)?;
        }
        out.write_all(b")\n")?;
        out.flush()
    }

    /// Patch list: all patches of the mesh, then the faces shared with other processors.
    fn patches(&self, part: u32, places: &Places) -> String {
        let sizes = self.spools.sizes(part);
        let entries = places.iter().filter_map(|(&list, &[first, _])| {
            let faces = sizes.get(&list).map_or(0, |size| size[0]);
            match list {
                FaceList::Inner => None,
                FaceList::Patch(patch) => Some(case::patch(self.boundary.patches.get(patch as usize)?, faces, first)),
                FaceList::Processor(other) => Some(case::processor_patch([part, other], faces, first)),
            }
        });
        case::patch_list(&entries.collect::<Vec<_>>())
    }
}

/// Writes consecutive faces of a list: corners, owners, neighbours and addresses.
fn put<F: io::Write + io::Seek>(
    [corners, owner, neighbour, address]: &mut [LabelList<F>; 4],
    faces: &[ProcessorFace],
    ranks: &Ranks,
    [number, corner]: &mut [u64; 2],
) -> io::Result<()> {
    let vertices: Vec<u32> = faces.iter().flat_map(ProcessorFace::vertices).map(|&v| ranks.rank(v)).collect();
    corners.put(*corner, &vertices)?;
    owner.put(*number, &faces.iter().map(|face| face.cells[0]).collect::<Vec<_>>())?;
    if faces[0].list == FaceList::Inner {
        neighbour.put(*number, &faces.iter().map(|face| face.cells[1]).collect::<Vec<_>>())?;
    }
    address.put(*number, &faces.iter().map(ProcessorFace::address).collect::<Vec<_>>())?;
    (*number, *corner) = (*number + faces.len() as u64, *corner + vertices.len() as u64);
    Ok(())
}
