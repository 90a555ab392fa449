//! The sections of a legacy file, one keyword after the other.

use super::array::LegacyArray;
use super::cursor::Cursor;
use super::error::VtkLegacyError;
use crate::text::Place;
use crate::text::shown;

/// A list of cells of poly data, or all cells of an unstructured grid.
pub(super) struct CellList<'a> {
    /// Its keyword.
    pub keyword: &'static str,
    /// Where it begins.
    pub place: Place,
    /// For each cell where it begins in the points, and at last where all end (since version 5); without it each cell in
    /// `points` is its number of points, then these.
    pub offsets: Option<LegacyArray<'a>>,
    pub points: LegacyArray<'a>,
    /// Number of cells.
    pub count: usize,
}

/// What is there of a file.
#[derive(Default)]
pub(super) struct Sections<'a> {
    pub points: Option<LegacyArray<'a>>,
    /// In the order of the file.
    pub lists: Vec<CellList<'a>>,
    /// The types of the cells of an unstructured grid.
    pub types: Option<LegacyArray<'a>>,
    pub point_data: Vec<LegacyArray<'a>>,
    pub cell_data: Vec<LegacyArray<'a>>,
    /// Whether it is an unstructured grid.
    pub grid: bool,
}

/// To whom the arrays of a section belong.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Owner {
    Dataset,
    Points,
    Cells,
}

/// The lists of cells that there are, in the order in which cell data run over them.
pub(super) const LISTS: [&str; 5] = ["VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS", "CELLS"];

impl<'a> Sections<'a> {
    /// Finds the sections of a file.
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
            let head = SectionHeader { place, words };
            match head.words[0].to_ascii_uppercase().as_str() {
                "DATASET" => sections.grid = head.is_grid()?,
                "POINTS" => sections.points = Some(head.points(&mut cursor)?),
                "CELL_TYPES" => {
                    let number = head.count(1, "a number of cells")?;
                    sections.types = Some(LegacyArray::take(&mut cursor, "CELL_TYPES", "int", Some(number))?);
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

    /// Keeps arrays of points and cells.
    fn keep(&mut self, owner: Owner, arrays: Vec<LegacyArray<'a>>) {
        match owner {
            Owner::Points => self.point_data.extend(arrays),
            Owner::Cells => self.cell_data.extend(arrays),
            Owner::Dataset => {}
        }
    }
}

/// A line that begins a section.
struct SectionHeader {
    place: Place,
    words: Vec<String>,
}

impl SectionHeader {
    /// The word at a place of the line as a count.
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

    fn points<'a>(&self, cursor: &mut Cursor<'a>) -> Result<LegacyArray<'a>, VtkLegacyError> {
        let count = self.count(1, "a number of points")?;
        LegacyArray::take(cursor, "POINTS", self.word(2, "a type of values")?, count.checked_mul(3))
    }

    /// A list of cells, of which two numbers are told: since version 5 those of offsets and of points, before it those of
    /// cells and of all integers.
    fn cells<'a>(&self, cursor: &mut Cursor<'a>, keyword: &'static str) -> Result<CellList<'a>, VtkLegacyError> {
        let first = self.count(1, "a number of cells")?;
        let second = self.count(2, "the number of cells and the size of the list")?;
        let place = self.place;
        if !cursor.next_is(b"OFFSETS") {
            let points = LegacyArray::take(cursor, keyword, "int", Some(second))?;
            return Ok(CellList { keyword, place, offsets: None, points, count: first });
        }
        let mut part = |name: &str, count: usize| {
            let (place, words) = cursor.keywords().ok_or(VtkLegacyError::MissingSection { section: "CONNECTIVITY" })?;
            let head = SectionHeader { place, words };
            if !head.words[0].eq_ignore_ascii_case(name) {
                return Err(VtkLegacyError::UnknownKeyword { place, found: shown(head.words[0].as_bytes()) });
            }
            LegacyArray::take(cursor, name, head.word(1, "a type of values")?, Some(count))
        };
        let offsets = part("OFFSETS", first)?;
        let points = part("CONNECTIVITY", second)?;
        Ok(CellList { keyword, place, offsets: Some(offsets), points, count: first.saturating_sub(1) })
    }

    /// The arrays of a section of attributes, for each of `count` points or cells.
    fn attributes<'a>(
        &self,
        cursor: &mut Cursor<'a>,
        keyword: &str,
        count: usize,
    ) -> Result<Vec<LegacyArray<'a>>, VtkLegacyError> {
        const NAME_AND_TYPE: &str = "a name and a type of values";
        let (width, kind) = match keyword {
            "FIELD" => return self.field(cursor),
            "LOOKUP_TABLE" => {
                let entries = self.count(2, "a name and a number of entries")?;
                let kind = if cursor.binary { "unsigned_char" } else { "float" };
                LegacyArray::take(cursor, keyword, kind, entries.checked_mul(4))?;
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
        Ok(vec![LegacyArray::take(cursor, &name, kind, width.and_then(|width| count.checked_mul(width)))?])
    }

    /// Arrays that each say how many values they have.
    fn field<'a>(&self, cursor: &mut Cursor<'a>) -> Result<Vec<LegacyArray<'a>>, VtkLegacyError> {
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
            let head = SectionHeader { place, words };
            let (width, tuples) = (head.count(1, NEEDED)?, head.count(2, NEEDED)?);
            let (name, kind) = (plain_name(&head.words[0]), head.word(3, NEEDED)?);
            let count = width.checked_mul(tuples);
            if kind.eq_ignore_ascii_case("string") {
                skip_strings(cursor, &name, count)?;
                // Nothing that could be a radius: an array without values.
                arrays.push(LegacyArray::take(cursor, &name, "bit", Some(0))?);
            } else {
                arrays.push(LegacyArray::take(cursor, &name, kind, count)?);
            }
        }
        Ok(arrays)
    }
}

/// Passes over strings: one a line, or each after its length.
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

/// The highest two bits of the first byte tell how many bytes the length has.
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

/// A name as its writer had it: blanks and the like are written as `%20`.
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
