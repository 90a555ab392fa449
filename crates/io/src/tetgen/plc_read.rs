//! Reader of piecewise linear complexes.

use super::error::{TetgenFault, TetgenFileError};
use super::nodes::{self, Nodes, read_nodes};
use super::plc::{Facet, Plc, PlcFormat, Region};
use crate::file::{FileError, extension, read_bytes};
use crate::text::{TextFault, Words, from_first};
use anastomesh_mesh::geometry::Point3;
use std::path::Path;

/// Reads a piecewise linear complex from a `.poly` or `.smesh` file. If it has no points, they are read from the
/// `.node` file beside it.
///
/// # Errors
/// See [`read_nodes`].
pub fn read_plc(path: &Path) -> Result<Plc, TetgenFileError> {
    let format = match extension(path).as_str() {
        "poly" => PlcFormat::Poly,
        "smesh" => PlcFormat::Smesh,
        _ => {
            let (path, kind) = (path.to_path_buf(), "facet");
            return Err(FileError::UnknownFormat { path, kind, known: ".poly, .smesh" });
        }
    };
    read_plc_as(path, format)
}

/// Reads a complex like [`read_plc`], in this format.
///
/// # Errors
/// See [`read_nodes`].
pub fn read_plc_as(path: &Path, format: PlcFormat) -> Result<Plc, TetgenFileError> {
    let bytes = read_bytes(path)?;
    let mut words = Words::new(&bytes, true);
    let mut nodes = nodes::parse(&mut words).map_err(FileError::content(path))?;
    let points_beside = nodes.points.is_empty();
    if points_beside {
        nodes = read_nodes(&path.with_extension("node"))?;
    }
    let plc = parse(&mut words, nodes, format).map_err(FileError::content(path))?;
    Ok(Plc { points_beside, ..plc })
}

impl Plc {
    /// Parses the bytes of a file that contains its points.
    ///
    /// # Errors
    /// The bytes violate the format, are incomplete, or contain no points.
    pub fn parse(bytes: &[u8], format: PlcFormat) -> Result<Self, TetgenFault> {
        let mut words = Words::new(bytes, true);
        let nodes = nodes::parse(&mut words)?;
        parse(&mut words, nodes, format)
    }
}

/// Parses the part after the points.
fn parse(words: &mut Words, nodes: Nodes, format: PlcFormat) -> Result<Plc, TetgenFault> {
    if nodes.points.is_empty() {
        return Err(TetgenFault::NoPoints);
    }
    let Nodes { points, attributes, attribute_count, markers, first } = nodes;
    let mut plc = Plc { points, point_markers: markers, first, ..Plc::default() };
    (plc.point_attributes, plc.attribute_count) = (attributes, attribute_count);
    // "1 0\n"
    let count = words.count("the count of facets", 4)?;
    let marked = words.flag_here("the number of facet markers (0 or 1)")?;
    words.skip_line();
    plc.facets.reserve_exact(count);
    let mut reader = FacetReader { words, points: plc.points.len(), first, marked };
    for facet in 0..count {
        plc.facets.push(match format {
            PlcFormat::Poly => reader.poly_facet(facet)?,
            PlcFormat::Smesh => reader.smesh_facet(facet)?,
        });
    }
    plc.holes = holes(words)?;
    plc.regions = regions(words)?;
    words.expect_end()?;
    Ok(plc)
}

struct FacetReader<'w, 'a> {
    words: &'w mut Words<'a>,
    points: usize,
    first: u32,
    marked: bool,
}

impl FacetReader<'_, '_> {
    /// Number of a facet in the file, counted like points.
    fn number(&self, facet: usize) -> usize {
        facet + self.first as usize
    }

    /// Parses `<polygons> [holes] [marker]`, then the polygons, then the holes.
    fn poly_facet(&mut self, facet: usize) -> Result<Facet, TetgenFault> {
        let words = &mut *self.words;
        // "1 0\n", "0 0 0 0\n"
        let polygons = words.count("a facet's count of polygons", 4)?;
        let line = words.line();
        let holes = words.count_here("a facet's count of holes", 8)?;
        let marker = self.marker()?;
        self.words.skip_line();
        if polygons == 0 {
            return Err(TetgenFault::EmptyFacet { line, facet: self.number(facet) });
        }
        let mut read = Facet { polygons: Vec::with_capacity(polygons), holes: Vec::with_capacity(holes), marker };
        for _ in 0..polygons {
            read.polygons.push(self.polygon(facet)?);
            self.words.skip_line();
        }
        for _ in 0..holes {
            self.words.integer("the number of a hole")?;
            read.holes.push(self.words.point_here()?);
            self.words.skip_line();
        }
        Ok(read)
    }

    /// Parses `<corners> <corner> … [marker]`.
    fn smesh_facet(&mut self, facet: usize) -> Result<Facet, TetgenFault> {
        let polygon = self.polygon(facet)?;
        let marker = self.marker()?;
        self.words.skip_line();
        Ok(Facet { polygons: vec![polygon], holes: Vec::new(), marker })
    }

    /// Parses the optional marker of a facet, if facets have one.
    fn marker(&mut self) -> Result<i32, TetgenFault> {
        match self.words.word_here() {
            Some(word) if self.marked => Ok(self.words.as_marker(word, "a facet's marker")?),
            _ => Ok(0),
        }
    }

    /// Parses `<corners> <corner> …`, which may continue on the next line.
    fn polygon(&mut self, facet: usize) -> Result<Vec<u32>, TetgenFault> {
        let count = self.words.count("a polygon's count of corners", 2)?;
        if count == 0 {
            return Err(TetgenFault::EmptyFacet { line: self.words.line(), facet: self.number(facet) });
        }
        let (points, first) = (self.points, self.first);
        let mut polygon = Vec::with_capacity(count);
        for _ in 0..count {
            let index = self.words.integer("a corner of a polygon")?;
            let corner = from_first(index, first, points).ok_or_else(|| {
                let (line, facet) = (self.words.line(), self.number(facet));
                TetgenFault::BadIndex { line, facet, index, points, first }
            })?;
            polygon.push(corner);
        }
        Ok(polygon)
    }
}

/// Parses `<count>`, then `<number> <x> <y> <z>`; the list may be missing at the end of the file.
fn holes(words: &mut Words) -> Result<Vec<Point3>, TextFault> {
    list(words, "the count of holes", Words::point_here)
}

/// Parses `<count>`, then `<number> <x> <y> <z> <attribute> <largest volume>`; the list may be missing. A single number
/// is both attribute and volume, as in Debian's `TetGen` 1.5.
fn regions(words: &mut Words) -> Result<Vec<Region>, TextFault> {
    list(words, "the count of regions", |words| {
        let point = words.point_here()?;
        let attribute = words.finite_here("a region's attribute")?;
        let max_volume = match words.word_here() {
            Some(word) => words.as_finite(word, "a region's largest volume")?,
            None => attribute,
        };
        Ok(Region { point, attribute, max_volume: Some(max_volume).filter(|&volume| volume > 0.0) })
    })
}

fn list<'a, T>(
    words: &mut Words<'a>,
    what: &'static str,
    read: impl Fn(&mut Words<'a>) -> Result<T, TextFault>,
) -> Result<Vec<T>, TextFault> {
    if words.peek().is_none() {
        return Ok(Vec::new());
    }
    // "0 0 0 0\n"
    let count = words.count(what, 8)?;
    words.skip_line();
    let mut items = Vec::with_capacity(count);
    for _ in 0..count {
        words.integer("the number of a hole or region")?;
        items.push(read(words)?);
        words.skip_line();
    }
    Ok(items)
}
