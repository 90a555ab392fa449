//! Reader of nodes, segments and joints.

use crate::network::content::{NetworkFile, NetworkNote, NetworkOptions, NodeNames};
use crate::network::polylines::{Polylines, Radii};
use crate::text::{TextFault, Words, shown};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::units::counted;
use rustc_hash::FxHashMap;
use std::f64::consts::PI;

/// Errors of a solver input.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Sv1dError {
    /// A number is missing or invalid.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// Two nodes, segments or lists have an equal name.
    #[error("line {line}: duplicate {what} '{name}': names must differ")]
    Repeated {
        /// Line of the file, from 1.
        line: usize,
        /// Missing or wrong item.
        what: &'static str,
        /// Name in the file.
        name: String,
    },
    /// A reference has no target.
    #[error("line {line}: unknown {what} '{name}': correct it")]
    Unknown {
        /// Line of the file, from 1.
        line: usize,
        /// Missing or wrong item.
        what: &'static str,
        /// Name in the file.
        name: String,
    },
    /// A joint refers to a segment list that is missing or belongs to another joint.
    #[error("line {line}: the segment list '{name}' is missing, or belongs to another joint: correct it")]
    NoList {
        /// Line of the file, from 1.
        line: usize,
        /// Name in the file.
        name: String,
    },
    /// An area is not positive.
    #[error("line {line}: the area {area} is not positive: correct it")]
    BadArea {
        /// Line of the file, from 1.
        line: usize,
        /// Area that was found.
        area: f64,
    },
    /// There are no segments.
    #[error("the file has no SEGMENT ({}): is it the input of a one-dimensional solver?", counted(*nodes, "node"))]
    NoSegments {
        /// Number of nodes.
        nodes: usize,
    },
    /// The number of nodes exceeds the index range.
    #[error("too many nodes for 32-bit indices ({})", u32::MAX)]
    TooMany,
}

/// Vessel between two nodes.
#[derive(Clone, Copy)]
struct Segment {
    ends: [u32; 2],
    radii: [f64; 2],
}

/// Segment list with its line.
struct List {
    line: usize,
    segments: Vec<i64>,
}

#[derive(Default)]
struct Input {
    nodes: FxHashMap<i64, u32>,
    ids: Vec<i64>,
    points: Vec<Point3>,
    segments: Vec<Segment>,
    index: FxHashMap<i64, usize>,
    inlets: FxHashMap<Vec<u8>, List>,
    outlets: FxHashMap<Vec<u8>, List>,
    /// Line, name of the inlet list and name of the outlet list.
    joints: Vec<(usize, Vec<u8>, Vec<u8>)>,
}

pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, Sv1dError> {
    let mut words = Words::new(bytes, true);
    let mut input = Input::default();
    while let Some(word) = words.word() {
        match word.to_ascii_uppercase().as_slice() {
            b"NODE" => input.node(&mut words)?,
            b"SEGMENT" => input.segment(&mut words, options)?,
            b"JOINTINLET" => list(&mut input.inlets, &mut words)?,
            b"JOINTOUTLET" => list(&mut input.outlets, &mut words)?,
            b"JOINT" => {
                let line = words.line();
                words.need_here("the name of a joint")?;
                words.need_here("the node of a joint")?;
                let inlet = words.need_here("the list of segments that end in a joint")?.to_owned();
                let outlet = words.need_here("the list of segments that begin in a joint")?.to_owned();
                input.joints.push((line, inlet, outlet));
            }
            _ => {}
        }
        words.skip_line();
    }
    input.into_network()
}

/// Parses a list: name, number of segments, and the segments.
fn list(lists: &mut FxHashMap<Vec<u8>, List>, words: &mut Words) -> Result<(), Sv1dError> {
    let line = words.line();
    let name = words.need_here("the name of a list of segments")?.to_owned();
    let count = words.count_here("a number of segments", 2)?;
    let mut segments = Vec::with_capacity(count);
    for _ in 0..count {
        let word = words.need_here("a segment")?;
        segments.push(words.as_integer(word, "a segment")?);
    }
    let shown_name = shown(&name);
    match lists.insert(name, List { line, segments }) {
        Some(_) => Err(Sv1dError::Repeated { line, what: "the list", name: shown_name }),
        None => Ok(()),
    }
}

impl Input {
    fn node(&mut self, words: &mut Words) -> Result<(), Sv1dError> {
        let word = words.need_here("the number of a node")?;
        let (id, line) = (words.as_integer(word, "the number of a node")?, words.line());
        let row = self.points.len() as u32;
        if row == u32::MAX {
            return Err(Sv1dError::TooMany);
        }
        if self.nodes.insert(id, row).is_some() {
            return Err(Sv1dError::Repeated { line, what: "node", name: id.to_string() });
        }
        self.ids.push(id);
        self.points.push(words.point_here()?);
        Ok(())
    }

    /// Parses a segment: name, number, length, elements, end nodes, end areas, and non-geometric data.
    fn segment(&mut self, words: &mut Words, options: &NetworkOptions) -> Result<(), Sv1dError> {
        let line = words.line();
        words.need_here("the name of a segment")?;
        let word = words.need_here("the number of a segment")?;
        let id = words.as_integer(word, "the number of a segment")?;
        words.float_here("the length of a segment")?;
        words.float_here("the number of elements of a segment")?;
        let mut ends = [0; 2];
        for end in &mut ends {
            let word = words.need_here("the node at an end of a segment")?;
            let node = words.as_integer(word, "the node at an end of a segment")?;
            let unknown = || Sv1dError::Unknown { line, what: "node", name: node.to_string() };
            *end = *self.nodes.get(&node).ok_or_else(unknown)?;
        }
        let mut radii = [0.0; 2];
        for radius in &mut radii {
            let area = words.float_here("the area at an end of a segment")?;
            if !options.any_radii && (area.is_nan() || area <= 0.0) {
                return Err(Sv1dError::BadArea { line, area });
            }
            *radius = (area / PI).sqrt();
        }
        if self.index.insert(id, self.segments.len()).is_some() {
            return Err(Sv1dError::Repeated { line, what: "segment", name: id.to_string() });
        }
        self.segments.push(Segment { ends, radii });
        Ok(())
    }

    fn into_network(mut self) -> Result<NetworkFile, Sv1dError> {
        if self.segments.is_empty() {
            return Err(Sv1dError::NoSegments { nodes: self.points.len() });
        }
        let bridges = self.bridges()?;
        let mut notes = Vec::new();
        if !bridges.is_empty() {
            notes.push(NetworkNote::Bridged { count: bridges.len() });
        }
        self.segments.extend(bridges);
        let polylines = Polylines {
            points: self.points,
            ends: (1..=self.segments.len()).map(|i| 2 * i).collect(),
            path: self.segments.iter().flat_map(|s| s.ends).collect(),
        };
        let corners = self.segments.iter().flat_map(|s| s.radii).collect();
        let mut network = NetworkFile { notes, names: NodeNames::Ids(self.ids), ..NetworkFile::default() };
        if !polylines.fits(&network.skeleton) {
            return Err(Sv1dError::TooMany);
        }
        polylines.append_to(&mut network.skeleton, &Radii { corners: Some(corners), ..Radii::default() });
        Ok(network)
    }

    /// Short vessels from the end of a joint's first segment to the start of others, if these differ. Each list belongs
    /// to one joint.
    fn bridges(&mut self) -> Result<Vec<Segment>, Sv1dError> {
        let mut bridges = Vec::new();
        for (line, inlet, outlet) in std::mem::take(&mut self.joints) {
            let (ending, beginning) = (self.inlets.remove(&inlet), self.outlets.remove(&outlet));
            let inlets = self.segments_of(ending, &inlet, line)?;
            let outlets = self.segments_of(beginning, &outlet, line)?;
            let Some(&first) = inlets.first() else { continue };
            let here = first.ends[1];
            let others = inlets[1..].iter().map(|s| (s.ends[1], s.radii[1]));
            let away: Vec<(u32, f64)> = others.chain(outlets.iter().map(|s| (s.ends[0], s.radii[0]))).collect();
            bridges.extend(
                away.into_iter()
                    .filter(|(node, _)| *node != here)
                    .map(|(node, radius)| Segment { ends: [here, node], radii: [radius; 2] }),
            );
        }
        Ok(bridges)
    }

    fn segments_of(&self, list: Option<List>, name: &[u8], line: usize) -> Result<Vec<Segment>, Sv1dError> {
        let list = list.ok_or_else(|| Sv1dError::NoList { line, name: shown(name) })?;
        let segment = |id: &i64| {
            let unknown = || Sv1dError::Unknown { line: list.line, what: "segment", name: id.to_string() };
            self.index.get(id).map(|&at| self.segments[at]).ok_or_else(unknown)
        };
        list.segments.iter().map(segment).collect()
    }
}
