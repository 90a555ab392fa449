//! Each condition on regions is broken once, and found.

use super::super::tests::{add_copy, relabelled};
use super::super::{Line, Outcome, Skipped, check_regions, check_regions_watched};
use super::*;
use crate::Cap;
use crate::geometry::{Point3, Vec3};
use crate::progress::{Cancelled, StopsAfter};
use crate::region::region_faces;
use crate::shapes::walled_channel;
use std::f64::consts::PI;

/// Channel with caps at both ends, and its regions and expectation.
fn channel() -> (VolumeMesh, Vec<NamedRegion>, Expectation) {
    let (mut volume, regions) = walled_channel(2);
    // The square of side 0.2 has the area of this disc.
    let radius = (0.04 / PI).sqrt();
    for (node, (z, patch)) in (0..).zip([0.0, 1.0].into_iter().zip(&mut volume.patches)) {
        let center = Point3::new(0.5, 0.5, z);
        patch.cap = Some(Cap { node, center, normal: Vec3::z() * (2.0 * z - 1.0), radius });
    }
    (volume, regions, Expectation { loops: vec![0], terminals: vec![0, 1] })
}

/// Failed conditions, in order.
fn failures(volume: &VolumeMesh, regions: &[NamedRegion], expectation: Option<&Expectation>) -> Vec<Line> {
    check_regions(volume, regions, expectation).failed().map(|failed| failed.line).collect()
}

/// Index of the first labelled face of a patch.
fn first_of(volume: &VolumeMesh, name: &str) -> usize {
    let id = volume.patches.iter().find(|patch| patch.name == name).unwrap().id;
    volume.boundary_patch.iter().position(|&patch| patch == id).unwrap()
}

#[test]
fn a_sound_mesh_is_valid() {
    let (volume, regions, expectation) = channel();
    let report = check_regions(&volume, &regions, Some(&expectation));
    assert!(report.is_valid(), "{report}");
    assert_eq!(report.lines.len(), Line::ALL.len() + Line::OF_REGIONS.len());
    let sizes: Vec<_> =
        report.regions.iter().map(|r| (r.name.as_str(), r.components, (1e9 * r.volume).round())).collect();
    assert_eq!(sizes, [("lumen", 1, 4e7), ("wall", 1, 3.2e8), ("tissue", 1, 6.4e8)]);
    assert!(report.to_string().contains("region wall: 1,920 tetrahedra, 1 component, "), "{report}");
    // The wall around the channel is a ring, the lumen has no loop.
    let other = Expectation { loops: vec![1], ..expectation };
    assert_eq!(failures(&volume, &regions, Some(&other)), [Line::Loops]);
}

#[test]
fn the_expectation_is_that_of_the_lumen() {
    let (volume, mut regions, expectation) = channel();
    regions[0].name = "blood".into();
    let report = check_regions(&volume, &regions, Some(&expectation));
    let outcome = |line| report.line(line).map(|result| result.outcome);
    assert_eq!(outcome(Line::Components), Some(Outcome::NotChecked(Skipped::NoLumen)));
    assert_eq!(outcome(Line::CapFlat), Some(Outcome::NotChecked(Skipped::NoLumen)));
    assert_eq!(report.failed().count(), 0, "{report}");
    let report = check_regions(&volume, &regions, None);
    let outcome = report.line(Line::Components).map(|result| result.outcome);
    assert_eq!(outcome, Some(Outcome::NotChecked(Skipped::NoExpectation)));
}

#[test]
fn faces_of_the_lumen_are_wall_or_cap_whatever_its_id() {
    let first = channel();
    let mut last = first.clone();
    let (volume, regions, _) = &mut last;
    let interface = first_of(volume, "interface_lumen_wall");
    let interface = volume.boundary_patch[interface];
    for block in volume.tet_block.iter_mut().chain(&mut volume.boundary_block).filter(|block| **block == 1) {
        *block = 9;
    }
    // Interfaces face out of the region with the smaller id.
    for (i, _) in (0..).zip(&volume.boundary_patch).filter(|(_, patch)| **patch == interface) {
        volume.boundary[i as usize].swap(0, 1);
        volume.boundary_block[i as usize] = 2;
    }
    regions[0].id = 9;
    regions.rotate_left(1);
    for (sound, regions, expectation) in [first, last] {
        assert_eq!(failures(&sound, &regions, Some(&expectation)), []);
        let relabelled = |name: &str| {
            let mut volume = sound.clone();
            let face = first_of(&volume, name);
            // The patch of the outer faces of the tissue.
            volume.boundary_patch[face] = 8;
            failures(&volume, &regions, Some(&expectation))
        };
        assert_eq!(relabelled("interface_lumen_wall"), [Line::WallOrCap]);
        assert_eq!(relabelled("interface_wall_tissue"), []);
    }
}

#[test]
fn inverted_tetrahedra_are_found() {
    let (mut volume, regions, expectation) = channel();
    volume.mesh.tets[70].swap(0, 1);
    assert!(failures(&volume, &regions, Some(&expectation)).contains(&Line::PositiveTets));
}

#[test]
fn labels_of_outer_faces_are_compared() {
    let (mut volume, regions, expectation) = channel();
    let face = first_of(&volume, "organ");
    volume.boundary[face].swap(0, 1);
    assert_eq!(failures(&volume, &regions, Some(&expectation)), [Line::LabelsMatchBoundary]);
    volume.boundary.remove(face);
    volume.boundary_block.remove(face);
    volume.boundary_patch.remove(face);
    assert_eq!(failures(&volume, &regions, Some(&expectation)), [Line::LabelsMatchBoundary]);
    let (mut volume, regions, expectation) = channel();
    let face = first_of(&volume, "outlet_0");
    volume.boundary_patch[face] = 8;
    assert!(failures(&volume, &regions, Some(&expectation)).contains(&Line::WallOrCap));
}

#[test]
fn labelled_faces_of_missing_points_are_found() {
    let (sound, regions, expectation) = channel();
    let face = first_of(&sound, "organ");
    for missing in [sound.mesh.points.len() as u32, u32::MAX] {
        let mut volume = sound.clone();
        volume.boundary[face][2] = missing;
        let report = check_regions(&volume, &regions, Some(&expectation));
        let outcome = |line| report.line(line).map(|result| result.outcome);
        assert_eq!(outcome(Line::LabelsMatchBoundary), Some(Outcome::Fail));
        let because = Outcome::NotChecked(Skipped::Because(Line::LabelsMatchBoundary));
        assert_eq!(outcome(Line::CapPerTerminal), Some(because));
    }
}

#[test]
fn one_region_has_no_interface_to_be_labelled() {
    let (mut volume, regions, _) = channel();
    volume.tet_block.fill(regions[0].id);
    let report = check_regions(&relabelled(volume), &regions[..1], None);
    let outcome = |line| report.line(line).map(|result| result.outcome);
    assert_eq!(outcome(Line::InterfacesLabelled), Some(Outcome::Pass));
    let (mut volume, regions, _) = channel();
    volume.boundary.retain(|_| false);
    let report = check_regions(&volume, &regions, None);
    let outcome = report.line(Line::InterfacesLabelled).map(|result| result.outcome);
    assert!(matches!(outcome, Some(Outcome::NotChecked(_))), "{outcome:?}");
}

#[test]
fn interfaces_are_labelled_once_and_turned_alike() {
    let (sound, regions, expectation) = channel();
    let face = first_of(&sound, "interface_wall_tissue");
    let broken = |change: &dyn Fn(&mut VolumeMesh)| {
        let mut volume = sound.clone();
        change(&mut volume);
        failures(&volume, &regions, Some(&expectation))
    };
    assert_eq!(broken(&|v| v.boundary[face].swap(0, 1)), [Line::InterfacesLabelled]);
    assert_eq!(broken(&|v| v.boundary_block[face] = 3), [Line::InterfacesLabelled]);
    let twice = broken(&|v| {
        v.boundary.push(v.boundary[face]);
        v.boundary_block.push(v.boundary_block[face]);
        v.boundary_patch.push(v.boundary_patch[face]);
    });
    assert_eq!(twice, [Line::InterfacesLabelled]);
    let without = broken(&|v| {
        v.boundary.remove(face);
        v.boundary_block.remove(face);
        v.boundary_patch.remove(face);
    });
    assert_eq!(without, [Line::InterfacesLabelled]);
}

#[test]
fn unlabelled_interfaces_are_allowed_in_other_files() {
    let (mut volume, regions, expectation) = channel();
    let faces = region_faces(&volume.mesh, &volume.tet_block);
    let mut outer = faces.iter().map(|face| face.beyond.is_none());
    let mut keep = || outer.next().unwrap();
    volume.boundary.retain(|_| keep());
    let is_outer = |i: &usize| faces[*i].beyond.is_none();
    let kept: Vec<usize> = (0..faces.len()).filter(is_outer).collect();
    volume.boundary_block = kept.iter().map(|&i| volume.boundary_block[i]).collect();
    volume.boundary_patch = kept.iter().map(|&i| volume.boundary_patch[i]).collect();
    let report = check_regions(&volume, &regions, None);
    assert_eq!(report.failed().count(), 0, "{report}");
    let line = report.line(Line::InterfacesLabelled).unwrap();
    assert_eq!(line.outcome, Outcome::NotChecked(Skipped::NoInterfaces));
    assert_eq!(failures(&volume, &regions, Some(&expectation)), [Line::InterfacesLabelled]);
}

#[test]
fn interfaces_lie_between_their_regions() {
    let (sound, regions, expectation) = channel();
    let set = |name: &str, patch: i32| {
        let mut volume = sound.clone();
        let face = first_of(&volume, name);
        volume.boundary_patch[face] = patch;
        failures(&volume, &regions, Some(&expectation))
    };
    // An outer face, and one of another interface.
    assert_eq!(set("organ", 4), [Line::InterfaceSides]);
    assert_eq!(set("interface_wall_tissue", 4), [Line::InterfaceSides]);
    let mut volume = sound.clone();
    // Second and third tetrahedron of the first cell, in the tissue.
    let common =
        |face: &[u32; 3]| face.iter().all(|v| volume.mesh.tets[0].contains(v) && volume.mesh.tets[5].contains(v));
    let tet = volume.mesh.tets[0];
    let face = crate::TET_FACES.map(|side| side.map(|i| tet[i])).into_iter().find(common).unwrap();
    volume.boundary.push(face);
    volume.boundary_block.push(3);
    volume.boundary_patch.push(5);
    assert_eq!(failures(&volume, &regions, Some(&expectation)), [Line::InterfaceSides]);
}

#[test]
fn boundaries_of_regions_are_manifold() {
    let (mut volume, regions, expectation) = channel();
    // A cell that touches the wall along an edge.
    let inside = |p: &Point3| (0.8..=0.9).contains(&p.x) && (0.8..=0.9).contains(&p.y);
    for (block, tet) in volume.tet_block.iter_mut().zip(&volume.mesh.tets) {
        if tet.iter().all(|&v| inside(&volume.mesh.points[v as usize])) {
            *block = 2;
        }
    }
    let volume = relabelled(volume);
    let report = check_regions(&volume, &regions, Some(&expectation));
    assert!(report.line(Line::RegionBoundaries).is_some_and(|line| line.count > 0), "{report}");
    assert_eq!(report.regions[1].components, 2);
    // Regions of a complex may touch themselves. The report counts the places.
    let report = check_regions(&volume, &regions, None);
    assert_eq!(report.failed().count(), 0, "{report}");
    assert_eq!(report.line(Line::RegionBoundaries).unwrap().outcome, Outcome::NotChecked(Skipped::MayTouch));
    assert!(report.regions.iter().any(|region| region.touches > 0));
}

#[test]
fn boundaries_of_regions_do_not_intersect() {
    let (mut volume, regions, _) = channel();
    add_copy(&mut volume, |p| p + Vec3::new(0.11, 0.13, 0.07));
    let failed = failures(&relabelled(volume), &regions, None);
    assert_eq!(failed, [Line::NoSelfIntersection, Line::RegionIntersections]);
    // A small copy inside the outermost region, without contact.
    let (mut volume, ..) = channel();
    add_copy(&mut volume, |p| p * 0.01 + Vec3::repeat(0.05));
    let failed = failures(&relabelled(volume), &regions, None);
    assert_eq!(failed, [Line::NoSelfIntersection, Line::RegionIntersections]);
}

#[test]
fn every_tetrahedron_has_a_named_region() {
    let (mut volume, mut regions, expectation) = channel();
    regions.push(NamedRegion::new(4, "annulus"));
    let report = check_regions(&volume, &regions, Some(&expectation));
    let named = report.line(Line::RegionsNamed).unwrap();
    assert_eq!((named.count, named.offenders[0].ids.clone()), (1, vec![4]));
    assert_eq!(report.failed().count(), 1);
    regions.pop();
    volume.tet_block.iter_mut().filter(|block| **block == 3).for_each(|block| *block = 9);
    volume.boundary_block.iter_mut().filter(|block| **block == 3).for_each(|block| *block = 9);
    let failed = failures(&volume, &regions, Some(&expectation));
    assert!(failed.contains(&Line::RegionsNamed), "{failed:?}");
}

#[test]
fn the_check_stops_when_asked() {
    let (volume, regions, expectation) = channel();
    let mut times = 0;
    let report = loop {
        match check_regions_watched(&volume, &regions, Some(&expectation), &StopsAfter::new(times)) {
            Ok(report) => break report,
            Err(error) => assert!(Cancelled::is_in(&error), "{error}"),
        }
        times += 1;
    };
    assert!(times > 4, "{times}");
    assert_eq!(report, check_regions(&volume, &regions, Some(&expectation)));
}
