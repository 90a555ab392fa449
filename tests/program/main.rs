//! Tests that run the program.

#[path = "../common/mod.rs"]
mod common;

mod arrays;
mod certificate;
mod check;
mod convert;
mod embed;
mod fidelity;
mod flow;
mod generate;
mod large_networks;
mod manual;
mod mesh;
mod messages;
mod network_files;
mod network_run;
mod order;
mod outputs;
mod parts;
mod refine;
mod regions;
mod render;
mod replay;
mod report;
mod shards;
mod sizes;
mod solvers;
mod stop;
mod surface;
mod terminal;
mod tetrahedralize;
mod tetrahedralize_faults;
mod view;
