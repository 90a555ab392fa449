//! Reader of tetrahedral meshes in VTK unstructured grids, from this and other programs.

use super::error::VtuFault;
use super::fields::Fields;
use super::names::{
    GLOBAL_IDS, REGION, VTK_PRISM, VTK_PYRAMID, VTK_QUAD, VTK_QUADRATIC_EDGE, VTK_QUADRATIC_TETRA,
    VTK_QUADRATIC_TRIANGLE, VTK_TETRA, VTK_TRIANGLE,
};
use crate::volume::content::{MeshFile, separate_midpoints};
use crate::vtk_xml::{ElementId, VtkXml};
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::stacks::Polyhedra;
use rayon::prelude::*;

/// Cell arrays that are used as boundary labels, in order of preference.
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

/// Reads a mesh from the bytes of a `.vtu` file. Prisms, pyramids and quadrilaterals are split into tetrahedra and
/// triangles; vertex and line cells are skipped. Second-order tetrahedra and triangles are read if all are.
/// Point ids that are negative or exceed 32 bits become `u32::MAX`, which a check detects.
///
/// # Errors
/// The file is invalid or incomplete, its arrays are inconsistent, or it has other cells.
pub(in crate::volume) fn read(bytes: &[u8]) -> Result<MeshFile, VtuFault> {
    let mut reader = GridReader::default();
    reader.read(bytes)?;
    reader.finish()
}

/// Mesh read from one or several consecutive files.
#[derive(Default)]
pub(in crate::volume) struct GridReader {
    volume: VolumeMesh,
    /// Cells to split.
    polyhedra: Polyhedra,
    /// Nodes of the second-order cells, which are also among the cells of the mesh with their corners.
    tets_10: Vec<[u32; 10]>,
    faces_6: Vec<[u32; 6]>,
    /// Name of the label array; later pieces use that of the first.
    label_array: Option<&'static str>,
    /// Field data of the first file that has any.
    fields: Fields,
    /// Number of each point in the mesh of which this is a piece.
    global_ids: Vec<i64>,
}

impl GridReader {
    /// Reads a file.
    pub(in crate::volume) fn read(&mut self, bytes: &[u8]) -> Result<(), VtuFault> {
        let xml = VtkXml::parse(bytes, "UnstructuredGrid")?;
        let grid = xml.child(VtkXml::ROOT, "UnstructuredGrid").ok_or(VtuFault::Missing { what: "UnstructuredGrid" })?;
        for piece in xml.children(grid, "Piece") {
            self.read_piece(&xml, piece)?;
        }
        if self.fields.is_empty() {
            self.fields = Fields::read(&xml, grid)?;
        }
        Ok(())
    }

    /// Points, and their global ids, which are complete or empty.
    pub(in crate::volume) fn points(&self) -> (&[Point3], &[i64]) {
        let points = &self.volume.mesh.points;
        (points, if self.global_ids.len() == points.len() { &self.global_ids } else { &[] })
    }

    /// Replaces the points. `index_of` holds the new number of each present one. Cells are split afterwards, because
    /// neighbours in different pieces agree on diagonals only by the common numbers.
    pub(in crate::volume) fn renumber(&mut self, points: Vec<Point3>, index_of: &[u32]) {
        let Self { volume, polyhedra, tets_10, faces_6, .. } = self;
        volume.mesh.points = points;
        let united = |v: &mut u32| *v = index_of.get(*v as usize).copied().unwrap_or(u32::MAX);
        volume.mesh.tets.as_flattened_mut().par_iter_mut().for_each(united);
        volume.boundary.as_flattened_mut().par_iter_mut().for_each(united);
        tets_10.as_flattened_mut().par_iter_mut().for_each(united);
        faces_6.as_flattened_mut().par_iter_mut().for_each(united);
        polyhedra.prisms.iter_mut().flat_map(|(_, prism)| prism).for_each(united);
        polyhedra.pyramids.iter_mut().flat_map(|(_, pyramid)| pyramid).for_each(united);
        polyhedra.quads.iter_mut().flat_map(|(_, quad)| quad).for_each(united);
    }

    /// Returns the mesh.
    ///
    /// # Errors
    /// Second-order cells are invalid.
    pub(in crate::volume) fn finish(mut self) -> Result<MeshFile, VtuFault> {
        self.polyhedra.split(&mut self.volume.mesh.tets, &mut self.volume.boundary);
        let second_order = separate_midpoints(&mut self.volume, self.tets_10, self.faces_6)?;
        let mut file = MeshFile { volume: self.volume, labelled: false, second_order, notes: self.fields.notes() };
        match self.label_array {
            Some(name) if !file.volume.boundary.is_empty() => {
                file.labelled = true;
                file.volume.patches = self.fields.patches(name, &file.volume.boundary_patch);
            }
            // Triangles without labels are not a boundary.
            _ => {
                file.volume.boundary.clear();
                file.volume.boundary_patch.clear();
                file.volume.boundary_block.clear();
            }
        }
        Ok(file)
    }

    fn read_piece(&mut self, xml: &VtkXml, piece: ElementId) -> Result<(), VtuFault> {
        let points = &mut self.volume.mesh.points;
        let first_point = points.len();
        read_points(xml, piece, points)?;
        self.global_ids.extend(global_ids(xml, piece, points.len() - first_point)?);
        let cells = CellArrays::read(xml, piece)?;
        let count = cells.types.len();
        let data = xml.child(piece, "CellData");
        let labels = match data {
            Some(data) => self.label_values(xml, data, count)?,
            None => None,
        };
        let array = |name| data.map_or(Ok(None), |data| int_array(xml, data, name, count));
        let blocks = array(REGION)?.map_or_else(|| array("block"), |regions| Ok(Some(regions)))?;
        let ghosts = array("vtkGhostType")?;
        self.add_cells(&cells, first_point as i64, &CellData { labels, blocks, ghosts })
    }

    /// Adds the cells of a piece whose points start at `first_point`.
    fn add_cells(&mut self, cells: &CellArrays, first_point: i64, data: &CellData) -> Result<(), VtuFault> {
        let volume = &mut self.volume;
        let at = |values: &Option<Vec<i64>>, cell: usize| values.as_ref().map_or(0, |v| v[cell] as i32);
        let id = |v: i64| u32::try_from(v + first_point).unwrap_or(u32::MAX);
        let mut start = 0;
        for (cell, (&kind, &end)) in cells.types.iter().zip(&cells.offsets).enumerate() {
            let ids = usize::try_from(end).ok().and_then(|end| cells.connectivity.get(start..end));
            let ids = ids.ok_or(VtuFault::BadOffset { cell })?;
            start += ids.len();
            if at(&data.ghosts, cell) & DUPLICATE != 0 {
                continue;
            }
            let mut tets = |tets: &[[u32; 4]]| {
                volume.mesh.tets.extend(tets);
                volume.tet_block.resize(volume.mesh.tets.len(), at(&data.blocks, cell));
                volume.mesh.tets.len() - tets.len()
            };
            let mut faces = |faces: &[[u32; 3]]| {
                volume.boundary.extend(faces);
                volume.boundary_patch.resize(volume.boundary.len(), at(&data.labels, cell));
                volume.boundary_block.resize(volume.boundary.len(), at(&data.blocks, cell));
                volume.boundary.len() - faces.len()
            };
            // Cells to split are filled in at the end.
            match (kind as u8, ids) {
                (VTK_TETRA, &[a, b, c, d]) => drop(tets(&[[id(a), id(b), id(c), id(d)]])),
                (VTK_TRIANGLE, &[a, b, c]) => drop(faces(&[[id(a), id(b), id(c)]])),
                (VTK_QUADRATIC_TETRA, &[a, b, c, d, ..]) if ids.len() == 10 => {
                    tets(&[[id(a), id(b), id(c), id(d)]]);
                    self.tets_10.push(std::array::from_fn(|i| id(ids[i])));
                }
                (VTK_QUADRATIC_TRIANGLE, &[a, b, c, ..]) if ids.len() == 6 => {
                    faces(&[[id(a), id(b), id(c)]]);
                    self.faces_6.push(std::array::from_fn(|i| id(ids[i])));
                }
                (VTK_PRISM, &[a, b, c, d, e, f]) => {
                    self.polyhedra.prisms.push((tets(&[[0; 4]; 3]), [a, b, c, d, e, f].map(id)));
                }
                (VTK_PYRAMID, &[a, b, c, d, e]) => {
                    self.polyhedra.pyramids.push((tets(&[[0; 4]; 2]), [a, b, c, d, e].map(id)));
                }
                (VTK_QUAD, &[a, b, c, d]) => {
                    self.polyhedra.quads.push((faces(&[[0; 3]; 2]), [a, b, c, d].map(id)));
                }
                (
                    VTK_TETRA
                    | VTK_TRIANGLE
                    | VTK_PRISM
                    | VTK_PYRAMID
                    | VTK_QUAD
                    | VTK_QUADRATIC_TETRA
                    | VTK_QUADRATIC_TRIANGLE,
                    _,
                ) => {
                    return Err(VtuFault::BadOffset { cell });
                }
                // Empty, vertex and line cells bound no volume.
                (0..=4 | VTK_QUADRATIC_EDGE, _) => {}
                _ => return Err(VtuFault::UnsupportedCell { kind, cell }),
            }
        }
        Ok(())
    }

    /// Labels of the cells of a piece.
    fn label_values(&mut self, xml: &VtkXml, data: ElementId, count: usize) -> Result<Option<Vec<i64>>, VtuFault> {
        for name in LABEL_ARRAYS {
            if self.label_array.is_none_or(|chosen| chosen == name)
                && let Some(values) = int_array(xml, data, name, count)?
            {
                self.label_array = Some(name);
                return Ok(Some(values));
            }
        }
        Ok(None)
    }
}

/// Bit in VTK's ghost array for cells that belong to another piece.
const DUPLICATE: i32 = 1;

/// Global id of each point; empty if unknown.
fn global_ids(xml: &VtkXml, piece: ElementId, points: usize) -> Result<Vec<i64>, VtuFault> {
    let Some(data) = xml.child(piece, "PointData") else { return Ok(Vec::new()) };
    let name = xml.attribute(data, "GlobalIds").unwrap_or(GLOBAL_IDS);
    Ok(int_array(xml, data, name, points)?.unwrap_or_default())
}

fn read_points(xml: &VtkXml, piece: ElementId, into: &mut Vec<Point3>) -> Result<(), VtuFault> {
    let expected = xml.count(piece, "NumberOfPoints")?.saturating_mul(3);
    let points = xml.child(piece, "Points").and_then(|points| xml.arrays(points).next());
    let values = match points {
        Some((_, array)) => xml.read(array)?.into_floats(),
        None => Vec::new(),
    };
    if values.len() != expected {
        return Err(VtuFault::Length { array: "Points".into(), expected, found: values.len() });
    }
    let (triples, _) = values.as_chunks::<3>();
    into.extend(triples.iter().map(|&p| Point3::from(p)));
    Ok(())
}

/// Cell arrays of a piece; `None` if missing in the file.
struct CellData {
    labels: Option<Vec<i64>>,
    blocks: Option<Vec<i64>>,
    ghosts: Option<Vec<i64>>,
}

struct CellArrays {
    connectivity: Vec<i64>,
    offsets: Vec<i64>,
    types: Vec<i64>,
}

impl CellArrays {
    fn read(xml: &VtkXml, piece: ElementId) -> Result<Self, VtuFault> {
        let count = xml.count(piece, "NumberOfCells")?;
        let Some(cells) = xml.child(piece, "Cells") else {
            return match count {
                0 => Ok(Self { connectivity: Vec::new(), offsets: Vec::new(), types: Vec::new() }),
                _ => Err(VtuFault::Missing { what: "Cells" }),
            };
        };
        let required = |name, length| int_array(xml, cells, name, length)?.ok_or(VtuFault::Missing { what: name });
        let offsets = required("offsets", count)?;
        let types = required("types", count)?;
        let length = offsets.last().map_or(0, |&end| end.max(0) as usize);
        Ok(Self { connectivity: required("connectivity", length)?, offsets, types })
    }
}

/// Integer array of an element with this name; `None` if it is missing or not an integer array.
fn int_array(xml: &VtkXml, parent: ElementId, name: &str, length: usize) -> Result<Option<Vec<i64>>, VtuFault> {
    let Some((_, array)) = xml.arrays(parent).find(|(n, _)| *n == name) else { return Ok(None) };
    let Some(values) = xml.read(array)?.into_ints() else { return Ok(None) };
    if values.len() != length {
        return Err(VtuFault::Length { array: name.into(), expected: length, found: values.len() });
    }
    Ok(Some(values))
}
