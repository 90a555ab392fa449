//! One planted fault at a time.

use super::*;

#[test]
fn parts_of_sound_meshes_pass_as_the_whole_does() {
    let bar = bar();
    assert_eq!((bar.pieces.len(), bar.joined.len()), (10, 9));
    assert_eq!(bar.check().verdict, Verdict::Valid);
    for cut in [bar, star(), ring(4), ring(2)] {
        assert!(cut.certificates.iter().all(Certificate::is_sound));
        assert_same(&cut);
        assert_eq!(cut.check().verdict, Verdict::Valid, "{:?}", cut.check().failed().collect::<Vec<_>>());
    }
    assert_eq!(ring(2).joined.len(), 4);
}

#[test]
fn certificates_survive_being_stored() {
    for certificate in
        bar().certificates.iter().chain(&planted(&bar(), |c| c.pieces[3].mesh.tets[5].swap(0, 1)).0.certificates)
    {
        let text = serde_json::to_string(certificate).unwrap();
        assert_eq!(&serde_json::from_str::<Certificate>(&text).unwrap(), certificate);
    }
}

#[test]
fn genus_and_components_are_compared() {
    let mut cut = ring(4);
    cut.expectation.loops = vec![0];
    let report = cut.check();
    assert_eq!(report.failed().map(|l| l.line).collect::<Vec<_>>(), [Line::Loops]);
    assert_same(&cut);
    cut.expectation.loops = vec![1, 0];
    assert_eq!(cut.failing(), [Line::Components, Line::Loops]);
    assert_same(&cut);
}

#[test]
fn surfaces_of_another_genus_are_named_by_their_smallest_vertex() {
    let (mut cut, _) = with_part(&ring(4), cube_at([2.0, 0.0, 0.0], 1.0));
    for loops in [vec![1, 1], vec![0, 0]] {
        cut.expectation.loops = loops;
        let (parts, whole) = (cut.check(), cut.whole());
        same_offenders(&parts, &whole, Line::Loops);
        let named = |report: &CheckReport| report.line(Line::Loops).unwrap().offenders.clone();
        assert_eq!(named(&parts), named(&whole));
    }
}

#[test]
fn faults_inside_a_part_are_named_in_numbers_of_the_whole() {
    let inverted = planted(&bar(), |c| c.pieces[4].mesh.tets[7].swap(1, 2)).0;
    assert_same(&inverted);
    assert_eq!(inverted.failing(), [Line::PositiveTets, Line::OppositeSides]);
    let (twice, lines) = planted(&star(), |c| {
        let t = c.pieces[0].mesh.tets[5];
        c.pieces[0].mesh.tets.push(t);
        c.pieces[0].tets.push(10_000);
    });
    assert!(lines.contains(&Line::NoDuplicateTets) && lines.contains(&Line::FacesSharedByTwo));
    same_offenders(&twice.check(), &twice.whole(), Line::FacesSharedByTwo);
    let (unused, lines) = planted(&star(), |c| {
        c.pieces[3].mesh.points.push(Point3::new(0.3, 0.2, 0.1));
        let id = c.pieces.iter().flat_map(|p| &p.vertices).max().unwrap() + 1;
        c.pieces[3].vertices.push(id);
    });
    assert_eq!(lines, [Line::NoUnusedPoints]);
    assert_same(&unused);
    let (copied, lines) = planted(&star(), |c| {
        let p = c.pieces[3].mesh.points[2];
        c.pieces[3].mesh.points.push(p);
        let id = c.pieces.iter().flat_map(|p| &p.vertices).max().unwrap() + 1;
        c.pieces[3].vertices.push(id);
    });
    assert_eq!(lines, [Line::NoDuplicatePoints, Line::NoUnusedPoints]);
    assert_same(&copied);
    let (moved, lines) = planted(&bar(), |c| c.pieces[4].mesh.points[0] = Point3::new(f64::NAN, 0.0, 0.0));
    assert_eq!(lines, [Line::FinitePoints]);
    assert_eq!(
        moved.check().line(Line::Loops).unwrap().outcome,
        Outcome::NotChecked(Skipped::Because(Line::FinitePoints))
    );
    let (_, lines) = planted(&bar(), |c| c.pieces[4].mesh.tets[3][1] = 1_000_000);
    assert_eq!(lines, [Line::IndicesInRange]);
    assert_eq!(MemoryParts::default().failing(), [Line::NotEmpty]);
}

#[test]
fn faults_of_joints() {
    // A joint's vertex moved in one of its parts.
    let bar = bar();
    let v = bar.pieces[5].joints[0][0][0];
    let id = i64::from(bar.pieces[5].vertices[v as usize]);
    let (moved, lines) = planted(&bar, |c| c.pieces[5].mesh.points[v as usize].x += 1e-9);
    assert_eq!(lines, [Line::NoDuplicatePoints]);
    assert_eq!(moved.check().line(Line::NoDuplicatePoints).unwrap().offenders[0].ids, [id]);
    // An unconnected joint: the same faces occur twice.
    let (_, lines) = planted(&bar, |c| {
        c.joined.remove(4);
    });
    assert!(lines.contains(&Line::NoSelfIntersection) && lines.contains(&Line::Components), "{lines:?}");
    // Connected twice.
    let (twice, lines) = planted(&bar, |c| c.joined.push(c.joined[4]));
    assert_eq!(lines, [Line::FacesSharedByTwo]);
    assert_eq!(twice.check().line(Line::FacesSharedByTwo).unwrap().count, bar.pieces[5].joints[0].len() as u64);
    // One face fewer in one of its parts.
    let face = bar.pieces[5].joints[0][3];
    let (less, lines) = planted(&bar, |c| {
        c.pieces[5].joints[0].remove(3);
    });
    assert!(lines.contains(&Line::LabelsMatchBoundary), "{lines:?}");
    let ids: BTreeSet<i64> = face.iter().map(|&v| i64::from(bar.pieces[5].vertices[v as usize])).collect();
    let named = &less.check().line(Line::LabelsMatchBoundary).unwrap().offenders[0].ids.clone();
    assert_eq!(named.iter().copied().collect::<BTreeSet<_>>(), ids);
    // Reversed orientation.
    let (_, lines) = planted(&bar, |c| c.pieces[5].joints[0].iter_mut().for_each(|f| f.swap(0, 1)));
    assert!(lines.contains(&Line::LabelsMatchBoundary), "{lines:?}");
    // Two ids swapped in one of its parts.
    let (_, lines) = planted(&bar, |c| {
        let w = c.pieces[5].joints[0][0][1];
        c.pieces[5].vertices.swap(v as usize, w as usize);
    });
    assert!(lines.contains(&Line::NoDuplicatePoints), "{lines:?}");
    // A joint that is no face of the part.
    let inner = tet_adjacency(&bar.pieces[5].mesh.tets, bar.pieces[5].mesh.points.len()).neighbors;
    let handle = inner.as_flattened().iter().position(|&n| n != u32::MAX).unwrap() as u32;
    let face = face_vertices(&bar.pieces[5].mesh.tets, handle);
    let (_, lines) = planted(&bar, |c| c.pieces[5].joints[0][0] = face);
    assert!(lines.contains(&Line::LabelsMatchBoundary), "{lines:?}");
    let mut piece = bar.pieces[5].clone();
    piece.joints[0][0] = [1_000_000, 0, 1];
    assert_eq!(piece.certificate().faults[0].line, Line::LabelsMatchBoundary);
    // Joints that do not exist are an error.
    let mut wrong = bar.clone();
    wrong.joined.push([(3, 9), (4, 0)]);
    assert!(check_parts(&wrong, &wrong.patches, None, 0).is_err());
}

#[test]
fn joints_are_discs_without_common_vertices() {
    // A bar of square section cut lengthwise into four: neighbours meet in a strip, all four in a line.
    let quarters = voxels(2, vec![0], |[x, y, _]| Some(2 * x + y));
    assert_eq!(quarters.whole().verdict, Verdict::Valid);
    assert_eq!(quarters.failing(), [Line::BoundaryFans]);
    // A ring around a core: the joint is an annulus of four sides.
    let core = voxels(3, vec![0], |[x, y, _]| Some(u32::from(x == 1 && y == 1)));
    assert_eq!(core.failing(), [Line::BoundaryFans]);
    let mut empty = star();
    empty.pieces[0].joints.push(Vec::new());
    empty.pieces[1].joints.push(Vec::new());
    empty.joined.push([(0, 6), (1, 1)]);
    empty.certify();
    assert_eq!(empty.failing(), [Line::BoundaryFans]);
}

#[test]
fn faults_of_ids() {
    // A point of one arm's tip has the id of one of another arm's.
    let star = star();
    let ids: Vec<u32> = star.pieces[1].vertices.clone();
    let free = ids.iter().copied().find(|id| !star.pieces[0].vertices.contains(id)).unwrap();
    let tip = star.pieces[4].vertices.iter().position(|id| !star.pieces[0].vertices.contains(id)).unwrap();
    let own = star.pieces[4].vertices[tip];
    let (twice, lines) = planted(&star, |c| c.pieces[4].vertices[tip] = free);
    assert_eq!(lines, [Line::NoUnusedPoints, Line::BoundaryFans]);
    assert_eq!(twice.check().line(Line::BoundaryFans).unwrap().offenders[0].ids, [i64::from(free)]);
    assert_eq!(twice.check().line(Line::NoUnusedPoints).unwrap().offenders[0].ids, [i64::from(own)]);
    let (_, lines) = planted(&star, |c| c.pieces[4].vertices[tip] = 1_000_000);
    assert_eq!(lines, [Line::IndicesInRange, Line::NoUnusedPoints]);
}

/// Adds an unconnected part, and expects one more component.
pub(super) fn with_part(cut: &MemoryParts, mesh: TetMesh) -> (MemoryParts, Vec<Line>) {
    planted(cut, |c| {
        let first = c.pieces.iter().flat_map(|p| &p.vertices).max().unwrap() + 1;
        let tets = c.pieces.iter().flat_map(|p| &p.tets).max().unwrap() + 1;
        let vertices = (0..mesh.points.len() as u32).map(|v| v + first).collect();
        let tets = (0..mesh.tets.len() as u64).map(|t| t + tets).collect();
        c.pieces.push(Piece { mesh, vertices, tets, ..Piece::default() });
        c.expectation.loops.push(0);
    })
}

pub(super) fn cube_at(corner: [f64; 3], size: f64) -> TetMesh {
    let mut mesh = cube_lattice(2);
    mesh.points.iter_mut().for_each(|p| *p = Point3::from(p.coords * size + Vec3::from(corner)));
    mesh
}

/// Mesh of two, the first one's points and tetrahedra first.
pub(super) fn side_by_side(first: &TetMesh, second: &TetMesh) -> TetMesh {
    let count = first.points.len() as u32;
    let mut mesh = first.clone();
    mesh.tets.extend(second.tets.iter().map(|t| t.map(|v| v + count)));
    mesh.points.extend_from_slice(&second.points);
    mesh
}

#[test]
fn parts_that_meet_are_found() {
    let star = star();
    assert_same(&with_part(&star, cube_at([2.0, 0.0, 0.0], 0.1)).0);
    let seventh = 1.0 / 7.0;
    let cases = [
        // Within two parts, through their joint; on a wall with a corner; with an edge on an edge; corner to corner;
        // face to face.
        [0.7, 0.45, 0.43],
        [5.0 * seventh, 0.45, 0.69],
        [5.0 * seventh, 5.0 * seventh, 0.5],
        [5.0 * seventh, 5.0 * seventh, 5.0 * seventh],
        [5.0 * seventh, 0.31, 0.31],
    ];
    for corner in cases {
        let (cut, lines) = with_part(&star, cube_at(corner, 0.09));
        assert!(lines.contains(&Line::NoSelfIntersection), "{lines:?}");
        let (parts, whole) = (cut.check(), cut.whole());
        fails_alike(&parts, &whole);
        let set = |r: &CheckReport| r.intersections.iter().map(|i| (faces(i), i.kind)).collect::<BTreeSet<_>>();
        assert_eq!(set(&parts), set(&whole));
        let meeting = check_parts(&cut, &cut.patches, None, 0).unwrap().meeting;
        let added = cut.pieces.len() as u32 - 1;
        assert!(meeting.iter().all(|pair| pair[1] == added), "{meeting:?}");
        assert_eq!(meeting.is_empty(), parts.intersections.is_empty());
    }
    assert_eq!(check_parts(&star, &star.patches, None, 0).unwrap().meeting, [[0; 2]; 0]);
}

fn faces(i: &Intersection) -> BTreeSet<[u32; 3]> {
    i.faces.iter().map(|&f| face_key(f)).collect()
}

/// Asserts that the same conditions fail, with the same counts.
fn fails_alike(parts: &CheckReport, whole: &CheckReport) {
    for (p, w) in parts.lines.iter().zip(&whole.lines) {
        assert!(p.outcome == w.outcome || is_unknown(p), "{p:?} {w:?}");
        if p.outcome == Outcome::Fail {
            assert_eq!(p.count, w.count, "{:?}", p.line);
        }
    }
}

#[test]
fn a_part_within_another_is_found_and_one_in_a_cavity_is_not() {
    let (nested, lines) = with_part(&star(), cube_at([0.45, 0.45, 0.45], 0.05));
    assert_eq!(lines, [Line::NoSelfIntersection]);
    let (parts, whole) = (nested.check(), nested.whole());
    same_offenders(&parts, &whole, Line::NoSelfIntersection);
    fails_alike(&parts, &whole);
    let place = |report: &CheckReport| report.line(Line::NoSelfIntersection).unwrap().offenders[0].position;
    assert_eq!(place(&parts), place(&whole));
    // Both in one part, the inner one first.
    let both = side_by_side(&cube_at([0.4, 0.4, 0.4], 0.2), &cube_at([0.0; 3], 1.0));
    let both = MemoryParts::with_parts(&both, &vec![0; both.tets.len()], &[], vec![0, 0]);
    assert_eq!(both.failing(), [Line::NoSelfIntersection]);
    same_offenders(&both.check(), &both.whole(), Line::NoSelfIntersection);
    // A hollow block in two halves would have a joint that is no disc; in one part with a stem it is valid.
    let hollow = voxels(5, vec![0, 0], |c| {
        if c.iter().all(|&x| x == 1) {
            return None;
        }
        c.iter().all(|&x| x < 3).then_some(0).or_else(|| (c[0] >= 3 && c[1] == 1 && c[2] == 1).then_some(1))
    });
    assert_eq!(hollow.check().counts.boundary_components, 2);
    assert_eq!(hollow.failing(), [Line::Components]);
    assert_same(&hollow);
    let (inside, lines) = with_part(&hollow, cube_at([0.25, 0.25, 0.25], 0.1));
    assert!(!lines.contains(&Line::NoSelfIntersection));
    assert_same(&inside);
    let (inside, lines) = with_part(&hollow, cube_at([0.05, 0.05, 0.05], 0.1));
    assert!(lines.contains(&Line::NoSelfIntersection));
    same_offenders(&inside.check(), &inside.whole(), Line::NoSelfIntersection);
}

#[test]
fn faults_of_caps() {
    let bar = bar();
    let (missing, lines) = planted(&bar, |c| c.pieces[0].caps.clear());
    assert_eq!(lines, [Line::CapDisc, Line::CapFlat, Line::CapCentred, Line::CapArea, Line::CapNormal]);
    assert_same(&missing);
    let (_, lines) = planted(&bar, |c| drop(c.patches.remove(1)));
    assert_eq!(lines, [Line::WallOrCap, Line::CapPerTerminal]);
    // Another disc of the same node.
    let others: [fn(&mut Cap); 3] = [|cap| cap.radius = 0.98, |cap| cap.center.x = 0.01, |cap| cap.normal.x = 1e-12];
    for change in others {
        let (_, lines) = planted(&bar, |c| change(c.patches[1].cap.as_mut().unwrap()));
        assert!(lines.contains(&Line::WallOrCap) && lines.contains(&Line::CapDisc), "{lines:?}");
    }
    let (hole, lines) = planted(&bar, |c| {
        c.pieces[0].caps[0].1.remove(0);
    });
    assert!(lines.contains(&Line::CapDisc));
    assert_same(&hole);
    let (_, lines) = planted(&bar, |c| {
        let face = c.pieces[0].joints[0][0];
        c.pieces[0].caps[0].1.push(face);
    });
    assert!(lines.contains(&Line::LabelsMatchBoundary) && lines.contains(&Line::CapDisc), "{lines:?}");
    let (tilted, lines) = planted(&bar, |c| {
        let tilt = Vec3::new(1e-8, 0.0, -1.0).normalize();
        c.pieces[0].caps[0].0.normal = tilt;
        c.patches[1].cap.as_mut().unwrap().normal = tilt;
    });
    assert_eq!(lines, [Line::CapFlat]);
    assert_same(&tilted);
}

#[test]
fn certificates_that_contradict_themselves_are_refused() {
    let changes: [fn(&mut HeldJoint); 2] = [|joint| joint.surface = 7, |joint| joint.component = 7];
    for change in changes {
        let mut cut = bar();
        change(&mut cut.certificates[1].joints[0]);
        let error = check_parts(&cut, &cut.patches, None, usize::MAX).unwrap_err();
        assert!(error.to_string().contains("contradicts itself"), "{error}");
    }
}

/// A wall with more ids than points.
#[test]
fn walls_with_ids_of_no_points_are_refused() {
    let cut = bar();
    let mut tallies = tallies::Tallies::default();
    let (held, _) = glue::Held::read(&cut, &mut tallies).unwrap();
    let is_joined = joints::flags(&cut, &held).unwrap();
    let mut wall = cut.wall(1).unwrap();
    assert!(held.is_wall(1, &is_joined, &wall));
    wall.vertices.push(0);
    assert!(!held.is_wall(1, &is_joined, &wall));
}

/// Walls changed after certification.
#[test]
fn what_was_not_certified_is_refused() {
    let mut cut = bar();
    cut.pieces[4].mesh.points.iter_mut().for_each(|p| p.x *= 1.5);
    assert_eq!(check_parts(&cut, &cut.patches, None, 0).unwrap_err().kind(), io::ErrorKind::InvalidData);
}

#[test]
fn the_result_depends_neither_on_memory_nor_on_threads() {
    let (cut, _) = with_part(&star(), cube_at([0.7, 0.45, 0.43], 0.09));
    let expected = cut.check();
    for memory in [0, 20_000, usize::MAX] {
        let report = check_parts(&cut, &cut.patches, Some(&cut.expectation), memory).unwrap().report;
        assert_eq!((&report, &report.intersections), (&expected, &expected.intersections));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| cut.check()), expected);
}
