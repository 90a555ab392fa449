//! Anastomesh turns the skeleton of a vascular network (a graph: node = point with a radius, edge = vessel) into one
//! tetrahedral volume mesh with a labelled boundary.
//!
//! The rooms and their floors are described in `ARCHITECTURE.md`; a room imports only from floors below it, which
//! `tests/layering.rs` holds.

pub mod block;
#[cfg(feature = "cli")]
pub mod cli;
pub mod geometry;
pub mod grow;
pub mod io;
pub mod mesh;
pub mod partition;
pub mod pipeline;
pub mod prepare;
pub mod refine;
pub mod report;
pub mod skeleton;
pub mod stitch;
pub mod surface;
pub mod tet;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
