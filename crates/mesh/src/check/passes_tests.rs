use super::*;
use crate::VolumeMesh;
use crate::check::{Outcome, check_regions};
use crate::shapes::walled_channel;

fn both(change: impl Fn(&mut VolumeMesh)) -> [CheckReport; 2] {
    let (mut volume, regions) = walled_channel(2);
    let lumen = check_regions(&volume, &regions, None);
    change(&mut volume);
    let whole = check_regions(&volume, &regions, None);
    [whole, check_regions_in_passes(&volume, &regions, &lumen, &()).expect("readable")]
}

fn failed(report: &CheckReport) -> Vec<Line> {
    report.failed().map(|line| line.line).collect()
}

type Change = fn(&mut VolumeMesh);

#[test]
fn a_sound_mesh_gets_the_same_report() {
    let [whole, passes] = both(|_| ());
    assert_eq!(failed(&passes), []);
    assert_eq!(whole.counts.tets, passes.counts.tets);
    assert_eq!(whole.counts.boundary_faces, passes.counts.boundary_faces);
    assert_eq!(whole.counts.components, passes.counts.components);
    for (a, b) in whole.regions.iter().zip(&passes.regions) {
        assert_eq!(
            (a.id, &a.name, a.tets, a.components, a.boundary_faces),
            (b.id, &b.name, b.tets, b.components, b.boundary_faces)
        );
        assert!((a.volume - b.volume).abs() < 1e-12 * a.volume);
    }
    let outcome = |report: &CheckReport| report.lines.iter().map(|line| (line.line, line.outcome)).collect::<Vec<_>>();
    let implied = |list: Vec<(Line, Outcome)>| {
        list.into_iter().filter(|(line, _)| !OF_NETWORK.contains(line)).collect::<Vec<_>>()
    };
    assert_eq!(implied(outcome(&whole)), implied(outcome(&passes)));
}

#[test]
fn faults_are_found() {
    let changes: [(&str, Change); 8] = [
        ("inverted", |v| v.mesh.tets[3].swap(0, 1)),
        ("missing", |v| {
            v.mesh.tets.pop();
            v.tet_block.pop();
        }),
        ("doubled", |v| {
            v.mesh.tets.push(v.mesh.tets[0]);
            v.tet_block.push(v.tet_block[0]);
        }),
        ("in the wrong region", |v| v.tet_block[0] = 2),
        ("in no region", |v| v.tet_block[0] = 9),
        ("a face without label", |v| {
            v.boundary.pop();
            v.boundary_patch.pop();
            v.boundary_block.pop();
        }),
        ("a reversed face", |v| v.boundary[0].swap(1, 2)),
        ("an unused point", |v| v.mesh.points.push(Point3::origin())),
    ];
    for (what, change) in changes {
        let [whole, passes] = both(change);
        assert!(!failed(&whole).is_empty(), "{what}");
        assert!(!failed(&passes).is_empty(), "{what}: {:?}", failed(&whole));
    }
}

#[test]
fn overlapping_regions_are_found() {
    let [whole, passes] = both(|volume| {
        // A second copy of the mesh at nearly the same place: each alone is sound.
        let n = volume.mesh.points.len() as u32;
        let moved: Vec<Point3> = volume.mesh.points.iter().map(|p| p + crate::geometry::Vec3::repeat(1e-3)).collect();
        volume.mesh.points.extend(moved);
        let tets: Vec<[u32; 4]> = volume.mesh.tets.iter().map(|t| t.map(|v| v + n)).collect();
        volume.mesh.tets.extend(tets);
        volume.tet_block.extend_from_within(..);
        let faces: Vec<[u32; 3]> = volume.boundary.iter().map(|f| f.map(|v| v + n)).collect();
        volume.boundary.extend(faces);
        volume.boundary_patch.extend_from_within(..);
        volume.boundary_block.extend_from_within(..);
    });
    assert!(failed(&whole).contains(&Line::NoSelfIntersection));
    assert!(failed(&passes).contains(&Line::NoSelfIntersection), "{:?}", failed(&passes));
}

#[test]
fn faces_of_both_orientations_cancel_in_a_chain() {
    let even = [[3, 7, 5], [7, 5, 3], [5, 3, 7]];
    let odd = [[7, 3, 5], [3, 5, 7], [5, 7, 3]];
    let sum = |faces: &[([u32; 3], bool)]| {
        let mut chain = Chain::default();
        for &(face, is_reversed) in faces {
            add(&mut chain, face, is_reversed);
        }
        chain
    };
    for a in even {
        assert!(even.iter().all(|&b| sum(&[(a, false)]) == sum(&[(b, false)])));
        assert!(
            odd.iter().all(|&b| sum(&[(a, false), (b, false)]) == [0; 2] && sum(&[(b, true)]) == sum(&[(a, false)]))
        );
        assert_ne!(sum(&[(a, false)]), [0; 2]);
    }
}
