//! VTK unstructured grids (`.vtu`): a labelled tetrahedral mesh, in appended raw data compressed with zlib.
//!
//! Tetrahedra come first, then the boundary triangles; the `Int32` cell arrays `patch` and `block` say where each
//! belongs (a tetrahedron's patch is 0). Field data name the patches (`patch_names`, indexed by the id) and hold what a
//! later check needs to know: the caps, the loops of each component, the terminals.

use super::mesh_file::MeshNotes;
use crate::mesh::VolumeMesh;
use flate2::{Compression, write::ZlibEncoder};
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::{self, Seek, SeekFrom, Write};
use std::ops::Range;

pub use super::vtu_read::read_vtu;

/// Values in a compressed block: a multiple of 12, so that points, triangles and tetrahedra do not straddle blocks.
const BLOCK: usize = 98_304;

/// Blocks compressed at a time: bounds the memory whatever the size of the mesh.
const WAVE: usize = 64;

/// VTK's cell types.
pub(super) const VTK_TRIANGLE: u8 = 5;
pub(super) const VTK_TETRA: u8 = 10;

/// Names of the field arrays, shared by writer and reader.
pub(super) mod field {
    pub const PATCH_NAMES: &str = "patch_names";
    pub const CAP_PATCH: &str = "cap_patch";
    pub const CAP_NODE: &str = "cap_node";
    pub const CAP_CENTER: &str = "cap_center";
    pub const CAP_NORMAL: &str = "cap_normal";
    pub const CAP_RADIUS: &str = "cap_radius";
    pub const LOOPS: &str = "expected_loops";
    pub const TERMINALS: &str = "expected_terminals";
    pub const GENERATOR: &str = "generator";
    pub const OPTIONS: &str = "options";
}

/// Where an array stands in the file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Field,
    Points,
    Cells,
    CellData,
}

/// Appends the little-endian bytes of a range of an array's values.
type Fill<'a> = Box<dyn Fn(Range<usize>, &mut Vec<u8>) + Sync + 'a>;

/// One array of the file: what it is called and where its values come from.
struct Array<'a> {
    place: Place,
    name: &'static str,
    kind: &'static str,
    width: usize,
    components: usize,
    values: usize,
    fill: Fill<'a>,
    /// Whether compression saves enough for the time it takes: coordinates and vertex numbers shrink little.
    shrinks: bool,
}

/// Writes a mesh as VTU. The bytes depend on the mesh and the notes alone, not on the number of threads.
///
/// # Errors
/// What the writer `out` reports.
pub fn write_vtu(out: &mut (impl Write + Seek), mesh: &VolumeMesh, notes: &MeshNotes) -> io::Result<()> {
    let names = patch_names(mesh);
    let arrays = arrays_of(mesh, notes, &names);
    // The offsets are known only after compression: room for the longest possible header is left in front.
    let reserved = header(mesh, &arrays, &vec![u64::MAX; arrays.len()]).len();
    let start = out.stream_position()?;
    write_spaces(out, reserved)?;
    out.write_all(APPENDED_OPEN)?;
    let base = out.stream_position()?;
    let mut offsets = Vec::with_capacity(arrays.len());
    for array in &arrays {
        offsets.push(out.stream_position()? - base);
        write_array(out, array)?;
    }
    out.write_all(APPENDED_CLOSE)?;
    let end = out.stream_position()?;
    out.seek(SeekFrom::Start(start))?;
    out.write_all(header(mesh, &arrays, &offsets).as_bytes())?;
    out.seek(SeekFrom::Start(end))?;
    Ok(())
}

const APPENDED_OPEN: &[u8] = b"\n<AppendedData encoding=\"raw\">\n_";
const APPENDED_CLOSE: &[u8] = b"\n</AppendedData>\n</VTKFile>\n";

fn write_spaces(out: &mut impl Write, count: usize) -> io::Result<()> {
    let spaces = [b' '; 256];
    let mut left = count;
    while left > 0 {
        let now = left.min(spaces.len());
        out.write_all(&spaces[..now])?;
        left -= now;
    }
    Ok(())
}

/// Patches with larger ids have no name in the file: the list has a place for every number below.
const LARGEST_NAMED: i32 = 1 << 16;

/// Names by patch id: `lumen` stands for the inside (0), ids that no patch has stay empty.
pub(super) fn patch_names(mesh: &VolumeMesh) -> Vec<String> {
    let largest =
        mesh.patches.iter().map(|p| p.id).filter(|&id| id <= LARGEST_NAMED).max().unwrap_or(0).max(0) as usize;
    let mut names = vec![String::new(); largest + 1];
    names[0] = "lumen".into();
    for patch in &mesh.patches {
        if patch.id > 0
            && let Some(name) = names.get_mut(patch.id as usize)
        {
            name.clone_from(&patch.name);
        }
    }
    names
}

fn arrays_of<'a>(mesh: &'a VolumeMesh, notes: &'a MeshNotes, names: &[String]) -> Vec<Array<'a>> {
    let mut arrays = field_arrays(mesh, notes, names);
    arrays.push(points_array(mesh));
    arrays.extend(cell_arrays(mesh));
    arrays.push(cell_data("patch", Some(0), &[], mesh, &mesh.boundary_patch));
    arrays.push(cell_data("block", None, &mesh.tet_block, mesh, &mesh.boundary_block));
    arrays
}

fn field_arrays<'a>(mesh: &'a VolumeMesh, notes: &'a MeshNotes, names: &[String]) -> Vec<Array<'a>> {
    let caps: Vec<_> = mesh.patches.iter().filter_map(|p| p.cap.map(|cap| (p.id, cap))).collect();
    let mut arrays = vec![strings(field::PATCH_NAMES, names)];
    if !caps.is_empty() {
        let vectors = |f: fn(&crate::mesh::Cap) -> [f64; 3]| caps.iter().flat_map(|(_, cap)| f(cap)).collect();
        arrays.push(ints(field::CAP_PATCH, caps.iter().map(|&(id, _)| i64::from(id)).collect()));
        arrays.push(ints(field::CAP_NODE, caps.iter().map(|(_, cap)| i64::from(cap.node)).collect()));
        arrays.push(floats(field::CAP_CENTER, 3, vectors(|cap| cap.center.coords.into())));
        arrays.push(floats(field::CAP_NORMAL, 3, vectors(|cap| cap.normal.into())));
        arrays.push(floats(field::CAP_RADIUS, 1, caps.iter().map(|(_, cap)| cap.radius).collect()));
    }
    if let Some(expected) = &notes.expectation {
        arrays.push(ints(field::LOOPS, expected.loops.iter().map(|&n| i64::from(n)).collect()));
        arrays.push(ints(field::TERMINALS, expected.terminals.iter().map(|&n| i64::from(n)).collect()));
    }
    for (name, text) in [(field::GENERATOR, &notes.generator), (field::OPTIONS, &notes.options)] {
        if !text.is_empty() {
            arrays.push(strings(name, std::slice::from_ref(text)));
        }
    }
    // An array without values is legal in VTK but trips other readers.
    arrays.retain(|array| array.values > 0);
    arrays
}

/// VTK's string arrays: the characters of each string and a zero behind it.
fn strings<'a>(name: &'static str, texts: &[String]) -> Array<'a> {
    let mut bytes = Vec::new();
    for text in texts {
        bytes.extend(text.bytes().filter(|&b| b != 0));
        bytes.push(0);
    }
    let tuples = texts.len();
    Array {
        place: Place::Field,
        name,
        kind: "String",
        width: 1,
        components: tuples,
        values: bytes.len(),
        fill: Box::new(move |range, out| out.extend_from_slice(&bytes[range])),
        shrinks: true,
    }
}

fn ints<'a>(name: &'static str, values: Vec<i64>) -> Array<'a> {
    Array {
        place: Place::Field,
        name,
        kind: "Int64",
        width: 8,
        components: 1,
        values: values.len(),
        fill: Box::new(move |range, out| out.extend(values[range].iter().flat_map(|v| v.to_le_bytes()))),
        shrinks: true,
    }
}

fn floats<'a>(name: &'static str, components: usize, values: Vec<f64>) -> Array<'a> {
    Array {
        place: Place::Field,
        name,
        kind: "Float64",
        width: 8,
        components,
        values: values.len(),
        fill: Box::new(move |range, out| out.extend(values[range].iter().flat_map(|v| v.to_le_bytes()))),
        shrinks: true,
    }
}

fn points_array(mesh: &VolumeMesh) -> Array<'_> {
    let points = &mesh.mesh.points;
    Array {
        place: Place::Points,
        name: "Points",
        kind: "Float64",
        width: 8,
        components: 3,
        values: 3 * points.len(),
        fill: Box::new(move |range, out| {
            for p in &points[range.start / 3..range.end / 3] {
                for x in [p.x, p.y, p.z] {
                    out.extend_from_slice(&x.to_le_bytes());
                }
            }
        }),
        shrinks: false,
    }
}

fn cell_arrays(mesh: &VolumeMesh) -> [Array<'_>; 3] {
    let (tets, triangles) = (mesh.mesh.tets.as_flattened(), mesh.boundary.as_flattened());
    let (tet_count, cells) = (mesh.mesh.tets.len(), mesh.mesh.tets.len() + mesh.boundary.len());
    let connectivity: Fill = Box::new(move |range, out| {
        for slice in [part(tets, &range, 0), part(triangles, &range, tets.len())] {
            out.extend(slice.iter().flat_map(|v| v.to_le_bytes()));
        }
    });
    let end_of = move |cell: usize| if cell < tet_count { 4 * (cell + 1) } else { tet_count + 3 * (cell + 1) };
    let fits = |count: usize| i32::try_from(count).is_ok();
    let narrow = fits(tets.len() + triangles.len()) && fits(mesh.mesh.points.len());
    let offsets: Fill = Box::new(move |range, out| {
        for cell in range {
            if narrow {
                out.extend_from_slice(&(end_of(cell) as i32).to_le_bytes());
            } else {
                out.extend_from_slice(&(end_of(cell) as i64).to_le_bytes());
            }
        }
    });
    let types: Fill = Box::new(move |range, out| {
        out.extend(range.map(|cell| if cell < tet_count { VTK_TETRA } else { VTK_TRIANGLE }));
    });
    // Ids are u32: within the signed range they can be written as they are, else they need 64 bits.
    let (kind, width) = if narrow { ("Int32", 4) } else { ("Int64", 8) };
    let connectivity: Fill = if narrow {
        connectivity
    } else {
        Box::new(move |range, out| {
            for slice in [part(tets, &range, 0), part(triangles, &range, tets.len())] {
                out.extend(slice.iter().flat_map(|&v| u64::from(v).to_le_bytes()));
            }
        })
    };
    let array = |name, kind, width, values, fill| Array {
        place: Place::Cells,
        name,
        kind,
        width,
        components: 1,
        values,
        fill,
        shrinks: true,
    };
    let corners = array("connectivity", kind, width, tets.len() + triangles.len(), connectivity);
    [
        Array { shrinks: false, ..corners },
        array("offsets", kind, width, cells, offsets),
        array("types", "UInt8", 1, cells, types),
    ]
}

/// What of `range` falls into `values`, whose first value has the index `start` in the whole.
fn part<'a, T>(values: &'a [T], range: &Range<usize>, start: usize) -> &'a [T] {
    let clip = |i: usize| i.clamp(start, start + values.len()) - start;
    &values[clip(range.start)..clip(range.end)]
}

/// A cell array whose tetrahedra all have `constant`, or the values `of_tets` (0 where these are missing).
fn cell_data<'a>(
    name: &'static str,
    constant: Option<i32>,
    of_tets: &'a [i32],
    mesh: &VolumeMesh,
    of_boundary: &'a [i32],
) -> Array<'a> {
    let tets = mesh.mesh.tets.len();
    let value = move |cell: usize| match cell.checked_sub(tets) {
        Some(face) => of_boundary.get(face).copied().unwrap_or(0),
        None => constant.unwrap_or_else(|| of_tets.get(cell).copied().unwrap_or(0)),
    };
    Array {
        place: Place::CellData,
        name,
        kind: "Int32",
        width: 4,
        components: 1,
        values: tets + mesh.boundary.len(),
        fill: Box::new(move |range, out| out.extend(range.flat_map(|cell| value(cell).to_le_bytes()))),
        shrinks: true,
    }
}

fn header(mesh: &VolumeMesh, arrays: &[Array], offsets: &[u64]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n",
    );
    section(&mut text, "FieldData", "", Place::Field, arrays, offsets);
    let (points, cells) = (mesh.mesh.points.len(), mesh.mesh.tets.len() + mesh.boundary.len());
    // Writing to a string cannot fail.
    let _ = writeln!(text, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">");
    section(&mut text, "Points", "", Place::Points, arrays, offsets);
    section(&mut text, "Cells", "", Place::Cells, arrays, offsets);
    section(&mut text, "CellData", " Scalars=\"patch\"", Place::CellData, arrays, offsets);
    text.push_str("</Piece>\n</UnstructuredGrid>");
    text
}

fn section(text: &mut String, tag: &str, attributes: &str, place: Place, arrays: &[Array], offsets: &[u64]) {
    let _ = writeln!(text, "<{tag}{attributes}>");
    for (array, offset) in arrays.iter().zip(offsets).filter(|(array, _)| array.place == place) {
        let Array { name, kind, components, .. } = array;
        let _ = if *kind == "String" {
            writeln!(
                text,
                "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{components}\" format=\"appended\" \
                 offset=\"{offset}\"/>"
            )
        } else {
            // Field arrays carry their length; elsewhere the piece knows it.
            let tuples = match place {
                Place::Field => format!(" NumberOfTuples=\"{}\"", array.values / components),
                _ => String::new(),
            };
            // One component is the default, and readers shape an explicit one as a column.
            let width = if *components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
            writeln!(
                text,
                "<DataArray type=\"{kind}\" Name=\"{name}\"{width}{tuples} format=\"appended\" offset=\"{offset}\"/>"
            )
        };
    }
    let _ = writeln!(text, "</{tag}>");
}

/// Writes the number and sizes of the blocks, then the blocks, compressed a wave at a time.
fn write_array(out: &mut (impl Write + Seek), array: &Array) -> io::Result<()> {
    let blocks = array.values.div_ceil(BLOCK);
    let size = (BLOCK * array.width) as u64;
    let last = ((array.values % BLOCK) * array.width) as u64;
    let mut sizes = vec![blocks as u64, size, last];
    let head = out.stream_position()?;
    write_spaces(out, 8 * (3 + blocks))?;
    for first in (0..blocks).step_by(WAVE) {
        let wave: Vec<io::Result<Vec<u8>>> = (first..blocks.min(first + WAVE))
            .into_par_iter()
            .map(|block| compress(array, block * BLOCK..array.values.min((block + 1) * BLOCK)))
            .collect();
        for bytes in wave {
            let bytes = bytes?;
            sizes.push(bytes.len() as u64);
            out.write_all(&bytes)?;
        }
    }
    let end = out.stream_position()?;
    out.seek(SeekFrom::Start(head))?;
    for size in sizes {
        out.write_all(&size.to_le_bytes())?;
    }
    out.seek(SeekFrom::Start(end))?;
    Ok(())
}

fn compress(array: &Array, range: Range<usize>) -> io::Result<Vec<u8>> {
    let mut raw = Vec::with_capacity(range.len() * array.width);
    (array.fill)(range, &mut raw);
    let level = if array.shrinks { Compression::fast() } else { Compression::none() };
    let mut encoder =
        ZlibEncoder::new(Vec::with_capacity(if array.shrinks { raw.len() / 2 } else { raw.len() + 64 }), level);
    encoder.write_all(&raw)?;
    encoder.finish()
}

#[cfg(test)]
#[path = "vtu_tests.rs"]
pub(super) mod tests;
