//! Delaunay tetrahedralization of the points of a `.node` file of TetGen's, timed: reading and checking are left out.
//!
//! ```sh
//! RAYON_NUM_THREADS=1 cargo run --release --example delaunay -- points.node
//! ```

use anastomesh::io::tetgen::read_nodes;
use anastomesh::tet::{Progress, Stage, Tetrahedralizer};
use std::error::Error;
use std::sync::{Arc, Mutex};
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which .node file?")?;
    let points = read_nodes(path.as_ref())?.points;
    // When the stage began and ended, by the clock and in seconds of work.
    let times = Arc::new(Mutex::new(Vec::new()));
    let seen = Arc::clone(&times);
    let note = move |progress: Progress| {
        if progress.stage == Stage::Delaunay
            && let Ok(mut seen) = seen.lock()
        {
            seen.push((Instant::now(), user_seconds()));
        }
    };
    let made = Tetrahedralizer::new().on_progress(note).delaunay(&points)?;
    println!("{} points, {} tetrahedra", points.len(), made.mesh.tets.len());
    let times = times.lock().map_err(|_| "the times are lost")?;
    if let [(begin, user), .., (end, user_at_end)] = times[..] {
        println!("wall {:.3} s", (end - begin).as_secs_f64());
        if let Some((end, start)) = user_at_end.zip(user) {
            println!("user {:.2} s", end - start);
        }
    }
    Ok(())
}

/// User CPU seconds of this process so far, in hundredths; Linux only.
fn user_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let (_, fields) = stat.rsplit_once(") ")?;
    let ticks: f64 = fields.split(' ').nth(11)?.parse().ok()?;
    Some(ticks / 100.0)
}
