//! Recovery figures of OFF surfaces: without interior points and without improvement, one line per file.
//!
//! ```sh
//! cargo run --release -p anastomesh-tet --example recovery -- surface.off ...
//! ```
//!
//! Each line has the file, the triangles, the tetrahedra, the Steiner points and the seconds, or the error.

use anastomesh_tet::{InputKind, Interior, Point3, Tetrahedralizer, TriMesh};
use std::error::Error;
use std::time::Instant;

/// Reads the points and triangles of an OFF file.
fn read_off(text: &str) -> Option<TriMesh> {
    let mut words = text.lines().flat_map(|line| line.split('#').next().unwrap_or("").split_whitespace());
    let mut next = || words.next();
    (next()? == "OFF").then_some(())?;
    let (points, triangles): (usize, usize) = (next()?.parse().ok()?, next()?.parse().ok()?);
    next()?;
    let mut mesh = TriMesh::default();
    for _ in 0..points {
        let [x, y, z] = [next()?.parse().ok()?, next()?.parse().ok()?, next()?.parse().ok()?];
        mesh.points.push(Point3::new(x, y, z));
    }
    for _ in 0..triangles {
        (next()? == "3").then_some(())?;
        mesh.triangles.push([next()?.parse().ok()?, next()?.parse().ok()?, next()?.parse().ok()?]);
    }
    Some(mesh)
}

fn main() -> Result<(), Box<dyn Error>> {
    for path in std::env::args().skip(1) {
        let surface = read_off(&std::fs::read_to_string(&path)?).ok_or("not an OFF file of triangles")?;
        let kind = if path.contains("plc_") { InputKind::Plc } else { InputKind::default() };
        let start = Instant::now();
        let tetrahedralizer = Tetrahedralizer::new().kind(kind).interior(Interior::None).optimize(false);
        let made = tetrahedralizer.run(&surface);
        let seconds = start.elapsed().as_secs_f64();
        match made {
            Ok(made) => {
                let steiner = made.mesh.points.len() - surface.points.len();
                let counts = (surface.triangles.len(), made.mesh.tets.len());
                println!("{path} {} {} {steiner} {seconds:.2}", counts.0, counts.1);
            }
            Err(error) => println!("{path} {} error {seconds:.2} {error}", surface.triangles.len()),
        }
    }
    Ok(())
}
