//! Writer of grids with prisms and pyramids.

use super::arrays::{self, ArrayLocation, ArrayWriter, INT32};
use super::file::File;
use super::names::{LAYER, REGION, VTK_PRISM, VTK_PYRAMID, VTK_QUAD, VTK_TETRA, VTK_TRIANGLE};
use crate::volume::content::MeshNotes;
use crate::volume::options::GridOptions;
use anastomesh_mesh::Patch;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::stacks::{MixedCell, MixedFace, MixedMesh};
use std::io::{self, Seek, Write};

/// Type of a cell with this number of vertices.
fn kind_of_cell(vertices: &[u32]) -> u8 {
    match vertices.len() {
        6 => VTK_PRISM,
        5 => VTK_PYRAMID,
        _ => VTK_TETRA,
    }
}

/// Type of a face with this number of vertices.
fn kind_of_face(vertices: &[u32]) -> u8 {
    if vertices.len() == 4 { VTK_QUAD } else { VTK_TRIANGLE }
}

/// Grid of mixed cells to be written.
pub(in crate::volume) struct MixedGrid<'a> {
    pub points: &'a [Point3],
    pub mixed: &'a MixedMesh,
    /// Patches and notes of the mesh; `None` in pieces after the first.
    pub notes: Option<(&'a [Patch], &'a MeshNotes)>,
    /// True if the blocks are regions.
    pub has_regions: bool,
    /// Number of each point in the mesh of which this is a piece.
    pub global_ids: Option<&'a [u32]>,
    pub options: GridOptions,
}

/// Writes a grid with mixed cells, and their patches, blocks and layers.
///
/// # Errors
/// The output `out` fails; `InvalidInput` if a number exceeds 32 bits.
pub(in crate::volume) fn write_mixed(out: &mut (impl Write + Seek), grid: &MixedGrid) -> io::Result<()> {
    let MixedGrid { points, mixed, notes, has_regions, global_ids, options } = *grid;
    let faces: &[_] = if options.tets_alone { &[] } else { &mixed.faces };
    let cells = mixed.cells.iter().map(|cell| (cell.vertices(), kind_of_cell(cell.vertices())));
    let all = || cells.clone().chain(faces.iter().map(|face| (face.vertices(), kind_of_face(face.vertices()))));
    let too_many =
        || io::Error::new(io::ErrorKind::InvalidInput, "a grid with prisms is limited to 2³¹ vertex numbers");
    let mut end = 0_i32;
    let mut ends = Vec::with_capacity(mixed.cells.len() + faces.len());
    for (vertices, _) in all() {
        end = end.checked_add(vertices.len() as i32).ok_or_else(too_many)?;
        ends.push(end);
    }
    let connectivity: Vec<i32> = all().flat_map(|(vertices, _)| vertices).map(|&v| v as i32).collect();
    let counts = format!("NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", points.len(), ends.len());
    let types: Vec<u8> = all().map(|(_, kind)| kind).collect();
    let labels = |of_cell: fn(&MixedCell) -> i32, of_face: fn(&MixedFace) -> i32| {
        mixed.cells.iter().map(of_cell).chain(faces.iter().map(of_face)).collect::<Vec<i32>>()
    };
    let mut arrays = notes.map_or_else(Vec::new, |(patches, notes)| arrays::of_fields(patches, notes));
    arrays.extend(global_ids.map(arrays::of_ids));
    arrays.push(arrays::points_array(points.len(), options.float32, |each| each(points)));
    arrays.push(ints(ArrayLocation::Cells, "connectivity", connectivity));
    arrays.push(ints(ArrayLocation::Cells, "offsets", ends));
    arrays.push(arrays::types_array(types));
    arrays.push(ints(ArrayLocation::CellData, "patch", labels(|_| 0, |face| face.patch)));
    arrays.push(ints(ArrayLocation::CellData, "block", labels(|cell| cell.block, |face| face.block)));
    if has_regions {
        arrays.push(ints(ArrayLocation::CellData, REGION, labels(|cell| cell.block, |face| face.block)));
    }
    arrays.push(ints(ArrayLocation::CellData, LAYER, labels(|cell| cell.layer, |_| 0)));
    File { kind: "UnstructuredGrid", counts, arrays, raw: options.raw }.write(out)
}

fn ints<'a>(place: ArrayLocation, name: &'static str, values: Vec<i32>) -> ArrayWriter<'a> {
    ArrayWriter::new(place, name, INT32, values.len(), move |out| out.push_ints(&values))
}
