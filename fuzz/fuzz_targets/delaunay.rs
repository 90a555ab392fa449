//! Delaunay tetrahedralization of points that mostly lie on grids: many are cospherical, coplanar, collinear or repeated.
//! The result is a valid Delaunay complex or an error that applies.
#![no_main]

use anastomesh_fuzz::stay_on_this_thread;
use anastomesh_mesh::Point3;
use anastomesh_mesh::geometry::predicates::insphere;
use anastomesh_tet::TetError;
use anastomesh_tet::parts::delaunay;
use libfuzzer_sys::fuzz_target;
use std::collections::HashSet;

fuzz_target!(|bytes: &[u8]| {
    stay_on_this_thread();
    let Some((&mode, rest)) = bytes.split_first() else { return };
    let points = points(mode, rest);
    match delaunay(&points) {
        Ok(complex) => {
            complex.sanity_check().expect("a sound complex");
            let mesh = complex.into_mesh();
            let at = |v: u32| &points[v as usize];
            for &[a, b, c, d] in mesh.tets.iter().take(200) {
                let inside = |e: &&Point3| insphere(at(a), at(b), at(c), at(d), e) > 0.0;
                assert!(points.iter().take(200).find(inside).is_none(), "a point lies in a circumsphere");
            }
        }
        Err(TetError::DuplicatePoints { .. }) => assert!(distinct(&points) < points.len()),
        Err(TetError::Empty { .. } | TetError::Flat) => {}
        Err(TetError::OutOfRange { .. }) => assert!(mode % 5 == 4),
        Err(other) => panic!("{other}"),
    }
});

fn points(mode: u8, bytes: &[u8]) -> Vec<Point3> {
    let mut points: Vec<Point3> = match mode % 5 {
        // A small grid: most are repeated.
        0 => bytes.chunks_exact(1).map(|b| grid(b[0] & 3, (b[0] >> 2) & 3, (b[0] >> 4) & 3)).collect(),
        1 => bytes.chunks_exact(3).map(|b| grid(b[0], b[1], b[2])).collect(),
        // A grid, moved by units in the last place.
        2 => bytes.chunks_exact(4).map(|b| near(grid(b[0] & 7, b[1] & 7, b[2] & 7), b[3])).collect(),
        3 => bytes.chunks_exact(6).map(|b| Point3::new(half(b, 0), half(b, 2), half(b, 4))).collect(),
        _ => bytes.chunks_exact(24).map(|b| Point3::new(double(b, 0), double(b, 8), double(b, 16))).collect(),
    };
    if mode & 128 != 0 {
        let mut seen = HashSet::new();
        points.retain(|p| seen.insert(key(p)));
    }
    points
}

fn grid(x: u8, y: u8, z: u8) -> Point3 {
    Point3::new(f64::from(x), f64::from(y), f64::from(z))
}

fn near(p: Point3, steps: u8) -> Point3 {
    let step = |x: f64, by: u8| f64::from_bits((x + 1.0).to_bits() + u64::from(by & 3));
    Point3::new(step(p.x, steps), step(p.y, steps >> 2), step(p.z, steps >> 4))
}

fn half(b: &[u8], at: usize) -> f64 {
    f64::from(i16::from_le_bytes([b[at], b[at + 1]])) / 256.0
}

fn double(b: &[u8], at: usize) -> f64 {
    f64::from_le_bytes(std::array::from_fn(|i| b[at + i]))
}

fn key(p: &Point3) -> [u64; 3] {
    [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits())
}

fn distinct(points: &[Point3]) -> usize {
    points.iter().map(key).collect::<HashSet<_>>().len()
}
