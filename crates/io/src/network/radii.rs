//! Selection of radius arrays, by name or by the caller's choice.

use super::content::{NetworkNote, NetworkOptions};

/// Name of the cell array with the radii at both ends of each line.
pub(super) const END_RADII: &str = "EndRadii";

/// Names of VMTK's cell arrays that assign lines to vessels.
pub(super) const GROUPS: [&str; 2] = ["GroupIds", "Blanking"];

/// Reasons for a missing radius array.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RadiusFault {
    /// No array name indicates a radius.
    #[error("{}", no_radius(available))]
    NoRadius {
        /// Names of the existing arrays.
        available: Vec<String>,
    },
    /// The requested array does not exist.
    #[error("the file has no array '{wanted}' on nodes or vessels; arrays: {}", list(available))]
    UnknownArray {
        /// Requested name.
        wanted: String,
        /// Names of the existing arrays.
        available: Vec<String>,
    },
}

/// Reasons for missing node values.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NodeArrayFault {
    /// The array does not exist.
    #[error("the file has no node array '{wanted}'; node arrays: {}", list(available))]
    Unknown {
        /// Requested name.
        wanted: String,
        /// Names of the existing arrays.
        available: Vec<String>,
    },
    /// The array has several components.
    #[error("array '{array}' has {components} components, but 1 is required")]
    Components {
        /// Name of the array.
        array: String,
        /// Number of components.
        components: usize,
    },
}

/// Finds the requested node array among the existing ones; `None` if none was requested.
pub(super) fn node_array(names: &[String], options: &NetworkOptions) -> Result<Option<String>, NodeArrayFault> {
    let Some(wanted) = &options.node_array else { return Ok(None) };
    let unknown = || NodeArrayFault::Unknown { wanted: wanted.clone(), available: names.to_vec() };
    named(names, wanted).map(Some).ok_or_else(unknown)
}

/// Text on a missing radius array.
fn no_radius(available: &[String]) -> String {
    if available.is_empty() {
        "the file has no radius array; add one".into()
    } else {
        format!("no array has the name of a radius; choose one of: {}", list(available))
    }
}

/// Names as a readable list, truncated if too long.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 40;
    let more = if names.len() > SHOWN { format!(" and {} more", names.len() - SHOWN) } else { String::new() };
    let shown: Vec<&str> = names.iter().take(SHOWN).map(String::as_str).collect();
    if names.is_empty() { "none".to_owned() } else { shown.join(", ") + &more }
}

/// Selected radius arrays.
pub(super) struct Choice {
    pub points: Option<String>,
    pub cells: Option<String>,
    unused: Vec<String>,
    /// True if the arrays were detected by their names.
    pub by_name: bool,
    /// True if the caller declares all of them as diameters.
    diameters: bool,
}

impl Choice {
    /// Selects among the point and cell arrays with these names.
    pub(super) fn of(points: &[String], cells: &[String], options: &NetworkOptions) -> Result<Self, RadiusFault> {
        let diameters = options.diameters;
        let available = || points.iter().chain(cells).cloned().collect();
        if let Some(wanted) = &options.radius_array {
            let choice = Self {
                points: named(points, wanted),
                cells: named(cells, wanted),
                unused: Vec::new(),
                by_name: false,
                diameters,
            };
            if choice.points.is_none() && choice.cells.is_none() {
                return Err(RadiusFault::UnknownArray { wanted: wanted.clone(), available: available() });
            }
            return Ok(choice);
        }
        let choice = Self { points: best(points), cells: best(cells), unused: Vec::new(), by_name: true, diameters };
        if choice.points.is_none() && choice.cells.is_none() && options.radius.is_none() {
            return Err(RadiusFault::NoRadius { available: available() });
        }
        let used = |n: &String| Some(n) == choice.points.as_ref() || Some(n) == choice.cells.as_ref();
        let unused =
            points.iter().chain(cells).filter(|n| rank(n).is_some() && !used(n) && *n != END_RADII).cloned().collect();
        Ok(Self { unused, ..choice })
    }

    /// True if the values of an array are halved here: by its name, unless all radii are halved anyway.
    pub(super) fn halves(&self, array: &str) -> bool {
        is_diameter(array) && !self.diameters
    }

    /// Converts the values of an array to radii.
    pub(super) fn radii(&self, array: &str, mut values: Vec<f64>) -> Vec<f64> {
        if self.halves(array) {
            for value in &mut values {
                *value *= 0.5;
            }
        }
        values
    }

    /// Notes on the selection.
    pub(super) fn notes(&self) -> Vec<NetworkNote> {
        if self.points.is_none() && self.cells.is_none() {
            return vec![NetworkNote::NoRadii];
        }
        let mut notes = Vec::new();
        let halved = |array: &String, notes: &mut Vec<_>| {
            if self.halves(array) {
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

/// Normalized name for comparisons: lower case letters and digits only.
pub(super) fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// True if the name indicates diameters.
fn is_diameter(name: &str) -> bool {
    plain(name).contains("diam")
}

/// Rank of a name as radius array: smaller is better.
fn rank(name: &str) -> Option<usize> {
    const KNOWN: [&str; 12] = [
        "radius",
        "edgeradius",
        "maximuminscribedsphereradius",
        "radii",
        "noderadius",
        "meanradius",
        "avgradius",
        "radiusavg",
        "avgradiusavg",
        "rad",
        "r",
        // Amira's name of the distance from the axis to the wall.
        "thickness",
    ];
    let plain = plain(name);
    if let Some(rank) = KNOWN.iter().position(|&k| k == plain) {
        return Some(rank);
    }
    // Standard deviations and errors of radii are not radii.
    if ["std", "stdev", "variance", "error"].iter().any(|end| plain.ends_with(end)) {
        return None;
    }
    if plain.contains("radius") || plain.contains("radii") {
        return Some(KNOWN.len());
    }
    plain.contains("diam").then_some(KNOWN.len() + 1)
}

/// Best ranked name; the first among equals.
fn best(names: &[String]) -> Option<String> {
    names.iter().filter_map(|n| rank(n).map(|r| (r, n))).min_by_key(|(r, _)| *r).map(|(_, n)| n.clone())
}

/// Finds the array with this name, or else the first that differs only in case.
fn named(names: &[String], wanted: &str) -> Option<String> {
    let exact = names.iter().find(|n| *n == wanted);
    exact.or_else(|| names.iter().find(|n| n.eq_ignore_ascii_case(wanted))).cloned()
}
