//! Tips that cannot be capped in place. They are extended or shortened along their vessel until a cap fits.

use crate::block::{BlockError, Finished, buried};
use crate::partition::{Cluster, EndKind};
use crate::surface::{CapError, CapFailure};
use anastomesh_mesh::geometry::{Tube, place_key};
use anastomesh_skeleton::NodeId;
use rustc_hash::FxHashMap;

/// Displacements of a tip to try in turn, in its radii. Positive ones move it outwards, past another vessel of its branch
/// point. Negative ones move it back, out of another vessel.
pub const MOVES: [f64; 8] = [0.5, -0.5, 1.0, -1.0, 1.5, -1.5, 2.0, 3.0];

/// Minimum length of the last piece of a vessel whose tip is shortened, in radii.
const LEFT: f64 = 0.5;

/// Ends of a cluster that could not be capped, ascending.
pub fn uncapped(cluster: &Cluster, result: &Result<Finished, BlockError>, failures: &[BlockError]) -> Vec<u32> {
    let mut ends: Vec<u32> =
        failures.iter().chain(result.as_ref().err()).filter_map(failed_end).map(|(end, _)| end).collect();
    let left_open = result.as_ref().map_or(&[][..], |made| &made.about.uncapped);
    let is_open = |kind| matches!(kind, EndKind::Terminal(node) if left_open.contains(&node.0));
    ends.extend((0..).zip(&cluster.ends).filter(|(_, end)| is_open(end.kind)).map(|(i, _)| i));
    // A finished block lists its uncapped ends.
    if result.is_ok() {
        ends.retain(|&i| is_open(cluster.ends[i as usize].kind));
    }
    ends.sort_unstable();
    ends.dedup();
    ends
}

/// End at which a block failed, if a tip is the cause, and its node.
fn failed_end(error: &BlockError) -> Option<(u32, NodeId)> {
    match error {
        BlockError::Cap { source: CapError::End { end, node: Some(node), .. }, .. } => Some((*end, *node)),
        _ => None,
    }
}

/// Terminals at which a cluster failed. If a tip lies within another vessel, all such tips are included.
pub fn to_blame(cluster: &Cluster, error: &BlockError) -> Vec<NodeId> {
    if is_buried(error) {
        buried(cluster).map(|(_, node, _)| node).collect()
    } else {
        failed_end(error).map(|(_, node)| node).into_iter().collect()
    }
}

/// True if a tip lies within another vessel, so that no parameter helps.
pub fn is_buried(error: &BlockError) -> bool {
    matches!(error, BlockError::Cap { source: CapError::End { reason: CapFailure::Buried, .. }, .. })
}

/// Returns the cluster with some tips moved, each by a number of its radii. `None` if a vessel is too short, or if a moved
/// tip lies within another vessel. No tip moves outwards by more than the length of its vessel.
pub fn moved(cluster: &Cluster, moves: &[(u32, f64)]) -> Option<Cluster> {
    let mut result = cluster.clone();
    for &(i, radii) in moves {
        let end = result.ends.get_mut(i as usize)?;
        let (from, way) = (end.section.origin, radii * end.section.radius);
        let to = from + end.section.axis * way;
        let beyond = end.overrun as usize;
        let last =
            (0..result.tubes.len()).find(|&k| k != beyond && [result.tubes[k].a, result.tubes[k].b].contains(&from))?;
        let is_too_short = result.tubes[last].length() + way < LEFT * end.section.radius;
        if is_too_short || way > vessel_length(cluster, i, last) {
            return None;
        }
        let tube = &mut result.tubes[last];
        *(if tube.a == from { &mut tube.a } else { &mut tube.b }) = to;
        let shift = to - from;
        result.tubes[beyond].a += shift;
        result.tubes[beyond].b += shift;
        end.section.origin = to;
    }
    if buried(&result).next().is_some() { None } else { Some(result) }
}

/// Length of the vessel of an end within its cluster, up to the next bifurcation. `last` is its tube at the end.
fn vessel_length(cluster: &Cluster, end: u32, last: usize) -> f64 {
    let mut around: FxHashMap<[u64; 3], Vec<usize>> = FxHashMap::default();
    for (i, tube) in cluster.tubes.iter().enumerate() {
        around.entry(place_key(&tube.a)).or_default().push(i);
        around.entry(place_key(&tube.b)).or_default().push(i);
    }
    let (mut at, mut tube, mut length) = (cluster.ends[end as usize].section.origin, last, 0.0);
    // At most once along each tube: vessels may form a ring.
    for _ in 0..cluster.tubes.len() {
        let Tube { a, b, .. } = cluster.tubes[tube];
        length += cluster.tubes[tube].length();
        at = if a == at { b } else { a };
        match around[&place_key(&at)][..] {
            [i, j] => tube = if i == tube { j } else { i },
            _ => break,
        }
    }
    length
}

/// Text on the displacement of tips.
pub fn described(moves: &[(u32, f64)]) -> String {
    let mut radii: Vec<f64> = moves.iter().map(|(_, radii)| *radii).collect();
    radii.sort_unstable_by(f64::total_cmp);
    radii.dedup();
    let radii: Vec<String> = radii.iter().map(f64::to_string).collect();
    format!("tips moved by {} radii", radii.join(" and "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::fixtures::bifurcation;

    #[test]
    fn a_tip_moves_along_its_vessel_and_no_further_than_it_is_long() {
        let cluster = bifurcation(3);
        for (i, end) in (0..).zip(&cluster.ends) {
            let out = moved(&cluster, &[(i, 1.0)]).expect("room");
            let way = out.ends[i as usize].section.origin - end.section.origin;
            assert!((way - end.section.axis * end.section.radius).norm() < 1e-12);
            let length = |c: &Cluster| c.tubes.iter().map(anastomesh_mesh::geometry::Tube::length).sum::<f64>();
            assert!((length(&out) - length(&cluster) - end.section.radius).abs() < 1e-9);
            assert_eq!(moved(&cluster, &[(i, -1e3)]), None);
            assert_eq!(moved(&cluster, &[(i, 1e3)]), None);
        }
        assert_eq!(moved(&cluster, &[(99, 1.0)]), None);
    }
}
