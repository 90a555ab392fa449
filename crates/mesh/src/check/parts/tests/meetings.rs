//! Pairs of parts with intersecting walls, and how often walls and ids are read.

use super::faults::{cube_at, side_by_side, with_part};
use super::served::Served;
use super::*;
use crate::check::parts::walls::Reader;

#[test]
fn walls_of_changed_parts_meet_as_those_of_all_parts_do() {
    let star = star();
    for corner in [[5.0 / 7.0, 0.45, 0.69], [2.0, 0.0, 0.0]] {
        let (cut, _) = with_part(&star, cube_at(corner, 0.09));
        let looked = Looked::at(&cut, 1 << 20).unwrap();
        let expected = looked.meeting().to_vec();
        assert_eq!(expected, check_parts(&cut, &cut.patches, None, 0).unwrap().meeting);
        assert_eq!(expected.is_empty(), corner[0] > 1.0);
        let boxes = looked.into_boxes();
        let certified: Vec<Aabb> = cut.certificates.iter().map(Certificate::bounds).collect();
        assert_eq!(boxes, certified);
        let found = |parts: &[u32]| meetings_of(&cut, Changed { boxes: &boxes, parts }).unwrap();
        let added = cut.pieces.len() as u32 - 1;
        assert_eq!(found(&[added]), expected);
        assert_eq!(found(&(0..=added).collect::<Vec<_>>()), expected);
        // Meetings with one other part alone.
        for part in 0..added {
            let of_part: Vec<[u32; 2]> = expected.iter().copied().filter(|pair| pair[0] == part).collect();
            assert_eq!(found(&[part]), of_part);
        }
    }
}

#[test]
fn walls_are_tested_in_batches_that_fit_in_memory() {
    let bar = bar();
    let (held, _) = glue::Held::read(&bar, &mut tallies::Tallies::default()).unwrap();
    let is_joined = joints::flags(&bar, &held).unwrap();
    let reader = Reader { parts: &bar, held: &held, is_joined: &is_joined };
    let bytes = |part: u32| 200 + 26 * bar.wall(part).unwrap().faces.len() as u64;
    let pairs = [[0, 1], [1, 2], [2, 3]];
    let fitting = |memory: u64| walls::fitting(&reader, &pairs, memory);
    // Walls of three parts; that of part 1 is needed twice and held once.
    let three = bytes(0) + bytes(1) + bytes(2);
    let all = three + bytes(3);
    let found = [0, 1, three - 1, three, all - 1, all, u64::MAX].map(fitting);
    assert_eq!(found, [1, 1, 1, 2, 2, 3, 3]);
}

/// Numbers of walls and of lists of ids that a check reads.
fn reads(parts: &MemoryParts) -> (usize, usize) {
    let counted = Served::of(parts);
    check_parts(&counted, &parts.patches, Some(&parts.expectation), usize::MAX).unwrap();
    (counted.walls.into_inner(), counted.vertices.into_inner())
}

#[test]
fn ids_of_a_valid_mesh_are_read_once() {
    let bar = bar();
    assert_eq!(reads(&bar), (bar.pieces.len(), bar.pieces.len()));
}

#[test]
fn surfaces_apart_need_no_other_walls() {
    let cube = cube_at([0.0; 3], 1.0);
    let both = side_by_side(&cube, &cube_at([2.0, 0.0, 0.0], 1.0));
    let parts: Vec<u32> = (0..both.tets.len()).map(|t| u32::from(t >= cube.tets.len())).collect();
    let two = MemoryParts::with_parts(&both, &parts, &[], vec![0, 0]);
    assert_eq!(two.failing(), []);
    assert_eq!(reads(&two).0, 2);
}
