//! Every condition fails on a mesh with its fault planted, and none on a valid one.

use super::result::{KEPT_OFFENDERS, PRINTED_OFFENDERS};
use super::*;
use crate::adjacency::boundary_faces;
use crate::geometry::{Point3, Vec3};
use crate::region::region_faces;
use crate::second_order::SecondOrder;
use crate::shapes::{cube_lattice, tube_lattice};
use crate::{Cap, Patch, WALL};

pub(super) const HEIGHT: f64 = 2.5;

/// Labels the faces again after a change of regions; interfaces have the patch `interface`, others `boundary`.
pub(super) fn relabelled(mut volume: VolumeMesh) -> VolumeMesh {
    let faces = region_faces(&volume.mesh, &volume.tet_block);
    volume.boundary = faces.iter().map(|face| face.vertices).collect();
    volume.boundary_block = faces.iter().map(|face| face.region).collect();
    volume.boundary_patch = faces.iter().map(|face| if face.beyond.is_some() { 3 } else { 2 }).collect();
    volume.patches =
        [(2, "boundary"), (3, "interface")].map(|(id, name)| Patch { id, name: name.into(), cap: None }).into();
    volume
}

/// Adds a copy of a mesh with its labels, whose points have other places.
pub(super) fn add_copy(volume: &mut VolumeMesh, place: impl Fn(&Point3) -> Point3) {
    let count = volume.mesh.points.len() as u32;
    volume.mesh.points.extend(volume.mesh.points.clone().iter().map(place));
    volume.mesh.tets.extend(volume.mesh.tets.clone().iter().map(|tet| tet.map(|v| v + count)));
    volume.tet_block.extend_from_within(..);
    volume.boundary.extend(volume.boundary.clone().iter().map(|face| face.map(|v| v + count)));
    volume.boundary_patch.extend_from_within(..);
    volume.boundary_block.extend_from_within(..);
}

/// A straight vessel of radius 1 with an inlet at the bottom (node 7) and an outlet at the top (node 3).
pub(super) fn tube() -> (VolumeMesh, Expectation) {
    tube_of(4)
}

/// One whose caps have `6 · rings` corners.
fn tube_of(rings: u32) -> (VolumeMesh, Expectation) {
    let mesh = tube_lattice(rings, 10, HEIGHT / 10.0);
    let cap = |node, z, normal| Cap { node, center: Point3::new(0.0, 0.0, z), normal, radius: 1.0 };
    let patch = |id, name: &str, cap| Patch { id, name: name.into(), cap };
    let boundary = boundary_faces(&mesh);
    let flat = |f: &[u32; 3], z: f64| f.iter().all(|&v| (mesh.points[v as usize].z - z).abs() < 1e-12);
    let label = |f: &[u32; 3]| match (flat(f, 0.0), flat(f, HEIGHT)) {
        (true, _) => 2,
        (_, true) => 3,
        _ => WALL,
    };
    let volume = VolumeMesh {
        tet_block: vec![0; mesh.tets.len()],
        boundary_block: vec![0; boundary.len()],
        boundary_patch: boundary.iter().map(label).collect(),
        patches: vec![
            patch(WALL, "wall", None),
            patch(2, "inlet", Some(cap(7, 0.0, -Vec3::z()))),
            patch(3, "outlet_0", Some(cap(3, HEIGHT, Vec3::z()))),
        ],
        boundary,
        mesh,
    };
    (volume, Expectation { loops: vec![0], terminals: vec![3, 7] })
}

pub(super) fn failing(volume: &VolumeMesh, expectation: &Expectation) -> Vec<Line> {
    let report = check_volume(volume, Some(expectation));
    assert_eq!(report.is_valid(), report.failed().next().is_none());
    report.failed().map(|result| result.line).collect()
}

/// Conditions that fail after a change to the valid tube.
fn planted(change: impl FnOnce(&mut VolumeMesh, &mut Expectation)) -> Vec<Line> {
    let (mut volume, mut expectation) = tube();
    change(&mut volume, &mut expectation);
    let report = check_volume(&volume, Some(&expectation));
    assert_eq!(report.verdict, Verdict::Invalid);
    report.failed().map(|result| result.line).collect()
}

/// Conditions on the mesh itself that fail, without labels.
fn planted_in_mesh(change: impl FnOnce(&mut TetMesh)) -> Vec<Line> {
    let mut mesh = cube_lattice(3);
    change(&mut mesh);
    let report = check_tets(&mesh, Some(&Expectation { loops: vec![0], terminals: Vec::new() }));
    assert_eq!(report.verdict, Verdict::Invalid);
    report.failed().map(|result| result.line).collect()
}

fn append(mesh: &mut TetMesh, other: &TetMesh, shift: Vec3) {
    let first = mesh.points.len() as u32;
    mesh.points.extend(other.points.iter().map(|p| p + shift));
    mesh.tets.extend(other.tets.iter().map(|t| t.map(|v| v + first)));
}

#[test]
fn a_sound_tube_passes_every_line() {
    let (volume, expectation) = tube();
    let report = check_volume(&volume, Some(&expectation));
    assert_eq!(report.failed().collect::<Vec<_>>(), Vec::<&LineResult>::new());
    assert!(report.is_valid());
    assert_eq!(report.lines.iter().map(|result| result.line).collect::<Vec<_>>(), Line::ALL);
    assert_eq!((report.counts.components, report.counts.boundary_components, report.counts.caps), (1, 1, 2));
}

#[test]
fn without_labels_no_verdict_of_validity() {
    let report = check_tets(&tube().0.mesh, None);
    assert_eq!(report.verdict, Verdict::NoFaultFound);
    let skipped = |line| report.line(line).map(|result| result.outcome);
    assert_eq!(skipped(Line::CapDisc), Some(Outcome::NotChecked(Skipped::NoLabels)));
    assert_eq!(skipped(Line::Loops), Some(Outcome::NotChecked(Skipped::NoExpectation)));
}

#[test]
fn faults_of_arrays() {
    assert_eq!(planted(|v, _| v.mesh.points[5].y = f64::NAN), [Line::FinitePoints]);
    assert_eq!(planted(|v, _| v.mesh.points[5].y = f64::INFINITY), [Line::FinitePoints]);
    assert_eq!(planted(|v, _| v.mesh.tets[5][2] = 1_000_000), [Line::IndicesInRange]);
    assert_eq!(planted(|v, _| v.mesh.tets.clear()), [Line::NotEmpty]);
}

#[test]
fn unusable_arrays_leave_the_other_conditions_unchecked() {
    let (mut volume, expectation) = tube();
    volume.mesh.tets[5][2] = 1_000_000;
    let report = check_volume(&volume, Some(&expectation));
    assert_eq!(report.lines.iter().map(|result| result.line).collect::<Vec<_>>(), Line::ALL);
    let because = Outcome::NotChecked(Skipped::Because(Line::IndicesInRange));
    let others: Vec<Line> =
        report.lines.iter().filter(|result| result.outcome != because).map(|result| result.line).collect();
    assert_eq!(others, [Line::NotEmpty, Line::FinitePoints, Line::IndicesInRange]);
}

#[test]
fn faults_of_tetrahedra() {
    let lines = planted_in_mesh(|m| m.tets[20][1] = m.tets[20][0]);
    assert!(lines.contains(&Line::NoRepeatedVertex) && lines.contains(&Line::PositiveTets));
    let lines = planted_in_mesh(|m| m.tets.push(m.tets[20]));
    assert!(lines.contains(&Line::NoDuplicateTets));
    let lines = planted_in_mesh(|m| m.tets.push([m.tets[20][1], m.tets[20][0], m.tets[20][2], m.tets[20][3]]));
    assert!(lines.contains(&Line::NoDuplicateTets));
    assert_eq!(planted_in_mesh(|m| m.tets[20].swap(0, 1)), [Line::PositiveTets, Line::OppositeSides]);
    // A flat tetrahedron: an inner point moved into the plane of an opposite face.
    let lines = planted_in_mesh(|m| m.points[21] = m.points[22]);
    assert!(lines.contains(&Line::PositiveTets) && lines.contains(&Line::NoDuplicatePoints));
}

#[test]
fn an_inner_point_pulled_through_a_face_inverts_tetrahedra_only() {
    let inner = 21;
    let lines = planted_in_mesh(|m| m.points[inner] += Vec3::new(0.9, 0.2, 0.1));
    assert_eq!(lines, [Line::PositiveTets]);
}

#[test]
fn faults_of_faces() {
    // A third tetrahedron on an inner face.
    let lines = planted_in_mesh(|m| {
        let [a, b, c, _] = m.tets[80];
        m.points.push(Point3::new(9.0, 9.0, 9.0));
        m.tets.push([a, b, c, m.points.len() as u32 - 1]);
    });
    assert!(lines.contains(&Line::FacesSharedByTwo));
    // A second tetrahedron outside the boundary, folded inwards: both on one side of the face.
    let mut mesh = TetMesh {
        points: [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.1, 0.1, 0.5]].map(Point3::from).into(),
        tets: vec![[0, 1, 2, 3], [0, 1, 2, 4]],
    };
    let report = check_tets(&mesh, None);
    assert!(report.failed().any(|result| result.line == Line::OppositeSides));
    mesh.points[4].z = -1.0;
    mesh.tets[1].swap(0, 1);
    assert_eq!(check_tets(&mesh, None).failed().count(), 0);
}

#[test]
fn faults_of_points() {
    assert_eq!(planted_in_mesh(|m| m.points.push(Point3::new(0.5, 0.25, 0.125))), [Line::NoUnusedPoints]);
    // The first tetrahedron gets its own copy of a boundary point.
    let lines = planted_in_mesh(|m| {
        m.points.push(m.points[0]);
        let at = m.tets[0].iter().position(|&v| v == 0).unwrap();
        m.tets[0][at] = m.points.len() as u32 - 1;
    });
    assert!(lines.contains(&Line::NoDuplicatePoints) && lines.contains(&Line::NoSelfIntersection));
    let minus_zero = planted_in_mesh(|m| {
        append(m, &TetMesh { points: m.points[..1].to_vec(), tets: Vec::new() }, Vec3::zeros());
        m.points.last_mut().unwrap().x = -0.0;
    });
    assert_eq!(minus_zero, [Line::NoDuplicatePoints, Line::NoUnusedPoints]);
}

/// Two cubes that share one vertex, and two that share one edge.
#[test]
fn faults_of_the_boundary() {
    let glued = |shift: Vec3| {
        let mut mesh = cube_lattice(2);
        let cube = mesh.clone();
        append(&mut mesh, &cube, shift);
        let count = cube.points.len();
        for t in mesh.tets.iter_mut().flatten().filter(|v| **v as usize >= count) {
            let p = mesh.points[*t as usize];
            *t = mesh.points.iter().position(|q| *q == p).unwrap() as u32;
        }
        let used = crate::adjacency::vertices_of(&mesh.tets, mesh.points.len());
        let kept: Vec<u32> = (0..mesh.points.len() as u32).filter(|&v| used[v as usize]).collect();
        for v in mesh.tets.iter_mut().flatten() {
            *v = kept.binary_search(v).unwrap() as u32;
        }
        mesh.points = kept.iter().map(|&v| mesh.points[v as usize]).collect();
        check_tets(&mesh, None).failed().map(|result| (result.line, result.count)).collect::<Vec<_>>()
    };
    assert_eq!(glued(Vec3::new(1.0, 1.0, 1.0)), [(Line::BoundaryFans, 1)]);
    // Faces of a crowded edge count as one fan.
    assert_eq!(glued(Vec3::new(1.0, 1.0, 0.0)), [(Line::BoundaryEdges, 2)]);
    assert_eq!(glued(Vec3::new(1.0, 0.0, 0.0)), []);
}

#[test]
fn faults_of_shape() {
    // A second vessel that passes through, with separate points.
    let lines = planted_in_mesh(|m| append(m, &cube_lattice(2), Vec3::new(0.55, 0.45, 0.35)));
    assert_eq!(lines, [Line::NoSelfIntersection, Line::Components, Line::Loops]);
    // One beside it.
    let lines = planted_in_mesh(|m| append(m, &cube_lattice(2), Vec3::new(5.0, 0.0, 0.0)));
    assert_eq!(lines, [Line::Components, Line::Loops]);
    // One that touches it in a single point.
    let lines = planted_in_mesh(|m| append(m, &cube_lattice(1), Vec3::new(1.0, 0.51, 0.52)));
    assert_eq!(lines, [Line::NoSelfIntersection, Line::Components, Line::Loops]);
}

/// Removing the middle column of cells leaves a ring.
#[test]
fn the_genus_is_compared_with_the_loops() {
    let mut mesh = cube_lattice(3);
    let cell = |t: &[u32; 4]| t.iter().fold(Vec3::zeros(), |s, &v| s + mesh.points[v as usize].coords) / 4.0;
    let hole = |c: Vec3| (c.x - 0.5).abs() < 1.0 / 6.0 && (c.y - 0.5).abs() < 1.0 / 6.0;
    mesh.tets = mesh.tets.iter().filter(|t| !hole(cell(t))).copied().collect();
    let lines = |loops: Vec<u32>| {
        let report = check_tets(&mesh, Some(&Expectation { loops, terminals: Vec::new() }));
        report.failed().map(|result| (result.line, result.found.clone())).collect::<Vec<_>>()
    };
    assert_eq!(lines(vec![1]), []);
    assert_eq!(lines(vec![0]), [(Line::Loops, Some(vec![1]))]);
    assert_eq!(lines(vec![1, 0]), [(Line::Components, Some(vec![1])), (Line::Loops, Some(vec![1]))]);
}

/// A cavity in the middle is a second boundary surface of the same component.
#[test]
fn a_cavity_fails() {
    let lines = planted_in_mesh(|m| {
        let points = m.points.clone();
        let middle = |t: &[u32; 4]| t.iter().fold(Vec3::zeros(), |s, &v| s + points[v as usize].coords) / 4.0;
        m.tets.retain(|t| (middle(t) - Vec3::repeat(0.5)).amax() > 1.0 / 6.0);
    });
    assert_eq!(lines, [Line::Loops]);
}

#[test]
fn faults_of_labels() {
    let wall = |v: &VolumeMesh| v.boundary_patch.iter().position(|&id| id == WALL).unwrap();
    let lines = planted(|v, _| {
        let face = wall(v);
        v.boundary.remove(face);
        v.boundary_patch.remove(face);
    });
    assert_eq!(lines, [Line::LabelsMatchBoundary]);
    let lines = planted(|v, _| {
        let face = wall(v);
        v.boundary[face].swap(0, 1);
    });
    assert_eq!(lines, [Line::LabelsMatchBoundary]);
    assert_eq!(planted(|v, _| v.boundary[0][0] = v.mesh.points.len() as u32), [Line::LabelsMatchBoundary]);
    assert_eq!(planted(|v, _| v.boundary[0][0] = 1_000_000), [Line::LabelsMatchBoundary]);
    assert_eq!(planted(|v, _| v.boundary.push([u32::MAX; 3])), [Line::LabelsMatchBoundary]);
    let lines = planted(|v, _| {
        v.boundary.push(v.boundary[wall(v)]);
        v.boundary_patch.push(WALL);
    });
    assert_eq!(lines, [Line::LabelsMatchBoundary]);
    let lines = planted(|v, _| {
        let face = wall(v);
        v.boundary_patch[face] = 0;
    });
    assert_eq!(lines, [Line::WallOrCap]);
    let lines = planted(|v, _| {
        v.patches.push(Patch { id: 9, name: "other".into(), cap: None });
        let face = wall(v);
        v.boundary_patch[face] = 9;
    });
    assert_eq!(lines, [Line::WallOrCap]);
}

#[test]
fn a_labelled_triangle_of_missing_points_has_no_place() {
    let (volume, _) = tube();
    let count = volume.mesh.points.len() as u32;
    let place = |last: u32| labels::face_at(&volume.mesh.points, [0, 1, last]).position;
    assert!(place(count - 1).is_some() && place(count).is_none() && place(u32::MAX).is_none());
}

#[test]
fn curved_caps_have_the_area_of_their_discs() {
    let (mut volume, expectation) = tube_of(2);
    volume.patches.iter_mut().filter_map(|patch| patch.cap.as_mut()).for_each(|cap| cap.radius = 1.02);
    let report = check_volume(&volume, Some(&expectation));
    let area = |report: &CheckReport| report.line(Line::CapArea).map(|line| line.outcome);
    assert_eq!(area(&report), Some(Outcome::Fail));
    let (curved, _) = SecondOrder::curved(&volume);
    let curved = report.clone().with_second_order(&volume, &curved);
    assert_eq!(area(&curved), Some(Outcome::Pass));
    let straight = report.clone().with_second_order(&volume, &SecondOrder::straight(&volume));
    assert_eq!(area(&straight), Some(Outcome::Fail));
    assert_eq!(curved.lines.len(), Line::ALL.len() + Line::OF_SECOND_ORDER.len());
    assert!(curved.lines.windows(2).all(|pair| pair[0].line < pair[1].line));
    // A polygon of 12 corners has 95.5 % of the area of its circle.
    let volume = |report: &CheckReport| report.counts.volume;
    assert!((volume(&straight) / volume(&report) - 1.0).abs() < 1e-12);
    assert!((volume(&curved) / volume(&report) - 1.0 / 0.955).abs() < 0.01);
}

#[test]
fn areas_of_curved_caps_are_those_of_circles_up_to_a_twentieth() {
    let (sound, expectation) = tube_of(2);
    let (curved, _) = SecondOrder::curved(&sound);
    for (radius, wrong) in [(0.97, 2), (0.98, 0), (1.02, 0), (1.03, 2)] {
        let mut volume = sound.clone();
        volume.patches.iter_mut().filter_map(|patch| patch.cap.as_mut()).for_each(|cap| cap.radius = radius);
        let report = check_volume(&volume, Some(&expectation)).with_second_order(&volume, &curved);
        assert_eq!(report.line(Line::CapArea).map(|line| line.count), Some(wrong), "{radius}");
    }
}

#[test]
fn conditions_on_boundaries_concern_surfaces() {
    for line in [Line::FinitePoints, Line::NoDuplicatePoints, Line::BoundaryEdges, Line::Loops, Line::CapNormal] {
        assert!(line.concerns_surfaces(), "{line:?}");
    }
    for line in [Line::NotEmpty, Line::IndicesInRange, Line::PositiveTets, Line::NoUnusedPoints] {
        assert!(!line.concerns_surfaces(), "{line:?}");
    }
}

#[test]
fn the_number_of_conditions_that_hold_is_told() {
    let all = Line::ALL.len();
    let of = |volume: &VolumeMesh, expectation: &Expectation| check_volume(volume, Some(expectation));
    let (mut volume, expectation) = tube();
    assert_eq!(text::tally(&of(&volume, &expectation), true), format!("all {all} conditions hold"));
    assert_eq!(text::tally(&of(&volume, &expectation), false), format!("all {all} conditions hold (-v lists them)"));
    let report = check_tets(&volume.mesh, Some(&expectation));
    let skipped = report.lines.iter().filter(|line| matches!(line.outcome, Outcome::NotChecked(_))).count();
    assert!(skipped > 0);
    let told = format!("{} of {all} conditions hold, {skipped} skipped", all - skipped);
    assert_eq!(text::tally(&report, true), told);
    volume.mesh.points.push(Point3::new(0.5, 0.25, 0.125));
    assert_eq!(text::tally(&of(&volume, &expectation), true), format!("{} of {all} conditions hold", all - 1));
}

#[test]
fn faults_of_caps() {
    assert!(planted(|v, _| v.patches[2].id = 2).contains(&Line::OwnPatch));
    assert_eq!(planted(|v, _| v.patches[2].name = "inlet".into()), [Line::OwnPatch]);
    assert_eq!(planted(|_, e| e.terminals.push(11)), [Line::CapPerTerminal]);
    assert_eq!(planted(|_, e| e.terminals.retain(|&n| n != 3)), [Line::CapPerTerminal]);
    assert_eq!(planted(|v, _| v.patches[2].cap.as_mut().unwrap().node = 7), [Line::CapPerTerminal]);
    assert_eq!(planted(|v, _| v.patches[2].cap.as_mut().unwrap().center.x = 0.11), [Line::CapCentred]);
    assert_eq!(planted(|v, _| v.patches[2].cap.as_mut().unwrap().radius = 1.03), [Line::CapArea]);
    assert_eq!(planted(|v, _| v.patches[2].cap.as_mut().unwrap().normal *= -1.0), [Line::CapNormal]);
    let tilt = Vec3::new(1e-8, 0.0, 1.0).normalize();
    assert_eq!(planted(|v, _| v.patches[2].cap.as_mut().unwrap().normal = tilt), [Line::CapFlat]);
    let bump = planted(|v, _| {
        let head = v.boundary.iter().zip(&v.boundary_patch).find(|(_, id)| **id == 3).unwrap().0[0];
        v.mesh.points[head as usize].z += 1e-8;
    });
    assert_eq!(bump, [Line::CapFlat]);
}

/// The tube moved and rotated, with coordinates rounded to 32 bits.
fn rounded(offset: f64) -> (VolumeMesh, Expectation) {
    moved(offset, |x| f64::from(x as f32))
}

/// The tube moved and rotated.
fn moved(offset: f64, round: impl Fn(f64) -> f64) -> (VolumeMesh, Expectation) {
    let (mut volume, expectation) = tube();
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, 0.7, 0.2);
    let put = |p: Point3| turn * p + Vec3::new(offset, -2.0 * offset, offset);
    for p in &mut volume.mesh.points {
        *p = put(*p).map(&round);
    }
    for cap in volume.patches.iter_mut().filter_map(|patch| patch.cap.as_mut()) {
        cap.center = put(cap.center);
        cap.normal = turn * cap.normal;
    }
    (volume, expectation)
}

#[test]
fn caps_far_from_the_origin_are_flat_to_the_rounding_of_their_coordinates() {
    let (mut volume, expectation) = moved(1e7, |x| x);
    assert_eq!(failing(&volume, &expectation), []);
    let head = volume.boundary.iter().zip(&volume.boundary_patch).find(|(_, id)| **id == 3).unwrap().0[0] as usize;
    volume.mesh.points[head] += volume.patches[2].cap.unwrap().normal * 1e-6;
    assert_eq!(failing(&volume, &expectation), [Line::CapFlat]);
}

#[test]
fn caps_of_rounded_coordinates_are_flat_to_their_rounding() {
    for offset in [0.0, 10.0, 1000.0] {
        let (mut volume, expectation) = rounded(offset);
        assert_eq!(failing(&volume, &expectation), [], "{offset}");
        let head = volume.boundary.iter().zip(&volume.boundary_patch).find(|(_, id)| **id == 3).unwrap().0[0] as usize;
        let place = volume.mesh.points[head];
        // A shift beyond rounding, though a 32-bit number.
        let bump = 4.0 * f64::from(f32::EPSILON) * (1.0 + 4.0 * offset);
        volume.mesh.points[head] = (place + volume.patches[2].cap.unwrap().normal * bump).map(|x| f64::from(x as f32));
        assert_eq!(failing(&volume, &expectation), [Line::CapFlat], "{offset}");
        // With one 64-bit coordinate, rounding to 32 bits is no excuse.
        volume.mesh.points[head] = place;
        volume.mesh.points[head].x += 1e-12 * (1.0 + offset);
        assert_eq!(failing(&volume, &expectation), [Line::CapFlat], "{offset}");
    }
}

/// A label moved from the cap's middle to the wall leaves a hole; one on the far side of the wall makes a second piece.
#[test]
fn caps_that_are_no_discs() {
    let centre_face = |v: &VolumeMesh| {
        v.boundary.iter().position(|f| {
            f.iter().all(|&i| {
                let p = v.mesh.points[i as usize];
                p.z > HEIGHT - 1e-9 && libm::hypot(p.x, p.y) < 0.6
            })
        })
    };
    let lines = planted(|v, _| {
        let face = centre_face(v).unwrap();
        v.boundary_patch[face] = WALL;
    });
    assert_eq!(lines, [Line::CapDisc]);
    let lines = planted(|v, _| {
        let face = v.boundary_patch.iter().position(|&id| id == WALL).unwrap();
        v.boundary_patch[face] = 3;
    });
    assert!(lines.contains(&Line::CapDisc) && lines.contains(&Line::CapNormal));
    let lines = planted(|v, _| v.boundary_patch.iter_mut().filter(|id| **id == 3).for_each(|id| *id = WALL));
    assert_eq!(lines, [Line::CapDisc, Line::CapFlat, Line::CapCentred, Line::CapArea, Line::CapNormal]);
}

#[test]
fn only_the_first_offenders_are_kept_and_fewer_are_printed() {
    let (mut volume, expectation) = tube();
    for t in &mut volume.mesh.tets {
        t.swap(0, 1);
    }
    let report = check_volume(&volume, Some(&expectation));
    let line = report.line(Line::PositiveTets).unwrap();
    let all = volume.mesh.tets.len();
    assert_eq!((line.count as usize, line.offenders.len()), (all, all.min(KEPT_OFFENDERS)));
    let json = serde_json::to_value(line).unwrap();
    assert_eq!(json["offenders"].as_array().unwrap().len(), PRINTED_OFFENDERS);
    assert_eq!(report.to_string().matches("         tetrahedron ").count(), PRINTED_OFFENDERS);
    assert_eq!(line.offenders[3].ids, [3]);
    assert!(failing(&volume, &expectation).contains(&Line::PositiveTets));
}

#[test]
fn offenders_of_two_conditions_are_kept_together_up_to_the_limit() {
    let line = |count: u32| {
        let mut tally = result::Tally::new(Line::NoUnusedPoints);
        (0..count).for_each(|v| tally.add(|| Offender::new(OffenderKind::Point, &[v], None)));
        tally.done()
    };
    for [first, second] in [[0, 3], [700, 200], [700, 700], [1200, 5]] {
        let mut tally = result::Tally::new(Line::NoUnusedPoints);
        tally.add_all(line(first));
        tally.add_all(line(second));
        let both = tally.done();
        let all = (first + second) as usize;
        assert_eq!((both.count as usize, both.offenders.len()), (all, all.min(KEPT_OFFENDERS)));
    }
}

#[test]
fn a_single_outlet_without_a_cap_hides_no_fault() {
    // A wall triangle with a label of its own, and a cap at a label that no triangle has.
    let strange_label = |v: &mut VolumeMesh, _: &mut Expectation| {
        let wall = v.boundary_patch.iter().position(|&id| id == WALL).unwrap();
        v.boundary_patch[wall] = 9;
        v.patches.push(Patch { id: 9, name: "outlet_6".into(), cap: None });
    };
    assert_eq!(planted(strange_label), [Line::WallOrCap]);
    let lost_cap = |v: &mut VolumeMesh, _: &mut Expectation| v.patches[2].cap = None;
    assert_eq!(planted(lost_cap), [Line::WallOrCap, Line::CapPerTerminal]);
}

#[test]
fn of_outlets_that_are_one_patch_the_caps_are_not_known() {
    let group = |v: &mut VolumeMesh, e: &mut Expectation| {
        v.patches[2] = Patch { id: 3, name: "outlets".into(), cap: None };
        e.terminals.retain(|&n| n != 3);
    };
    let (mut volume, mut expectation) = tube();
    group(&mut volume, &mut expectation);
    assert_ne!(check_volume(&volume, Some(&expectation)).verdict, Verdict::Invalid);
    let remove_both_caps = |v: &mut VolumeMesh, e: &mut Expectation| {
        group(v, e);
        v.patches[1].cap = None;
    };
    assert_eq!(planted(remove_both_caps), [Line::CapPerTerminal]);
}
