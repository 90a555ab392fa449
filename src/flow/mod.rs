//! Floor 3: flow through a network in one dimension: each vessel a cone with Poiseuille's resistance, each node a balance.

mod conductors;
mod conjugate_gradient;
mod orders;
mod poiseuille;

pub use conjugate_gradient::NotConverged;
pub use orders::Orders;
pub use poiseuille::{NetworkFlow, solve};
