//! Comparison of connected joints: same faces with the same ids and opposite orientation, and bit-equal points.

use super::glue::{Held, invalid, sum_of};
use super::tallies::Tallies;
use super::{FacesApart, Parts};
use crate::check::cells::centroid;
use crate::check::result::{Line, Offender, OffenderKind};
use crate::face_key;
use crate::geometry::Point3;
use crate::same_turn;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::io;

/// Pairs of joints compared at a time.
const COMPARED: usize = 1 << 14;

/// Result of the comparison of joints.
#[derive(Debug, Default)]
pub(super) struct Joined {
    /// Flag per pair of [`Parts::joined`], true if it is connected.
    connects: Vec<bool>,
    /// Condition violated by a joint.
    pub broken: Option<Line>,
}

impl Joined {
    /// Connected pairs, as (part, joint).
    pub(super) fn pairs<'a>(&'a self, parts: &'a dyn Parts) -> impl Iterator<Item = &'a [(u32, u32); 2]> {
        parts.joined().iter().zip(&self.connects).filter(|(_, connects)| **connects).map(|(pair, _)| pair)
    }
}

/// Flags per joint number, true for connected joints.
pub(super) fn flags(parts: &dyn Parts, held: &Held) -> io::Result<Vec<bool>> {
    let mut flags = vec![false; held.joint_count()];
    for pair in parts.joined() {
        for number in numbers(held, pair)? {
            flags[number as usize] = true;
        }
    }
    Ok(flags)
}

fn numbers(held: &Held, pair: &[(u32, u32); 2]) -> io::Result<[u32; 2]> {
    match pair.map(|joint| held.joint_number(joint)) {
        [Some(a), Some(b)] => Ok([a, b]),
        _ => Err(invalid(format!("parts have no such joints: {pair:?}"))),
    }
}

/// Checks every pair of joints.
pub(super) fn check(parts: &dyn Parts, held: &Held, tallies: &mut Tallies) -> io::Result<Joined> {
    let mut joined = Joined { connects: Vec::with_capacity(parts.joined().len()), broken: None };
    let mut seen = vec![false; held.joint_count()];
    for pair in parts.joined() {
        let [a, b] = numbers(held, pair)?;
        let mut free = a != b;
        for (number, &(part, joint)) in [a, b].into_iter().zip(pair) {
            if std::mem::replace(&mut seen[number as usize], true) {
                free = false;
                if let Some(joint) = read(parts, held, (part, joint))? {
                    third_tets(&joint, tallies);
                }
            }
        }
        joined.connects.push(free);
        if !free {
            joined.broken = Some(Line::FacesSharedByTwo);
        }
    }
    drop(seen);
    for (some, connects) in parts.joined().chunks(COMPARED).zip(joined.connects.chunks_mut(COMPARED)) {
        let compare = |(pair, connects): (&[(u32, u32); 2], &bool)| match connects {
            true => compare(parts, held, pair),
            false => Ok(JointDifferences { all: true, ..JointDifferences::default() }),
        };
        let differences =
            some.par_iter().zip(&*connects).map(compare).collect::<io::Result<Vec<JointDifferences>>>()?;
        for (differences, connects) in differences.into_iter().zip(connects) {
            if *connects && differences.all {
                *connects = false;
                joined.broken = Some(Line::LabelsMatchBoundary);
            }
            for (line, offender) in differences.found {
                joined.broken = Some(line);
                tallies.add(line, offender);
            }
        }
    }
    Ok(joined)
}

/// Reports the faces of a joint that is connected more than once.
fn third_tets(joint: &FacesApart, tallies: &mut Tallies) {
    for face in &joint.faces {
        // Both joints may be reported: the same faces with opposite orientation.
        let mut offender = face_of(joint, *face);
        offender.ids.sort_unstable();
        tallies.add(Line::FacesSharedByTwo, offender);
    }
}

fn face_of(joint: &FacesApart, face: [u32; 3]) -> Offender {
    let ids = face.map(|v| joint.vertices[v as usize]);
    Offender::new(OffenderKind::Face, &ids, Some(centroid(&joint.points, &face)))
}

#[derive(Default)]
struct JointDifferences {
    found: Vec<(Line, Offender)>,
    /// True if no face is common.
    all: bool,
}

/// Reads a joint and verifies that it is the certified one. `None` for a joint off the boundary, already a fault.
fn read(parts: &dyn Parts, held: &Held, (part, joint): (u32, u32)) -> io::Result<Option<FacesApart>> {
    let read = parts.joint(part, joint)?;
    let sum = sum_of(&read.points, &read.faces).filter(|_| read.points.len() == read.vertices.len());
    let certified = held.joint_number((part, joint)).map(|number| held.joint(number));
    let same = certified.is_some_and(|c| c.faces as usize == read.faces.len() && sum == Some(c.sum));
    match same {
        true => Ok(Some(read)),
        false if sum.is_some() && !held.is_sound(part) => Ok(None),
        false => Err(invalid(format!("joint {joint} of part {part} is not what was certified"))),
    }
}

fn compare(parts: &dyn Parts, held: &Held, pair: &[(u32, u32); 2]) -> io::Result<JointDifferences> {
    let mut differences = JointDifferences::default();
    if let (Some(a), Some(b)) = (read(parts, held, pair[0])?, read(parts, held, pair[1])?) {
        compare_faces(&a, &b, &mut differences);
        compare_points(&a, &b, &mut differences);
    } else {
        differences.all = true;
    }
    Ok(differences)
}

/// Faces sorted by their ids.
fn by_ids(joint: &FacesApart) -> Vec<([u32; 3], [u32; 3], [u32; 3])> {
    let ids = |face: &[u32; 3]| face.map(|v| joint.vertices[v as usize]);
    let mut faces: Vec<_> = joint.faces.iter().map(|face| (face_key(ids(face)), ids(face), *face)).collect();
    faces.sort_unstable();
    faces
}

fn compare_faces(a: &FacesApart, b: &FacesApart, differences: &mut JointDifferences) {
    let (first, second) = (by_ids(a), by_ids(b));
    let (mut i, mut j) = (0, 0);
    differences.all = true;
    while i < first.len() || j < second.len() {
        let order = match (first.get(i), second.get(j)) {
            (Some(x), Some(y)) => x.0.cmp(&y.0),
            (Some(_), None) => Ordering::Less,
            _ => Ordering::Greater,
        };
        match order {
            Ordering::Equal => {
                differences.all = false;
                if same_turn(first[i].1, second[j].1) {
                    differences.found.push((Line::OppositeSides, face_of(a, first[i].2)));
                }
            }
            Ordering::Less => differences.found.push((Line::LabelsMatchBoundary, face_of(a, first[i].2))),
            Ordering::Greater => differences.found.push((Line::LabelsMatchBoundary, face_of(b, second[j].2))),
        }
        i += usize::from(order.is_le());
        j += usize::from(order.is_ge());
    }
}

/// Compares points: common ids need equal points, and stand for one point each.
fn compare_points(a: &FacesApart, b: &FacesApart, differences: &mut JointDifferences) {
    let by_id = |joint: &FacesApart| {
        let mut ids: Vec<(u32, Point3)> = joint.vertices.iter().copied().zip(joint.points.iter().copied()).collect();
        ids.sort_by_key(|entry| entry.0);
        ids
    };
    let (first, second) = (by_id(a), by_id(b));
    let point = |&(id, p): &(u32, Point3)| Offender::new(OffenderKind::Point, &[id], Some(p));
    for ids in [&first, &second] {
        for pair in ids.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            differences.found.push((Line::BoundaryFans, point(&pair[0])));
        }
    }
    for entry in &first {
        let Ok(other) = second.binary_search_by_key(&entry.0, |entry| entry.0) else { continue };
        let bits = |p: &Point3| [p.x, p.y, p.z].map(f64::to_bits);
        if bits(&entry.1) != bits(&second[other].1) {
            differences.found.push((Line::NoDuplicatePoints, point(entry)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joint with these faces by ids.
    fn joint(faces: &[[u32; 3]]) -> FacesApart {
        let points = (0..10).map(|i| Point3::new(f64::from(i), f64::from(i * i), 0.0)).collect();
        FacesApart { points, vertices: (0..10).collect(), faces: faces.to_vec() }
    }

    /// Differences of a joint from another, with the ids of the faces, and true if no face is common.
    fn differences(a: &[[u32; 3]], b: &[[u32; 3]]) -> (Vec<(Line, Vec<i64>)>, bool) {
        let mut differences = JointDifferences::default();
        compare_faces(&joint(a), &joint(b), &mut differences);
        (differences.found.into_iter().map(|(line, offender)| (line, offender.ids)).collect(), differences.all)
    }

    #[test]
    fn faces_of_one_joint_alone_are_named() {
        let all = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 5, 2]];
        let turned = all.map(|[a, b, c]| [a, c, b]);
        assert_eq!(differences(&all, &turned), (vec![], false));
        // The first, a middle and the last one, in either joint.
        for i in 0..4 {
            let rest: Vec<[u32; 3]> = (0..4).filter(|&j| j != i).map(|j| turned[j]).collect();
            let ids = |face: [u32; 3]| face.map(i64::from).to_vec();
            assert_eq!(differences(&all, &rest), (vec![(Line::LabelsMatchBoundary, ids(all[i]))], false));
            let other: Vec<[u32; 3]> = (0..4).filter(|&j| j != i).map(|j| all[j]).collect();
            assert_eq!(differences(&other, &turned), (vec![(Line::LabelsMatchBoundary, ids(turned[i]))], false));
        }
    }

    #[test]
    fn joints_without_a_common_face_differ_entirely() {
        let (found, all) = differences(&[[0, 1, 2]], &[[4, 5, 2]]);
        assert!(all && found.iter().all(|(line, _)| *line == Line::LabelsMatchBoundary));
        assert_eq!(found.len(), 2);
        // Common, but with the same orientation.
        assert_eq!(differences(&[[0, 1, 2]], &[[1, 2, 0]]), (vec![(Line::OppositeSides, vec![0, 1, 2])], false));
    }
}
