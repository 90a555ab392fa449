//! Reads lines with radii.

use super::error::VtpError;
use super::radii::{Choice, is_diameter};
use super::write::END_RADII;
use crate::geometry::Point3;
use crate::io::network::content::{NetworkFile, NetworkNote, NetworkOptions};
use crate::io::vtk_xml::{ElementId, VtkXml};
use crate::skeleton::{Edge, Node, NodeId, Skeleton};

pub(in crate::io::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, VtpError> {
    let document = VtkXml::parse(bytes, "PolyData")?;
    let poly = document.child(VtkXml::ROOT, "PolyData").ok_or(VtpError::MissingElement { element: "PolyData" })?;
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
