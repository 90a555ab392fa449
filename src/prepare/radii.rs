//! Radii that cannot be true, filled from their neighbours.

use anastomesh_mesh::geometry::{DisjointSets, Total, place_key};
use anastomesh_skeleton::{LARGEST, NodeId, Skeleton, SkeletonError};
use rustc_hash::FxHashMap;
use serde::Serialize;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A radius this many times that of all its neighbours, or as many times smaller, is absurd.
const ABSURD: f64 = 10.0;
/// Over so many radii of a wider place a vessel that goes on does not narrow to a tenth and widen again, nor end in a point:
/// that is where a distance map had nothing to measure.
const WINDOW: f64 = 4.0;
/// Places looked at to either side of one, at most.
const MOST_BESIDE: usize = 256;
/// Sweeps by which filled radii are evened out: a run of so many nodes becomes linear.
const SWEEPS: usize = 50;
/// The least distance that two places have, in the unit of the network: its inverse is a number.
const APART: f64 = f64::MIN_POSITIVE * 1e20;

/// What is wrong with a radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RadiusDefect {
    /// It is zero, negative, infinite or no number.
    Missing,
    /// It is ten times that of all its neighbours, or less than a tenth of what the vessel has to both sides near by, or at
    /// the one side of a tip.
    Absurd,
}

/// A radius that was filled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FilledRadius {
    /// The node.
    pub node: u32,
    /// What was there; none when it was no finite number.
    pub given: Option<f64>,
    /// What it is now, in the unit of the network.
    pub filled: f64,
    /// What was wrong.
    pub fault: RadiusDefect,
}

/// The network with usable radii, and the nodes whose radius was filled: between those of the nodes around it that are
/// good, in proportion to their distance along the vessel. What has no good one in its component gets the median of all.
///
/// # Errors
/// When an edge names no node or a position is no number. Where no radius is good nothing is filled.
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
        // Nothing to fill from: the caller's own check names the node, or there is none.
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
            // An edge that has its radius from its node follows it.
            let same = edge.radii[end] == raw.nodes[node].radius;
            if !good(edge.radii[end]) || faults[node].is_some() && same {
                edge.radii[end] = filled[places.of_node[node] as usize];
            }
        }
    }
    Ok((network, report))
}

fn good(radius: f64) -> bool {
    radius > 0.0 && radius < LARGEST
}

fn check_all_but_radii(raw: &Skeleton) -> Result<(), SkeletonError> {
    let mut sound = raw.clone();
    for radius in sound.nodes.iter_mut().map(|n| &mut n.radius).chain(sound.edges.iter_mut().flat_map(|e| &mut e.radii))
    {
        *radius = 1.0;
    }
    sound.check_numbers()
}

/// What a vessel does beyond a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beyond {
    /// It becomes ten times as wide, near by for that width.
    Wider,
    /// It ends.
    End,
    /// It goes on as it is.
    Same,
}

/// Nodes at one place are one: many files hold each vessel with points of its own.
struct Places {
    of_node: Vec<u32>,
    count: usize,
    beside: Vec<Vec<Beside>>,
}

/// A place beside another.
#[derive(Clone, Copy, Debug)]
struct Beside {
    place: u32,
    /// How far it is along the vessel.
    length: f64,
    /// Radius that the vessel has there: a branch point has that of its widest.
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

    /// What is wrong with the radius of each node.
    fn faults(&self, raw: &Skeleton) -> Vec<Option<RadiusDefect>> {
        let mut at = vec![0.0_f64; self.count];
        for (node, &place) in raw.nodes.iter().zip(&self.of_node) {
            if good(node.radius) {
                at[place as usize] = at[place as usize].max(node.radius);
            }
        }
        // Of an inner node of a vessel, of which both neighbours agree, it can be told.
        let absurd = |place: u32| {
            let [p, q] = self.beside[place as usize][..] else { return false };
            let [r, a, b] = [place, p.place, q.place].map(|i| at[i as usize]);
            a > 0.0 && b > 0.0 && a.max(b) <= 2.0 * a.min(b) && (r > ABSURD * a.max(b) || r * ABSURD < a.min(b))
        };
        // A radius that is absurdly large says nothing of those beside it.
        let all: Vec<bool> = (0..self.count as u32).map(absurd).collect();
        let mut told = at.clone();
        for (radius, _) in told.iter_mut().zip(&all).filter(|(_, absurd)| **absurd) {
            *radius = 0.0;
        }
        let fault = |(node, &place): (&anastomesh_skeleton::Node, &u32)| match node.radius {
            r if !good(r) => Some(RadiusDefect::Missing),
            _ if all[place as usize] || self.is_dip(place, &told) => Some(RadiusDefect::Absurd),
            _ => None,
        };
        raw.nodes.iter().zip(&self.of_node).map(fault).collect()
    }

    /// Whether the vessel is ten times as wide to both sides of a place, near by for that width, or to one side where it ends
    /// to the other.
    fn is_dip(&self, place: u32, radii: &[f64]) -> bool {
        let beside = &self.beside[place as usize];
        if beside.len() > 2 {
            return false;
        }
        let found: Vec<Beyond> = beside.iter().map(|&next| self.beyond(place, next, radii)).collect();
        found.contains(&Beyond::Wider) && !found.contains(&Beyond::Same)
    }

    /// What follows where the vessel leaves a place towards `next`.
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

    /// A radius for each place; none when there is no good one.
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
            // To and fro, so that it does not matter at which end a run begins.
            for k in 0..missing.len() {
                let place = missing[if sweep % 2 == 0 { k } else { missing.len() - 1 - k }];
                radii[place] = self.mean(place, &radii).unwrap_or(radii[place]);
            }
        }
        Some(radii)
    }

    /// Mean of the radii beside a place, weighted by nearness.
    fn mean(&self, place: usize, radii: &[f64]) -> Option<f64> {
        let (mut sum, mut weights) = (0.0, 0.0);
        for next in &self.beside[place] {
            let weight = 1.0 / next.length.max(APART);
            sum += weight * radii[next.place as usize];
            weights += weight;
        }
        let mean = sum / weights;
        good(mean).then_some(mean)
    }

    /// The nearest known radius along the vessels.
    fn nearest(&self, known: &[Option<f64>]) -> Vec<Option<f64>> {
        let mut radii = vec![None; self.count];
        let sources = (0..).zip(known).filter_map(|(place, r)| Some((Total(0.0), place, Total((*r)?))));
        // The nearest first: its distance, its place, and the radius that comes along.
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
