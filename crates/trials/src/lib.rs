//! Trials of the mesher: difficult input and faults, limits of time and memory, two checkers, shrinking and a page of results.

mod case;
mod cli;
mod compact;
mod faults;
mod figures;
mod format;
mod gate;
mod judge;
mod kinds;
mod network;
mod page;
mod process;
mod random;
mod rotate;
mod sections;
mod shrink;
mod state;
mod surface;
mod vector;

pub use cli::program;
