//! Pieces of the whole agree with each other.

use super::*;
use crate::pipeline::store::{Extents, Manifest};
use crate::pipeline::tests::uneven;
use crate::pipeline::{MeshPlan, Meshed, mesh_into};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::gather;

fn meshed(store: &Store) -> Meshed<Whole<'_>> {
    mesh_into(store, &uneven(), &MeshPlan::default(), &|_| Ok(()), &()).expect("meshed")
}

#[test]
fn labels_and_counts_are_those_of_the_cells() {
    let store = Store::in_memory();
    let whole = meshed(&store).mesh;
    let (mut points, mut tets, mut faces) = (0, 0, 0);
    for part in 0..whole.parts() {
        let (cells, labels) = (whole.tets(part).expect("read"), whole.tet_labels(part).expect("read"));
        assert_eq!((labels.count, &labels.blocks), (cells.tets.len(), &cells.blocks));
        assert_eq!(cells.blocks.len(), cells.tets.len());
        assert_eq!(whole.tet(part, 1), tets as u64 + 1);
        let (boundary, labels) = (whole.boundary(part).expect("read"), whole.face_labels(part).expect("read"));
        assert_eq!(labels.count, boundary.faces.len());
        assert_eq!((&labels.patches, &labels.blocks), (&boundary.patches, &boundary.blocks));
        assert_eq!((boundary.patches.len(), boundary.blocks.len()), (labels.count, labels.count));
        assert_eq!(whole.bounds(part).expect("read"), whole.certificate(part).expect("read").bounds());
        points += whole.points(part).expect("read").len();
        tets += cells.tets.len();
        faces += labels.count;
    }
    assert_eq!(whole.counts(), SourceCounts { points, tets, boundary: faces });
    let size = whole.size();
    assert_eq!((size.points, size.tets, size.wall_triangles + size.cap_triangles), (points, tets, faces));
    assert!(size.cap_triangles > 0 && size.cap_triangles < faces / 4);
}

#[test]
fn both_sides_of_a_joint_have_the_same_points_and_numbers() {
    let store = Store::in_memory();
    let whole = meshed(&store).mesh;
    let all: Vec<Point3> = (0..whole.parts()).flat_map(|part| whole.points(part).expect("read").into_owned()).collect();
    assert!(!whole.joined().is_empty());
    let mut numbers = Vec::new();
    for [a, b] in whole.joined() {
        let [a, b] = [a, b].map(|&(part, joint)| Parts::joint(&whole, part, joint).expect("read"));
        assert_eq!((&a.vertices, &a.points), (&b.vertices, &b.points));
        let named: Vec<Point3> = a.vertices.iter().map(|&v| all[v as usize]).collect();
        assert_eq!(named, a.points);
        // Faces of both sides are turned to each other.
        let turned =
            |face: &[u32; 3]| b.faces.iter().any(|other| face.iter().all(|v| other.contains(v)) && face != other);
        assert!(a.faces.len() == b.faces.len() && a.faces.iter().all(turned));
        numbers.push(a.vertices);
    }
    #[cfg(feature = "woven")]
    assert_eq!(whole.joint_vertices().expect("read"), numbers);
    for part in 0..whole.parts() {
        let wall = whole.wall(part).expect("read");
        assert!(wall.vertices.is_sorted() && wall.vertices.len() == wall.points.len());
        let ids: Vec<u32> = wall.vertices.iter().copied().step_by(7).collect();
        let named: Vec<Point3> = wall.points.iter().copied().step_by(7).collect();
        assert_eq!(whole.points_of(&ids).expect("read"), named);
        let count = whole.connectivity(whole.plan.part(part)).expect("read").sizes().points;
        let vertices = whole.vertices(part, count).expect("read");
        assert!((0..count).all(|v| whole.vertex(part, v) == vertices[v as usize]));
    }
    let missing = whole.counts().points as u32;
    assert!(whole.points_of(&[missing]).is_err());
}

#[test]
fn a_whole_in_a_work_directory_is_read_again_without_its_network() {
    let folder = tempfile::tempdir().expect("a folder");
    let manifest = Manifest::new(&uneven(), serde_json::Value::Null);
    assert!(!LeftWhole::may_be_in(folder.path()) && LeftWhole::open(folder.path()).is_none());
    let given = {
        let store = Store::in_folder(folder.path(), &manifest, false).expect("a work directory");
        let whole = meshed(&store).mesh;
        whole.leave().expect("written");
        gather(&whole).expect("read")
    };
    assert!(given.patches.iter().filter(|patch| patch.cap.is_some()).count() == 4);
    assert!(LeftWhole::may_be_in(folder.path()));
    let left = LeftWhole::open(folder.path()).expect("there");
    assert_eq!(gather(&left.whole(&())).expect("read"), given);
    // Other counts than those of the parts are found, and so is a file that is cut off.
    let (extents, plan): (Extents, Numbering) = Store::left(folder.path(), left::NAME).expect("there");
    let store = Store::in_folder(folder.path(), &manifest, false).expect("a work directory");
    let broken = |change: &dyn Fn(&mut Numbering)| {
        let mut plan = plan.clone();
        change(&mut plan);
        store.leave(left::NAME, &(extents.clone(), plan)).expect("written");
        LeftWhole::open(folder.path()).is_none()
    };
    assert!(!broken(&|_| ()));
    assert!(broken(&|plan| plan.parts.truncate(1)));
    assert!(broken(&|plan| plan.parts[1].first_point = u32::MAX));
    assert!(broken(&|plan| plan.parts[1].first_tet = u64::MAX));
    assert!(broken(&|plan| plan.counts.points = 0));
    assert!(broken(&|plan| plan.counts.tets = 0));
    assert!(broken(&|plan| plan.counts.points = usize::MAX));
    assert!(broken(&|plan| plan.clusters += 1));
    assert!(broken(&|plan| plan.joined[0][1].0 = u32::MAX));
    assert!(broken(&|plan| plan.joined[0][1].0 = plan.parts.len() as u32));
    let open = |plan: &mut Numbering, part: usize| {
        plan.open.insert(JointPlace { part: part as u32, joint: 0 }, 1);
    };
    assert!(broken(&|plan| open(plan, plan.parts.len())) && !broken(&|plan| open(plan, 0)));
    assert!(!broken(&|_| ()));
}
