//! Floor 3: 3.1 of the paper, improvement of the skeleton before it is meshed.

mod split;

pub use split::{SplitNode, SplitReport, split};
