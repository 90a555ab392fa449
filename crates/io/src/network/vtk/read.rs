//! Extraction of lines and radii from the sections of a legacy file.

use super::array::Array;
use super::error::VtkLegacyError;
use super::sections::{CellList, LISTS, Sections};
use crate::network::content::{NetworkFile, NetworkNote, NetworkOptions};
use crate::network::polylines::{Polylines, Radii, tell_groups};
use crate::network::radii::{Choice, GROUPS, node_array};
use anastomesh_mesh::geometry::Point3;

/// Cell types of lines.
const LINE_TYPES: [i64; 2] = [3, 4];

pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, VtkLegacyError> {
    let sections = Sections::of(bytes)?;
    let points = sections.points.as_ref().ok_or(VtkLegacyError::MissingSection { section: "POINTS" })?.floats()?;
    let points: Vec<Point3> = points.as_chunks::<3>().0.iter().map(|&p| Point3::from(p)).collect();
    let cells = Lines::of(&sections)?;
    if cells.ends.is_empty() {
        return Err(VtkLegacyError::NoLines { others: cells.count });
    }
    let (count, all) = (points.len(), cells.count);
    let names = |arrays: &[Array]| -> Vec<String> { arrays.iter().map(|a| a.name.clone()).collect() };
    let choice = Choice::of(&names(&sections.point_data), &names(&sections.cell_data), options)?;
    let values = node_array(&names(&sections.point_data), options)?;
    let nodes = radii(&choice, &sections.point_data, choice.points.as_deref(), count)?;
    let of_cells = radii(&choice, &sections.cell_data, choice.cells.as_deref(), all)?;
    let lines = of_cells.map(|r| cells.index.iter().map(|&cell| r[cell]).collect());
    let polylines = Polylines::checked(points, cells.ends, &cells.path).map_err(|a| VtkLegacyError::UnknownPoint {
        line: cells.index[a.line],
        point: a.point,
        points: count,
    })?;
    let mut network = NetworkFile { notes: choice.notes(), ..NetworkFile::default() };
    if !polylines.fits(&network.skeleton) {
        return Err(VtkLegacyError::TooMany);
    }
    let others = all - polylines.ends.len();
    if others > 0 {
        network.notes.push(NetworkNote::OtherCells { count: others });
    }
    if let Some(groups) = groups(&sections.cell_data, all)? {
        let of_lines: Vec<[i64; 2]> = cells.index.iter().map(|&cell| groups[cell]).collect();
        network.groups = polylines.groups(&of_lines);
        tell_groups(&mut network);
    }
    if let Some(values) = values.and_then(|name| sections.point_data.iter().find(|a| a.name == name)) {
        network.node_values = numbers(values, count)?;
    }
    polylines.append_to(&mut network.skeleton, &Radii { nodes, lines, corners: None });
    Ok(network)
}

/// Values of the chosen array, one per point or cell; `None` if no array was chosen.
fn radii(
    choice: &Choice,
    arrays: &[Array],
    name: Option<&str>,
    expected: usize,
) -> Result<Option<Vec<f64>>, VtkLegacyError> {
    let Some(array) = name.and_then(|name| arrays.iter().find(|a| a.name == name)) else { return Ok(None) };
    Ok(Some(choice.radii(&array.name, numbers(array, expected)?)))
}

/// Values of an array with the expected length.
fn numbers(array: &Array, expected: usize) -> Result<Vec<f64>, VtkLegacyError> {
    if array.count != expected {
        return Err(VtkLegacyError::WrongLength { array: array.name.clone(), expected, found: array.count });
    }
    array.floats()
}

/// Group and blanking of each cell; `None` unless the file has both as integers.
fn groups(arrays: &[Array], expected: usize) -> Result<Option<Vec<[i64; 2]>>, VtkLegacyError> {
    let find = |name| arrays.iter().find(|a: &&Array| a.name == name);
    let [Some(groups), Some(blanked)] = GROUPS.map(find) else { return Ok(None) };
    for array in [groups, blanked] {
        if array.count != expected {
            return Err(VtkLegacyError::WrongLength { array: array.name.clone(), expected, found: array.count });
        }
    }
    let (Ok(groups), Ok(blanked)) = (groups.integers(), blanked.integers()) else { return Ok(None) };
    Ok(Some(groups.into_iter().zip(blanked).map(<[i64; 2]>::from).collect()))
}

/// Line cells.
#[derive(Default)]
struct Lines {
    ends: Vec<usize>,
    path: Vec<i64>,
    /// Index of each line among all cells.
    index: Vec<usize>,
    /// Number of all cells.
    count: usize,
}

impl Lines {
    fn of(sections: &Sections) -> Result<Self, VtkLegacyError> {
        let mut lines = Self::default();
        let types = sections.types.as_ref().map(Array::integers).transpose()?;
        for keyword in LISTS.into_iter().filter(|&k| (k == "CELLS") == sections.grid) {
            for list in sections.lists.iter().filter(|list| list.keyword == keyword) {
                let taken = |cell: usize| match keyword {
                    "CELLS" => types.as_ref().and_then(|t| t.get(cell)).is_some_and(|t| LINE_TYPES.contains(t)),
                    _ => keyword == "LINES",
                };
                lines.add(list, taken)?;
            }
        }
        Ok(lines)
    }

    /// Adds the line cells of a list.
    fn add(&mut self, list: &CellList, taken: impl Fn(usize) -> bool) -> Result<(), VtkLegacyError> {
        let points = list.points.integers()?;
        let offsets = list.offsets.as_ref().map(Array::integers).transpose()?;
        let mut at = 0;
        let mut cell = 0;
        while cell < list.count {
            let bad = || VtkLegacyError::BadCells { place: list.place, list: list.keyword, cell };
            let range = if let Some(offsets) = &offsets {
                offsets[cell]..offsets[cell + 1]
            } else {
                let &length = points.get(at).ok_or_else(bad)?;
                let begin = at as i64 + 1;
                begin..begin.checked_add(length).ok_or_else(bad)?
            };
            let range = usize::try_from(range.start).ok().zip(usize::try_from(range.end).ok()).ok_or_else(bad)?;
            let ids = points.get(range.0..range.1).ok_or_else(bad)?;
            at = range.1;
            if taken(cell) {
                self.path.extend_from_slice(ids);
                self.ends.push(self.path.len());
                self.index.push(self.count + cell);
            }
            cell += 1;
        }
        self.count += list.count;
        Ok(())
    }
}
