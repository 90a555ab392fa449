use super::*;
use crate::check::tests::{add_copy, relabelled};
use crate::check::{Outcome, check_regions};
use crate::geometry::Vec3;
use crate::shapes::walled_channel;
use crate::source::SourceCounts;
use crate::{Patch, VolumeMesh};
use std::borrow::Cow;

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
    let pop = |v: &mut VolumeMesh| {
        v.mesh.tets.pop();
        v.tet_block.pop();
    };
    let double = |v: &mut VolumeMesh| {
        v.mesh.tets.push(v.mesh.tets[0]);
        v.tet_block.push(v.tet_block[0]);
    };
    let unlabel = |v: &mut VolumeMesh| {
        v.boundary.pop();
        v.boundary_patch.pop();
        v.boundary_block.pop();
    };
    // All other conditions on the mesh follow from these.
    let changes: [(&str, Change, &[Line]); 9] = [
        (
            "inverted",
            |v| v.mesh.tets[3].swap(0, 1),
            &[Line::PositiveTets, Line::BoundaryEdges, Line::LabelsMatchBoundary],
        ),
        ("not finite", |v| v.mesh.points[133].x = f64::NAN, &[Line::PositiveTets]),
        ("missing", pop, &[Line::LabelsMatchBoundary]),
        ("doubled", double, &[Line::LabelsMatchBoundary]),
        ("in the wrong region", |v| v.tet_block[0] = 2, &[Line::LabelsMatchBoundary]),
        ("in no region", |v| v.tet_block[0] = 9, &[Line::LabelsMatchBoundary, Line::RegionsNamed]),
        ("a face without label", unlabel, &[Line::BoundaryEdges, Line::LabelsMatchBoundary]),
        ("a reversed face", |v| v.boundary[0].swap(1, 2), &[Line::BoundaryEdges, Line::LabelsMatchBoundary]),
        ("an unused point", |v| v.mesh.points.push(Point3::origin()), &[Line::NoUnusedPoints]),
    ];
    for (what, change, expected) in changes {
        let [whole, passes] = both(change);
        assert!(!failed(&whole).is_empty(), "{what}");
        assert_eq!(failed(&passes), expected, "{what}");
        let implied = passes.line(Line::FacesSharedByTwo).map(|line| line.outcome);
        assert_eq!(implied, Some(Outcome::NotChecked(Skipped::Because(Line::PositiveTets))), "{what}");
    }
}

#[test]
fn overlapping_regions_are_found() {
    // A second copy of the mesh at nearly the same place: each alone is sound.
    let [whole, passes] = both(|volume| add_copy(volume, |p| p + Vec3::repeat(1e-3)));
    assert!(failed(&whole).contains(&Line::NoSelfIntersection));
    assert!(failed(&passes).contains(&Line::NoSelfIntersection), "{:?}", failed(&passes));
}

#[test]
fn oriented_faces_begin_with_their_smallest_vertex() {
    for face in [[3, 5, 7], [5, 7, 3], [7, 3, 5]] {
        assert_eq!(oriented(face), [3, 5, 7]);
    }
    for face in [[3, 7, 5], [7, 5, 3], [5, 3, 7]] {
        assert_eq!(oriented(face), [3, 7, 5]);
    }
    assert_eq!(oriented([4, 4, 2]), [2, 4, 4]);
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
    assert_eq!(sum(&[([3, 5, 7], false)]), id_sums([3, 5, 7]));
    for a in even {
        assert!(even.iter().all(|&b| sum(&[(a, false)]) == sum(&[(b, false)])));
        assert!(
            odd.iter().all(|&b| sum(&[(a, false), (b, false)]) == [0; 2] && sum(&[(b, true)]) == sum(&[(a, false)]))
        );
        assert_ne!(sum(&[(a, false)]), [0; 2]);
    }
}

#[test]
fn a_mesh_inside_another_is_found() {
    // A small copy in the outermost region.
    let [whole, passes] = both(|volume| add_copy(volume, |p| p * 0.01 + Vec3::repeat(0.05)));
    assert!(failed(&whole).contains(&Line::NoSelfIntersection));
    assert_eq!(failed(&passes), [Line::NoSelfIntersection]);
    let [whole, passes] = both(|volume| add_copy(volume, |p| p + Vec3::x() * 1.5));
    assert_eq!((failed(&whole), failed(&passes)), (vec![], vec![]));
}

#[test]
fn inner_boundaries_are_told_from_the_outer_one() {
    let [_, passes] = both(|volume| {
        // A cell of the third region that touches the second along an edge.
        let is_in = |p: &Point3| (0.8..=0.9).contains(&p.x) && (0.8..=0.9).contains(&p.y);
        for (block, tet) in volume.tet_block.iter_mut().zip(&volume.mesh.tets) {
            if tet.iter().all(|&v| is_in(&volume.mesh.points[v as usize])) {
                *block = 2;
            }
        }
        *volume = relabelled(std::mem::take(volume));
    });
    assert_eq!(failed(&passes), [Line::RegionBoundaries]);
}

#[test]
fn regions_beyond_faces_are_those_of_their_tetrahedra() {
    // Patches whose names do not tell the regions.
    let renamed = |volume: &mut VolumeMesh| {
        for patch in &mut volume.patches {
            patch.name = patch.name.replace("interface", "membrane");
        }
    };
    let [whole, passes] = both(renamed);
    assert_eq!((failed(&whole), failed(&passes)), (vec![], vec![]));
    let lost = both(|volume| {
        renamed(volume);
        volume.boundary_block.iter_mut().filter(|block| **block == 2).for_each(|block| *block = 1);
    });
    assert!(failed(&lost[1]).contains(&Line::LabelsMatchBoundary));
}

#[test]
fn interfaces_face_out_of_the_region_with_the_smaller_id() {
    let [whole, passes] = both(|volume| {
        let face = volume.boundary_patch.iter().position(|&patch| patch == 5).unwrap();
        volume.boundary[face].swap(1, 2);
        volume.boundary_block[face] = 3;
    });
    assert_eq!(failed(&whole), [Line::InterfacesLabelled]);
    assert_eq!(failed(&passes), [Line::RegionBoundaries, Line::InterfaceSides]);
}

#[test]
fn regions_with_tetrahedra_and_with_names_are_the_same() {
    let [whole, passes] = both(|volume| {
        volume.tet_block.iter_mut().chain(&mut volume.boundary_block).filter(|b| **b == 3).for_each(|block| *block = 9);
        // Its faces tell the region from the tetrahedra.
        volume.patches.iter_mut().filter(|patch| patch.id == 5).for_each(|patch| patch.name = "membrane".into());
    });
    assert!(failed(&whole).contains(&Line::RegionsNamed));
    let line = passes.line(Line::RegionsNamed).unwrap();
    let ids: Vec<&[i64]> = line.offenders.iter().map(|offender| &offender.ids[..]).collect();
    assert_eq!((line.outcome, ids), (Outcome::Fail, vec![&[3][..], &[9]]));
}

/// Mesh with its tetrahedra in parts of a thousand.
struct InParts(VolumeMesh);

impl MeshSource for InParts {
    fn counts(&self) -> SourceCounts {
        self.0.counts()
    }

    fn patches(&self) -> &[Patch] {
        &self.0.patches
    }

    fn parts(&self) -> u32 {
        self.0.mesh.tets.len().div_ceil(1000) as u32
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        if part == 0 { self.0.points(0) } else { Ok(Cow::default()) }
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        let of = part as usize;
        let tets = self.0.mesh.tets.chunks(1000).nth(of).unwrap_or_default().into();
        Ok(TetPiece { tets, blocks: self.0.tet_block.chunks(1000).nth(of).unwrap_or_default().into() })
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        if part == 0 { self.0.boundary(0) } else { Ok(FacePiece::default()) }
    }
}

#[test]
fn faults_have_numbers_of_the_whole() {
    let (mut volume, regions) = walled_channel(2);
    let lumen = check_regions(&volume, &regions, None);
    for tet in [7, 1003, 2005, 2006] {
        volume.mesh.tets[tet].swap(0, 1);
    }
    for tet in [8, 1004, 2007] {
        volume.mesh.tets[tet][0] = volume.mesh.tets[tet][3];
    }
    let report = check_regions_in_passes(&InParts(volume), &regions, &lumen, &()).unwrap();
    let ids = |line| report.line(line).unwrap().offenders.iter().map(|offender| offender.ids[0]).collect::<Vec<_>>();
    assert_eq!(ids(Line::NoRepeatedVertex), [8, 1004, 2007]);
    assert_eq!(ids(Line::PositiveTets), [7, 8, 1003, 1004, 2005, 2006, 2007]);
}
