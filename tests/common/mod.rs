//! What the integration tests share.
#![allow(dead_code, reason = "each test binary uses its own part")]

use std::path::PathBuf;

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
