//! One-dimensional network flow: vessels are cones with Poiseuille resistance, and nodes conserve the flow.

mod between;
mod conductors;
mod conjugate_gradient;
mod orders;
mod poiseuille;

pub use between::solve_between;
pub use conjugate_gradient::NotConverged;
pub use orders::Orders;
pub use poiseuille::{NetworkFlow, resistance, solve, solve_with_resistances};
