//! Mutation tests of parts of the workspace.
//!
//! cargo-mutants lists the mutants. All of them are compiled once, and one is chosen when a test runs. The README describes the
//! steps.

mod build;
mod cli;
mod list;
mod parts;
mod rewrite;
mod trial;

pub use cli::program;
