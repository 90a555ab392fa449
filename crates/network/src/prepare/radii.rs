//! Replacement of implausible radii by values from neighbours.

use anastomesh_mesh::geometry::{DisjointSets, Total, place_key};
use anastomesh_skeleton::{NodeId, Skeleton, SkeletonError, is_usable_radius};
use rustc_hash::FxHashMap;
use serde::Serialize;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Ratio between a radius and its neighbours' above which it is implausible.
const ABSURD: f64 = 10.0;
/// Distance, in radii of a wider place, within which a real vessel neither narrows to a tenth nor ends in a point. Such
/// narrow places come from distance maps without data.
const WINDOW: f64 = 4.0;
/// Maximum number of places examined on either side.
const MOST_BESIDE: usize = 256;
/// Sweeps that smooth replaced radii. A run of up to this many nodes becomes linear.
const SWEEPS: usize = 50;
/// Minimum distance of two places, in the unit of the network, so that its inverse is finite.
const APART: f64 = f64::MIN_POSITIVE * 1e20;

/// Fault of a radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RadiusDefect {
    /// The radius is zero, negative, infinite or NaN.
    Missing,
    /// The radius is ten times that of all neighbours. Or it is below a tenth of the nearby vessel radius on both
    /// sides, or on the one side of a tip.
    Absurd,
}

/// Replaced radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FilledRadius {
    /// Node index.
    pub node: u32,
    /// Given value; `None` if it was not finite.
    pub given: Option<f64>,
    /// New value, in the unit of the network.
    pub filled: f64,
    /// Fault of the given value.
    pub fault: RadiusDefect,
}

/// Replaces faulty radii and returns the affected nodes. New values interpolate between the surrounding valid radii by
/// distance along the vessel. Components without a valid radius get the median of all.
///
/// # Errors
/// An edge refers to a missing node or a position is not finite. If no radius is valid, nothing is replaced.
pub(super) fn fill(raw: &Skeleton) -> Result<(Skeleton, Vec<FilledRadius>), SkeletonError> {
    check_all_but_radii(raw)?;
    let mut network = raw.clone();
    let places = Places::of(raw);
    let faults: Vec<Option<RadiusDefect>> = places.faults(raw);
    let mut radii: Vec<Option<f64>> = vec![None; places.count];
    for (i, node) in raw.nodes.iter().enumerate() {
        if faults[i].is_none() {
            let slot = &mut radii[places.of_node[i] as usize];
            *slot = Some(slot.unwrap_or(0.0_f64).max(node.radius));
        }
    }
    let filled = places.filled(&radii);
    let Some(filled) = filled else {
        // No source for values: the caller's check reports the node, if there is one.
        return Ok((network, Vec::new()));
    };
    let mut report = Vec::new();
    for (i, fault) in faults.iter().enumerate() {
        let Some(fault) = *fault else { continue };
        let (given, radius) = (raw.nodes[i].radius, filled[places.of_node[i] as usize]);
        network.nodes[i].radius = radius;
        let given = given.is_finite().then_some(given);
        report.push(FilledRadius { node: raw.nodes[i].original, given, filled: radius, fault });
    }
    for edge in &mut network.edges {
        for end in 0..2 {
            let node = edge.nodes[end].index();
            // An edge with the radius of its node follows the node.
            let same = edge.radii[end] == raw.nodes[node].radius;
            if !is_usable_radius(edge.radii[end]) || faults[node].is_some() && same {
                edge.radii[end] = filled[places.of_node[node] as usize];
            }
        }
    }
    Ok((network, report))
}

fn check_all_but_radii(raw: &Skeleton) -> Result<(), SkeletonError> {
    let mut sound = raw.clone();
    for radius in sound.nodes.iter_mut().map(|n| &mut n.radius).chain(sound.edges.iter_mut().flat_map(|e| &mut e.radii))
    {
        *radius = 1.0;
    }
    sound.check_numbers()
}

/// Continuation of a vessel beyond a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beyond {
    /// The vessel becomes ten times as wide within `WINDOW` of the wider radii.
    Wider,
    /// The vessel ends.
    End,
    /// The vessel continues unchanged.
    Same,
}

/// Distinct places. Coinciding nodes are one place, as many files give each vessel its own points.
struct Places {
    of_node: Vec<u32>,
    count: usize,
    beside: Vec<Vec<Beside>>,
}

/// Neighbour of a place.
#[derive(Clone, Copy, Debug)]
struct Beside {
    place: u32,
    /// Distance along the vessel.
    length: f64,
    /// Radius of the vessel there: a branch point has that of its widest vessel.
    radius: f64,
}

impl Places {
    fn of(raw: &Skeleton) -> Self {
        let mut sets = DisjointSets::new(raw.nodes.len());
        let mut first: FxHashMap<_, u32> = FxHashMap::default();
        for (i, node) in (0..).zip(&raw.nodes) {
            sets.join(*first.entry(place_key(&node.position)).or_insert(i), i);
        }
        let of_node = sets.numbered();
        let count = of_node.iter().max().map_or(0, |&m| m as usize + 1);
        let mut beside = vec![Vec::new(); count];
        for edge in &raw.edges {
            let [a, b] = edge.nodes.map(NodeId::index);
            let length = (raw.nodes[a].position - raw.nodes[b].position).norm();
            let [p, q] = [of_node[a], of_node[b]];
            if p != q {
                beside[p as usize].push(Beside { place: q, length, radius: edge.radii[1] });
                beside[q as usize].push(Beside { place: p, length, radius: edge.radii[0] });
            }
        }
        Self { of_node, count, beside }
    }

    /// Fault of each node's radius.
    fn faults(&self, raw: &Skeleton) -> Vec<Option<RadiusDefect>> {
        let mut at = vec![0.0_f64; self.count];
        for (node, &place) in raw.nodes.iter().zip(&self.of_node) {
            if is_usable_radius(node.radius) {
                at[place as usize] = at[place as usize].max(node.radius);
            }
        }
        // Decidable for inner nodes of a vessel with similar neighbours.
        let absurd = |place: u32| {
            let [p, q] = self.beside[place as usize][..] else { return false };
            let [r, a, b] = [place, p.place, q.place].map(|i| at[i as usize]);
            a > 0.0 && b > 0.0 && a.max(b) <= 2.0 * a.min(b) && (r > ABSURD * a.max(b) || r * ABSURD < a.min(b))
        };
        // An implausibly large radius carries no information about its neighbours.
        let all: Vec<bool> = (0..self.count as u32).map(absurd).collect();
        let mut told = at.clone();
        for (radius, _) in told.iter_mut().zip(&all).filter(|(_, absurd)| **absurd) {
            *radius = 0.0;
        }
        let fault = |(node, &place): (&anastomesh_skeleton::Node, &u32)| match node.radius {
            r if !is_usable_radius(r) => Some(RadiusDefect::Missing),
            _ if all[place as usize] || self.is_dip(place, &told) => Some(RadiusDefect::Absurd),
            _ => None,
        };
        let faults: Vec<_> = raw.nodes.iter().zip(&self.of_node).map(fault).collect();
        if faults.iter().all(Option::is_some) {
            // Radii that all contradict each other are still better than none.
            return faults.into_iter().map(|fault| fault.filter(|&fault| fault == RadiusDefect::Missing)).collect();
        }
        faults
    }

    /// True if the vessel is ten times as wide near both sides of a place, or near one side if it ends on the other.
    fn is_dip(&self, place: u32, radii: &[f64]) -> bool {
        let beside = &self.beside[place as usize];
        if beside.len() > 2 {
            return false;
        }
        let found: Vec<Beyond> = beside.iter().map(|&next| self.beyond(place, next, radii)).collect();
        found.contains(&Beyond::Wider) && !found.contains(&Beyond::Same)
    }

    /// Continuation of the vessel from a place towards `next`.
    fn beyond(&self, place: u32, mut next: Beside, radii: &[f64]) -> Beyond {
        let (own, mut last, mut arc) = (radii[place as usize], place, 0.0);
        for _ in 0..MOST_BESIDE {
            arc += next.length;
            let radius = radii[next.place as usize].min(next.radius);
            if radius > ABSURD * own && arc <= WINDOW * radius {
                return Beyond::Wider;
            }
            match self.beside[next.place as usize][..] {
                [_] => return Beyond::End,
                [p, q] => (last, next) = (next.place, if p.place == last { q } else { p }),
                _ => return Beyond::Same,
            }
        }
        Beyond::Same
    }

    /// A radius for each place; `None` if no valid radius exists.
    fn filled(&self, known: &[Option<f64>]) -> Option<Vec<f64>> {
        let mut all: Vec<f64> = known.iter().flatten().copied().collect();
        all.sort_unstable_by(f64::total_cmp);
        let median = *all.get(all.len() / 2)?;
        let mut radii: Vec<Option<f64>> = self.nearest(known);
        let missing: Vec<usize> = (0..self.count).filter(|&i| known[i].is_none()).collect();
        for &place in &missing {
            radii[place].get_or_insert(median);
        }
        let mut radii: Vec<f64> = radii.into_iter().flatten().collect();
        for sweep in 0..SWEEPS {
            // Alternating direction, so that the result does not depend on the end at which a run begins.
            for k in 0..missing.len() {
                let place = missing[if sweep % 2 == 0 { k } else { missing.len() - 1 - k }];
                radii[place] = self.mean(place, &radii).unwrap_or(radii[place]);
            }
        }
        Some(radii)
    }

    /// Mean of the neighbouring radii, weighted by inverse distance.
    fn mean(&self, place: usize, radii: &[f64]) -> Option<f64> {
        let (mut sum, mut weights) = (0.0, 0.0);
        for next in &self.beside[place] {
            let weight = 1.0 / next.length.max(APART);
            sum += weight * radii[next.place as usize];
            weights += weight;
        }
        let mean = sum / weights;
        is_usable_radius(mean).then_some(mean)
    }

    /// Nearest known radius along the vessels.
    fn nearest(&self, known: &[Option<f64>]) -> Vec<Option<f64>> {
        let mut radii = vec![None; self.count];
        let sources = (0..).zip(known).filter_map(|(place, r)| Some((Total(0.0), place, Total((*r)?))));
        // Min-heap of distance, place, and propagated radius.
        let mut heap: BinaryHeap<Reverse<(Total, u32, Total)>> = sources.map(Reverse).collect();
        while let Some(Reverse((Total(distance), place, radius))) = heap.pop() {
            if radii[place as usize].is_some() {
                continue;
            }
            radii[place as usize] = Some(radius.0);
            let further = self.beside[place as usize].iter().filter(|next| radii[next.place as usize].is_none());
            heap.extend(further.map(|next| Reverse((Total(distance + next.length), next.place, radius))));
        }
        radii
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::network;

    /// Two lines between the same places, whose radii contradict each other, and a vessel without radii. Found by the fuzz
    /// target `prepare`.
    #[test]
    fn radii_that_all_contradict_each_other_are_kept() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [5.0, 0.0, 0.0], [9.0, 0.0, 0.0]];
        let mut raw = network(&points, 1.0, &[(0, 1), (2, 3), (4, 5)]);
        for (node, radius) in [(1, 1e-3), (3, 1e-3), (4, 0.0), (5, f64::NAN)] {
            raw.nodes[node].radius = radius;
        }
        for edge in &mut raw.edges {
            edge.radii = edge.nodes.map(|n| raw.nodes[n.index()].radius);
        }
        let (network, filled) = fill(&raw).unwrap();
        assert_eq!(network.check_numbers(), Ok(()));
        let missing: Vec<_> = filled.iter().map(|f| (f.node, f.fault)).collect();
        assert_eq!(missing, [(4, RadiusDefect::Missing), (5, RadiusDefect::Missing)]);
        assert_eq!(network.nodes[1].radius, 1e-3);
    }
}
