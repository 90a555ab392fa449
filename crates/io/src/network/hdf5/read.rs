//! Reader of sections and of SONATA segments.

use super::arrays::{self, List};
use super::error::Hdf5Error;
use crate::network::content::{NetworkFile, NetworkOptions, NodeNames};
use crate::network::polylines::{Polylines, Radii};
use crate::network::radii::Choice;
use anastomesh_mesh::geometry::Point3;
use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use rustc_hash::FxHashMap;

/// Name of the diameters in notes and options.
const DIAMETER: &str = "diameter";

/// Reads a network: sections (`points`, `structure`, `connectivity`), or SONATA's table of segments in `nodes`.
///
/// # Errors
/// The file is damaged, or is not a network.
pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, Hdf5Error> {
    let file = arrays::open(bytes)?;
    let damaged = |error: Error| Hdf5Error::File { reason: error.to_string() };
    let root = file.root_group().map_err(damaged)?;
    if let (Some(points), Some(structure)) = (arrays::reals(&root, "points")?, arrays::wholes(&root, "structure")?) {
        return sections(&points, &structure, arrays::wholes(&root, "connectivity")?, options);
    }
    match segments_of(&root).map_err(damaged)? {
        Some(group) => segments(&group, options),
        None => Err(Hdf5Error::NotANetwork),
    }
}

/// Sections: each begins at an offset in the list of points. `connectivity` has pairs of a section and one that begins at its
/// end.
fn sections(
    points: &List<f64>,
    structure: &List<i64>,
    connectivity: Option<List<i64>>,
    options: &NetworkOptions,
) -> Result<NetworkFile, Hdf5Error> {
    with_columns(points, "points", 4)?;
    with_columns(structure, "structure", 2)?;
    if structure.columns == 3 {
        return Err(Hdf5Error::Cell);
    }
    let offset = |(row, line): (usize, &[i64])| {
        let missing = || missing("structure", row, "point", line[0], points.len());
        usize::try_from(line[0]).ok().filter(|&at| at < points.len()).ok_or_else(missing)
    };
    let starts = structure.rows().enumerate().map(offset).collect::<Result<Vec<usize>, _>>()?;
    let end = |section: usize| starts.get(section + 1).copied().unwrap_or(points.len());
    let mut lines = Lines::default();
    for (section, &start) in starts.iter().enumerate() {
        lines.add(start as u32..end(section).max(start) as u32);
    }
    if let Some(connectivity) = connectivity {
        with_columns(&connectivity, "connectivity", 2)?;
        for (row, line) in connectivity.rows().enumerate() {
            let section = |number: i64| {
                let missing = || missing("connectivity", row, "section", number, starts.len());
                usize::try_from(number).ok().filter(|&section| section < starts.len()).ok_or_else(missing)
            };
            let (parent, child) = (section(line[0])?, section(line[1])?);
            // Cleaning merges points at one place.
            if let (Some(last), first) = (end(parent).checked_sub(1), starts[child]) {
                lines.add([last as u32, first as u32]);
            }
        }
    }
    let places = points.rows().map(|row| Point3::new(row[0], row[1], row[2])).collect();
    let choice = Choice::of(&[DIAMETER.into()], &[], options)?;
    let radii = choice.radii(DIAMETER, points.rows().map(|row| row[3]).collect());
    finished(places, lines, &Radii { nodes: Some(radii), ..Radii::default() }, &choice, NodeNames::Order)
}

/// Group of segments: `nodes/POPULATION/0`.
fn segments_of(root: &Group) -> Result<Option<Group>, Error> {
    let Some(nodes) = child(root, "nodes")? else { return Ok(None) };
    for population in nodes.groups()? {
        if let Some(group) = child(&population, "0")?
            && group.members()?.1.iter().any(|list| list.name() == "start_x")
        {
            return Ok(Some(group));
        }
    }
    Ok(None)
}

fn child(group: &Group, name: &str) -> Result<Option<Group>, Error> {
    Ok(group.groups()?.into_iter().find(|child| child.name() == name))
}

/// Segments with positions, diameters and node ids of both ends. Without ids, ends at one place are one node.
fn segments(group: &Group, options: &NetworkOptions) -> Result<NetworkFile, Hdf5Error> {
    let list = |name: String| {
        let absent = || Hdf5Error::List { list: name.clone(), reason: "the group has no such list".into() };
        arrays::reals(group, &name)?.ok_or_else(absent)
    };
    let ends = ["start", "end"];
    let [places, diameters] = [&["x", "y", "z"][..], &[DIAMETER]].map(|names| {
        let of_end =
            |end| names.iter().map(|name| list(format!("{end}_{name}"))).collect::<Result<Vec<_>, Hdf5Error>>();
        ends.iter().map(of_end).collect::<Result<Vec<_>, _>>()
    });
    let (places, diameters) = (places?, diameters?);
    let ids = ends.map(|end| arrays::wholes(group, &format!("{end}_node")));
    let [starts, stops] = ids;
    let ids = starts?.zip(stops?);
    let count = places[0][0].len();
    let lengths = places.iter().chain(&diameters).flatten().map(List::len);
    let lengths = lengths.chain(ids.iter().flat_map(|(a, b)| [a.len(), b.len()]));
    if let Some(other) = lengths.into_iter().find(|&length| length != count) {
        let expected = format!("the length {count} of 'start_x'");
        return Err(Hdf5Error::Shape { list: "segments".into(), found: vec![other as u64], expected });
    }
    let (mut numbers, mut names, mut points, mut lines) =
        (FxHashMap::default(), Vec::new(), Vec::new(), Lines::default());
    let mut corners = Vec::with_capacity(2 * count);
    for row in 0..count {
        let line = [0, 1].map(|end| {
            let id = ids.as_ref().map_or(2 * row as i64 + end as i64, |(a, b)| [a, b][end].values[row]);
            corners.push(diameters[end][0].values[row]);
            *numbers.entry(id).or_insert_with(|| {
                let [x, y, z] = [0, 1, 2].map(|axis| places[end][axis].values[row]);
                points.push(Point3::new(x, y, z));
                names.push(id);
                points.len() as u32 - 1
            })
        });
        lines.add(line);
    }
    let choice = Choice::of(&[], &[DIAMETER.into()], options)?;
    let corners = choice.radii(DIAMETER, corners);
    let names = if ids.is_some() { NodeNames::Ids(names) } else { NodeNames::Order };
    finished(points, lines, &Radii { corners: Some(corners), ..Radii::default() }, &choice, names)
}

/// Lines of points.
#[derive(Default)]
struct Lines {
    path: Vec<u32>,
    ends: Vec<usize>,
}

impl Lines {
    fn add(&mut self, points: impl IntoIterator<Item = u32>) {
        self.path.extend(points);
        self.ends.push(self.path.len());
    }
}

fn finished(
    points: Vec<Point3>,
    Lines { path, ends }: Lines,
    radii: &Radii,
    choice: &Choice,
    names: NodeNames,
) -> Result<NetworkFile, Hdf5Error> {
    let polylines = Polylines { points, ends, path };
    let mut network = NetworkFile { notes: choice.notes(), names, ..NetworkFile::default() };
    if !polylines.fits(&network.skeleton) {
        return Err(Hdf5Error::TooMany);
    }
    polylines.append_to(&mut network.skeleton, radii);
    if network.skeleton.edges.is_empty() { Err(Hdf5Error::Empty) } else { Ok(network) }
}

fn with_columns<T>(list: &List<T>, name: &str, columns: usize) -> Result<(), Hdf5Error> {
    let found = vec![list.len() as u64, list.columns as u64];
    let expected = format!("{columns} columns");
    if list.columns < columns { Err(Hdf5Error::Shape { list: name.into(), found, expected }) } else { Ok(()) }
}

fn missing(list: &'static str, row: usize, what: &'static str, number: i64, count: usize) -> Hdf5Error {
    Hdf5Error::Missing { list, row, what, number, count }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECTIONS: &[u8] = include_bytes!("../../../../../fixtures/y_sections.h5");
    const SEGMENTS: &[u8] = include_bytes!("../../../../../fixtures/y_segments.h5");

    /// Numbers of nodes and edges, and the radii at the ends of each edge.
    fn of(bytes: &[u8], options: &NetworkOptions) -> (usize, Vec<[f64; 2]>) {
        let network = read(bytes, options).unwrap();
        let (clean, _) = anastomesh_skeleton::clean(&network.skeleton).unwrap();
        (clean.nodes.len(), clean.edges.iter().map(|edge| edge.radii).collect())
    }

    #[test]
    fn sections_and_segments_are_one_network() {
        let options = NetworkOptions::default();
        let (nodes, radii) = of(SECTIONS, &options);
        assert_eq!((nodes, radii.len()), (5, 4));
        assert_eq!(radii[0], [1.5, 1.25]);
        let (nodes, of_segments) = of(SEGMENTS, &options);
        assert_eq!((nodes, &of_segments), (5, &radii));
        let doubled = of(SEGMENTS, &options.clone().diameters(true)).1;
        assert_eq!(doubled[0], [3.0, 2.5]);
        assert_eq!(read(SEGMENTS, &options).unwrap().names.of(anastomesh_skeleton::NodeId(0)), "10");
    }

    #[test]
    fn damaged_files_are_named() {
        let options = NetworkOptions::default();
        for bytes in [SECTIONS, SEGMENTS] {
            for length in (0..bytes.len()).step_by(97) {
                let _ = read(&bytes[..length], &options);
            }
            let mut changed = bytes.to_vec();
            for i in 0..bytes.len() {
                changed[i] ^= 0xff;
                let _ = read(&changed, &options);
                changed[i] ^= 0xff;
            }
        }
        assert!(matches!(read(b"no", &options), Err(Hdf5Error::File { .. })));
        let options = options.radius_array("volume".to_owned());
        assert!(matches!(read(SECTIONS, &options), Err(Hdf5Error::Radius(_))));
    }
}
