//! Records of blocks with vertex numbers of both sizes, and damaged ones.

use super::*;
use crate::block::topology::FinishedJoint;
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_skeleton::NodeId;

/// Block that refers to its last points; with a hull instead of tetrahedra if `hollow`.
fn block(points: u32, hollow: bool) -> Finished {
    let last = points - 1;
    let tets = vec![[last - 3, last - 2, last - 1, last], [0, 2, last, 5], [7, last, 1, 3]];
    let hull = vec![[last, 0, 1], [2, 3, last - 1], [last - 2, 9, 4], [1, 2, last]];
    let section = Section::new(Point3::new(1.0, 2.0, 3.0), Vec3::z(), 0.5);
    let cap = |node: u32, faces: &[u32]| FinishedCap { node: NodeId(node), section, faces: faces.to_vec() };
    Finished {
        mesh: TetMesh {
            points: (0..points).map(|i| Point3::new(f64::from(i), 0.25, -1.0)).collect(),
            tets: if hollow { Vec::new() } else { tets },
        },
        hull: if hollow { hull } else { Vec::new() },
        shared: 5,
        wall: vec![0, 2, 3],
        joints: vec![
            FinishedJoint { vertices: vec![0, 2, last], faces: vec![1] },
            FinishedJoint { vertices: vec![1, 3], faces: vec![0, 2, 3] },
        ],
        caps: vec![cap(8, &[3, 1]), cap(9, &[2])],
        ..Finished::default()
    }
}

#[test]
fn numbers_of_both_sizes_come_back() {
    for (points, hollow) in [(12, false), (12, true), (1 << 16, false), (65_537, false), (65_537, true)] {
        let given = block(points, hollow);
        let Encoded { connectivity, geometry, .. } = Encoded::of(&given).expect("encoded");
        let record = Record::open(&connectivity[..], &geometry[..]).expect("a record");
        assert_eq!(record.block().expect("read"), given, "{points} {hollow}");
        let faces = if hollow { vec![3, 0, 2] } else { vec![11, 0, 6] };
        let triangles = record.connectivity.triangles(&faces).expect("read");
        assert_eq!(triangles, given.triangles(&faces), "{points} {hollow}");
        assert!(record.connectivity.triangles(&[if hollow { 4 } else { 12 }]).is_err());
        let some = [points - 1, 0, 17 % points];
        let expected: Vec<Point3> = some.iter().map(|&v| given.mesh.points[v as usize]).collect();
        assert_eq!(record.geometry.points_at(&some).expect("read"), expected);
        assert!(record.geometry.points_at(&[points]).is_err());
        let sizes = record.connectivity.sizes();
        assert_eq!((sizes.outer_faces(), sizes.shared, sizes.joint_vertices, sizes.joint_faces), (6, 5, 5, 4));
    }
}

#[test]
fn records_that_do_not_belong_together_or_contradict_themselves_are_refused() {
    let [a, b] = [12, 13].map(|points| Encoded::of(&block(points, false)).expect("encoded"));
    assert!(a.hash != b.hash);
    assert!(Record::open(&a.connectivity[..], &b.geometry[..]).is_err());
    let mut without_caps = block(12, false);
    without_caps.caps.clear();
    let other = Encoded::of(&without_caps).expect("encoded");
    assert!(Record::open(&other.connectivity[..], &a.geometry[..]).is_err());
    let refused = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = a.connectivity.clone();
        change(&mut bytes);
        Connectivity::open(&bytes[..]).and_then(|record| {
            record.joints().and(record.caps())?;
            record.wall().and(record.hull())?;
            record.tets()
        })
    };
    assert!(refused(&|_| ()).is_ok());
    // More shared points than points.
    assert!(refused(&|bytes| bytes[4] = 13).is_err());
    assert!(refused(&|bytes| bytes[4] = 12).is_ok());
    // A vertex beyond the last point, which is the last number.
    assert!(refused(&|bytes| *bytes.iter_mut().rev().nth(1).expect("a number") = 12).is_err());
    assert!(refused(&|bytes| *bytes.iter_mut().rev().nth(1).expect("a number") = 11).is_ok());
    // Joints and caps with more members than all have.
    assert!(refused(&|bytes| bytes[40] = 6).is_err());
    assert!(refused(&|bytes| bytes[44] = 5).is_err());
}

#[test]
fn records_that_are_cut_off_are_not_opened() {
    for (points, hollow) in [(12, false), (12, true), (65_537, false)] {
        let Encoded { connectivity, geometry, .. } = Encoded::of(&block(points, hollow)).expect("encoded");
        let sizes = Connectivity::open(&connectivity[..]).expect("a record").sizes();
        assert_eq!(sizes.bytes(), connectivity.len() as u64);
        for length in [0, 40, connectivity.len() / 2, connectivity.len() - 1] {
            assert!(Connectivity::open(&connectivity[..length]).is_err(), "{length} of {}", connectivity.len());
        }
        assert!(Record::open(&connectivity[..], &geometry[..geometry.len() / 2]).is_err());
    }
}

#[test]
fn triangles_have_no_vertex_beyond_the_last_point() {
    let mut bytes = Encoded::of(&block(12, true)).expect("encoded").connectivity;
    // The last number is a vertex of the last triangle.
    for (vertex, is_sound) in [(11, true), (12, false)] {
        *bytes.iter_mut().rev().nth(1).expect("a number") = vertex;
        let record = Connectivity::open(&bytes[..]).expect("a record");
        assert_eq!(record.triangles(&[3]).is_ok(), is_sound);
    }
}
