//! Own progress, and a run that is cancelled: first a surface, then a network.
//!
//! ```sh
//! cargo run --release --example progress
//! ```

use anastomesh::io::{NetworkOptions, read_network, read_surface};
use anastomesh::meshing::{MeshPlan, RunError, mesh_network};
use anastomesh::network::clean;
use anastomesh::tet::{TetError, Tetrahedralizer};
use anastomesh::{Point3, Progress, Stage};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Prints the stages of a run, and stops it when it has done some of one of them. Whoever holds the switch can stop it, too,
/// from any thread.
struct Until {
    stage: Stage,
    stop: Arc<AtomicBool>,
}

impl Progress for Until {
    fn at(&self, stage: Stage, done: u64, total: u64) {
        println!("{}: {done} of {total}", stage.name());
        if stage == self.stage && done > 0 {
            self.stop.store(true, Ordering::Relaxed);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");

    let stop = Arc::new(AtomicBool::new(false));
    let tetrahedralizer = Tetrahedralizer::new().progress(Until { stage: Stage::Recover, stop: Arc::clone(&stop) });
    let torus = read_surface(&fixtures.join("torus.off"))?;
    assert_eq!(tetrahedralizer.run(&torus), Err(TetError::Cancelled));
    // It can be used again: points alone need no recovery.
    stop.store(false, Ordering::Relaxed);
    let corners: Vec<Point3> =
        (0..8).map(|i| Point3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
    assert!(tetrahedralizer.delaunay(&corners).is_ok());

    let file = read_network(&fixtures.join("tree_30.swc"), &NetworkOptions::default())?;
    let (network, _) = clean(&file.skeleton)?;
    stop.store(false, Ordering::Relaxed);
    match mesh_network(&network, &MeshPlan::default(), &Until { stage: Stage::Blocks, stop }) {
        Err(RunError::Cancelled) => println!("stopped when the first block was done"),
        Ok(_) => return Err("it was to be stopped".into()),
        Err(error) => return Err(error.into()),
    }
    Ok(())
}

#[test]
fn it_runs() {
    main().unwrap();
}
