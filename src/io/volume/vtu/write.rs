//! Writes unstructured grids: the text with the places of the arrays, and the arrays behind it.

use super::arrays::{self, Array, Place};
use super::names::GLOBAL_IDS;
use crate::io::volume::content::MeshNotes;
use crate::io::vtk_xml::{write_blocks, write_spaces};
use crate::mesh::source::{MeshSource, SourceCounts};
use flate2::Compression;
use std::fmt::Write as _;
use std::io::{self, Seek, SeekFrom, Write};

/// Writes a mesh as VTU. The bytes depend on the mesh and the notes alone, not on the number of threads, nor on the
/// pieces in which the mesh is read. Points, tetrahedra and boundary faces are read in one pass each, their labels in others;
/// memory does not grow with the mesh: some blocks for each thread are all that is held.
///
/// # Errors
/// What the writer `out` or reading the mesh reports.
pub(in crate::io::volume) fn write(
    out: &mut (impl Write + Seek),
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
) -> io::Result<()> {
    Grid { mesh, notes: Some(notes), global_ids: None }.write(out)
}

/// What goes into a file.
pub(in crate::io::volume) struct Grid<'a> {
    pub mesh: &'a dyn MeshSource,
    /// What the field data say; none for a piece without.
    pub notes: Option<&'a MeshNotes>,
    /// For a piece of a mesh: which point of the whole each point is.
    pub global_ids: Option<&'a [u32]>,
}

impl Grid<'_> {
    /// Writes the file.
    pub(in crate::io::volume) fn write(&self, out: &mut (impl Write + Seek)) -> io::Result<()> {
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
        let mut all = self.notes.map_or_else(Vec::new, |notes| arrays::of_fields(self.mesh.patches(), notes));
        all.extend(self.global_ids.map(arrays::of_ids));
        all.extend(arrays::of_mesh(self.mesh));
        all
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
pub(super) const APPENDED_CLOSE: &[u8] = b"\n</AppendedData>\n</VTKFile>\n";

fn section(text: &mut String, tag: &str, attributes: &str, place: Place, arrays: &[Array], offsets: &[u64]) {
    let _ = writeln!(text, "<{tag}{attributes}>");
    for (array, offset) in arrays.iter().zip(offsets).filter(|(array, _)| array.place == place) {
        let Array { name, kind, components, .. } = array;
        // Field arrays carry their length; elsewhere the piece knows it.
        let tuples = match place {
            Place::Field => format!(" NumberOfTuples=\"{}\"", array.values / components),
            _ => String::new(),
        };
        // VTK takes global ids only from arrays of its own type of ids.
        let ids = if place == Place::PointData { " IdType=\"1\"" } else { "" };
        // One component is the default, and readers shape an explicit one as a column.
        let width = if *components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
        let _ = writeln!(
            text,
            "<DataArray type=\"{kind}\"{ids} Name=\"{name}\"{width}{tuples} format=\"appended\" offset=\"{offset}\"/>"
        );
    }
    let _ = writeln!(text, "</{tag}>");
}
