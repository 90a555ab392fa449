//! (room under construction)

pub mod cap;
