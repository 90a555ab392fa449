//! Messages of tetrahedralizer errors, with positions and remedies.

use std::cell::Cell;
use std::fmt::Write as _;

use super::input::Input;
use super::numbers::FileNumbers;
use crate::cli::exit::{Exit, Failure};
use crate::cli::stop::NOTHING_KEPT;
use anastomesh_tet::{InputPart, TetError, parts::Names};

/// Remedy that does not help after a repair.
const OR_REPAIR: &str = ", or give --repair";

/// Message and exit code of an error; `from` names the input, which may have been repaired.
pub fn failure(error: &TetError, from: &str, input: &Input, is_repaired: bool) -> Failure {
    if *error == TetError::Cancelled {
        return Failure::stopped(NOTHING_KEPT);
    }
    let asked = Asked { numbers: &input.numbers, triangles: Cell::new(false), points: Cell::new(false) };
    let mut message = format!("{from}: {}", error.clone().renamed(&asked));
    message.push_str(&place(error, input));
    message.push_str(&input.numbers.legend(asked.triangles.get(), asked.points.get()));
    if let Some(remedy) = remedy(error) {
        let remedy = if is_repaired { remedy.trim_end_matches(OR_REPAIR) } else { remedy };
        let _ = write!(message, "; {remedy}");
    }
    Failure { exit: exit(error), message }
}

/// Numbers of the file, with a record of those that a message uses.
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

/// Position of the edge at the end of a message, or ends of the segments it names.
fn place(error: &TetError, input: &Input) -> String {
    match error {
        TetError::Open(found)
        | TetError::NotShared(found)
        | TetError::NotManifold(found)
        | TetError::NotOriented(found) => match found.edge.map(|v| input.plc.surface.points.get(v as usize)) {
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

/// Exit code of an error.
fn exit(error: &TetError) -> Exit {
    match error {
        TetError::BadSize { .. }
        | TetError::BadGrowth { .. }
        | TetError::BadBound { .. }
        | TetError::Layers(_)
        | TetError::LayersAlong(_) => Exit::Usage,
        TetError::NotRecovered { .. } | TetError::NotCertified(_) | TetError::Broken(_) | TetError::TooLarge { .. } => {
            Exit::StageFailed
        }
        _ => Exit::BadInput,
    }
}

/// Remedy of an error.
fn remedy(error: &TetError) -> Option<&'static str> {
    Some(match error {
        TetError::Empty { .. } | TetError::Flat => "give at least four points that are not coplanar",
        TetError::OutOfRange { .. } => "scale or shift the input",
        TetError::DuplicatePoints { .. } | TetError::NotShared(_) => "merge them, or give --repair",
        TetError::BadTriangle { .. } | TetError::DuplicateTriangles { .. } => "remove them, or give --repair",
        TetError::FlatTriangle { .. } => "remove them in the program that wrote the surface",
        TetError::Open(_) => "close the holes, or give --plc to keep open facets",
        TetError::NotManifold(_) => "separate the sheets, or give --plc to allow interior facets",
        TetError::NotOriented(_) | TetError::InsideOut { .. } => "orient the triangles, or give --repair",
        TetError::SelfIntersection { .. } | TetError::EdgeMeets { .. } => {
            "separate or unite the intersecting parts in the program that wrote the surface"
        }
        TetError::BadSeed { .. } => "move it into its region",
        TetError::NothingEnclosed => "close the outer surface, or remove the hole",
        TetError::Outside { .. } => "remove them or their hole, or omit --strict to ignore them",
        TetError::NotSeparating { .. } => "orient the shells, or give --repair",
        TetError::NotRecovered { .. } => {
            "the surface passed all checks: give --split to allow splitting, and please report it"
        }
        TetError::TooMany { .. } => {
            "give a larger --size, --max-volume or --growth, omit --uniform, or raise --max-tets (100 to 200 bytes each)"
        }
        TetError::NotCertified(_) | TetError::Broken(_) => {
            "internal error: please report it with the input and the options"
        }
        _ => return None,
    })
}
