use super::*;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::check::check_tets;
use anastomesh_mesh::shapes::sphere_surface;

/// Cylinder of radius 1 and this length along z, with `n` vertices in each of `rings` rings and flat caps 0 and 1.
fn cylinder(length: f64, n: u32, rings: u32) -> (TriMesh, Vec<Option<u32>>) {
    let mut points = Vec::new();
    for ring in 0..rings {
        for i in 0..n {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            points.push(Point3::new(
                libm::cos(angle),
                libm::sin(angle),
                length * f64::from(ring) / f64::from(rings - 1),
            ));
        }
    }
    let (bottom, top) = (points.len() as u32, points.len() as u32 + 1);
    points.extend([Point3::new(0.0, 0.0, 0.0), Point3::new(0.0, 0.0, length)]);
    let (mut triangles, mut caps) = (Vec::new(), Vec::new());
    for i in 0..n {
        let j = (i + 1) % n;
        for ring in 0..rings - 1 {
            let [a, b] = [ring * n + i, ring * n + j];
            triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
            caps.extend([None; 2]);
        }
        let last = (rings - 1) * n;
        triangles.extend([[bottom, j, i], [top, last + i, last + j]]);
        caps.extend([Some(0), Some(1)]);
    }
    (TriMesh { points, triangles }, caps)
}

fn mesh(surface: &TriMesh, made: &Shells) -> TetMesh {
    TetMesh { points: [&surface.points[..], &made.points].concat(), tets: made.tets.clone() }
}

fn volume(mesh: &TetMesh, tets: &[[u32; 4]]) -> f64 {
    let of = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| mesh.points[v as usize]);
        (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0
    };
    tets.iter().map(of).sum()
}

#[test]
fn wall_of_a_tube_has_its_volume_and_flat_rings() {
    let (surface, caps) = cylinder(5.0, 48, 41);
    let count = surface.points.len();
    let shells = [Shell::new(vec![0.2; count]).layers(2), Shell::new(vec![0.3; count]).layers(3).growth(1.5)];
    let made = Shells::around(&surface, &caps, &shells, None, &()).expect("grown");
    assert_eq!(made.thinnest(), None);
    let all = mesh(&surface, &made);
    // Unused points: those inside the caps.
    let faults: Vec<_> = check_tets(&all, None).failed().map(|line| (line.line, line.count)).collect();
    assert_eq!(faults, [(anastomesh_mesh::check::Line::NoUnusedPoints, 2)]);
    for (shell, [inner, outer]) in [[1.0, 1.2], [1.2, 1.5_f64]].into_iter().enumerate() {
        let tets: Vec<[u32; 4]> =
            made.tets.iter().zip(&made.shell_of).filter(|(_, s)| **s == shell as u32).map(|(t, _)| *t).collect();
        let exact = std::f64::consts::PI * 5.0 * (outer * outer - inner * inner);
        assert!((volume(&all, &tets) / exact - 1.0).abs() < 0.005, "{} {exact}", volume(&all, &tets));
    }
    for ring in &made.rings {
        let z = if ring.cap == 0 { 0.0 } else { 5.0 };
        assert!(ring.triangles.iter().flatten().all(|&v| (all.points[v as usize].z - z).abs() < 1e-12));
        let normal: f64 = ring
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| all.points[v as usize]);
                (b - a).cross(&(c - a)).z
            })
            .sum();
        assert!(normal * (z - 2.5) > 0.0);
    }
    assert_eq!(made.rings.len(), 4);
}

#[test]
fn shells_thin_where_spheres_are_close() {
    let ball = sphere_surface(3);
    let n = ball.points.len() as u32;
    let mut pair = ball.clone();
    pair.points.extend(ball.points.iter().map(|p| Point3::new(p.x + 2.1, p.y, p.z)));
    pair.triangles.extend(ball.triangles.iter().map(|t| t.map(|v| v + n)));
    let caps = vec![None; pair.triangles.len()];
    let made = Shells::around(&pair, &caps, &[Shell::new(vec![0.3; pair.points.len()])], None, &()).expect("grown");
    let (at, share) = made.thinnest().expect("thin between the spheres");
    assert!((pair.points[at as usize].x - 1.05).abs() < 0.1 && (0.02..0.3).contains(&share), "{at} {share}");
    let faults: Vec<_> = check_tets(&mesh(&pair, &made), None).failed().map(|line| line.line).collect();
    assert!(faults.is_empty(), "{faults:?}");
    assert!(made.shares.iter().filter(|share| **share == 1.0).count() > made.shares.len() / 2);
}

#[test]
fn invalid_shells_are_refused() {
    let ball = sphere_surface(1);
    let (caps, count) = (vec![None; ball.triangles.len()], ball.points.len());
    let grown = |caps: &[Option<u32>], shell: Shell| Shells::around(&ball, caps, &[shell], None, &());
    assert!(matches!(grown(&caps[1..], Shell::new(vec![0.1; count])), Err(TetError::WrongLength { .. })));
    assert!(matches!(grown(&caps, Shell::new(vec![0.1; 3])), Err(TetError::WrongLength { .. })));
    assert!(matches!(grown(&caps, Shell::new(vec![0.0; count])), Err(TetError::BadSize { .. })));
    assert!(matches!(grown(&caps, Shell::new(vec![0.1; count]).layers(0)), Err(TetError::Layers(_))));
    // The obstacle intersects the ball.
    let shell = [Shell::new(vec![0.1; count])];
    let points = ball.points.iter().map(|p| Point3::new(p.x + 0.5, p.y, p.z)).collect();
    let beside = TriMesh { points, ..ball.clone() };
    let fault = Shells::around(&ball, &caps, &shell, Some(&beside), &());
    assert!(matches!(fault, Err(TetError::Stuck { .. })), "{fault:?}");
}

#[test]
fn a_crumpled_ball_gets_shells() {
    // Radii are random, so the radial directions lead away from all triangles: thin shells are possible everywhere.
    for seed in [0, 3, 5, 9_u64] {
        let mut ball = sphere_surface(3);
        let mut state = seed;
        for p in &mut ball.points {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *p *= 0.15 + (state >> 40) as f64 / f64::from(1 << 24);
        }
        let caps = vec![None; ball.triangles.len()];
        let made = Shells::around(&ball, &caps, &[Shell::new(vec![1.0; ball.points.len()])], None, &());
        let made = made.unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
        let faults: Vec<_> = check_tets(&mesh(&ball, &made), None).failed().map(|line| line.line).collect();
        assert!(faults.is_empty(), "seed {seed}: {faults:?}");
    }
}
