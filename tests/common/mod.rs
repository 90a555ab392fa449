//! Shared parts of the integration tests.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub mod oracle;
#[cfg(feature = "cli")]
pub mod program;
pub mod surfaces;

use anastomesh::io::{NetworkOptions, read_network};
use anastomesh::meshing::{MeshPlan, Meshed, RunError, mesh_network};
use anastomesh::network::{Skeleton, clean};
use std::path::{Path, PathBuf};

/// Folder of real networks and surfaces beside the checkout, which a user's clone does not have.
///
/// Returns `None` with a note if it is missing. Panics instead if `ANASTOMESH_REQUIRE_SHARED` is set, so that a run
/// with required data cannot pass by skipping.
pub fn shared() -> Option<PathBuf> {
    let dir = std::env::var_os("ANASTOMESH_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    if dir.join("data").is_dir() {
        return Some(dir);
    }
    assert!(std::env::var_os("ANASTOMESH_REQUIRE_SHARED").is_none(), "no data at {}", dir.display());
    eprintln!("skipped: no data at {}", dir.display());
    None
}

/// File of the repository's fixtures.
pub fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

/// Cleaned network of a file.
pub fn network(path: &Path) -> Skeleton {
    let file = read_network(path, &NetworkOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    clean(&file.skeleton).unwrap_or_else(|e| panic!("{}: {e}", path.display())).0
}

/// Mesh of a network; panics with a list of the failed blocks.
pub fn mesh(network: &Skeleton, rho: f64) -> Meshed {
    let mut plan = MeshPlan::default();
    plan.rho = rho;
    mesh_by(network, &plan)
}

pub fn mesh_by(network: &Skeleton, plan: &MeshPlan) -> Meshed {
    match mesh_network(network, plan, &()) {
        Ok(meshed) => meshed,
        Err(RunError::BlocksFailed(report)) => panic!("blocks failed\n{report}"),
        Err(error) => panic!("{error}"),
    }
}
