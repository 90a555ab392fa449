//! Comparison of the exact self-intersection test with CGAL, pair by pair.

use crate::common;
use crate::common::oracle::{self, Random};
use anastomesh::mesh::shapes::torus_surface;
use anastomesh::testing::{Improper, self_contacts, self_intersections};
use anastomesh::{Point3, TriMesh, Vec3};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

fn oracle() -> Option<PathBuf> {
    oracle::cgal("self_intersections")
}

type Surface = (Vec<Point3>, Vec<[u32; 3]>);

/// Pairs found by CGAL.
fn cgal(program: &Path, (points, triangles): &Surface) -> Vec<(u32, u32)> {
    let mut input = format!("{} {}\n", points.len(), triangles.len());
    for p in points {
        // Rust prints the shortest digits that restore the number.
        let _ = writeln!(input, "{} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in triangles {
        let _ = writeln!(input, "{a} {b} {c}");
    }
    let text = oracle::answer(program, input);
    let number = |word: Option<&str>| word.and_then(|w| w.parse().ok()).expect("a number");
    let pair = |line: &str| {
        let mut words = line.split(' ');
        (number(words.next()), number(words.next()))
    };
    text.lines().map(pair).collect()
}

/// Triangles without shared ids, with corners by `corner` around random positions.
fn soup(count: u32, random: &mut Random, corner: impl Fn(&mut Random) -> Point3) -> Surface {
    let mut points = Vec::new();
    while points.len() < 3 * count as usize {
        let t = [corner(random), corner(random), corner(random)];
        // CGAL does not define intersections of degenerate triangles.
        if (t[1] - t[0]).cross(&(t[2] - t[0])).norm() > 0.0 {
            points.extend(t);
        }
    }
    (points, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Torus of `n` × `m` quadrilaterals, two triangles each.
fn torus(n: u32, m: u32, tube: f64) -> Surface {
    let TriMesh { points, triangles } = torus_surface(n, m, tube);
    (points, triangles)
}

fn joined(mut a: Surface, b: &Surface) -> Surface {
    let first = a.0.len() as u32;
    a.0.extend(&b.0);
    a.1.extend(b.1.iter().map(|t| t.map(|v| v + first)));
    a
}

fn moved(mut surface: Surface, by: Vec3) -> Surface {
    surface.0.iter_mut().for_each(|p| *p += by);
    surface
}

fn agree(surface: &Surface, program: &Path) -> usize {
    let ours = self_intersections(&surface.0, &surface.1);
    assert_eq!(ours, cgal(program, surface));
    ours.len()
}

#[test]
fn soups() {
    let Some(program) = &oracle() else { return };
    let mut random = Random(1);
    for size in [3.0, 5.0, 12.0] {
        let grid = |r: &mut Random| Point3::new(0.0, 0.0, 0.0).map(|_: f64| (r.unit() * size).floor());
        assert!(agree(&soup(300, &mut random, grid), program) > 10);
    }
    // Coplanar triangles: contacts and overlaps only.
    let flat = |r: &mut Random| Point3::new((r.unit() * 30.0).floor(), (r.unit() * 30.0).floor(), 7.0);
    assert!(agree(&soup(200, &mut random, flat), program) > 100);
    let general = |r: &mut Random| Point3::new(r.unit(), r.unit(), r.unit());
    assert!(agree(&soup(400, &mut random, general), program) > 1000);
}

#[test]
fn surfaces_with_planted_intersections() {
    let Some(program) = &oracle() else { return };
    assert_eq!(agree(&torus(60, 24, 0.3), program), 0);
    // A torus with a tube wider than its circle intersects itself.
    assert!(agree(&torus(40, 24, 1.2), program) > 100);
    // Two linked rings; one is shifted so that it intersects, touches in equal points, or lies inside the other.
    let ring = torus(48, 24, 0.3);
    assert!(agree(&joined(ring.clone(), &moved(ring.clone(), Vec3::new(0.4, 0.0, 0.0))), program) > 100);
    assert!(agree(&joined(ring.clone(), &moved(ring.clone(), Vec3::zeros())), program) > 1000);
    assert_eq!(agree(&joined(ring.clone(), &torus(48, 24, 0.2)), program), 0);
    // Displaced vertices: neighbours fold over and intersect beyond their shared elements.
    let mut random = Random(2);
    for size in [0.05, 0.2, 0.5] {
        let mut wild = ring.clone();
        for p in &mut wild.0 {
            *p += Vec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5) * size;
        }
        agree(&wild, program);
    }
    // Separate triangles on a coarse grid: coplanar ones, equal points and edges, contacts everywhere.
    let round = torus(30, 14, 0.4);
    let corners = round.1.iter().map(|t| t.map(|v| round.0[v as usize].map(|x| (x * 6.0).round())));
    let corners = corners.filter(|[a, b, c]| (b - a).cross(&(c - a)).norm() > 0.0);
    let points: Vec<Point3> = corners.flatten().collect();
    let snapped = (points.clone(), (0..points.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect());
    assert!(agree(&snapped, program) > 100);
}

/// Every kind is found by name where it was planted in a ring.
#[test]
fn each_kind_is_found_in_a_surface() {
    let ring = torus(48, 24, 0.3);
    let kinds = |surface: &Surface| {
        let mut kinds: Vec<Improper> = self_contacts(&surface.0, &surface.1).into_iter().map(|c| c.2).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds
    };
    assert_eq!(kinds(&ring), []);
    // A separate triangle that touches the ring at one of its points.
    let probe = |at: Point3, away: Vec3, across: Vec3| -> Surface {
        joined(ring.clone(), &(vec![at, at + away + across, at + away - across], vec![[0, 1, 2]]))
    };
    let t = ring.1[0].map(|v| ring.0[v as usize]);
    let normal = (t[1] - t[0]).cross(&(t[2] - t[0])).normalize();
    let across = (t[1] - t[0]) * 0.3;
    assert_eq!(kinds(&probe(t[0], normal * 0.5, across)), [Improper::CoincidentPoint]);
    let pierced = probe(nalgebra::center(&t[0], &nalgebra::center(&t[1], &t[2])), normal * 0.5, across);
    assert!(kinds(&moved_tip(pierced, -normal * 0.01)).contains(&Improper::Crossing));
    let mut twice = ring.clone();
    twice.1.push([ring.1[0][1], ring.1[0][0], ring.1[0][2]]);
    assert!(kinds(&twice).contains(&Improper::SameVertices));
}

fn moved_tip(mut surface: Surface, by: Vec3) -> Surface {
    let tip = surface.0.len() - 3;
    surface.0[tip] += by;
    surface
}

/// Valid shared surfaces have no self-intersections; perturbed ones have those that CGAL finds.
#[test]
fn surfaces_of_others() {
    let (Some(program), Some(shared)) = (&oracle(), common::shared()) else { return };
    let mut random = Random(3);
    for name in ["tube_tree_1k", "libigl_3holes", "cgal_pipe"] {
        let path = shared.join("data/surfaces").join(format!("{name}.off"));
        let mut surface = read_off(&std::fs::read_to_string(&path).expect("the surface is there"));
        assert_eq!(agree(&surface, program), 0, "{name}");
        let t = surface.1[0].map(|v| surface.0[v as usize]);
        let size = (t[1] - t[0]).norm();
        for p in &mut surface.0 {
            *p += Vec3::new(random.unit() - 0.5, random.unit() - 0.5, random.unit() - 0.5) * size;
        }
        assert!(agree(&surface, program) > 0, "{name}");
    }
}

fn read_off(text: &str) -> Surface {
    let mut words = text.split_whitespace().skip(1);
    let mut number = || words.next().and_then(|w| w.parse::<f64>().ok()).expect("a number");
    let (points, triangles, _) = (number() as usize, number() as usize, number());
    let points = (0..points).map(|_| Point3::new(number(), number(), number())).collect();
    let corners = |number: &mut dyn FnMut() -> f64| {
        assert!((number() - 3.0).abs() < 0.5, "triangles only");
        [number() as u32, number() as u32, number() as u32]
    };
    (points, (0..triangles).map(|_| corners(&mut number)).collect())
}

/// Wall of a network with overlapping vessels, the main use of the check.
#[test]
fn the_wall_of_overlapping_vessels() {
    let (Some(program), Some(shared)) = (&oracle(), common::shared()) else { return };
    let network = common::network(&shared.join("data/kidney/subtree_989.vtp"));
    let meshed = common::mesh(&network, 3.0);
    // Inner points are not part of the wall.
    let mut number = vec![u32::MAX; meshed.mesh.mesh.points.len()];
    let mut wall = Surface::default();
    for face in &meshed.mesh.boundary {
        wall.1.push(face.map(|v| {
            let id = &mut number[v as usize];
            if *id == u32::MAX {
                *id = wall.0.len() as u32;
                wall.0.push(meshed.mesh.mesh.points[v as usize]);
            }
            *id
        }));
    }
    let pairs = agree(&wall, program);
    println!("{} triangles, {pairs} pairs meet", wall.1.len());
    assert!(pairs > 0);
    assert_eq!(meshed.check.intersections.len(), pairs);
}
