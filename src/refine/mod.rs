//! Floor 3: 3.1 of the paper, improvement of the skeleton before it is meshed.

mod bend;
mod contact;
mod forces;
mod frame;
mod params;
mod push;
mod room;
mod shape;
mod solve;
mod split;

pub use params::{RefineError, RefineParams, Residual};
pub use solve::{Displacement, Sample};
pub use split::{SplitNode, SplitReport, split};

use crate::geometry::Point3;
use crate::skeleton::Skeleton;

/// A refined skeleton.
#[derive(Clone, Debug)]
pub struct Refined {
    /// The skeleton. Nodes keep their `original`.
    pub skeleton: Skeleton,
    /// Where each node was before it moved: after splitting.
    pub origin: Vec<Point3>,
    /// The metrics over the iterations.
    pub history: Vec<Sample>,
    /// How many bends were put in.
    pub bends: usize,
    /// The paper's unit of length in the unit of the skeleton.
    pub unit: f64,
}

/// Refines a skeleton.
///
/// # Errors
/// When a parameter is out of its range, or the skeleton does not satisfy `Skeleton::check`.
pub fn refine(
    skeleton: &Skeleton,
    params: &RefineParams,
    progress: &mut dyn FnMut(usize, Option<(&Sample, &Skeleton)>),
) -> Result<Refined, RefineError> {
    params.check()?;
    skeleton.check()?;
    let (split, _) = split(skeleton);
    let moved = solve::solve(&split, params, progress)?;
    Ok(Refined {
        skeleton: moved.skeleton,
        origin: moved.origin,
        history: moved.history,
        bends: moved.bends,
        unit: moved.unit,
    })
}
