//! Floor 3: flow through a network in one dimension: each vessel a cone with Poiseuille's resistance, each node a balance.

mod conductors;
mod iterate;
mod orders;
mod poiseuille;

pub use orders::Orders;
pub use poiseuille::{NetworkFlow, solve};
