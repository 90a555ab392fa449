//! VTK unstructured grids (`.vtu`): a labelled tetrahedral mesh, in appended raw data compressed with zlib.
//!
//! Tetrahedra come first, then the boundary triangles; the `Int32` cell arrays `patch` and `block` say where each
//! belongs (a tetrahedron's patch is 0). Field data name the patches (`patch_names`, indexed by the id) and hold what a
//! later check needs to know: the caps, the loops of each component, the terminals.

use super::mesh_file::MeshNotes;
use super::vtu_blocks::{Blocks, write_blocks, write_spaces};
use crate::geometry::Point3;
use crate::mesh::Patch;
use crate::mesh::source::{MeshSource, SourceCounts};
use flate2::Compression;
use std::fmt::Write as _;
use std::io::{self, Seek, SeekFrom, Write};

pub use super::vtu_pieces::{VtuPieces, VtuPiecesError};
pub use super::vtu_read::read_vtu;

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

/// Name of the point array that says which point of the whole mesh each point of a piece is.
pub(super) const GLOBAL_IDS: &str = "GlobalPointIds";

/// Where an array stands in the file.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Field,
    PointData,
    Points,
    Cells,
    CellData,
}

/// Gives an array's values, as little-endian bytes.
type Fill<'a> = Box<dyn Fn(&mut Blocks) -> io::Result<()> + 'a>;

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

/// Writes a mesh as VTU. The bytes depend on the mesh and the notes alone, not on the number of threads, nor on the
/// pieces in which the mesh is read. Points, tetrahedra and boundary faces are read in one pass each, their labels in others;
/// memory does not grow with the mesh: some blocks for each thread are all that is held.
///
/// # Errors
/// What the writer `out` or reading the mesh reports.
pub fn write_vtu(out: &mut (impl Write + Seek), mesh: &dyn MeshSource, notes: &MeshNotes) -> io::Result<()> {
    Grid { mesh, notes: Some(notes), global_ids: None }.write(out)
}

/// What goes into a file.
pub(super) struct Grid<'a> {
    pub mesh: &'a dyn MeshSource,
    /// What the field data say; none for a piece without.
    pub notes: Option<&'a MeshNotes>,
    /// For a piece of a mesh: which point of the whole each point is.
    pub global_ids: Option<&'a [u32]>,
}

impl Grid<'_> {
    /// Writes the file.
    pub(super) fn write(&self, out: &mut (impl Write + Seek)) -> io::Result<()> {
        let arrays = self.arrays();
        // The offsets are known only after compression: room for the longest possible header is left in front.
        let reserved = self.header(&arrays, &vec![u64::MAX; arrays.len()]).len();
        let start = out.stream_position()?;
        write_spaces(out, reserved)?;
        out.write_all(APPENDED_OPEN)?;
        let base = out.stream_position()?;
        let mut offsets = Vec::with_capacity(arrays.len());
        for array in &arrays {
            offsets.push(out.stream_position()? - base);
            let level = if array.shrinks { Compression::fast() } else { Compression::none() };
            write_blocks(out, array.values, array.width, level, &array.fill)?;
        }
        out.write_all(APPENDED_CLOSE)?;
        let end = out.stream_position()?;
        out.seek(SeekFrom::Start(start))?;
        out.write_all(self.header(&arrays, &offsets).as_bytes())?;
        out.seek(SeekFrom::Start(end))?;
        Ok(())
    }

    fn arrays(&self) -> Vec<Array<'_>> {
        let mesh = self.mesh;
        let mut arrays = match self.notes {
            Some(notes) => field_arrays(mesh.patches(), notes),
            None => Vec::new(),
        };
        arrays.extend(self.global_ids.map(id_array));
        arrays.push(points_array(mesh));
        arrays.extend(cell_arrays(mesh, Width::of(mesh.counts())));
        arrays.push(patch_array(mesh));
        arrays.push(block_array(mesh));
        arrays
    }

    fn header(&self, arrays: &[Array], offsets: &[u64]) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<UnstructuredGrid>\n",
        );
        if self.notes.is_some() {
            section(&mut text, "FieldData", "", Place::Field, arrays, offsets);
        }
        let SourceCounts { points, tets, boundary } = self.mesh.counts();
        let cells = tets + boundary;
        // Writing to a string cannot fail.
        let _ = writeln!(text, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">");
        if self.global_ids.is_some() {
            let attributes = format!(" GlobalIds=\"{GLOBAL_IDS}\"");
            section(&mut text, "PointData", &attributes, Place::PointData, arrays, offsets);
        }
        section(&mut text, "Points", "", Place::Points, arrays, offsets);
        section(&mut text, "Cells", "", Place::Cells, arrays, offsets);
        section(&mut text, "CellData", " Scalars=\"patch\"", Place::CellData, arrays, offsets);
        text.push_str("</Piece>\n</UnstructuredGrid>");
        text
    }
}

const APPENDED_OPEN: &[u8] = b"\n<AppendedData encoding=\"raw\">\n_";
const APPENDED_CLOSE: &[u8] = b"\n</AppendedData>\n</VTKFile>\n";

/// Patches with larger ids have no name in the file: the list has a place for every number below.
const LARGEST_NAMED: i32 = 1 << 16;

/// Names by patch id: `lumen` stands for the inside (0), ids that no patch has stay empty.
fn patch_names(patches: &[Patch]) -> Vec<String> {
    let largest = patches.iter().map(|p| p.id).filter(|&id| id <= LARGEST_NAMED).max().unwrap_or(0).max(0) as usize;
    let mut names = vec![String::new(); largest + 1];
    names[0] = "lumen".into();
    for patch in patches {
        if patch.id > 0
            && let Some(name) = names.get_mut(patch.id as usize)
        {
            name.clone_from(&patch.name);
        }
    }
    names
}

fn field_arrays<'a>(patches: &[Patch], notes: &MeshNotes) -> Vec<Array<'a>> {
    let caps: Vec<_> = patches.iter().filter_map(|p| p.cap.map(|cap| (p.id, cap))).collect();
    let mut arrays = vec![strings(field::PATCH_NAMES, &patch_names(patches))];
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
        fill: Box::new(move |out| out.push(bytes.len(), |i| [bytes[i]])),
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
        fill: Box::new(move |out| out.push(values.len(), |i| values[i].to_le_bytes())),
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
        fill: Box::new(move |out| out.push(values.len(), |i| values[i].to_le_bytes())),
        shrinks: true,
    }
}

fn id_array(ids: &[u32]) -> Array<'_> {
    Array {
        place: Place::PointData,
        name: GLOBAL_IDS,
        kind: "Int64",
        width: 8,
        components: 1,
        values: ids.len(),
        fill: Box::new(move |out| out.push(ids.len(), |i| u64::from(ids[i]).to_le_bytes())),
        shrinks: true,
    }
}

fn points_array(mesh: &dyn MeshSource) -> Array<'_> {
    Array {
        place: Place::Points,
        name: "Points",
        kind: "Float64",
        width: 8,
        components: 3,
        values: 3 * mesh.counts().points,
        fill: Box::new(move |out| mesh.points(&mut |points| out.push(points.len(), |i| point_bytes(&points[i])))),
        shrinks: false,
    }
}

fn point_bytes(p: &Point3) -> [u8; 24] {
    let mut bytes = [0; 24];
    let (words, _) = bytes.as_chunks_mut::<8>();
    for (word, x) in words.iter_mut().zip([p.x, p.y, p.z]) {
        *word = x.to_le_bytes();
    }
    bytes
}

/// How wide vertex numbers and offsets are.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Width {
    Int32,
    Int64,
}

impl Width {
    /// Ids are u32: within the signed range they can be written as they are, else they need 64 bits.
    fn of(counts: SourceCounts) -> Self {
        let fits = |count: usize| i32::try_from(count).is_ok();
        let narrow = fits(4 * counts.tets + 3 * counts.boundary) && fits(counts.points);
        if narrow { Self::Int32 } else { Self::Int64 }
    }

    fn bytes(self) -> usize {
        if self == Self::Int32 { 4 } else { 8 }
    }

    fn push(self, out: &mut Blocks, count: usize, value: impl Fn(usize) -> u64 + Sync) -> io::Result<()> {
        match self {
            Self::Int32 => out.push(count, |i| (value(i) as u32).to_le_bytes()),
            Self::Int64 => out.push(count, |i| value(i).to_le_bytes()),
        }
    }
}

fn cell_arrays(mesh: &dyn MeshSource, width: Width) -> [Array<'_>; 3] {
    let SourceCounts { tets, boundary, .. } = mesh.counts();
    let corners: Fill = Box::new(move |out| {
        let mut push = |ids: &[u32]| width.push(out, ids.len(), |i| u64::from(ids[i]));
        mesh.tets(&mut |piece| push(piece.tets.as_flattened()))?;
        mesh.boundary(&mut |piece| push(piece.faces.as_flattened()))
    });
    let offsets: Fill = Box::new(move |out| {
        width.push(out, tets, |tet| 4 * (tet as u64 + 1))?;
        width.push(out, boundary, |face| 4 * tets as u64 + 3 * (face as u64 + 1))
    });
    let types: Fill = Box::new(move |out| {
        out.push(tets, |_| [VTK_TETRA])?;
        out.push(boundary, |_| [VTK_TRIANGLE])
    });
    let kind = if width == Width::Int32 { "Int32" } else { "Int64" };
    let array = |name, kind, width, values, fill, shrinks| Array {
        place: Place::Cells,
        name,
        kind,
        width,
        components: 1,
        values,
        fill,
        shrinks,
    };
    [
        // Half of a wide number is zeros.
        array("connectivity", kind, width.bytes(), 4 * tets + 3 * boundary, corners, width == Width::Int64),
        array("offsets", kind, width.bytes(), tets + boundary, offsets, true),
        array("types", "UInt8", 1, tets + boundary, types, true),
    ]
}

fn cell_data<'a>(name: &'static str, counts: SourceCounts, fill: Fill<'a>) -> Array<'a> {
    Array {
        place: Place::CellData,
        name,
        kind: "Int32",
        width: 4,
        components: 1,
        values: counts.tets + counts.boundary,
        fill,
        shrinks: true,
    }
}

/// Patches of the boundary faces; those of tetrahedra are 0.
fn patch_array(mesh: &dyn MeshSource) -> Array<'_> {
    let counts = mesh.counts();
    let fill: Fill = Box::new(move |out| {
        out.push(counts.tets, |_| [0; 4])?;
        mesh.face_labels(&mut |piece| push_known(out, piece.patches, piece.count))
    });
    cell_data("patch", counts, fill)
}

fn block_array(mesh: &dyn MeshSource) -> Array<'_> {
    let fill: Fill = Box::new(move |out| {
        mesh.tet_labels(&mut |piece| push_known(out, piece.blocks, piece.count))?;
        mesh.face_labels(&mut |piece| push_known(out, piece.blocks, piece.count))
    });
    cell_data("block", mesh.counts(), fill)
}

/// Pushes `count` values, 0 where they are not known.
fn push_known(out: &mut Blocks, values: &[i32], count: usize) -> io::Result<()> {
    let known = values.len().min(count);
    out.push_ints(&values[..known])?;
    out.push(count - known, |_| [0; 4])
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
            // VTK takes global ids only from arrays of its own type of ids.
            let ids = if place == Place::PointData { " IdType=\"1\"" } else { "" };
            // One component is the default, and readers shape an explicit one as a column.
            let width = if *components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
            writeln!(
                text,
                "<DataArray type=\"{kind}\"{ids} Name=\"{name}\"{width}{tuples} format=\"appended\" offset=\"{offset}\"/>"
            )
        };
    }
    let _ = writeln!(text, "</{tag}>");
}

#[cfg(test)]
#[path = "vtu_tests.rs"]
pub(super) mod tests;
