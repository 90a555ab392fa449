//! Parts whose certificates and data contradict each other.

use super::served::Served;
use super::*;

/// Result of a check that reads changed joints.
fn with_joints(parts: &MemoryParts, change: fn(&mut FacesApart)) -> io::Result<CheckReport> {
    let served = Served { change, ..Served::of(parts) };
    check_parts(&served, &parts.patches, Some(&parts.expectation), 0).map(|checked| checked.report)
}

#[test]
fn joints_other_than_the_certified_ones_are_refused() {
    let changes: [fn(&mut FacesApart); 4] = [
        |joint| joint.points[2].z += 1e-9,
        |joint| joint.faces.truncate(5),
        |joint| joint.vertices.push(0),
        |joint| joint.faces[0][1] = 1_000_000,
    ];
    let bar = bar();
    for change in changes {
        let error = with_joints(&bar, change).unwrap_err();
        assert!(error.to_string().contains("is not what was certified"), "{error}");
    }
}

#[test]
fn joints_of_faulty_parts_may_differ_but_have_points() {
    let (faulty, _) = planted(&bar(), |c| c.pieces.iter_mut().for_each(|piece| piece.mesh.tets[5].swap(0, 1)));
    assert_eq!(with_joints(&faulty, |joint| joint.faces.truncate(5)).unwrap().verdict, Verdict::Invalid);
    assert!(with_joints(&faulty, |joint| joint.faces[0][1] = 1_000_000).is_err());
}

#[test]
fn walls_have_the_certified_faces_and_points() {
    let cut = bar();
    let (held, _) = glue::Held::read(&cut, &mut tallies::Tallies::default()).unwrap();
    let is_joined = joints::flags(&cut, &held).unwrap();
    let mut moved = cut.wall(1).unwrap();
    moved.points[3].x += 1e-9;
    let mut less = cut.wall(1).unwrap();
    less.faces.pop();
    for wall in [moved, less] {
        assert!(!held.is_wall(1, &is_joined, &wall));
    }
}

#[test]
fn more_vertices_in_a_joint_than_there_are_leave_ids_out_of_range() {
    let mut cut = bar();
    let joined = cut.joined[4][0];
    cut.certificates[joined.0 as usize].joints[joined.1 as usize].vertices += 1;
    assert_eq!(cut.failing(), [Line::IndicesInRange]);
}

#[test]
fn ids_up_to_the_number_of_points_are_in_range() {
    // 64 points, whose flags fill a word.
    let mesh = cube_lattice(3);
    let whole = MemoryParts::with_parts(&mesh, &vec![0; mesh.tets.len()], &[], vec![0]);
    assert_eq!(whole.failing(), []);
    let (beyond, lines) = planted(&whole, |c| c.pieces[0].vertices[63] = 64);
    assert_eq!(lines, [Line::IndicesInRange, Line::NoUnusedPoints]);
    assert_eq!(beyond.check().line(Line::IndicesInRange).unwrap().offenders[0].ids, [64]);
    assert_eq!(beyond.check().line(Line::NoUnusedPoints).unwrap().offenders[0].ids, [63]);
}
