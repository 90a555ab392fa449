//! One-dimensional network flow: vessels are cones with Poiseuille resistance, and nodes conserve the flow.

mod conductors;
mod iterate;
mod orders;
mod poiseuille;

pub use orders::Orders;
pub use poiseuille::{NetworkFlow, solve};
