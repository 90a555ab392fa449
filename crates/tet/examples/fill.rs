//! Fills a surface and integrates over its tetrahedra: the mean temperature of a body whose temperature grows linearly along x.
//!
//! ```sh
//! cargo run --release -p anastomesh-tet --example fill
//! ```

use anastomesh_tet::{Point3, Refinement, Sizing, TetQuality, Tetrahedralizer, TriMesh, check_tets, repair};
use std::error::Error;

/// A cube whose sides are `n` by `n` squares, each cut in two.
fn cube(n: u32) -> TriMesh {
    let mut soup = TriMesh::default();
    for axis in 0..3 {
        for side in [0, n] {
            for (u, v) in (0..n).flat_map(|u| (0..n).map(move |v| (u, v))) {
                let corner = |u: u32, v: u32| {
                    let mut place = [0.0; 3];
                    place[axis] = f64::from(side);
                    place[(axis + 1) % 3] = f64::from(u);
                    place[(axis + 2) % 3] = f64::from(v);
                    Point3::from(place) / f64::from(n)
                };
                let first = soup.points.len() as u32;
                soup.points.extend([corner(u, v), corner(u + 1, v), corner(u + 1, v + 1), corner(u, v + 1)]);
                let turned = if side == 0 { [[0, 2, 1], [0, 3, 2]] } else { [[0, 1, 2], [0, 2, 3]] };
                soup.triangles.extend(turned.map(|t| t.map(|corner| first + corner)));
            }
        }
    }
    // Each corner occurs in up to six squares; the repair merges the copies.
    repair(&soup).surface
}

fn main() -> Result<(), Box<dyn Error>> {
    let surface = cube(4);
    let made = Tetrahedralizer::new()
        .refine(Refinement::default().max_radius_edge(2.0))
        .sizing(Sizing::Constant(0.25))
        .run(&surface)?;
    // The mesh keeps the surface: the indices of its points and the order of its triangles.
    assert_eq!(made.mesh.points[..surface.points.len()], surface.points);
    assert_eq!(made.faces, surface.triangles);
    assert!(check_tets(&made.mesh, None).failed().next().is_none());

    let (mut volume, mut heat) = (0.0, 0.0);
    for tet in &made.mesh.tets {
        let [a, b, c, d] = tet.map(|v| made.mesh.points[v as usize]);
        let share = (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0;
        let temperature = 20.0 + 10.0 * (a.x + b.x + c.x + d.x) / 4.0;
        volume += share;
        heat += share * temperature;
    }
    let quality = TetQuality::of(&made.mesh);
    println!("{} tetrahedra, mean radius ratio {:.3}", made.mesh.tets.len(), quality.mean);
    println!("mean temperature {:.3}", heat / volume);
    assert!((volume - 1.0).abs() < 1e-12 && (heat / volume - 25.0).abs() < 1e-9);
    Ok(())
}

#[test]
fn it_runs() {
    main().unwrap();
}
