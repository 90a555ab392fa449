//! Errors of the tetrahedralizer for people: what, where, why, and what to do.

use std::fmt::Write as _;

use super::input::Input;
use crate::cli::exit::{Exit, Failure};
use crate::tet::TetError;

/// Facets that are named.
const NAMED: usize = 10;

/// The message and exit code for an error; `from` names the input.
pub fn failure(error: &TetError, from: &str, input: &Input) -> Failure {
    let mut message = format!("{from}: {error}");
    message.push_str(&facets(error, input));
    if let Some(remedy) = remedy(error) {
        let _ = write!(message, "; {remedy}");
    }
    Failure { exit: exit(error), message }
}

/// Whose fault it is.
fn exit(error: &TetError) -> Exit {
    match error {
        TetError::BadOption { .. } | TetError::Unsupported { .. } => Exit::Usage,
        TetError::NotRecovered { .. }
        | TetError::NotCertified(_)
        | TetError::Broken(_)
        | TetError::Cancelled
        | TetError::TooLarge { .. } => Exit::StageFailed,
        _ => Exit::BadInput,
    }
}

/// The facets that the triangles of a message are part of.
fn facets(error: &TetError, input: &Input) -> String {
    let mut ids: Vec<u32> = triangles(error).iter().filter_map(|&t| input.facet_of.get(t as usize).copied()).collect();
    ids.sort_unstable();
    ids.dedup();
    if ids.is_empty() {
        return String::new();
    }
    let more = if ids.len() > NAMED { ", …" } else { "" };
    let listed: Vec<String> = ids.iter().take(NAMED).map(ToString::to_string).collect();
    format!(" (triangles are numbered as cut from the facets; these are of the facets {}{more})", listed.join(", "))
}

/// The triangles that an error names.
fn triangles(error: &TetError) -> Vec<u32> {
    match error {
        TetError::BadTriangle { triangles, .. }
        | TetError::FlatTriangle { triangles, .. }
        | TetError::DuplicateTriangles { triangles, .. }
        | TetError::Open { triangles, .. }
        | TetError::NotManifold { triangles, .. }
        | TetError::NotOriented { triangles, .. }
        | TetError::NotRecovered { triangles, .. } => triangles.clone(),
        TetError::SelfIntersection { pairs, .. } => pairs.as_flattened().to_vec(),
        TetError::Outside { what: "triangles", ids, .. } => ids.clone(),
        _ => Vec::new(),
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
        TetError::BadTriangle { .. } | TetError::DuplicateTriangles { .. } => "remove them, or give --repair",
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
        TetError::Outside { .. } => "remove them, or the hole that they lie in",
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
