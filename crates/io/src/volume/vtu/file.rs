//! VTK file: XML with the array offsets, followed by the arrays.

use super::arrays::{ArrayLocation, ArrayWriter};
use super::names::{CELL_IDS, GLOBAL_IDS};
use crate::vtk_xml::{Packing, write_blocks, write_spaces};
use flate2::Compression;
use std::fmt::Write as _;
use std::io::{self, Seek, SeekFrom, Write};

/// Contents of a single-piece file.
pub(in crate::volume) struct File<'a> {
    /// VTK name of the file type.
    pub kind: &'static str,
    /// Number of points and cells, as attributes of the piece.
    pub counts: String,
    pub arrays: Vec<ArrayWriter<'a>>,
    /// True for uncompressed arrays.
    pub raw: bool,
}

/// Sections of a piece in file order.
const SECTIONS: [(ArrayLocation, &str); 5] = [
    (ArrayLocation::PointData, "PointData"),
    (ArrayLocation::Points, "Points"),
    (ArrayLocation::Cells, "Cells"),
    (ArrayLocation::Polys, "Polys"),
    (ArrayLocation::CellData, "CellData"),
];

/// Arrays of numbers in the whole mesh.
const IDS: [&str; 2] = [GLOBAL_IDS, CELL_IDS];

/// Array that viewers show first, if present.
const LABELS: &str = "patch";

const APPENDED_OPEN: &[u8] = b"\n<AppendedData encoding=\"raw\">\n_";
pub(super) const APPENDED_CLOSE: &[u8] = b"\n</AppendedData>\n</VTKFile>\n";

impl File<'_> {
    /// Writes the file.
    pub(in crate::volume) fn write(&self, out: &mut (impl Write + Seek)) -> io::Result<()> {
        // Offsets are known only after compression, so space for the longest possible header is reserved.
        let reserved = self.header(&vec![u64::MAX; self.arrays.len()]).len();
        let start = out.stream_position()?;
        write_spaces(out, reserved)?;
        out.write_all(APPENDED_OPEN)?;
        let base = out.stream_position()?;
        let mut offsets = vec![0; self.arrays.len()];
        for i in self.stored_order() {
            let array = &self.arrays[i];
            offsets[i] = out.stream_position()? - base;
            write_blocks(out, array.values, array.width, self.packing(array), &array.fill)?;
        }
        out.write_all(APPENDED_CLOSE)?;
        let end = out.stream_position()?;
        out.seek(SeekFrom::Start(start))?;
        out.write_all(self.header(&offsets).as_bytes())?;
        out.seek(SeekFrom::Start(end))?;
        Ok(())
    }

    /// Indices of the arrays in the order of their bytes: the reverse of that in the header.
    ///
    /// meshio 5 looks up the element of the next array by its offset, takes the first match, and replaces the offset. With bytes
    /// in the order of the header, a replaced offset may equal that of a later array. In reverse order, each match is the right one.
    fn stored_order(&self) -> Vec<usize> {
        let tag = |i: &usize| {
            SECTIONS.iter().position(|(place, _)| *place == self.arrays[*i].place).unwrap_or(SECTIONS.len())
        };
        let mut order: Vec<usize> = (0..self.arrays.len()).collect();
        order.sort_by_key(tag);
        order.reverse();
        order
    }

    fn packing(&self, array: &ArrayWriter) -> Packing {
        if self.raw {
            return Packing::Raw;
        }
        Packing::Zlib(if array.shrinks { Compression::fast() } else { Compression::none() })
    }

    fn header(&self, offsets: &[u64]) -> String {
        let kind = self.kind;
        let compressor = if self.raw { "" } else { " compressor=\"vtkZLibDataCompressor\"" };
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\"{compressor}>\n<{kind}>\n"
        );
        // Writing to a string cannot fail.
        let _ = writeln!(text, "<Piece {}>", self.counts);
        for section in SECTIONS {
            self.section(&mut text, section, offsets);
        }
        let _ = writeln!(text, "</Piece>");
        // Last in the header, so that their bytes are first and can be read without the others.
        self.section(&mut text, (ArrayLocation::Field, "FieldData"), offsets);
        let _ = write!(text, "</{kind}>");
        text
    }

    fn section(&self, text: &mut String, (place, tag): (ArrayLocation, &str), offsets: &[u64]) {
        let arrays: Vec<_> = self.arrays.iter().zip(offsets).filter(|(array, _)| array.place == place).collect();
        if arrays.is_empty() {
            return;
        }
        let ids = arrays.iter().map(|(array, _)| array.name).find(|name| IDS.contains(name));
        let ids = ids.map_or_else(String::new, |name| format!(" GlobalIds=\"{name}\""));
        let has_labels = arrays.iter().any(|(array, _)| array.name == LABELS);
        let labels = if has_labels { format!(" Scalars=\"{LABELS}\"") } else { String::new() };
        let _ = writeln!(text, "<{tag}{labels}{ids}>");
        for (array, offset) in arrays {
            let _ = writeln!(text, "<DataArray {} format=\"appended\" offset=\"{offset}\"/>", attributes_of(array));
        }
        let _ = writeln!(text, "</{tag}>");
    }
}

/// XML attributes of an array, except its offset.
fn attributes_of(array: &ArrayWriter) -> String {
    let ArrayWriter { name, kind, components, .. } = array;
    // Field arrays need their length; for others it follows from the piece.
    let tuples = match array.place {
        ArrayLocation::Field => format!(" NumberOfTuples=\"{}\"", array.values / components),
        _ => String::new(),
    };
    // VTK accepts global ids only in arrays of its id type.
    let ids = if IDS.contains(name) { " IdType=\"1\"" } else { "" };
    // One component is the default; readers give an explicit one the shape of a column.
    let width = if *components > 1 { format!(" NumberOfComponents=\"{components}\"") } else { String::new() };
    format!("type=\"{kind}\"{ids} Name=\"{name}\"{width}{tuples}")
}
