//! Own progress, and a run that is cancelled: first a surface, then a network.
//!
//! ```sh
//! cargo run --release --example progress
//! ```

use anastomesh::Point3;
use anastomesh::io::{NetworkOptions, read_network, read_surface};
use anastomesh::network::{MeshPlan, Observer, RunError, Stage, clean, mesh_network};
use anastomesh::tet::{Plc, TetError, Tetrahedralizer};
use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Prints the stages of a run, and stops it when it has done as much as it may.
struct Limited {
    done: AtomicU64,
    limit: u64,
}

impl Observer for Limited {
    fn begin(&self, stage: Stage, total: u64) {
        println!("{}: {total} units of work", stage.name());
    }

    fn advance(&self, amount: u64) {
        self.done.fetch_add(amount, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.done.load(Ordering::Relaxed) >= self.limit
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");

    // Whoever holds the switch can stop the tetrahedralizer, from any thread. Here its own progress does.
    let stop = Arc::new(AtomicBool::new(false));
    let (seen, asked) = (Arc::clone(&stop), Arc::clone(&stop));
    let tetrahedralizer = Tetrahedralizer::new()
        .on_progress(move |progress| {
            println!("{:?}: {} of {}", progress.stage, progress.done, progress.total);
            if progress.stage == anastomesh::tet::Stage::Recover {
                seen.store(true, Ordering::Relaxed);
            }
        })
        .cancel(move || asked.load(Ordering::Relaxed));
    let torus = Plc::from(read_surface(&fixtures.join("torus.off"))?);
    assert_eq!(tetrahedralizer.run(&torus), Err(TetError::Cancelled));
    // It can be used again: points alone need no recovery.
    stop.store(false, Ordering::Relaxed);
    let corners: Vec<Point3> =
        (0..8).map(|i| Point3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
    assert!(tetrahedralizer.delaunay(&corners).is_ok());

    let file = read_network(&fixtures.join("tree_30.swc"), &NetworkOptions::default())?;
    let (network, _) = clean(&file.skeleton)?;
    let observer = Limited { done: AtomicU64::new(0), limit: 1 };
    match mesh_network(&network, &MeshPlan::default(), &observer) {
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
