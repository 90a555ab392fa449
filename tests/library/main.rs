//! Tests that call the library.

#[path = "../common/mod.rs"]
mod common;

mod damaged_files;
mod flow_of_meshes;
mod kidney_meshes;
mod messages_of_files;
mod nasty_networks;
mod network_flow;
mod partition_networks;
mod prepare;
mod refine_networks;
mod regions;
mod self_intersection_oracle;
mod skeleton_meshes;
mod surface_files;
mod tet_oracles;
mod vessel_fidelity;
