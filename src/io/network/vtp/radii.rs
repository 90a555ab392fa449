//! Which arrays hold the radii, by their names or by the caller's choice.

use super::error::VtpError;
use super::write::END_RADII;
use crate::io::network::content::{NetworkNote, NetworkOptions};
use crate::io::vtk_xml::{ElementId, VtkXml};

/// Which arrays hold the radius.
pub(super) struct Choice {
    pub points: Option<String>,
    pub cells: Option<String>,
    unused: Vec<String>,
    /// Whether the arrays were found by their names.
    pub by_name: bool,
}

impl Choice {
    /// Chooses, by the names of the arrays of the first piece.
    pub(super) fn of(document: &VtkXml, piece: ElementId, options: &NetworkOptions) -> Result<Self, VtpError> {
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

    /// What the caller should know of the choice.
    pub(super) fn notes(&self) -> Vec<NetworkNote> {
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

/// Whether an array holds diameters, by its name.
pub(super) fn is_diameter(name: &str) -> bool {
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
