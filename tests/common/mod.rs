//! What the integration tests share.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub mod oracle;
#[cfg(feature = "cli")]
pub mod program;
pub mod surfaces;

use anastomesh::io::{NetworkOptions, read_network};
use anastomesh::network::{MeshPlan, Meshed, RunError, Skeleton, clean, mesh_network};
use std::path::{Path, PathBuf};

/// The folder of real networks and surfaces beside the checkout, which a user's clone does not have.
///
/// `None`, with a note, when it is absent; a panic instead when `ANASTOMESH_REQUIRE_SHARED` is set, so that a run which
/// ought to have the data cannot pass by skipping.
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

/// A file of the repository's fixtures.
pub fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

/// A network of a file, cleaned.
pub fn network(path: &Path) -> Skeleton {
    let file = read_network(path, &NetworkOptions::default()).unwrap_or_else(|e| panic!("{e}"));
    clean(&file.skeleton).unwrap_or_else(|e| panic!("{}: {e}", path.display())).0
}

/// The mesh of a network; a panic with the list of blocks when one of them fails.
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
