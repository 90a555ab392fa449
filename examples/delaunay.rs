//! Delaunay tetrahedralization of the points of a `.node` file of TetGen's, timed: reading is left out.
//!
//! ```sh
//! RAYON_NUM_THREADS=1 cargo run --release --example delaunay -- points.node
//! ```

use anastomesh::io::tetgen::read_nodes;
use anastomesh::tet::delaunay::delaunay;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which .node file?")?;
    let points = read_nodes(path.as_ref())?.points;
    let (wall, user) = (Instant::now(), user_seconds());
    let complex = delaunay(&points)?;
    let (wall, user) = (wall.elapsed().as_secs_f64(), user_seconds().zip(user).map(|(end, start)| end - start));
    let tets = complex.real_tets().count();
    println!("{} points, {tets} tetrahedra", points.len());
    println!("wall {wall:.3} s");
    if let Some(user) = user {
        println!("user {user:.2} s");
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
