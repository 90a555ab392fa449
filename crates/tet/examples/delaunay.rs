//! Delaunay tetrahedralization of the points of a `.node` file of TetGen's, timed: reading and checking are left out.
//!
//! ```sh
//! RAYON_NUM_THREADS=1 cargo run --release -p anastomesh-tet --example delaunay -- points.node
//! ```

use anastomesh_io::tetgen::read_nodes;
use anastomesh_tet::{Progress, Stage, Tetrahedralizer};
use std::error::Error;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// Start and end of the stage, as wall clock and CPU seconds.
#[derive(Clone, Default)]
struct Times(Arc<Mutex<Vec<Moment>>>);

/// Wall clock, and seconds of work where they are known.
type Moment = (Instant, Option<f64>);

impl Progress for Times {
    fn at(&self, stage: Stage, _: u64, _: u64) {
        if stage == Stage::Delaunay
            && let Ok(mut seen) = self.0.lock()
        {
            seen.push((Instant::now(), user_seconds()));
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which .node file?")?;
    timed(path.as_ref())
}

fn timed(path: &Path) -> Result<(), Box<dyn Error>> {
    let points = read_nodes(path)?.points;
    let times = Times::default();
    let made = Tetrahedralizer::new().progress(times.clone()).delaunay(&points)?;
    println!("{} points, {} tetrahedra", points.len(), made.mesh.tets.len());
    let times = times.0.lock().map_err(|_| "the times are lost")?;
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

#[test]
fn it_runs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.node");
    std::fs::write(&path, "5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n").unwrap();
    timed(&path).unwrap();
}
