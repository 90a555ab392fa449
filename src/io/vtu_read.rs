//! Reads tetrahedral meshes from VTK unstructured grids: those that `vtu` writes, and those of other programs.

use super::mesh_file::{ContentFault, MeshFile, MeshNotes};
use super::vtk_xml::{ElementId, VtkXml};
use super::vtu::{VTK_TETRA, VTK_TRIANGLE, field};
use crate::geometry::{Point3, Vec3};
use crate::mesh::check::Expectation;
use crate::mesh::{Cap, Patch, WALL};
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
    let xml = VtkXml::parse(bytes, "UnstructuredGrid")?;
    let grid = xml.child(xml.root(), "UnstructuredGrid").ok_or(ContentFault::Missing { what: "UnstructuredGrid" })?;
    let mut file = MeshFile::default();
    let mut label_array = None;
    for piece in xml.children(grid, "Piece") {
        read_piece(&xml, piece, &mut file, &mut label_array)?;
    }
    let fields = Fields::read(&xml, grid)?;
    file.notes = fields.notes();
    match label_array {
        Some(name) if !file.volume.boundary.is_empty() => {
            file.labelled = true;
            file.volume.patches = fields.patches(&name, &file.volume.boundary_patch);
        }
        // Triangles that no array labels are no boundary.
        _ => {
            file.volume.boundary.clear();
            file.volume.boundary_patch.clear();
            file.volume.boundary_block.clear();
        }
    }
    Ok(file)
}

fn read_piece(
    xml: &VtkXml,
    piece: ElementId,
    file: &mut MeshFile,
    label_array: &mut Option<String>,
) -> Result<(), ContentFault> {
    let first_point = file.volume.mesh.points.len();
    read_points(xml, piece, file)?;
    let cells = Cells::read(xml, piece)?;
    let count = cells.types.len();
    let data = xml.child(piece, "CellData");
    let (name, labels) = match data {
        Some(data) => label_values(xml, data, count, label_array.as_deref())?,
        None => (None, None),
    };
    if label_array.is_none() {
        *label_array = name;
    }
    let blocks = match data {
        Some(data) => int_array(xml, data, "block", count)?,
        None => None,
    };
    let volume = &mut file.volume;
    let at = |values: &Option<Vec<i64>>, cell: usize| values.as_ref().map_or(0, |v| v[cell] as i32);
    let mut start = 0;
    for (cell, (&kind, &end)) in cells.types.iter().zip(&cells.offsets).enumerate() {
        let ids = usize::try_from(end).ok().and_then(|end| cells.connectivity.get(start..end));
        let ids = ids.ok_or(ContentFault::BadOffset { cell })?;
        start += ids.len();
        let id = |v: i64| u32::try_from(v + first_point as i64).unwrap_or(u32::MAX);
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

fn read_points(xml: &VtkXml, piece: ElementId, file: &mut MeshFile) -> Result<(), ContentFault> {
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
    file.volume.mesh.points.extend(triples.iter().map(|&p| Point3::from(p)));
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
struct Fields {
    ints: FxHashMap<String, Vec<i64>>,
    floats: FxHashMap<String, Vec<f64>>,
    strings: FxHashMap<String, Vec<String>>,
}

impl Fields {
    fn read(xml: &VtkXml, grid: ElementId) -> Result<Self, ContentFault> {
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

    fn notes(&self) -> MeshNotes {
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

    /// The patches: those with a name, or else those that occur, under their usual names.
    fn patches(&self, label_array: &str, used: &[i32]) -> Vec<Patch> {
        let caps = self.caps();
        let patch = |id: i32, name: String| Patch { id, name, cap: caps.get(&id).copied() };
        if let Some(names) = self.strings.get(&format!("{label_array}_names")) {
            let named = names.iter().enumerate().skip(1).filter(|(_, name)| !name.is_empty());
            return named.map(|(id, name)| patch(id as i32, name.clone())).collect();
        }
        let mut ids = used.to_vec();
        ids.sort_unstable();
        ids.dedup();
        ids.into_iter().map(|id| patch(id, usual_name(id))).collect()
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
