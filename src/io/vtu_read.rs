//! Reads tetrahedral meshes from VTK unstructured grids: those that `vtu` writes, and those of other programs.

use super::mesh_file::{ContentFault, MeshFile, MeshNotes};
use super::vtk_xml::{ElementId, VtkXml};
use super::vtu::{GLOBAL_IDS, VTK_TETRA, VTK_TRIANGLE, field};
use crate::geometry::{Point3, Vec3};
use crate::mesh::check::Expectation;
use crate::mesh::{Cap, Patch, VolumeMesh, WALL};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Cell arrays that are taken for the labels of the boundary, in order of preference.
const LABEL_ARRAYS: [&str; 9] = [
    "patch",
    "PatchId",
    "patch_id",
    "gmsh:physical",
    "boundary",
    "ModelFaceID",
    "CellEntityIds",
    "BoundaryId",
    "medit:ref",
];

/// Reads a mesh from the bytes of a `.vtu` file. Tetrahedra and triangles are taken, points and lines among the cells
/// passed over. A point id that is negative or beyond 32 bits becomes `u32::MAX`, for a check to find.
///
/// # Errors
/// When the file is no such file or incomplete, its arrays do not fit each other, or it holds other cells.
pub fn read_vtu(bytes: &[u8]) -> Result<MeshFile, ContentFault> {
    let mut reader = GridReader::default();
    reader.read(bytes)?;
    Ok(reader.finish())
}

/// A mesh that is read from one file, or from several, one after another.
#[derive(Default)]
pub(super) struct GridReader {
    volume: VolumeMesh,
    /// Name of the array of labels; a later piece uses that of the first.
    label_array: Option<String>,
    /// The field data of the first file that has any.
    fields: Fields,
    /// The number of each point in the mesh of which this is a piece.
    global_ids: Vec<i64>,
}

impl GridReader {
    /// Reads a file.
    pub(super) fn read(&mut self, bytes: &[u8]) -> Result<(), ContentFault> {
        let xml = VtkXml::parse(bytes, "UnstructuredGrid")?;
        let grid =
            xml.child(xml.root(), "UnstructuredGrid").ok_or(ContentFault::Missing { what: "UnstructuredGrid" })?;
        for piece in xml.children(grid, "Piece") {
            self.read_piece(&xml, piece)?;
        }
        if self.fields.is_empty() {
            self.fields = Fields::read(&xml, grid)?;
        }
        Ok(())
    }

    /// Unites the points that are the same by their global ids, if every point has one: afterwards points are in the order
    /// of these.
    pub(super) fn unite(&mut self) -> Result<(), ContentFault> {
        let ids = std::mem::take(&mut self.global_ids);
        let mesh = &mut self.volume.mesh;
        if ids.len() != mesh.points.len() {
            return Ok(());
        }
        let mut distinct = ids.clone();
        distinct.par_sort_unstable();
        distinct.dedup();
        let index_of: Vec<u32> =
            ids.par_iter().map(|id| distinct.binary_search(id).map_or(u32::MAX, |i| i as u32)).collect();
        let mut points = vec![None; distinct.len()];
        for ((&index, &p), &id) in index_of.iter().zip(&mesh.points).zip(&ids) {
            if let Some(place) = points.get_mut(index as usize)
                && place.replace(p).is_some_and(|other| other != p)
            {
                return Err(ContentFault::PointsDiffer { id });
            }
        }
        mesh.points = points.into_iter().flatten().collect();
        let united = |v: &mut u32| *v = index_of.get(*v as usize).copied().unwrap_or(u32::MAX);
        mesh.tets.as_flattened_mut().par_iter_mut().for_each(united);
        self.volume.boundary.as_flattened_mut().par_iter_mut().for_each(united);
        Ok(())
    }

    /// What was read.
    pub(super) fn finish(self) -> MeshFile {
        let mut file = MeshFile { volume: self.volume, labelled: false, notes: self.fields.notes() };
        match self.label_array {
            Some(name) if !file.volume.boundary.is_empty() => {
                file.labelled = true;
                file.volume.patches = self.fields.patches(&name, &file.volume.boundary_patch);
            }
            // Triangles that no array labels are no boundary.
            _ => {
                file.volume.boundary.clear();
                file.volume.boundary_patch.clear();
                file.volume.boundary_block.clear();
            }
        }
        file
    }

    fn read_piece(&mut self, xml: &VtkXml, piece: ElementId) -> Result<(), ContentFault> {
        let volume = &mut self.volume;
        let first_point = volume.mesh.points.len();
        read_points(xml, piece, &mut volume.mesh.points)?;
        self.global_ids.extend(global_ids(xml, piece, volume.mesh.points.len() - first_point)?);
        let cells = Cells::read(xml, piece)?;
        let count = cells.types.len();
        let data = xml.child(piece, "CellData");
        let (name, labels) = match data {
            Some(data) => label_values(xml, data, count, self.label_array.as_deref())?,
            None => (None, None),
        };
        if self.label_array.is_none() {
            self.label_array = name;
        }
        let array = |name| data.map_or(Ok(None), |data| int_array(xml, data, name, count));
        let (blocks, ghosts) = (array("block")?, array("vtkGhostType")?);
        let at = |values: &Option<Vec<i64>>, cell: usize| values.as_ref().map_or(0, |v| v[cell] as i32);
        let mut start = 0;
        for (cell, (&kind, &end)) in cells.types.iter().zip(&cells.offsets).enumerate() {
            let ids = usize::try_from(end).ok().and_then(|end| cells.connectivity.get(start..end));
            let ids = ids.ok_or(ContentFault::BadOffset { cell })?;
            start += ids.len();
            let id = |v: i64| u32::try_from(v + first_point as i64).unwrap_or(u32::MAX);
            if at(&ghosts, cell) & DUPLICATE != 0 {
                continue;
            }
            match (kind as u8, ids) {
                (VTK_TETRA, &[a, b, c, d]) => {
                    volume.mesh.tets.push([id(a), id(b), id(c), id(d)]);
                    volume.tet_block.push(at(&blocks, cell));
                }
                (VTK_TRIANGLE, &[a, b, c]) => {
                    volume.boundary.push([id(a), id(b), id(c)]);
                    volume.boundary_patch.push(at(&labels, cell));
                    volume.boundary_block.push(at(&blocks, cell));
                }
                (VTK_TETRA | VTK_TRIANGLE, _) => return Err(ContentFault::BadOffset { cell }),
                // Empty cells, points and lines bound no volume.
                (0..=4, _) => {}
                _ => return Err(ContentFault::UnsupportedCell { kind, cell }),
            }
        }
        Ok(())
    }
}

/// The bit in VTK's array of ghosts of a cell that another piece has.
const DUPLICATE: i32 = 1;

/// The global id of each point; empty when the file does not know.
fn global_ids(xml: &VtkXml, piece: ElementId, points: usize) -> Result<Vec<i64>, ContentFault> {
    let Some(data) = xml.child(piece, "PointData") else { return Ok(Vec::new()) };
    let name = xml.attribute(data, "GlobalIds").unwrap_or(GLOBAL_IDS);
    Ok(int_array(xml, data, name, points)?.unwrap_or_default())
}

fn read_points(xml: &VtkXml, piece: ElementId, into: &mut Vec<Point3>) -> Result<(), ContentFault> {
    let expected = 3 * xml.count(piece, "NumberOfPoints")?;
    let points = xml.child(piece, "Points").and_then(|points| xml.arrays(points).next());
    let values = match points {
        Some((_, array)) => xml.read(array)?.into_floats(),
        None => Vec::new(),
    };
    if values.len() != expected {
        return Err(ContentFault::Length { array: "Points".into(), expected, found: values.len() });
    }
    let (triples, _) = values.as_chunks::<3>();
    into.extend(triples.iter().map(|&p| Point3::from(p)));
    Ok(())
}

struct Cells {
    connectivity: Vec<i64>,
    offsets: Vec<i64>,
    types: Vec<i64>,
}

impl Cells {
    fn read(xml: &VtkXml, piece: ElementId) -> Result<Self, ContentFault> {
        let count = xml.count(piece, "NumberOfCells")?;
        let Some(cells) = xml.child(piece, "Cells") else {
            return match count {
                0 => Ok(Self { connectivity: Vec::new(), offsets: Vec::new(), types: Vec::new() }),
                _ => Err(ContentFault::Missing { what: "Cells" }),
            };
        };
        let required = |name, length| int_array(xml, cells, name, length)?.ok_or(ContentFault::Missing { what: name });
        let offsets = required("offsets", count)?;
        let types = required("types", count)?;
        let length = offsets.last().map_or(0, |&end| end.max(0) as usize);
        Ok(Self { connectivity: required("connectivity", length)?, offsets, types })
    }
}

/// The integer array of one name among an element's arrays; none when there is none of that name, or it is not of
/// integers.
fn int_array(xml: &VtkXml, parent: ElementId, name: &str, length: usize) -> Result<Option<Vec<i64>>, ContentFault> {
    let Some((_, array)) = xml.arrays(parent).find(|(n, _)| *n == name) else { return Ok(None) };
    let Some(values) = xml.read(array)?.into_ints() else { return Ok(None) };
    if values.len() != length {
        return Err(ContentFault::Length { array: name.into(), expected: length, found: values.len() });
    }
    Ok(Some(values))
}

/// The labels of the cells, and the name of their array; a later piece uses the array of the first.
#[allow(clippy::type_complexity)]
fn label_values(
    xml: &VtkXml,
    data: ElementId,
    count: usize,
    chosen: Option<&str>,
) -> Result<(Option<String>, Option<Vec<i64>>), ContentFault> {
    for name in LABEL_ARRAYS.into_iter().filter(|name| chosen.is_none_or(|chosen| chosen == *name)) {
        if let Some(values) = int_array(xml, data, name, count)? {
            return Ok((Some(name.into()), Some(values)));
        }
    }
    Ok((None, None))
}

/// The field data of a file.
#[derive(Default)]
pub(super) struct Fields {
    ints: FxHashMap<String, Vec<i64>>,
    floats: FxHashMap<String, Vec<f64>>,
    strings: FxHashMap<String, Vec<String>>,
}

impl Fields {
    fn is_empty(&self) -> bool {
        self.ints.is_empty() && self.floats.is_empty() && self.strings.is_empty()
    }

    pub(super) fn read(xml: &VtkXml, grid: ElementId) -> Result<Self, ContentFault> {
        let mut fields = Self::default();
        for data in xml.children(grid, "FieldData") {
            for (name, array) in xml.arrays(data) {
                let is_text = xml.attribute(array, "type") == Some("String");
                let values = xml.read(array)?;
                if is_text {
                    fields.strings.insert(name.into(), values.into_strings().unwrap_or_default());
                } else if matches!(values.values, super::vtk_xml::Values::Int(_)) {
                    fields.ints.insert(name.into(), values.into_ints().unwrap_or_default());
                } else {
                    fields.floats.insert(name.into(), values.into_floats());
                }
            }
        }
        Ok(fields)
    }

    fn text(&self, name: &str) -> String {
        self.strings.get(name).and_then(|texts| texts.first()).cloned().unwrap_or_default()
    }

    fn counts(&self, name: &str) -> Option<Vec<u32>> {
        self.ints.get(name).map(|values| values.iter().map(|&v| u32::try_from(v).unwrap_or(u32::MAX)).collect())
    }

    pub(super) fn notes(&self) -> MeshNotes {
        // An empty list is not written: a mesh of loops alone has no terminals.
        let expectation = self
            .counts(field::LOOPS)
            .map(|loops| Expectation { loops, terminals: self.counts(field::TERMINALS).unwrap_or_default() });
        MeshNotes {
            expectation,
            generator: self.text(field::GENERATOR),
            options: self.text(field::OPTIONS),
            regions: false,
        }
    }

    /// The patches: those with a name or a cap (names end at some id); when none has a name, those that occur, under
    /// their usual names.
    fn patches(&self, label_array: &str, used: &[i32]) -> Vec<Patch> {
        self.named_patches(label_array).unwrap_or_else(|| {
            let mut ids = used.to_vec();
            ids.sort_unstable();
            ids.dedup();
            let caps = self.caps();
            ids.into_iter().map(|id| Patch { id, name: usual_name(id), cap: caps.get(&id).copied() }).collect()
        })
    }

    /// The patches with a name or a cap; none when the file names none.
    pub(super) fn named_patches(&self, label_array: &str) -> Option<Vec<Patch>> {
        let names = self.strings.get(&format!("{label_array}_names"))?;
        let mut caps = self.caps();
        let named = names.iter().enumerate().skip(1).filter(|(_, name)| !name.is_empty());
        let mut patches: Vec<Patch> = named
            .map(|(id, name)| Patch { id: id as i32, name: name.clone(), cap: caps.remove(&(id as i32)) })
            .collect();
        patches.extend(caps.into_iter().map(|(id, cap)| Patch { id, name: usual_name(id), cap: Some(cap) }));
        patches.sort_by_key(|patch| patch.id);
        Some(patches)
    }

    /// Caps by patch; none when the arrays about them do not fit each other.
    fn caps(&self) -> FxHashMap<i32, Cap> {
        let ints = |name| self.ints.get(name).map_or(&[][..], Vec::as_slice);
        let floats = |name| self.floats.get(name).map_or(&[][..], Vec::as_slice);
        let (centers, _) = floats(field::CAP_CENTER).as_chunks::<3>();
        let (normals, _) = floats(field::CAP_NORMAL).as_chunks::<3>();
        let (nodes, radii) = (ints(field::CAP_NODE), floats(field::CAP_RADIUS));
        let mut caps = FxHashMap::default();
        for (i, &id) in ints(field::CAP_PATCH).iter().enumerate() {
            let (Some(&node), Some(&center)) = (nodes.get(i), centers.get(i)) else { break };
            let (Some(&normal), Some(&radius)) = (normals.get(i), radii.get(i)) else { break };
            let node = u32::try_from(node).unwrap_or(u32::MAX);
            caps.insert(id as i32, Cap { node, center: Point3::from(center), normal: Vec3::from(normal), radius });
        }
        caps
    }
}

/// What a patch is called that a file gives a number but no name.
pub(super) fn usual_name(id: i32) -> String {
    match id {
        WALL => "wall".into(),
        2 => "inlet".into(),
        3.. => format!("outlet_{}", id - 3),
        _ => format!("patch_{id}"),
    }
}
