//! Tests of the whole surface stage.

use super::halfedge::HalfEdges;
use super::*;
use anastomesh_mesh::budget::Budget;
use anastomesh_mesh::geometry::{Section, Tube};
use anastomesh_skeleton::FinePlace;
use proptest::prelude::*;

fn tube(a: [f64; 3], b: [f64; 3], ra: f64, rb: f64) -> Tube {
    Tube { a: Point3::from(a), b: Point3::from(b), ra, rb }
}

/// Contours a sign field on an n³ grid with an outside border.
fn contour_signs(n: usize, inside: &[bool]) -> Option<TriMesh> {
    let value = |x: contour::Node| {
        let at = x.map(|c| c - 1);
        let within = at.iter().all(|&c| c >= 0 && (c as usize) < n);
        let index = || at[0] as usize + n * (at[1] as usize + n * at[2] as usize);
        if within && inside[index()] { -1.0 } else { 1.0 }
    };
    let mut seeds = Vec::new();
    let m = n as i32 + 1;
    for x in 0..m {
        for y in 0..m {
            for z in 0..m {
                let c: Vec<bool> =
                    (0..8).map(|c| value([x + (c & 1), y + (c >> 1 & 1), z + (c >> 2 & 1)]) < 0.0).collect();
                if c.iter().any(|&s| s) && !c.iter().all(|&s| s) {
                    seeds.push([x, y, z]);
                }
            }
        }
    }
    (!seeds.is_empty()).then(|| contour::contour(&seeds, usize::MAX, value, &Watch::NOBODY).unwrap().0)
}

fn volume(mesh: &TriMesh) -> f64 {
    mesh.triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.points[v as usize].coords);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum()
}

#[test]
fn all_256_cases_close_to_an_outward_manifold() {
    for mask in 1..256usize {
        let inside: Vec<bool> = (0..8).map(|c| mask >> c & 1 == 1).collect();
        let mesh = contour_signs(2, &inside).unwrap();
        HalfEdges::new(&mesh).unwrap_or_else(|e| panic!("case {mask}: {e:?}"));
        assert!(volume(&mesh) > 0.0, "case {mask}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn every_sign_field_gives_a_closed_manifold(inside in prop::collection::vec(prop::bool::weighted(0.5), 125)) {
        if let Some(mesh) = contour_signs(5, &inside) {
            prop_assert!(HalfEdges::new(&mesh).is_ok());
        }
    }
}

#[test]
fn straight_tube() {
    let t = [tube([0.1, 0.2, 0.3], [8.0, 3.0, 2.0], 1.0, 1.0)];
    for rho in [3.0, 4.0, 5.0] {
        let mesh = vessel_surface(&t, &SurfaceParams::with_voxel(2.0 / rho)).unwrap();
        assert!(HalfEdges::new(&mesh).is_ok());
        assert_eq!(euler_characteristic(&mesh), 2);
        assert!(volume(&mesh) > 0.0);
    }
}

/// Area of the section of a closed surface by a plane.
fn section_area(mesh: &TriMesh, origin: &Point3, axis: &Vec3) -> f64 {
    let mut area = 0.0;
    for t in &mesh.triangles {
        let p = t.map(|v| mesh.points[v as usize]);
        let h = p.map(|p| (p - origin).dot(axis));
        let (mut start, mut end) = (None, None);
        for i in 0..3 {
            let j = (i + 1) % 3;
            if (h[i] < 0.0) != (h[j] < 0.0) {
                let x = p[i] + (p[j] - p[i]) * (h[i] / (h[i] - h[j])) - origin;
                if h[i] < 0.0 { start = Some(x) } else { end = Some(x) }
            }
        }
        if let (Some(a), Some(b)) = (start, end) {
            area += 0.5 * axis.dot(&a.cross(&b));
        }
    }
    area.abs()
}

/// Mean over sections of the relative error of the radius of the circle of equal area.
fn radius_error(mesh: &TriMesh, tube: &Tube, from: f64, to: f64) -> f64 {
    let axis = (tube.b - tube.a).normalize();
    let errors = (0..50).map(|i| {
        let t = (from + (to - from) * f64::from(i) / 49.0) / tube.length();
        (section_area(mesh, &tube.point(t), &axis) / std::f64::consts::PI).sqrt() / tube.radius(t) - 1.0
    });
    errors.sum::<f64>() / 50.0
}

fn smallest_angle(mesh: &TriMesh) -> f64 {
    let cosine = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.points[v as usize]);
        relax::largest_cosine(&a, &b, &c)
    };
    libm::acos(mesh.triangles.iter().map(cosine).fold(0.0, f64::max)).to_degrees()
}

fn check_wall(mesh: &TriMesh) {
    assert!(HalfEdges::new(mesh).is_ok());
    assert_eq!(euler_characteristic(mesh), 2);
    assert!(volume(mesh) > 0.0);
    assert_eq!(anastomesh_mesh::geometry::self_intersections(&mesh.points, &mesh.triangles), []);
    assert!(smallest_angle(mesh) > 20.0, "{}", smallest_angle(mesh));
}

#[test]
fn straight_and_tapering_tubes_have_their_radius() {
    for rho in [3.0, 4.0, 5.0] {
        for (t, limit) in [
            (tube([0.1, 0.2, 0.3], [9.0, 3.0, 2.0], 1.0, 1.0), 0.005),
            (tube([0.1, 0.2, 0.3], [20.0, 3.0, 2.0], 1.0, 3.0), 0.005),
        ] {
            let mesh = vessel_surface(&[t], &SurfaceParams::with_voxel(2.0 / rho)).unwrap();
            check_wall(&mesh);
            let e = radius_error(&mesh, &t, 1.5 * t.ra, t.length() - 1.5 * t.rb);
            assert!(e.abs() < limit, "rho {rho}: {e}");
        }
    }
}

#[test]
fn vertices_lie_within_two_percent_of_the_radius() {
    let t = tube([0.1, 0.2, 0.3], [9.0, 3.0, 2.0], 1.0, 1.0);
    let mesh = vessel_surface(&[t], &SurfaceParams::with_voxel(0.5)).unwrap();
    let axis = (t.b - t.a).normalize();
    let (mut sum, mut count) = (0.0, 0.0);
    for p in &mesh.points {
        let w = p - t.a;
        let s = w.dot(&axis);
        if s > 1.5 && s < t.length() - 1.5 {
            sum += (w - axis * s).norm();
            count += 1.0;
        }
    }
    assert!((sum / count - 1.0f64).abs() < 0.02);
}

#[test]
fn short_pieces_add_up_to_the_tube_they_divide() {
    let whole = tube([0.0; 3], [8.0, 1.0, 0.5], 1.0, 1.3);
    let pieces: Vec<Tube> = (0..80)
        .map(|i| {
            let t = [f64::from(i) / 80.0, f64::from(i + 1) / 80.0];
            Tube { a: whole.point(t[0]), b: whole.point(t[1]), ra: whole.radius(t[0]), rb: whole.radius(t[1]) }
        })
        .collect();
    let (mut one, mut many) = (Field::new(&[whole], 0.4).unwrap(), Field::new(&pieces, 0.4).unwrap());
    for i in 0..40 {
        let t = 0.15 + 0.7 * f64::from(i) / 40.0;
        let p = whole.point(t) + Vec3::new(-0.1, 0.8, 0.0) * whole.radius(t);
        let (a, b) = (one.value(&p), many.value(&p));
        assert!((a - b).abs() < 4e-3, "{a} {b}");
    }
}

#[test]
fn gradients_are_those_of_the_values() {
    let tubes = [tube([0.0; 3], [8.0, 1.0, 0.5], 1.0, 1.6), tube([8.0, 1.0, 0.5], [12.0, 5.0, 0.0], 1.2, 0.9)];
    let mut field = Field::new(&tubes, 0.4).unwrap();
    for i in 0..60 {
        let t = f64::from(i) / 59.0;
        let p = tubes[0].point(1.2 * t - 0.05) + Vec3::new(0.1, 0.7 * libm::sin(9.0 * t), 0.8 * libm::cos(9.0 * t));
        let (value, gradient) = field.value_and_gradient(&p);
        if value > 0.3 && value < 1.5 {
            let h = 1e-4;
            let numeric = Vec3::from_fn(|k, _| {
                let mut e = Vec3::zeros();
                e[k] = h;
                (field.value(&(p + e)) - field.value(&(p - e))) / (2.0 * h)
            });
            assert!((numeric - gradient).norm() < 2e-3 * gradient.norm(), "{numeric} {gradient}");
        }
    }
}

/// Twelve cones that leave one point in the directions of an icosahedron, as the branches of a neuron do.
fn star() -> Vec<Tube> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let signs = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
    let corners = signs.iter().flat_map(|&(s, t)| {
        let (a, b) = (s, t * golden);
        [Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]
    });
    corners.map(|corner| Tube { a: Point3::origin(), b: (corner.normalize() * 9.0).into(), ra: 8.0, rb: 1.5 }).collect()
}

#[test]
fn a_star_is_as_wide_as_its_vessels() {
    let mut field = Field::new(&star(), 0.33).unwrap();
    for way in [Vec3::x(), Vec3::new(1.0, 1.0, 1.0).normalize(), Vec3::new(1.0, 0.2, 0.1).normalize()] {
        let mut range = [0.0, 30.0];
        for _ in 0..50 {
            let middle = 0.5 * (range[0] + range[1]);
            range[usize::from(field.value(&(way * middle).into()) >= 1.0)] = middle;
        }
        assert!((range[0] / 8.0 - 1.0).abs() < 0.06, "{way} {range:?}");
    }
}

#[test]
fn gradients_in_a_star_are_those_of_the_values() {
    let mut field = Field::new(&star(), 0.33).unwrap();
    for i in 0..60 {
        let t = f64::from(i);
        let p = Point3::new(libm::sin(0.7 * t), libm::cos(1.1 * t), libm::sin(0.3 * t)) * (4.0 + 0.07 * t);
        let (value, gradient) = field.value_and_gradient(&p);
        if value > 0.3 && value < 1.5 {
            let h = 1e-4;
            let numeric = Vec3::from_fn(|k, _| {
                let mut e = Vec3::zeros();
                e[k] = h;
                (field.value(&(p + e)) - field.value(&(p - e))) / (2.0 * h)
            });
            assert!((numeric - gradient).norm() < 1e-2 * gradient.norm() + 1e-4, "{numeric} {gradient}");
        }
    }
}

#[test]
fn scale_and_place_do_not_matter() {
    let t = tube([0.1, 0.2, 0.3], [9.0, 3.0, 2.0], 1.0, 1.2);
    let count = |scale: f64| {
        let s = Tube { a: t.a * scale, b: t.b * scale, ra: t.ra * scale, rb: t.rb * scale };
        vessel_surface(&[s], &SurfaceParams::with_voxel(0.5 * scale)).unwrap().triangles.len() as f64
    };
    assert!((count(1e-6) / count(1.0) - 1.0).abs() < 0.02);
    assert!((count(1e6) / count(1.0) - 1.0).abs() < 0.02);
}

#[test]
fn what_cannot_be_made_is_refused() {
    let t = tube([0.0; 3], [8.0, 0.0, 0.0], 1.0, 1.0);
    let far = tube([0.0, 9.0, 0.0], [8.0, 9.0, 0.0], 1.0, 1.0);
    let params = SurfaceParams::with_voxel(0.5);
    assert_eq!(vessel_surface(&[], &params), Err(SurfaceError::Empty));
    let apart = vessel_surface(&[t, far], &params);
    assert_eq!(apart, Err(SurfaceError::Disconnected { components: 2, tubes: [0, 1] }));
    let fine = vessel_surface(&[t], &SurfaceParams { voxel: 1e-5, ..params });
    assert!(matches!(fine, Err(SurfaceError::TooLarge { .. })));
    let bad = Tube { ra: f64::NAN, ..t };
    assert_eq!(vessel_surface(&[t, bad], &params), Err(SurfaceError::InvalidTube { tube: 1 }));
    let zero = vessel_surface(&[t], &SurfaceParams { voxel: 0.0, ..params });
    assert!(matches!(zero, Err(SurfaceError::InvalidParameter { name: "voxel", .. })));
}

fn direction() -> impl Strategy<Value = Vec3> {
    (-1.0..1.0f64, 0.0..std::f64::consts::TAU).prop_map(|(z, a)| {
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * libm::cos(a), r * libm::sin(a), z)
    })
}

/// Middle and mean edge length of each triangle.
fn edges(mesh: &TriMesh) -> Vec<(Point3, f64)> {
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.points[v as usize]);
        (Point3::from((a.coords + b.coords + c.coords) / 3.0), ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0)
    };
    mesh.triangles.iter().map(of).collect()
}

#[test]
fn edges_follow_the_radius() {
    // A vessel with a branch of a third of its radius.
    let tubes = [
        tube([-9.0, 0.0, 0.0], [0.0, 0.0, 0.0], 1.5, 1.5),
        tube([0.0, 0.0, 0.0], [9.0, 0.0, 0.0], 1.5, 1.5),
        tube([0.0, 0.0, 0.0], [0.5, 6.0, 0.0], 0.5, 0.5),
    ];
    let params = SurfaceParams { thin: 0.5, follow: 1.0, ..SurfaceParams::with_voxel(1.0 / 3.0) };
    let wall = vessel_wall(&tubes, &params, &Finer::default(), &Watch::NOBODY).unwrap();
    check_wall(&wall.mesh);
    assert_eq!(wall.sizes.len(), wall.mesh.points.len());
    let all = edges(&wall.mesh);
    let mean = |keep: &dyn Fn(&Point3) -> bool| {
        let kept: Vec<f64> = all.iter().filter(|(p, _)| keep(p)).map(|e| e.1).collect();
        kept.iter().sum::<f64>() / kept.len() as f64
    };
    let (thick, thin) = (mean(&|p| p.x.abs() > 4.0), mean(&|p| p.y > 3.0));
    assert!((2.6..3.6).contains(&(thick / thin)), "{thick} {thin}");
    let as_fine =
        vessel_wall(&tubes, &SurfaceParams { follow: 0.0, ..params }, &Finer::default(), &Watch::NOBODY).unwrap();
    assert!(2 * wall.mesh.triangles.len() < as_fine.mesh.triangles.len());
    // Triangle size changes by less than a factor 1.5 between neighbours.
    let mut sides: Vec<([u32; 2], usize)> = Vec::new();
    for (i, t) in wall.mesh.triangles.iter().enumerate() {
        sides.extend((0..3).map(|k| ([t[k].min(t[(k + 1) % 3]), t[k].max(t[(k + 1) % 3])], i)));
    }
    sides.sort_unstable();
    for pair in sides.chunks_exact(2) {
        let ratio = all[pair[0].1].1 / all[pair[1].1].1;
        assert!((1.0 / 1.5..1.5).contains(&ratio), "{ratio} at {}", all[pair[0].1].0);
    }
}

#[test]
fn edges_at_forks_are_as_short_as_asked_and_on_the_same_wall() {
    let way = |y: f64| Vec3::new(1.0, y, 0.0).normalize();
    let ways = [Vec3::new(-1.0, 0.0, 0.0), way(0.9), way(-0.9)];
    let tubes: Vec<Tube> =
        ways.iter().map(|w| Tube { a: Point3::origin(), b: Point3::from(w * 8.0), ra: 1.0, rb: 1.0 }).collect();
    let ends: Vec<Section> = ways.iter().map(|w| Section::new(Point3::from(w * 4.0), *w, 1.0)).collect();
    let params = SurfaceParams { thin: 1.0, follow: 1.0, ..SurfaceParams::with_voxel(2.0 / 3.0) };
    let mut field = Field::new(&tubes, params.kappa).unwrap();
    let walls = [1.0, 0.5, 0.25].map(|factor| {
        let fork = FinePlace { at: Point3::origin(), within: 1.3, factor };
        let finer = Finer::new(&[fork], ends.clone());
        let wall = vessel_wall(&tubes, &params, &finer, &Watch::NOBODY).unwrap();
        check_wall(&wall.mesh);
        let all = edges(&wall.mesh);
        let mean = |from: f64, to: f64| {
            let kept = all.iter().filter(|(p, _)| (from..to).contains(&p.coords.norm())).map(|e| e.1);
            let kept: Vec<f64> = kept.collect();
            kept.iter().sum::<f64>() / kept.len() as f64
        };
        let off = |p: &Point3, field: &mut Field| (field.value(p) - 1.0).abs();
        let off = wall.mesh.points.iter().map(|p| off(p, &mut field)).fold(0.0, f64::max);
        (factor, mean(0.0, 1.3), mean(4.0, 7.0), off)
    });
    let (_, near, far, off) = walls[0];
    for (factor, finer, same, finer_off) in &walls[1..] {
        assert!((0.85..1.15).contains(&(finer / near / factor)), "{factor}: {finer} of {near}");
        assert!((0.97..1.03).contains(&(same / far)), "{factor}: {same} of {far}");
        assert!(*finer_off <= off, "{factor}: {finer_off} beyond {off}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn bifurcations_have_sound_walls(
        d in prop::array::uniform3(direction()),
        r in prop::array::uniform3(0.6..1.0f64),
        rho in 3.0..5.0f64,
    ) {
        let apart = |i: usize, j: usize| d[i].dot(&d[j]) < 0.85;
        prop_assume!(apart(0, 1) && apart(1, 2) && apart(0, 2));
        let tubes: Vec<Tube> = (0..3)
            .map(|i| Tube { a: Point3::origin(), b: Point3::from(d[i] * 8.0), ra: r[i], rb: r[i] })
            .collect();
        let smallest = r[0].min(r[1]).min(r[2]);
        check_wall(&vessel_surface(&tubes, &SurfaceParams::with_voxel(2.0 * smallest / rho)).unwrap());
    }
}

#[test]
fn a_wall_beyond_its_budget_is_given_up() {
    let t = [tube([0.0; 3], [20.0, 0.0, 0.0], 1.0, 1.0), tube([20.0, 0.0, 0.0], [30.0, 8.0, 0.0], 1.0, 0.7)];
    let params = SurfaceParams::with_voxel(0.2);
    let of = |limit: u64| {
        let budget = Budget::new(limit);
        let wall = vessel_wall(&t, &params, &Finer::default(), &Watch::NOBODY.within(&budget));
        (wall.map(|wall| wall.mesh), budget.spent())
    };
    let (whole, all) = of(u64::MAX);
    assert_eq!(whole, vessel_surface(&t, &params));
    // Every stage notices that the budget is exceeded, and soon.
    for part in 0..20 {
        let limit = all * part / 20;
        let (wall, spent) = of(limit);
        assert!(matches!(wall, Err(SurfaceError::Stopped(_))), "{limit} of {all}");
        assert!(spent <= limit + all / 5, "{spent} for {limit} of {all}");
    }
}

#[test]
fn pieces_that_crowd_are_counted() {
    let pieces = |count: u32| -> Vec<Tube> {
        let x = |i: u32| 10.0 * f64::from(i) / f64::from(count);
        // A staircase, so that pieces are not merged.
        let at = |i: u32| [x(i), 0.05 * f64::from(i % 2), 0.0];
        (0..count).map(|i| tube(at(i), at(i + 1), 1.0, 1.0)).collect()
    };
    let spent = |count: u32| {
        let budget = Budget::new(u64::MAX);
        let watch = Watch::NOBODY.within(&budget);
        vessel_wall(&pieces(count), &SurfaceParams::with_voxel(0.4), &Finer::default(), &watch).unwrap();
        budget.spent()
    };
    let (few, many) = (spent(20), spent(2000));
    assert!(many > 5 * few, "{few} {many}");
}
