//! Errors of the tetrahedralizer for people: what, where, why, and what to do.

use std::cell::Cell;
use std::fmt::Write as _;

use super::input::Input;
use super::numbers::FileNumbers;
use crate::cli::exit::{Exit, Failure};
use crate::cli::stop::NOTHING_KEPT;
use anastomesh_tet::{InputPart, TetError, parts::Names};

/// The message and exit code for an error; `from` names the input.
pub fn failure(error: &TetError, from: &str, input: &Input) -> Failure {
    if *error == TetError::Cancelled {
        return Failure::stopped(NOTHING_KEPT);
    }
    let asked = Asked { numbers: &input.numbers, triangles: Cell::new(false), points: Cell::new(false) };
    let mut message = format!("{from}: {}", error.clone().renamed(&asked));
    message.push_str(&place(error, input));
    message.push_str(&input.numbers.legend(asked.triangles.get(), asked.points.get()));
    if let Some(remedy) = remedy(error) {
        let _ = write!(message, "; {remedy}");
    }
    Failure { exit: exit(error), message }
}

/// The numbers of the file, and which of them a message has.
struct Asked<'a> {
    numbers: &'a FileNumbers,
    triangles: Cell<bool>,
    points: Cell<bool>,
}

impl Names for Asked<'_> {
    fn point(&self, id: u32) -> u32 {
        self.points.set(true);
        self.numbers.point(id)
    }

    fn triangle(&self, id: u32) -> u32 {
        self.triangles.set(true);
        self.numbers.triangle(id)
    }

    fn seed(&self, index: u32) -> u32 {
        self.numbers.seed(index)
    }
}

/// Where the edge is that a message ends with, or which segments it means.
fn place(error: &TetError, input: &Input) -> String {
    match error {
        TetError::Open { edge, .. }
        | TetError::NotShared { edge, .. }
        | TetError::NotManifold { edge, .. }
        | TetError::NotOriented { edge, .. } => match edge.map(|v| input.plc.surface.points.get(v as usize)) {
            [Some(a), Some(b)] => format!(" from {a} to {b}"),
            _ => String::new(),
        },
        TetError::Outside { part: InputPart::Segments, ids, .. } | TetError::BadSegment { segments: ids, .. } => {
            let ends = ids.iter().filter_map(|&i| input.plc.segments.get(i as usize));
            let ends = ends.map(|[a, b]| format!("{}-{}", input.numbers.point(*a), input.numbers.point(*b)));
            format!(", between the points {}{}", ends.collect::<Vec<_>>().join(", "), input.numbers.legend(false, true))
        }
        _ => String::new(),
    }
}

/// Whose fault it is.
fn exit(error: &TetError) -> Exit {
    match error {
        TetError::BadSize { .. } | TetError::BadBound { .. } | TetError::Layers(_) | TetError::LayersAlong(_) => {
            Exit::Usage
        }
        TetError::NotRecovered { .. } | TetError::NotCertified(_) | TetError::Broken(_) | TetError::TooLarge { .. } => {
            Exit::StageFailed
        }
        _ => Exit::BadInput,
    }
}

/// What to do.
fn remedy(error: &TetError) -> Option<&'static str> {
    Some(match error {
        TetError::Empty { .. } | TetError::Flat => "a volume needs at least four points that do not lie in one plane",
        TetError::OutOfRange { .. } => "scale or shift the input so that its coordinates are of ordinary size",
        TetError::DuplicatePoints { .. } => {
            "join them, or give --repair, which joins points that are equal bit for bit"
        }
        TetError::BadTriangle { .. } => "remove them, or give --repair",
        TetError::DuplicateTriangles { .. } => "--repair mends that",
        TetError::NotShared { .. } => "--repair joins those at the same place",
        TetError::FlatTriangle { .. } => {
            "remove them (collapse an edge, or swap the longest one) in the program that made the surface"
        }
        TetError::Open { .. } => "close the holes there, or give --plc if the facets are only to be kept",
        TetError::NotManifold { .. } => "separate the sheets there, or give --plc if facets may lie inside",
        TetError::NotOriented { .. } | TetError::InsideOut { .. } => {
            "turn the triangles over, or give --repair, which does"
        }
        TetError::SelfIntersection { .. } | TetError::EdgeMeets { .. } => {
            "separate or unite the parts that meet in the program that made the surface"
        }
        TetError::BadSeed { .. } => "move it into the part of space that it stands for",
        TetError::NothingEnclosed => "close the outer surface, or remove the hole that empties it",
        TetError::Outside { .. } => {
            "remove them, or the hole that they lie in, or leave --strict out: then the mesh goes without them"
        }
        TetError::NotSeparating { .. } => "give --repair, which orients shells",
        TetError::NotRecovered { .. } => {
            "the surface is valid as far as was checked: give --split if it may be split, and please report it"
        }
        TetError::NotCertified(_) | TetError::Broken(_) => {
            "this is a fault of the program: please report it with the input and the options"
        }
        _ => return None,
    })
}
