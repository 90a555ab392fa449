use anastomesh::geometry::Point3;
use anastomesh::mesh::{TetMesh, quality::TetQuality};
use anastomesh::tet::{Complex, optimize::*};
use std::time::Instant;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let data = std::fs::read(&args[1]).unwrap();
    let u = |i: usize| u64::from_le_bytes(data[8 * i..8 * i + 8].try_into().unwrap()) as usize;
    let (nv, n, m) = (u(0), u(1), u(2));
    let f = |i: usize| f64::from_le_bytes(data[24 + 8 * i..32 + 8 * i].try_into().unwrap());
    let o = 24 + 24 * n;
    let k = |i: usize| u32::from_le_bytes(data[o + 4 * i..o + 4 * i + 4].try_into().unwrap());
    let mut mesh = TetMesh {
        points: (0..n).map(|i| Point3::new(f(3 * i), f(3 * i + 1), f(3 * i + 2))).collect(),
        tets: (0..m).map(|i| [k(4 * i), k(4 * i + 1), k(4 * i + 2), k(4 * i + 3)]).collect(),
    };
    mesh.tets.retain(|t| {
        let [a, b, c, d] = t.map(|v| mesh.points[v as usize]);
        let r = anastomesh::geometry::predicates::orient3d(&a, &b, &c, &d) > 0.0;
        if !r {
            println!("dropped {t:?}");
        }
        r
    });
    let show = |q: &TetQuality| {
        println!(
            "tets {} mean {:.4} p1 {:.4} min {:.5} dih {:.3}..{:.3} hist {:?}",
            q.tets, q.mean, q.percentile_1, q.min, q.dihedral_min, q.dihedral_max, q.histogram
        )
    };
    show(&TetQuality::of(&mesh));
    let mut options = OptimizeOptions { fixed_points: nv, ..Default::default() };
    for a in &args[2..] {
        let (key, v) = a.split_once('=').unwrap();
        match key {
            "rounds" => options.rounds = v.parse().unwrap(),
            "smooth" => options.smooth_below = v.parse().unwrap(),
            "flip" => options.flip_below = v.parse().unwrap(),
            "stub" => options.stubborn_below = v.parse().unwrap(),
            _ => panic!(),
        }
    }
    let t0 = Instant::now();
    let mut c = Complex::from_mesh(mesh.points.clone(), &mesh.tets).unwrap();
    let t1 = Instant::now();
    let r = optimize_complex(&mut c, &options);
    let dt = t1.elapsed().as_secs_f64();
    c.sanity_check().unwrap();
    let out = c.into_mesh();
    println!("build {:.3} opt {:.3} s, {:.0} tets/s  {r:?}", (t1 - t0).as_secs_f64(), dt, m as f64 / dt);
    show(&TetQuality::of(&out));
}
