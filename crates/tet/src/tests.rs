use super::complex::Complex;
use super::error::{EdgeFaults, Obstacle, Stuck};
use super::progress::Watch;
use super::*;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::TetQuality;
use anastomesh_mesh::shapes::{sphere_surface, torus_surface};
use proptest::prelude::*;

/// A tube of radius 1 along z with flat caps: `n` points around, `rings` rings. Caps are fans from a centre or, without
/// one, a strip of their ring alone (exactly coplanar and nearly cocircular).
pub(super) fn tube(n: u32, rings: u32, length: f64, centre: bool, direction: Vec3) -> TriMesh {
    let w = direction.normalize();
    let u = w.cross(&if w.x.abs() < 0.9 { Vec3::x() } else { Vec3::y() }).normalize();
    let v = w.cross(&u);
    let mut s = TriMesh::default();
    for r in 0..rings {
        for i in 0..n {
            let angle = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            let z = length * f64::from(r) / f64::from(rings - 1);
            s.points.push(Point3::from(u * libm::cos(angle) + v * libm::sin(angle) + w * z));
        }
    }
    let at = |r: u32, i: u32| r * n + i % n;
    for r in 0..rings - 1 {
        for i in 0..n {
            s.triangles.push([at(r, i), at(r, i + 1), at(r + 1, i + 1)]);
            s.triangles.push([at(r, i), at(r + 1, i + 1), at(r + 1, i)]);
        }
    }
    if centre {
        s.points.push(Point3::origin());
        s.points.push(Point3::from(w * length));
        let (low, high) = (n * rings, n * rings + 1);
        for i in 0..n {
            s.triangles.push([low, at(0, i + 1), at(0, i)]);
            s.triangles.push([high, at(rings - 1, i), at(rings - 1, i + 1)]);
        }
    } else {
        for i in 1..n - 1 {
            s.triangles.push([at(0, 0), at(0, i + 1), at(0, i)]);
            s.triangles.push([at(rings - 1, 0), at(rings - 1, i), at(rings - 1, i + 1)]);
        }
    }
    s
}

pub(super) fn cube(n: u32) -> TriMesh {
    // Faces of an n-grid; all diagonals have one direction, so neither Delaunay tie is favoured.
    let mut s = TriMesh::default();
    let mut id = std::collections::BTreeMap::new();
    let mut vertex = |p: [u32; 3], s: &mut TriMesh| {
        *id.entry(p).or_insert_with(|| {
            s.points.push(Point3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2])));
            s.points.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        for (level, flip) in [(0, true), (n, false)] {
            for i in 0..n {
                for j in 0..n {
                    let corner = |di: u32, dj: u32| {
                        let mut p = [0; 3];
                        p[axis] = level;
                        p[(axis + 1) % 3] = i + di;
                        p[(axis + 2) % 3] = j + dj;
                        p
                    };
                    let [a, b, c, d] =
                        [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)].map(|p| vertex(p, &mut s));
                    for t in [[a, b, c], [a, c, d]] {
                        s.triangles.push(if flip { [t[0], t[2], t[1]] } else { t });
                    }
                }
            }
        }
    }
    s
}

fn flipped(mut s: TriMesh) -> TriMesh {
    for t in &mut s.triangles {
        t.swap(1, 2);
    }
    s
}

pub(super) fn joined(mut a: TriMesh, b: &TriMesh, scale: f64, shift: Vec3) -> TriMesh {
    let n = a.points.len() as u32;
    a.points.extend(b.points.iter().map(|p| Point3::from(p.coords * scale + shift)));
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + n)));
    a
}

/// Fills a surface as the vascular mesher does.
fn fill(surface: &TriMesh, tetrahedralizer: &Tetrahedralizer) -> Result<TetMesh, TetError> {
    parts::fill_outward(&tetrahedralizer.clone().effort(Effort::Fast), surface, &Watch::NOBODY)
}

fn fills(s: &TriMesh) -> TetMesh {
    let mut last = TetMesh::default();
    for interior in [Interior::None, Interior::Lattice { cell: None, clearance: None }] {
        for optimize in [false, true] {
            let options = Tetrahedralizer::new().interior(interior.clone()).optimize(optimize);
            last = fill(s, &options).unwrap();
            certify::certify(&last, s).unwrap();
            Complex::from_mesh(last.points.clone(), &last.tets).unwrap().sanity_check().unwrap();
        }
    }
    last
}

#[test]
fn spheres_and_tori_are_filled() {
    for level in 1..3 {
        fills(&sphere_surface(level));
    }
    fills(&torus_surface(24, 9, 0.35));
}

#[test]
fn tubes_with_flat_caps_are_filled() {
    for n in [3, 4, 6, 8, 13] {
        for centre in [false, true] {
            for direction in [Vec3::z(), Vec3::new(1.0, 2.0, 3.0), Vec3::new(-0.3, 0.1, 0.7)] {
                fills(&tube(n, 5, 3.0, centre, direction));
            }
        }
    }
}

#[test]
fn grids_on_a_cube_are_filled() {
    for n in 1..5 {
        fills(&cube(n));
    }
}

#[test]
fn nested_shells_and_several_components_are_filled() {
    let ball = sphere_surface(2);
    let hollow = joined(ball.clone(), &flipped(ball.clone()), 0.5, Vec3::zeros());
    let two = joined(hollow, &ball, 0.3, Vec3::new(5.0, 0.0, 0.0));
    fills(&two);
}

#[test]
fn wrong_surfaces_are_typed_errors() {
    let s = sphere_surface(1);
    let error = |s: &TriMesh| fill(s, &Tetrahedralizer::new()).unwrap_err();
    assert!(matches!(error(&TriMesh::default()), TetError::Empty { .. }));
    assert!(matches!(error(&flipped(s.clone())), TetError::InsideOut { .. }));
    let mut open = s.clone();
    open.triangles.pop();
    assert!(matches!(error(&open), TetError::Open(EdgeFaults { edges: 3, .. })));
    let mut twisted = s.clone();
    twisted.triangles[0].swap(0, 1);
    assert!(matches!(error(&twisted), TetError::NotOriented(EdgeFaults { edges: 3, .. })));
    let mut crowded = s.clone();
    crowded.triangles.push([s.triangles[0][0], s.triangles[0][1], s.triangles[9][0]]);
    assert!(matches!(error(&crowded), TetError::NotManifold(_)));
    let mut bad = s.clone();
    bad.triangles[3][1] = 10_000;
    assert!(matches!(error(&bad), TetError::BadTriangle { ref triangles, count: 1, .. } if triangles == &[3]));
    let mut nan = s.clone();
    nan.points[5].y = f64::INFINITY;
    assert!(matches!(error(&nan), TetError::OutOfRange { ref points, .. } if points == &[5]));
    let twin = joined(s.clone(), &s, 1.0, Vec3::zeros());
    assert!(matches!(error(&twin), TetError::DuplicatePoints { .. }));
    // A solid ball inside a solid ball: the inner shell is filled as a hole, and turned over.
    let inside = joined(s.clone(), &s, 0.5, Vec3::zeros());
    assert_eq!(Tetrahedralizer::new().run(&inside).unwrap().summary.reversed, s.triangles.len());
}

#[test]
fn points_in_triangles_are_found_before_anything_is_made() {
    let check = |p: Point3| {
        let mut plc = Plc::from(&cube(1));
        plc.surface.points.push(p);
        let tetrahedralizer = Tetrahedralizer::new();
        let checked = tetrahedralizer.check(&plc);
        assert_eq!(checked.clone().err(), tetrahedralizer.run(&plc).err());
        checked
    };
    assert_eq!(check(Point3::new(0.5, 0.375, 0.25)), Ok(()));
    assert!(matches!(
        check(Point3::new(0.0, 0.25, 0.0)),
        Err(TetError::EdgeMeets { obstacle: Obstacle::Point(8), .. })
    ));
    let inside = check(Point3::new(1.0, 0.75, 0.375));
    assert!(matches!(inside, Err(TetError::Stuck { part: Obstacle::Triangle(_), reason: Stuck::Intersection })));
}

#[test]
fn surfaces_that_meet_themselves_end_in_an_error() {
    let s = sphere_surface(2);
    let crossing = joined(s.clone(), &s, 1.0, Vec3::new(0.9, 0.1, 0.05));
    let error = fill(&crossing, &Tetrahedralizer::new()).unwrap_err();
    assert!(matches!(error, TetError::SelfIntersection { .. }), "{error:?}");
    // Two boxes that share part of a plane, so that triangles overlap without piercing.
    let beside = joined(cube(2), &cube(2), 0.9, Vec3::new(2.0, 0.07, 0.11));
    let error = fill(&beside, &Tetrahedralizer::new()).unwrap_err();
    assert!(matches!(error, TetError::SelfIntersection { .. }), "{error:?}");
    // A point of one ball inside a triangle of the other.
    let (a, b) = (sphere_surface(0), sphere_surface(1));
    let corner = |i: u32| a.points[i as usize].coords;
    let middle = a.triangles[0].map(corner).iter().sum::<Vec3>() / 3.0;
    let touching = joined(a.clone(), &b, 0.25, middle - b.points[0].coords * 0.25);
    assert!(fill(&touching, &Tetrahedralizer::new()).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn deformed_spheres_are_filled(bumps in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, -0.4..0.4f64), 1..6)) {
        let mut s = sphere_surface(3);
        for p in &mut s.points {
            // Star-shaped, so it cannot intersect itself.
            let mut r = 1.0;
            for &(x, y, z, size) in &bumps {
                r += size / bumps.len() as f64 * libm::sin(4.0 * p.coords.dot(&Vec3::new(x, y, z)));
            }
            *p = Point3::from(p.coords * r);
        }
        fills(&s);
    }
}

#[test]
fn a_carved_complex_is_sane_with_its_ghosts() {
    let s = tube(9, 6, 3.0, true, Vec3::new(1.0, 0.2, 0.3));
    let edges = input::validate(&s, &[], InputKind::Closed).unwrap();
    let mut points = s.points.clone();
    points.extend(conform::box_corners(&s.points));
    let mut c = delaunay::delaunay(&points).unwrap();
    c.sanity_check().unwrap();
    recover::recover(&mut c, &s, &edges, recover::Rule::Positive, &Watch::NOBODY).unwrap();
    c.sanity_check().unwrap();
    let sides = carve::Sides::find(&c, &s, InputKind::Closed, &[]).unwrap();
    let carved = carve::carve(&c, &s, &sides);
    carved.sanity_check().unwrap();
    let rebuilt = Complex::from_mesh(carved.points.clone(), &carved.clone().into_mesh().tets).unwrap();
    rebuilt.sanity_check().unwrap();
    let ghosts = |c: &Complex| (0..c.slots() as u32).filter(|&t| c.is_alive(t) && c.is_ghost(t)).count();
    assert_eq!(ghosts(&carved), s.triangles.len());
    assert_eq!(ghosts(&rebuilt), s.triangles.len());
}

#[test]
fn lattice_points_keep_inside_and_off_the_wall() {
    let s = sphere_surface(3);
    let (cell, clearance) = (0.25, 0.1);
    let points = lattice::lattice_points(&s, cell, clearance, &Watch::NOBODY).unwrap();
    let volume = certify::enclosed_volume(&s).0;
    let expected = 2.0 * volume * (1.0 - clearance).powi(3) / cell.powi(3);
    assert!((points.len() as f64 / expected - 1.0).abs() < 0.1, "{} for {expected}", points.len());
    for p in &points {
        assert!(p.coords.norm() < 1.0 - clearance);
        let corners = |t: &[u32; 3]| t.map(|v| s.points[v as usize]);
        let near = s.triangles.iter().map(|t| anastomesh_mesh::geometry::point_triangle(p, corners(t).each_ref()).1);
        assert!(near.fold(f64::INFINITY, f64::min) >= clearance);
    }
    assert_eq!(points, lattice::lattice_points(&s, cell, clearance, &Watch::NOBODY).unwrap());
    for cell in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-30] {
        assert!(lattice::lattice_points(&s, cell, clearance, &Watch::NOBODY).unwrap().is_empty());
    }
}

#[test]
fn points_given_are_used_and_points_outside_are_dropped() {
    let s = sphere_surface(2);
    let given = vec![Point3::new(0.1, 0.0, 0.0), Point3::new(9.0, 0.0, 0.0), Point3::new(0.0, 0.3, 0.2)];
    let interior = Interior::Points(given.clone());
    let options = Tetrahedralizer::new().interior(interior).optimize(false);
    let mesh = fill(&s, &options).unwrap();
    assert_eq!(mesh.points[s.points.len()..], [given[0], given[2]]);
    let twice = vec![given[0], given[2], given[0]];
    let error = fill(&s, &options.clone().interior(Interior::Points(twice))).unwrap_err();
    assert!(matches!(error, TetError::BadInteriorPoint { index: 2, .. }), "{error:?}");
    let nan = vec![given[0], Point3::new(0.0, f64::NAN, 0.0)];
    let error = fill(&s, &options.interior(Interior::Points(nan))).unwrap_err();
    assert!(matches!(error, TetError::BadInteriorPoint { index: 1, .. }), "{error:?}");
}

#[test]
fn the_certificate_finds_every_kind_of_fault() {
    use certify::{CertifyError, certify};
    let s = sphere_surface(1);
    let mesh = fill(&s, &Tetrahedralizer::new().optimize(false)).unwrap();
    certify(&mesh, &s).unwrap();
    let mut moved = mesh.clone();
    moved.points[3].x = moved.points[3].x.next_up();
    assert_eq!(certify(&moved, &s), Err(CertifyError::PointMoved { point: 3 }));
    let mut inverted = mesh.clone();
    inverted.tets[2].swap(0, 1);
    assert!(matches!(certify(&inverted, &s), Err(CertifyError::NotPositive { tet: 2, .. })));
    let mut lost = mesh.clone();
    lost.tets.pop();
    assert!(matches!(certify(&lost, &s), Err(CertifyError::ForeignFace { .. })));
    let mut twice = mesh.clone();
    twice.tets.push(mesh.tets[0]);
    assert!(matches!(certify(&twice, &s), Err(CertifyError::NotConforming { .. })));
    let two = joined(s.clone(), &s, 1.0, Vec3::new(5.0, 0.0, 0.0));
    let mut half = mesh.clone();
    half.points.splice(s.points.len().., two.points[s.points.len()..].iter().copied());
    half.points.extend(mesh.points[s.points.len()..].iter().copied());
    let shift = s.points.len() as u32;
    for v in half.tets.iter_mut().flatten().filter(|v| **v >= shift) {
        *v += shift;
    }
    assert_eq!(certify(&half, &two), Err(CertifyError::TriangleLost { triangle: s.triangles.len() as u32 }));
}

#[test]
fn a_graded_lattice_is_the_lattice_near_the_wall_and_thinner_inside() {
    let s = sphere_surface(4);
    let (cell, clearance) = (0.06, 0.03);
    let all = lattice::lattice_points(&s, cell, clearance, &Watch::NOBODY).unwrap();
    let graded = lattice::graded_lattice_points(&s, cell, clearance, &Watch::NOBODY).unwrap();
    let beyond = |points: &[Point3], r: f64| points.iter().filter(|p| p.coords.norm() > r).count();
    assert_eq!(beyond(&all, 0.9), beyond(&graded, 0.9));
    assert!(graded.len() * 2 < all.len(), "{} of {}", graded.len(), all.len());
    assert!(graded.iter().all(|p| all.contains(p)));
    // A step of the coarser lattices takes eight times the volume.
    let within = |points: &[Point3], r: f64| points.len() - beyond(points, r);
    assert!(within(&graded, 0.7) * 7 < within(&all, 0.7) && within(&graded, 0.7) * 60 > within(&all, 0.7));
    let interior = Interior::Graded { cell: Some(cell), clearance: Some(clearance) };
    let mesh = fill(&s, &Tetrahedralizer::new().interior(interior)).unwrap();
    assert!(TetQuality::of(&mesh).percentile_1 > 0.45, "{:?}", TetQuality::of(&mesh));
}
