//! Reader of lines with radii, in poly data or an unstructured grid.

use super::error::VtpError;
use crate::network::content::{NetworkFile, NetworkNote, NetworkOptions};
use crate::network::polylines::{Astray, Polylines, Radii, tell_groups};
use crate::network::radii::{Choice, END_RADII, GROUPS, NodeArrayFault, RadiusFault, node_array};
use crate::vtk_xml::{ElementId, VtkXml};
use anastomesh_mesh::geometry::Point3;

/// Reads lines of poly data.
pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, VtpError> {
    read_as(bytes, options, ("PolyData", poly_data_lines))
}

/// Reads lines and polylines of an unstructured grid.
pub(in crate::network) fn read_grid(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, VtpError> {
    read_as(bytes, options, ("UnstructuredGrid", grid_lines))
}

/// Type of a file, and the reader of its lines.
type Kind = (&'static str, fn(&VtkXml, ElementId) -> Result<Lines, VtpError>);

fn read_as(bytes: &[u8], options: &NetworkOptions, (element, lines): Kind) -> Result<NetworkFile, VtpError> {
    let document = VtkXml::parse(bytes, element)?;
    let data = document.child(VtkXml::ROOT, element).ok_or(VtpError::MissingElement { element })?;
    let pieces: Vec<ElementId> = document.children(data, "Piece").collect();
    let &first = pieces.first().ok_or(VtpError::MissingElement { element: "Piece" })?;
    let names = |section: &str| -> Vec<String> {
        let section = document.child(first, section);
        section.map(|s| document.arrays(s).map(|(name, _)| name.to_owned()).collect()).unwrap_or_default()
    };
    let choice = Choice::of(&names("PointData"), &names("CellData"), options)?;
    let mut network = NetworkFile { notes: choice.notes(), ..NetworkFile::default() };
    let mut others = Others::default();
    let values = node_array(&names("PointData"), options)?;
    for piece in pieces {
        if let Some(name) = &values {
            network.node_values.extend(read_node_values(&document, piece, name)?);
        }
        let lines = lines(&document, piece)?;
        read_piece(&document, piece, lines, &choice, &mut network, &mut others)?;
    }
    if others.lines == 0 {
        return Err(VtpError::NoLines { polygons: others.polygons, vertices: others.vertices });
    }
    if others.polygons + others.vertices > 0 {
        network.notes.push(NetworkNote::OtherCells { count: others.polygons + others.vertices });
    }
    tell_groups(&mut network);
    Ok(network)
}

/// Number of cells of each kind.
#[derive(Clone, Copy, Default)]
struct Others {
    lines: usize,
    polygons: usize,
    vertices: usize,
}

/// Lines of a piece among its cells.
struct Lines {
    /// End of each line in the connectivity.
    ends: Vec<usize>,
    connectivity: Vec<i64>,
    /// Cell of each line.
    cells: Vec<usize>,
    counts: Others,
}

impl Lines {
    fn cell_count(&self) -> usize {
        let Others { lines, polygons, vertices } = self.counts;
        lines.saturating_add(polygons).saturating_add(vertices)
    }
}

/// Lines of poly data, which follow the vertex cells.
fn poly_data_lines(document: &VtkXml, piece: ElementId) -> Result<Lines, VtpError> {
    let (ends, connectivity) = read_lines(document, piece)?;
    let vertices = document.count(piece, "NumberOfVerts")?;
    let polygons = document.count(piece, "NumberOfPolys")?.saturating_add(document.count(piece, "NumberOfStrips")?);
    let cells = (0..ends.len()).map(|line| vertices.saturating_add(line)).collect();
    let counts = Others { lines: ends.len(), polygons, vertices };
    Ok(Lines { ends, connectivity, cells, counts })
}

/// VTK's numbers of cell types: vertices, and lines.
const VERTEX_TYPES: [i64; 2] = [1, 2];
const LINE_TYPES: [i64; 2] = [3, 4];

/// Lines of an unstructured grid, among other cells.
fn grid_lines(document: &VtkXml, piece: ElementId) -> Result<Lines, VtpError> {
    let count = document.count(piece, "NumberOfCells")?;
    let (all, connectivity) = read_cells(document, piece, "Cells", count)?;
    let types = read_ints(document, piece, "Cells", "types", count)?;
    let mut lines = Lines { ends: Vec::new(), connectivity: Vec::new(), cells: Vec::new(), counts: Others::default() };
    let mut start = 0;
    for (cell, (end, kind)) in all.into_iter().zip(types).enumerate() {
        if LINE_TYPES.contains(&kind) {
            lines.connectivity.extend(&connectivity[start..end]);
            lines.ends.push(lines.connectivity.len());
            lines.cells.push(cell);
        }
        let of_kind = match kind {
            kind if LINE_TYPES.contains(&kind) => &mut lines.counts.lines,
            kind if VERTEX_TYPES.contains(&kind) => &mut lines.counts.vertices,
            _ => &mut lines.counts.polygons,
        };
        *of_kind += 1;
        start = end;
    }
    Ok(lines)
}

fn read_piece(
    document: &VtkXml,
    piece: ElementId,
    lines: Lines,
    choice: &Choice,
    network: &mut NetworkFile,
    others: &mut Others,
) -> Result<(), VtpError> {
    let points = read_points(document, piece)?;
    let cells = lines.cell_count();
    let Lines { ends, connectivity, cells: of_line, counts } = lines;
    let nodes = read_radii(document, piece, "PointData", (choice, choice.points.as_deref()), points.len())?;
    let of_cells = read_radii(document, piece, "CellData", (choice, choice.cells.as_deref()), cells)?;
    let end_radii = read_end_radii(document, piece, choice, cells)?;
    let count = points.len();
    let astray = |a: Astray| VtpError::UnknownPoint { line: others.lines + a.line, point: a.point, points: count };
    let polylines = Polylines::checked(points, ends, &connectivity).map_err(astray)?;
    if !polylines.fits(&network.skeleton) {
        return Err(VtpError::TooMany);
    }
    let of_lines = of_cells.map(|radii| of_line.iter().map(|&cell| radii[cell]).collect());
    let mut radii = Radii { nodes, lines: of_lines, corners: None };
    if let Some(ends) = end_radii {
        let ends: Vec<[f64; 2]> = of_line.iter().map(|&cell| ends[cell]).collect();
        radii.corners = Some(corner_radii(&polylines, &ends, &radii));
    }
    if let Some(groups) = read_groups(document, piece, cells)? {
        network.groups.resize(network.skeleton.nodes.len(), None);
        let groups: Vec<[i64; 2]> = of_line.iter().map(|&cell| groups[cell]).collect();
        network.groups.extend(polylines.groups(&groups));
    }
    polylines.append_to(&mut network.skeleton, &radii);
    others.lines += counts.lines;
    others.vertices += counts.vertices;
    others.polygons += counts.polygons;
    Ok(())
}

/// Radii along all lines: both end radii if a line has two points, else those of the line or its points.
fn corner_radii(polylines: &Polylines, ends: &[[f64; 2]], radii: &Radii) -> Vec<f64> {
    let mut corners = Vec::with_capacity(polylines.path.len());
    let mut start = 0;
    for (line, &end) in polylines.ends.iter().enumerate() {
        let path = &polylines.path[start..end];
        let of_node = |point: u32| radii.nodes.as_ref().map_or(0.0, |r| r[point as usize]);
        let of_line = radii.lines.as_ref().map(|r| r[line]);
        match path.len() {
            2 => corners.extend(ends[line]),
            _ => corners.extend(path.iter().map(|&p| of_line.unwrap_or_else(|| of_node(p)))),
        }
        start = end;
    }
    corners
}

/// Radii at both ends of each line, as written by this program. `None` if the caller chose another array.
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
    if array.len() != cells.saturating_mul(2) {
        return Err(VtpError::WrongLength {
            array: END_RADII.to_owned(),
            expected: cells.saturating_mul(2),
            found: array.len(),
        });
    }
    Ok(Some(array.into_floats().as_chunks::<2>().0.to_vec()))
}

/// Group and blanking of each cell; `None` unless the piece has both as integers.
fn read_groups(document: &VtkXml, piece: ElementId, cells: usize) -> Result<Option<Vec<[i64; 2]>>, VtpError> {
    let Some(section) = document.child(piece, "CellData") else { return Ok(None) };
    let mut arrays = [Vec::new(), Vec::new()];
    for (name, values) in GROUPS.into_iter().zip(&mut arrays) {
        let Some((_, element)) = document.arrays(section).find(|(n, _)| *n == name) else { return Ok(None) };
        let Some(read) = document.read(element)?.into_ints() else { return Ok(None) };
        if read.len() != cells {
            return Err(VtpError::WrongLength { array: name.to_owned(), expected: cells, found: read.len() });
        }
        *values = read;
    }
    let [groups, blanked] = arrays;
    Ok(Some(groups.into_iter().zip(blanked).map(<[i64; 2]>::from).collect()))
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
    // Some writers omit the attribute; points then have three components.
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

/// End offsets of the lines of poly data, and the connectivity.
fn read_lines(document: &VtkXml, piece: ElementId) -> Result<(Vec<usize>, Vec<i64>), VtpError> {
    let count = document.count(piece, "NumberOfLines")?;
    if count == 0 { Ok(Default::default()) } else { read_cells(document, piece, "Lines", count) }
}

/// End offsets of cells, and their connectivity.
fn read_cells(
    document: &VtkXml,
    piece: ElementId,
    section: &'static str,
    count: usize,
) -> Result<(Vec<usize>, Vec<i64>), VtpError> {
    let connectivity = ints(document, piece, section, "connectivity")?;
    let offsets = read_ints(document, piece, section, "offsets", count)?;
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

/// Integer array of a section, of a given length.
fn read_ints(
    document: &VtkXml,
    piece: ElementId,
    section: &'static str,
    array: &'static str,
    expected: usize,
) -> Result<Vec<i64>, VtpError> {
    let values = ints(document, piece, section, array)?;
    if values.len() != expected {
        return Err(VtpError::WrongLength { array: array.into(), expected, found: values.len() });
    }
    Ok(values)
}

fn ints(document: &VtkXml, piece: ElementId, section: &'static str, array: &'static str) -> Result<Vec<i64>, VtpError> {
    let missing = || VtpError::MissingElement { element: section };
    let found = document.child(piece, section).ok_or_else(missing)?;
    let (_, element) = document.arrays(found).find(|(name, _)| *name == array).ok_or_else(missing)?;
    document.read(element)?.into_ints().ok_or(VtpError::NotIntegers { array })
}

/// Values of an array, one per point.
fn read_node_values(document: &VtkXml, piece: ElementId, name: &str) -> Result<Vec<f64>, VtpError> {
    let expected = document.count(piece, "NumberOfPoints")?;
    let element = document.child(piece, "PointData").and_then(|s| document.arrays(s).find(|(n, _)| *n == name));
    let Some((_, element)) = element else {
        return if expected == 0 { Ok(Vec::new()) } else { Err(VtpError::MissingElement { element: "DataArray" }) };
    };
    let array = document.read(element)?;
    if array.components > 1 {
        let components = array.components;
        return Err(NodeArrayFault::Components { array: name.to_owned(), components }.into());
    }
    if array.len() != expected {
        return Err(VtpError::WrongLength { array: name.to_owned(), expected, found: array.len() });
    }
    Ok(array.into_floats())
}

/// Radii of the chosen array, one per point or cell; `None` if no array was chosen.
fn read_radii(
    document: &VtkXml,
    piece: ElementId,
    section: &'static str,
    (choice, name): (&Choice, Option<&str>),
    expected: usize,
) -> Result<Option<Vec<f64>>, VtpError> {
    let Some(name) = name else { return Ok(None) };
    let element = document.child(piece, section).and_then(|s| document.arrays(s).find(|(n, _)| *n == name));
    let Some((_, element)) = element else {
        return Err(RadiusFault::UnknownArray { wanted: name.to_owned(), available: Vec::new() }.into());
    };
    let array = document.read(element)?;
    if array.len() != expected {
        return Err(VtpError::WrongLength { array: name.to_owned(), expected, found: array.len() });
    }
    Ok(Some(choice.radii(name, array.into_floats())))
}
