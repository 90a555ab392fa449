//! VTP: VTK poly data whose lines are vessels.

use super::write::END_RADII;
use super::{NetworkFile, NetworkNote, NetworkOptions};
use crate::geometry::Point3;
use crate::io::vtk_xml::{ElementId, VtkError, VtkXml};
use crate::skeleton::{Edge, Node, NodeId, Skeleton};

/// Why a VTP file is no usable network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtpError {
    /// The file itself is damaged or of another kind.
    #[error(transparent)]
    File(#[from] VtkError),
    /// An element that every VTP file has is missing.
    #[error("there is no <{element}> in the file")]
    MissingElement {
        /// The element.
        element: &'static str,
    },
    /// The points are no triples.
    #[error("the points have {components} coordinates; three are needed")]
    BadPoints {
        /// Number of coordinates of each.
        components: usize,
    },
    /// An array has not as many values as there are points or cells.
    #[error("array '{array}' has {found} values, but the file announces {expected}: was it written completely?")]
    WrongLength {
        /// The array.
        array: String,
        /// How many values it should have.
        expected: usize,
        /// How many it has.
        found: usize,
    },
    /// Connectivity or offsets of the lines are no integers.
    #[error("array '{array}' of the lines holds no integers")]
    NotIntegers {
        /// The array.
        array: &'static str,
    },
    /// The offsets of the lines do not ascend, or go beyond the connectivity.
    #[error(
        "line {line} (from 0) ends at offset {offset}, which is out of order or beyond the {length} indices there are: \
         correct the offsets"
    )]
    BadOffset {
        /// The line.
        line: usize,
        /// Its offset.
        offset: i64,
        /// Number of indices.
        length: usize,
    },
    /// A line names a point that does not exist.
    #[error(
        "line {line} (from 0) names point {point}, but there are only {points} points (from 0): correct the connectivity"
    )]
    UnknownPoint {
        /// The line.
        line: usize,
        /// What it names.
        point: i64,
        /// Number of points.
        points: usize,
    },
    /// There are no lines.
    #[error(
        "there are no lines in the file ({polygons} polygons and strips, {vertices} vertices): a network is needed, lines \
         with a radius, not a surface"
    )]
    NoLines {
        /// Number of polygons and strips.
        polygons: usize,
        /// Number of vertex cells.
        vertices: usize,
    },
    /// No array is known as a radius.
    #[error(
        "no array on points or lines is named like a radius; there are: {}; choose with --radius-array",
        list(available)
    )]
    NoRadius {
        /// Names of the arrays there are.
        available: Vec<String>,
    },
    /// The array that was asked for does not exist.
    #[error("there is no array '{wanted}' on points or lines; there are: {}", list(available))]
    UnknownArray {
        /// What was asked for.
        wanted: String,
        /// Names of the arrays there are.
        available: Vec<String>,
    },
    /// There are more points or edges than can be numbered.
    #[error("there are more points than can be numbered ({})", u32::MAX)]
    TooMany,
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

/// Parses a file.
pub(super) fn parse(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, VtpError> {
    let document = VtkXml::parse(bytes, "PolyData")?;
    let poly = document.child(document.root(), "PolyData").ok_or(VtpError::MissingElement { element: "PolyData" })?;
    let pieces: Vec<ElementId> = document.children(poly, "Piece").collect();
    let &first = pieces.first().ok_or(VtpError::MissingElement { element: "Piece" })?;
    let choice = Choice::of(&document, first, options)?;
    let mut network = NetworkFile { skeleton: Skeleton::default(), notes: choice.notes() };
    let mut others = Others::default();
    for piece in pieces {
        read_piece(&document, piece, &choice, &mut network.skeleton, &mut others)?;
    }
    if others.lines == 0 {
        return Err(VtpError::NoLines { polygons: others.polygons, vertices: others.vertices });
    }
    if others.polygons + others.vertices > 0 {
        network.notes.push(NetworkNote::OtherCells { count: others.polygons + others.vertices });
    }
    Ok(network)
}

/// How many cells of each kind there are.
#[derive(Default)]
struct Others {
    lines: usize,
    polygons: usize,
    vertices: usize,
}

/// Which arrays hold the radius.
struct Choice {
    points: Option<String>,
    cells: Option<String>,
    unused: Vec<String>,
    /// Whether the arrays were found by their names.
    by_name: bool,
}

impl Choice {
    fn of(document: &VtkXml, piece: ElementId, options: &NetworkOptions) -> Result<Self, VtpError> {
        let names = |section: &str| -> Vec<String> {
            let section = document.child(piece, section);
            section.map(|s| document.arrays(s).map(|(name, _)| name.to_owned()).collect()).unwrap_or_default()
        };
        let (points, cells) = (names("PointData"), names("CellData"));
        let available = || points.iter().chain(&cells).cloned().collect();
        if let Some(wanted) = &options.radius_array {
            let choice = Self {
                points: named(&points, wanted),
                cells: named(&cells, wanted),
                unused: Vec::new(),
                by_name: false,
            };
            if choice.points.is_none() && choice.cells.is_none() {
                return Err(VtpError::UnknownArray { wanted: wanted.clone(), available: available() });
            }
            return Ok(choice);
        }
        let choice = Self { points: best(&points), cells: best(&cells), unused: Vec::new(), by_name: true };
        if choice.points.is_none() && choice.cells.is_none() {
            return Err(VtpError::NoRadius { available: available() });
        }
        let used = |n: &String| Some(n) == choice.points.as_ref() || Some(n) == choice.cells.as_ref();
        let unused =
            points.iter().chain(&cells).filter(|n| rank(n).is_some() && !used(n) && *n != END_RADII).cloned().collect();
        Ok(Self { unused, ..choice })
    }

    fn notes(&self) -> Vec<NetworkNote> {
        let mut notes = Vec::new();
        let halved = |array: &String, notes: &mut Vec<_>| {
            if is_diameter(array) {
                notes.push(NetworkNote::Halved { array: array.clone() });
            }
        };
        match &self.points {
            Some(array) => {
                notes.push(NetworkNote::NodeRadii { array: array.clone() });
                halved(array, &mut notes);
            }
            None => notes.push(NetworkNote::NodeRadiiFromEdges),
        }
        if let Some(array) = &self.cells {
            notes.push(NetworkNote::EdgeRadii { array: array.clone() });
            if self.points.as_ref() != Some(array) {
                halved(array, &mut notes);
            }
        }
        if !self.unused.is_empty() {
            notes.push(NetworkNote::NotUsed { arrays: self.unused.clone() });
        }
        notes
    }
}

/// A name as it is compared: lower case, letters and digits only.
fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

fn is_diameter(name: &str) -> bool {
    plain(name).contains("diam")
}

/// How well a name fits a radius: smaller is better.
fn rank(name: &str) -> Option<usize> {
    const KNOWN: [&str; 8] =
        ["radius", "edgeradius", "maximuminscribedsphereradius", "radii", "noderadius", "meanradius", "avgradius", "r"];
    let plain = plain(name);
    if let Some(rank) = KNOWN.iter().position(|&k| k == plain) {
        return Some(rank);
    }
    if plain.contains("radius") || plain.contains("radii") {
        return Some(KNOWN.len());
    }
    plain.contains("diam").then_some(KNOWN.len() + 1)
}

/// The name that fits a radius best; the first among equals.
fn best(names: &[String]) -> Option<String> {
    names.iter().filter_map(|n| rank(n).map(|r| (r, n))).min_by_key(|(r, _)| *r).map(|(_, n)| n.clone())
}

/// The array of this name, or else the first that differs from it only by case.
fn named(names: &[String], wanted: &str) -> Option<String> {
    let exact = names.iter().find(|n| *n == wanted);
    exact.or_else(|| names.iter().find(|n| n.eq_ignore_ascii_case(wanted))).cloned()
}

fn read_piece(
    document: &VtkXml,
    piece: ElementId,
    choice: &Choice,
    skeleton: &mut Skeleton,
    others: &mut Others,
) -> Result<(), VtpError> {
    let points = read_points(document, piece)?;
    let (lines, connectivity) = read_lines(document, piece)?;
    let vertices = document.count(piece, "NumberOfVerts")?;
    let polygons = document.count(piece, "NumberOfPolys")?.saturating_add(document.count(piece, "NumberOfStrips")?);
    let cells = lines.len().saturating_add(vertices).saturating_add(polygons);
    let node_radii = read_radii(document, piece, "PointData", choice.points.as_deref(), points.len())?;
    let cell_radii = read_radii(document, piece, "CellData", choice.cells.as_deref(), cells)?;
    let (base, first_edge) = (skeleton.nodes.len(), skeleton.edges.len());
    if base + points.len() + connectivity.len() >= u32::MAX as usize {
        return Err(VtpError::TooMany);
    }
    for (i, position) in points.iter().enumerate() {
        let radius = node_radii.as_ref().map_or(0.0, |r| r[i]);
        skeleton.nodes.push(Node { position: *position, radius, original: (base + i) as u32 });
    }
    let end_radii = read_end_radii(document, piece, choice, cells)?;
    // Cell data run over vertex cells first, then lines.
    let line_radius = |line: usize| cell_radii.as_ref().map(|r| r[vertices + line]);
    let mut start = 0;
    for (line, &end) in lines.iter().enumerate() {
        let ids = &connectivity[start..end];
        start = end;
        if let Some(&point) = ids.iter().find(|&&p| p < 0 || p >= points.len() as i64) {
            return Err(VtpError::UnknownPoint { line: others.lines + line, point, points: points.len() });
        }
        for pair in ids.windows(2) {
            let nodes = [pair[0], pair[1]].map(|p| NodeId((base as i64 + p) as u32));
            let of_line = end_radii.as_ref().map(|r| r[vertices + line]).filter(|_| ids.len() == 2);
            let radii = match (of_line, line_radius(line)) {
                (Some(radii), _) => radii,
                (None, Some(radius)) => [radius; 2],
                (None, None) => nodes.map(|n| skeleton.node(n).radius),
            };
            skeleton.edges.push(Edge { nodes, radii });
        }
    }
    if node_radii.is_none() {
        node_radii_from_edges(&mut skeleton.nodes[base..], base, &skeleton.edges[first_edge..]);
    }
    others.lines += lines.len();
    others.vertices += vertices;
    others.polygons += polygons;
    Ok(())
}

/// The radii at both ends of each line, which our own files hold beside those of the lines; none when the caller chose
/// another array.
fn read_end_radii(
    document: &VtkXml,
    piece: ElementId,
    choice: &Choice,
    cells: usize,
) -> Result<Option<Vec<[f64; 2]>>, VtpError> {
    if !choice.by_name {
        return Ok(None);
    }
    let arrays = document.child(piece, "CellData").map(|s| document.arrays(s).find(|(n, _)| *n == END_RADII));
    let Some((_, element)) = arrays.flatten() else { return Ok(None) };
    let array = document.read(element)?;
    if array.len() != 2 * cells {
        return Err(VtpError::WrongLength { array: END_RADII.to_owned(), expected: 2 * cells, found: array.len() });
    }
    Ok(Some(array.into_floats().as_chunks::<2>().0.to_vec()))
}

/// Points on no line get any legal radius: cleaning drops them.
fn node_radii_from_edges(nodes: &mut [Node], base: usize, edges: &[Edge]) {
    for edge in edges {
        for (id, radius) in edge.nodes.into_iter().zip(edge.radii) {
            let node = &mut nodes[id.index() - base];
            node.radius = node.radius.max(radius);
        }
    }
    for node in nodes.iter_mut().filter(|n| n.radius <= 0.0) {
        node.radius = 1.0;
    }
}

fn read_points(document: &VtkXml, piece: ElementId) -> Result<Vec<Point3>, VtpError> {
    let missing = VtpError::MissingElement { element: "Points" };
    let count = document.count(piece, "NumberOfPoints")?;
    let Some(section) = document.child(piece, "Points") else {
        return if count == 0 { Ok(Vec::new()) } else { Err(missing) };
    };
    let Some((_, element)) = document.arrays(section).next() else {
        return if count == 0 { Ok(Vec::new()) } else { Err(missing) };
    };
    let array = document.read(element)?;
    // Three is the default for points in some writers that leave the attribute out.
    let stated = document.attribute(element, "NumberOfComponents").is_some();
    if stated && array.components != 3 {
        return Err(VtpError::BadPoints { components: array.components });
    }
    if Some(array.len()) != count.checked_mul(3) {
        return Err(VtpError::WrongLength {
            array: "Points".into(),
            expected: count.saturating_mul(3),
            found: array.len(),
        });
    }
    let values = array.into_floats();
    Ok(values.as_chunks::<3>().0.iter().map(|&p| Point3::from(p)).collect())
}

/// Where each line ends in the connectivity, and the connectivity.
fn read_lines(document: &VtkXml, piece: ElementId) -> Result<(Vec<usize>, Vec<i64>), VtpError> {
    let count = document.count(piece, "NumberOfLines")?;
    let Some(section) = document.child(piece, "Lines").filter(|_| count > 0) else {
        return if count == 0 { Ok(Default::default()) } else { Err(VtpError::MissingElement { element: "Lines" }) };
    };
    let read = |array: &'static str| -> Result<Vec<i64>, VtpError> {
        let found = document.arrays(section).find(|(name, _)| *name == array);
        let (_, element) = found.ok_or(VtpError::MissingElement { element: "Lines" })?;
        document.read(element)?.into_ints().ok_or(VtpError::NotIntegers { array })
    };
    let (connectivity, offsets) = (read("connectivity")?, read("offsets")?);
    if offsets.len() != count {
        return Err(VtpError::WrongLength { array: "offsets".into(), expected: count, found: offsets.len() });
    }
    let mut ends = Vec::with_capacity(offsets.len());
    let mut before = 0;
    for (line, &offset) in offsets.iter().enumerate() {
        if offset < before || offset > connectivity.len() as i64 {
            return Err(VtpError::BadOffset { line, offset, length: connectivity.len() });
        }
        before = offset;
        ends.push(offset as usize);
    }
    Ok((ends, connectivity))
}

/// The radii in the chosen array, one per point or cell; none when no array was chosen.
fn read_radii(
    document: &VtkXml,
    piece: ElementId,
    section: &'static str,
    name: Option<&str>,
    expected: usize,
) -> Result<Option<Vec<f64>>, VtpError> {
    let Some(name) = name else { return Ok(None) };
    let element = document.child(piece, section).and_then(|s| document.arrays(s).find(|(n, _)| *n == name));
    let Some((_, element)) = element else {
        return Err(VtpError::UnknownArray { wanted: name.to_owned(), available: Vec::new() });
    };
    let array = document.read(element)?;
    if array.len() != expected {
        return Err(VtpError::WrongLength { array: name.to_owned(), expected, found: array.len() });
    }
    let mut radii = array.into_floats();
    if is_diameter(name) {
        for radius in &mut radii {
            *radius *= 0.5;
        }
    }
    Ok(Some(radii))
}
