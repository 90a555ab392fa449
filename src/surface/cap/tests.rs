//! Tests of capping.

use super::*;
use crate::surface::{Finer, euler_characteristic, vessel_wall};
use anastomesh_mesh::geometry::{Tube, self_intersections};

/// Tubes from a common node, each with a terminal at its end, and the ends.
fn star(arms: &[([f64; 3], f64, f64)]) -> (Vec<Tube>, Vec<Closing<'static>>) {
    let (mut tubes, mut ends) = (Vec::new(), Vec::new());
    for (i, &(to, ra, rb)) in arms.iter().enumerate() {
        let b = Point3::from(to);
        let axis = b.coords.normalize();
        tubes.push(Tube { a: Point3::origin(), b, ra, rb });
        tubes.push(Tube { a: b, b: b + axis * (1.25 * rb), ra: rb, rb });
        let section = Section::new(b, axis, rb);
        ends.push(Closing { section, node: Some(NodeId(i as u32)), disc: None });
    }
    (tubes, ends)
}

fn capped(arms: &[([f64; 3], f64, f64)], rho: f64) -> (CappedSurface, Vec<Closing<'static>>) {
    let (tubes, ends) = star(arms);
    let smallest = tubes.iter().map(Tube::min_radius).fold(f64::INFINITY, f64::min);
    let params = SurfaceParams::with_voxel(2.0 * smallest / rho);
    let wall = vessel_wall(&tubes, &params, &Finer::default(), &Watch::NOBODY).unwrap();
    let mut field = Field::new(&tubes, params.kappa).unwrap();
    (cap_terminals(&wall, &mut field, &ends, &params, false, &Watch::NOBODY).unwrap(), ends)
}

fn check(surface: &CappedSurface, ends: &[Closing], smallest_angle: f64) {
    let mesh = &surface.mesh;
    assert_eq!(surface.cap.len(), mesh.triangles.len());
    assert!(HalfEdges::new(mesh).is_ok());
    assert_eq!(euler_characteristic(mesh), 2);
    assert_eq!(self_intersections(&mesh.points, &mesh.triangles), []);
    for (i, end) in ends.iter().enumerate() {
        let s = &end.section;
        let (mut area, mut center, mut faces, mut edges) = (0.0, Vec3::zeros(), 0i64, 0i64);
        let mut vertices = std::collections::BTreeSet::new();
        for (t, _) in mesh.triangles.iter().zip(&surface.cap).filter(|(_, c)| **c == Some(i as u32)) {
            let [a, b, c] = t.map(|v| mesh.points[v as usize]);
            let normal = (b - a).cross(&(c - a)) * 0.5;
            assert!(normal.dot(&s.axis) > 0.999_999 * normal.norm());
            assert!(t.iter().all(|&v| s.height(&mesh.points[v as usize]).abs() < 1e-9 * s.radius));
            area += normal.norm();
            center += (a.coords + b.coords + c.coords) * (normal.norm() / 3.0);
            faces += 1;
            vertices.extend(t);
        }
        assert!((area / (std::f64::consts::PI * s.radius * s.radius) - 1.0).abs() < 1e-6, "area {area}");
        assert!((center / area - s.origin.coords).norm() < 1e-3 * s.radius);
        let lies_flat = |t: &[u32; 3]| t.iter().all(|v| vertices.contains(v));
        assert!(mesh.triangles.iter().zip(&surface.cap).all(|(t, c)| c.is_some() || !lies_flat(t)), "a wall on a disc");
        // One disc: V − E + F = 1, with 3 F = 2 E − (boundary edges).
        let on_wall =
            |v: &u32| mesh.triangles.iter().zip(&surface.cap).any(|(t, c)| *c != Some(i as u32) && t.contains(v));
        let ring = vertices.iter().filter(|v| on_wall(v)).count() as i64;
        edges += i64::midpoint(3 * faces, ring);
        assert_eq!(vertices.len() as i64 - edges + faces, 1);
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.points[v as usize]);
        let angle = libm::acos(crate::surface::relax::largest_cosine(&a, &b, &c)).to_degrees();
        assert!(angle > smallest_angle, "{angle}");
    }
}

#[test]
fn every_terminal_ends_in_a_disc() {
    for rho in [3.0, 4.0, 5.0] {
        let (surface, ends) =
            capped(&[([-8.0, 0.3, 0.1], 1.0, 1.0), ([6.0, 4.0, 0.5], 0.8, 0.7), ([6.0, -4.0, -0.7], 0.8, 0.9)], rho);
        check(&surface, &ends, 20.0);
    }
}

#[test]
fn thick_terminals_of_fine_walls_are_capped() {
    let (surface, ends) = capped(&[([-14.0, 0.3, 0.1], 2.0, 3.0), ([7.0, 6.0, 0.5], 0.8, 0.7)], 3.0);
    check(&surface, &ends, 20.0);
}

#[test]
fn a_tip_that_another_vessel_leans_on_is_capped() {
    // At the plane the second vessel's axis is 2.2 radii away: the walls have fused.
    let (surface, ends) =
        capped(&[([-8.0, 0.0, 0.0], 1.3, 1.3), ([7.0, 0.0, 0.0], 1.0, 1.0), ([14.0, 4.6, 0.3], 1.3, 1.2)], 3.0);
    check(&surface, &ends, 10.0);
}

#[test]
fn a_terminal_inside_another_vessel_is_refused() {
    let arms = [([-9.0, 0.0, 0.0], 2.0, 2.0), ([9.0, 0.0, 0.0], 2.0, 2.0), ([3.0, 1.0, 0.0], 1.0, 1.0)];
    let (tubes, ends) = star(&arms);
    let params = SurfaceParams::with_voxel(0.6);
    let wall = vessel_wall(&tubes, &params, &Finer::default(), &Watch::NOBODY).unwrap();
    let mut field = Field::new(&tubes, params.kappa).unwrap();
    let error = cap_terminals(&wall, &mut field, &ends, &params, false, &Watch::NOBODY).unwrap_err();
    assert!(matches!(error, CapError::End { end: 2, node: Some(NodeId(2)), .. }), "{error}");
}

#[test]
fn the_tree_finds_all_faces_near_a_tip() {
    let tubes = [Tube { a: Point3::origin(), b: Point3::new(9.0, 0.0, 0.0), ra: 1.0, rb: 1.0 }];
    let wall = vessel_wall(&tubes, &SurfaceParams::with_voxel(0.4), &Finer::default(), &Watch::NOBODY).unwrap();
    let count = wall.mesh.triangles.len();
    let (few, many) = (TipSearch::of(&wall.mesh, FEW), TipSearch::of(&wall.mesh, FEW + 1));
    assert_eq!(few.near(&Point3::origin(), 1.0), (0..count as u32).collect::<Vec<u32>>());
    for x in [0.0, 3.0, 9.0] {
        let p = Point3::new(x, 0.2, -0.1);
        let near = many.near(&p, 1.5);
        assert!(near.is_sorted() && near.len() < count);
        let is_near = |&f: &u32| (wall.mesh.points[wall.mesh.triangles[f as usize][0] as usize] - p).norm() <= 1.5;
        assert!((0..count as u32).filter(is_near).all(|f| near.contains(&f)));
        let section = Section::new(p, Vec3::x(), 1.0);
        assert_eq!(few.tip(&section).0, many.tip(&section).0);
    }
}

#[test]
fn terminals_that_cannot_be_capped_are_left_open_if_they_may_be() {
    let arms = [([6.0, 0.0, 0.0], 1.0, 1.0), ([-6.0, 0.0, 0.0], 1.0, 1.0), ([0.0, 6.0, 0.0], 1.0, 1.0)];
    let (tubes, mut ends) = star(&arms);
    // No tip lies beyond this plane.
    ends[1].section.origin.x = -30.0;
    let params = SurfaceParams::with_voxel(0.5);
    let wall = vessel_wall(&tubes, &params, &Finer::default(), &Watch::NOBODY).unwrap();
    let mut field = Field::new(&tubes, params.kappa).unwrap();
    let mut made = |may_leave| cap_terminals(&wall, &mut field, &ends, &params, may_leave, &Watch::NOBODY);
    assert!(matches!(made(false), Err(CapError::End { end: 1, reason: CapFailure::NoTip, .. })));
    let capped = made(true).unwrap();
    assert_eq!([0, 1, 2].map(|end| capped.cap.contains(&Some(end))), [true, false, true]);
    // Only the other two ends given, the surface is the same.
    let two = [ends[0], ends[2]];
    let alone = cap_terminals(&wall, &mut field, &two, &params, false, &Watch::NOBODY).unwrap();
    assert_eq!(alone.mesh, capped.mesh);
}
