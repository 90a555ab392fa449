//! Piecewise linear complexes: points, facets, holes, regions.

use super::super::text::{TextFault, Words};
use super::node::Nodes;
use super::{TetgenFault, node};
use crate::geometry::Point3;

/// A format of files with a piecewise linear complex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PlcFormat {
    /// `.poly`: a facet is a list of polygons and holes.
    Poly,
    /// `.smesh`: a facet is one polygon in one line.
    Smesh,
}

/// A piecewise linear complex, as it stands in its file: nothing is checked but that its numbers are numbers and its
/// corners exist.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plc {
    /// Positions.
    pub points: Vec<Point3>,
    /// Boundary marker of each point; empty when the file has none.
    pub point_markers: Vec<i32>,
    /// Attributes of all points, those of one after those of another.
    pub point_attributes: Vec<f64>,
    /// How many attributes a point has.
    pub attribute_count: usize,
    /// Flat pieces of the boundary, outer or inner.
    pub facets: Vec<Facet>,
    /// A point in each part of space that is not to be meshed.
    pub holes: Vec<Point3>,
    /// Parts of the volume with an attribute of their own.
    pub regions: Vec<Region>,
    /// Whether the points stand in the `.node` file beside it.
    pub points_beside: bool,
    /// Number of the first point in the file, 0 or 1. Indices here run from 0 in any case.
    pub first: u32,
}

/// A flat piece of the boundary: the area that its polygons enclose, without its holes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facet {
    /// Indices of points around each polygon. A polygon of two is a segment, of one an isolated point in the facet.
    pub polygons: Vec<Vec<u32>>,
    /// A point in (or above) each hole of the facet.
    pub holes: Vec<Point3>,
    /// Boundary marker; 0 when the file has none.
    pub marker: i32,
}

/// The part of the volume around a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// A point in it.
    pub point: Point3,
    /// What its tetrahedra are labelled with.
    pub attribute: f64,
    /// Bound on the volume of its tetrahedra; none when it is not positive. A line with one number says the same with
    /// it as attribute and as bound.
    pub max_volume: Option<f64>,
}

impl Plc {
    /// Parses the bytes of a file that has its points in it.
    ///
    /// # Errors
    /// When the bytes are no such file, or it is incomplete, or without points.
    pub fn parse(bytes: &[u8], format: PlcFormat) -> Result<Self, TetgenFault> {
        let mut words = Words::new(bytes, true);
        let nodes = node::parse(&mut words)?;
        parse(&mut words, nodes, format)
    }
}

/// Parses what follows the points.
pub(super) fn parse(words: &mut Words, nodes: Nodes, format: PlcFormat) -> Result<Plc, TetgenFault> {
    if nodes.points.is_empty() {
        return Err(TetgenFault::NoPoints);
    }
    let Nodes { points, attributes, attribute_count, markers, first } = nodes;
    let mut plc = Plc { points, point_markers: markers, first, ..Plc::default() };
    (plc.point_attributes, plc.attribute_count) = (attributes, attribute_count);
    // "1 0\n"
    let count = words.count("the count of facets", 4)?;
    let marked = match words.word_here() {
        Some(word) => words.as_integer(word, "the number of facet markers (0 or 1)")? != 0,
        None => false,
    };
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
    /// The number of a facet in the file: they count as points do.
    fn number(&self, facet: usize) -> usize {
        facet + self.first as usize
    }

    /// `<polygons> [holes] [marker]`, then the polygons, then the holes.
    fn poly_facet(&mut self, facet: usize) -> Result<Facet, TetgenFault> {
        let words = &mut *self.words;
        // "1 0\n", "0 0 0 0\n"
        let polygons = words.count("a facet's count of polygons", 4)?;
        let line = words.line();
        let holes = match words.word_here() {
            Some(word) => words.as_count(word, "a facet's count of holes", 8)?,
            None => 0,
        };
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

    /// `<corners> <corner> … [marker]`.
    fn smesh_facet(&mut self, facet: usize) -> Result<Facet, TetgenFault> {
        let polygon = self.polygon(facet)?;
        let marker = self.marker()?;
        self.words.skip_line();
        Ok(Facet { polygons: vec![polygon], holes: Vec::new(), marker })
    }

    /// The marker of a facet, where facets have one; it may be left out.
    fn marker(&mut self) -> Result<i32, TetgenFault> {
        match self.words.word_here() {
            Some(word) if self.marked => Ok(self.words.as_marker(word, "a facet's marker")?),
            _ => Ok(0),
        }
    }

    /// `<corners> <corner> …`; long ones may go on in the next line.
    fn polygon(&mut self, facet: usize) -> Result<Vec<u32>, TetgenFault> {
        let count = self.words.count("a polygon's count of corners", 2)?;
        if count == 0 {
            return Err(TetgenFault::EmptyFacet { line: self.words.line(), facet: self.number(facet) });
        }
        let (points, first) = (self.points, self.first);
        let mut polygon = Vec::with_capacity(count);
        for _ in 0..count {
            let index = self.words.integer("a corner of a polygon")?;
            let from_zero = index.checked_sub(first.into()).and_then(|i| usize::try_from(i).ok());
            match from_zero {
                Some(i) if i < points => polygon.push(i as u32),
                _ => {
                    let (line, facet) = (self.words.line(), self.number(facet));
                    return Err(TetgenFault::BadIndex { line, facet, index, points, first });
                }
            }
        }
        Ok(polygon)
    }
}

/// `<count>`, then `<number> <x> <y> <z>`; the list may be missing at the end of the file.
fn holes(words: &mut Words) -> Result<Vec<Point3>, TextFault> {
    list(words, "the count of holes", Words::point_here)
}

/// `<count>`, then `<number> <x> <y> <z> <attribute> <largest volume>`; the list may be missing. Where only one number
/// stands it is both: so does Debian's `TetGen` 1.5.
fn regions(words: &mut Words) -> Result<Vec<Region>, TextFault> {
    list(words, "the count of regions", |words| {
        let point = words.point_here()?;
        let word = words.need_here("a region's attribute")?;
        let attribute = words.as_finite(word, "a region's attribute")?;
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
