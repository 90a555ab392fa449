//! Sections of a legacy file, parsed keyword by keyword.

use super::array::Array;
use super::cursor::Cursor;
use super::error::VtkLegacyError;
use crate::text::Place;
use crate::text::shown;

/// Cell list of poly data, or all cells of an unstructured grid.
pub(super) struct CellList<'a> {
    /// Keyword of the list.
    pub keyword: &'static str,
    /// Position of its start.
    pub place: Place,
    /// Offsets of the cells in `points`, plus the total (since version 5). Without offsets, each cell in `points` is a
    /// count followed by its points.
    pub offsets: Option<Array<'a>>,
    pub points: Array<'a>,
    /// Number of cells.
    pub count: usize,
}

/// Sections of a file.
#[derive(Default)]
pub(super) struct Sections<'a> {
    pub points: Option<Array<'a>>,
    /// Cell lists in file order.
    pub lists: Vec<CellList<'a>>,
    /// Cell types of an unstructured grid.
    pub types: Option<Array<'a>>,
    pub point_data: Vec<Array<'a>>,
    pub cell_data: Vec<Array<'a>>,
    /// True for an unstructured grid.
    pub grid: bool,
}

/// Owner of the arrays in a section.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Owner {
    Dataset,
    Points,
    Cells,
}

/// Keywords of cell lists, in the order of cell data.
pub(super) const LISTS: [&str; 5] = ["VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS"];

impl<'a> Sections<'a> {
    /// Parses the sections of a file.
    pub(super) fn of(bytes: &'a [u8]) -> Result<Self, VtkLegacyError> {
        let mut cursor = Cursor::new(bytes);
        let first = cursor.line().unwrap_or_default();
        if !first.to_ascii_lowercase().starts_with(b"# vtk datafile") {
            return Err(VtkLegacyError::NotVtk);
        }
        cursor.line();
        let encoding = cursor.line().unwrap_or_default().trim_ascii();
        let binary = match encoding.to_ascii_uppercase().as_slice() {
            b"ASCII" => false,
            b"BINARY" => true,
            _ => return Err(VtkLegacyError::UnknownEncoding { found: shown(encoding) }),
        };
        cursor.binary = binary;
        let mut sections = Self::default();
        let (mut owner, mut count) = (Owner::Dataset, 0);
        while let Some((place, words)) = cursor.keywords() {
            let head = Head { place, words };
            match head.words[0].to_ascii_uppercase().as_str() {
                "DATASET" => sections.grid = head.is_grid()?,
                "POINTS" => sections.points = Some(head.points(&mut cursor)?),
                "CELL_TYPES" => {
                    let number = head.count(1, "a number of cells")?;
                    sections.types = Some(Array::take(&mut cursor, "CELL_TYPES", "int", Some(number))?);
                }
                "METADATA" => cursor.skip_block(),
                "POINT_DATA" => (owner, count) = (Owner::Points, head.count(1, "a number of points")?),
                "CELL_DATA" => (owner, count) = (Owner::Cells, head.count(1, "a number of cells")?),
                keyword => match LISTS.iter().find(|list| **list == keyword) {
                    Some(list) => sections.lists.push(head.cells(&mut cursor, list)?),
                    None => sections.keep(owner, head.attributes(&mut cursor, keyword, count)?),
                },
            }
        }
        Ok(sections)
    }

    /// Stores arrays of points and cells.
    fn keep(&mut self, owner: Owner, arrays: Vec<Array<'a>>) {
        match owner {
            Owner::Points => self.point_data.extend(arrays),
            Owner::Cells => self.cell_data.extend(arrays),
            Owner::Dataset => {}
        }
    }
}

/// First line of a section.
struct Head {
    place: Place,
    words: Vec<String>,
}

impl Head {
    /// Parses the word at a position of the line as a count.
    fn count(&self, at: usize, needed: &'static str) -> Result<usize, VtkLegacyError> {
        let count = self.words.get(at).and_then(|w| w.parse().ok());
        count.ok_or_else(|| Cursor::bad(self.place, &self.words, needed))
    }

    fn word(&self, at: usize, needed: &'static str) -> Result<&str, VtkLegacyError> {
        self.words.get(at).map(String::as_str).ok_or_else(|| Cursor::bad(self.place, &self.words, needed))
    }

    fn is_grid(&self) -> Result<bool, VtkLegacyError> {
        match self.word(1, "the kind of the dataset")?.to_ascii_uppercase().as_str() {
            "POLYDATA" => Ok(false),
            "UNSTRUCTURED_GRID" => Ok(true),
            other => Err(VtkLegacyError::WrongDataset { found: shown(other.as_bytes()) }),
        }
    }

    fn points<'a>(&self, cursor: &mut Cursor<'a>) -> Result<Array<'a>, VtkLegacyError> {
        let count = self.count(1, "a number of points")?;
        Array::take(cursor, "POINTS", self.word(2, "a type of values")?, count.checked_mul(3))
    }

    /// Parses a cell list with its two counts: offsets and points since version 5, or cells and integers before.
    fn cells<'a>(&self, cursor: &mut Cursor<'a>, keyword: &'static str) -> Result<CellList<'a>, VtkLegacyError> {
        let first = self.count(1, "a number of cells")?;
        let second = self.count(2, "the number of cells and the size of the list")?;
        let place = self.place;
        if !cursor.next_is(b"OFFSETS") {
            let points = Array::take(cursor, keyword, "int", Some(second))?;
            return Ok(CellList { keyword, place, offsets: None, points, count: first });
        }
        let mut part = |name: &str, count: usize| {
            let (place, words) = cursor.keywords().ok_or(VtkLegacyError::MissingSection { section: "CONNECTIVITY" })?;
            let head = Head { place, words };
            if !head.words[0].eq_ignore_ascii_case(name) {
                return Err(VtkLegacyError::UnknownKeyword { place, found: shown(head.words[0].as_bytes()) });
            }
            Array::take(cursor, name, head.word(1, "a type of values")?, Some(count))
        };
        let offsets = part("OFFSETS", first)?;
        let points = part("CONNECTIVITY", second)?;
        Ok(CellList { keyword, place, offsets: Some(offsets), points, count: first.saturating_sub(1) })
    }

    /// Parses the arrays of an attribute section, for `count` points or cells.
    fn attributes<'a>(
        &self,
        cursor: &mut Cursor<'a>,
        keyword: &str,
        count: usize,
    ) -> Result<Vec<Array<'a>>, VtkLegacyError> {
        const NAME_AND_TYPE: &str = "a name and a type of values";
        let (width, kind) = match keyword {
            "FIELD" => return self.field(cursor),
            "LOOKUP_TABLE" => {
                let entries = self.count(2, "a name and a number of entries")?;
                let kind = if cursor.binary { "unsigned_char" } else { "float" };
                Array::take(cursor, keyword, kind, entries.checked_mul(4))?;
                return Ok(Vec::new());
            }
            "SCALARS" => (self.words.get(3).map_or(Some(1), |w| w.parse().ok()), self.word(2, NAME_AND_TYPE)?),
            "COLOR_SCALARS" => {
                let kind = if cursor.binary { "unsigned_char" } else { "float" };
                (Some(self.count(2, "a name and a number of values")?), kind)
            }
            "TEXTURE_COORDINATES" => {
                (Some(self.count(2, "a name, a dimension and a type")?), self.word(3, NAME_AND_TYPE)?)
            }
            "VECTORS" | "NORMALS" => (Some(3), self.word(2, NAME_AND_TYPE)?),
            "TENSORS" => (Some(9), self.word(2, NAME_AND_TYPE)?),
            "TENSORS6" => (Some(6), self.word(2, NAME_AND_TYPE)?),
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => (Some(1), self.word(2, NAME_AND_TYPE)?),
            _ => {
                let found = shown(self.words[0].as_bytes());
                return Err(VtkLegacyError::UnknownKeyword { place: self.place, found });
            }
        };
        if keyword == "SCALARS" && cursor.next_is(b"LOOKUP_TABLE") {
            cursor.keywords();
        }
        let name = plain_name(self.word(1, NAME_AND_TYPE)?);
        Ok(vec![Array::take(cursor, &name, kind, width.and_then(|width| count.checked_mul(width)))?])
    }

    /// Parses field arrays, which have individual lengths.
    fn field<'a>(&self, cursor: &mut Cursor<'a>) -> Result<Vec<Array<'a>>, VtkLegacyError> {
        const NEEDED: &str = "a name, a number of components, a number of tuples and a type of values";
        let number = self.count(2, "a name and a number of arrays")?;
        let mut arrays = Vec::new();
        while arrays.len() < number {
            if cursor.next_is(b"METADATA") {
                cursor.keywords();
                cursor.skip_block();
                continue;
            }
            let missing = || VtkLegacyError::CutShort { place: self.place, array: "FIELD".into(), count: number };
            let (place, words) = cursor.keywords().ok_or_else(missing)?;
            let head = Head { place, words };
            let (width, tuples) = (head.count(1, NEEDED)?, head.count(2, NEEDED)?);
            let (name, kind) = (plain_name(&head.words[0]), head.word(3, NEEDED)?);
            let count = width.checked_mul(tuples);
            if kind.eq_ignore_ascii_case("string") {
                skip_strings(cursor, &name, count)?;
                // Cannot be a radius: becomes an array without values.
                arrays.push(Array::take(cursor, &name, "bit", Some(0))?);
            } else {
                arrays.push(Array::take(cursor, &name, kind, count)?);
            }
        }
        Ok(arrays)
    }
}

/// Skips strings: one per line in text files, length-prefixed in binary ones.
fn skip_strings(cursor: &mut Cursor, name: &str, count: Option<usize>) -> Result<(), VtkLegacyError> {
    let count = count.unwrap_or(usize::MAX);
    let cut = VtkLegacyError::CutShort { place: cursor.place(), array: shown(name.as_bytes()), count };
    for _ in 0..count {
        let there = if cursor.binary { skip_string(cursor).is_some() } else { cursor.line().is_some() };
        if !there {
            return Err(cut);
        }
    }
    Ok(())
}

/// The two highest bits of the first byte encode the size of the length.
fn skip_string(cursor: &mut Cursor) -> Option<()> {
    let first = *cursor.take(1)?.first()?;
    let more = match first >> 6 {
        3 => 0,
        2 => 1,
        1 => 3,
        _ => 7,
    };
    let fold = |sum: u64, &byte: &u8| sum << 8 | u64::from(byte);
    let length = cursor.take(more)?.iter().fold(u64::from(first & 63), fold);
    cursor.take(usize::try_from(length).ok()?).map(|_| ())
}

/// Decodes a name, in which special characters are written as `%20`.
fn plain_name(name: &str) -> String {
    let bytes = name.as_bytes();
    let mut plain = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = bytes.get(at + 1..at + 3).filter(|_| bytes[at] == b'%');
        let code = code.and_then(|c| std::str::from_utf8(c).ok()).and_then(|c| u8::from_str_radix(c, 16).ok());
        plain.push(code.unwrap_or(bytes[at]));
        at += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&plain).into_owned()
}
