use super::*;
use crate::mesh::TriMesh;
use crate::tet::plc::InputKind;
use crate::tet::{carve, certify, fill};

/// Recovers all of a closed surface by this tier alone, carves, certifies.
fn fills(surface: &TriMesh) -> Result<ExactSummary, TetError> {
    let mut points = surface.points.clone();
    points.extend(fill::box_corners(&surface.points));
    let (c, summary) = recover_exact(&points, &surface.triangles, &[])?;
    let carved = carve::carve(&c, surface, InputKind::Closed, &[])?;
    let mesh = carved.into_compact_mesh(surface.points.len());
    certify::certify(&mesh, surface)?;
    Ok(summary)
}

fn read_off(path: &std::path::Path) -> TriMesh {
    let text = std::fs::read_to_string(path).unwrap();
    let mut words = text.split_whitespace().skip(1);
    let mut next = || words.next().unwrap();
    let (n, m): (usize, usize) = (next().parse().unwrap(), next().parse().unwrap());
    next();
    let mut s = TriMesh::default();
    for _ in 0..n {
        let mut x = || next().parse::<f64>().unwrap();
        s.points.push(Point3::new(x(), x(), x()));
    }
    for _ in 0..m {
        next();
        let mut v = || next().parse::<u32>().unwrap();
        s.triangles.push([v(), v(), v()]);
    }
    s
}

/// All surfaces of a folder that have `ONLY` in their name, with times. By hand.
#[test]
#[ignore = "a survey of real surfaces; names in ONLY, folder in SURFACES"]
fn survey() {
    let dir = std::env::var("SURFACES").unwrap();
    let only = std::env::var("ONLY").unwrap_or_default();
    let mut files: Vec<_> = std::fs::read_dir(dir).unwrap().map(|f| f.unwrap().path()).collect();
    files.sort();
    for path in files {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        if path.extension().is_some_and(|e| e == "off") && only.split(',').any(|o| name.contains(o)) {
            let surface = read_off(&path);
            let cpu = || {
                let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
                text.split(' ').next().and_then(|x| x.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
            };
            let start = cpu();
            let result = fills(&surface);
            println!("{name:40} {:7} tris {:8.3} CPU s {result:?}", surface.triangles.len(), cpu() - start);
        }
    }
}
