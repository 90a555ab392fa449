//! Bends: additional nodes in the middle of stuck vessels.
//!
//! A straight vessel between terminals on either side of a thick vessel cannot leave it. Two long vessels that leave a
//! node side by side would have to move as a whole. A bend lets them separate at the overlap.

use super::frame::Frame;
use anastomesh_skeleton::{EdgeId, Overlap, Overlaps};
use std::collections::BTreeMap;

/// Minimum length, in radii, of the pieces on both sides of a bend.
const SHORTEST: f64 = 5.0;

/// Half the length of a vessel that moves for an overlap, in sums of its radii.
const REACH: f64 = 4.0;
/// Maximum number of divisions on each side of an overlap, and their minimum distance in radii.
const DIVISIONS: f64 = 6.0;
const STEP: f64 = 2.0;
/// Minimum distance of divisions of different overlaps from each other and from the nodes, as a fraction of the step.
const GAP: f64 = 0.7;

/// Divides the edges of overlapping vessels near the overlap, so that only this part moves; returns the number of new nodes.
/// `Frame::rejoin` must follow.
pub(super) fn divide_near(frame: &mut Frame, overlaps: &Overlaps) -> usize {
    let mut places: BTreeMap<EdgeId, Vec<(f64, f64)>> = BTreeMap::new();
    for overlap in &overlaps.pairs {
        for (edge, point) in overlap.edges.into_iter().zip(overlap.points) {
            let tube = frame.skeleton.tube(edge);
            let length = tube.length();
            let reach = REACH * overlap.radii;
            let step = (STEP * tube.max_radius()).max(reach / DIVISIONS);
            let at = (point - tube.a).norm();
            let count = (reach / step).floor() as i32;
            let offsets = (-count..=count).map(|k| (at + f64::from(k) * step, GAP * step));
            let inner = offsets.filter(|(s, gap)| *s > *gap && *s < length - gap);
            places.entry(edge).or_default().extend(inner.map(|(s, gap)| (s / length, gap / length)));
        }
    }
    let before = frame.origin.len();
    for (edge, mut places) in places {
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut last = 0.0;
        places.retain(|&(t, gap)| {
            let is_apart = t - last >= gap;
            if is_apart {
                last = t;
            }
            is_apart
        });
        let places: Vec<f64> = places.into_iter().map(|(t, _)| t).collect();
        frame.divide(edge, &places);
    }
    frame.origin.len() - before
}

/// Adds bends to overlapping vessels and returns their number. `Frame::rejoin` must follow.
pub(super) fn add_bends(frame: &mut Frame, overlaps: &Overlaps) -> usize {
    let edges = frame.skeleton.edges.len();
    let mut done = vec![false; edges];
    let mut count = 0;
    for overlap in &overlaps.pairs {
        if overlap.edges.iter().any(|e| done[e.index()]) {
            continue;
        }
        if let Some((edge, t)) = place(frame, overlap) {
            done[edge.index()] = true;
            frame.add_bend(edge, t);
            count += 1;
        }
    }
    count
}

/// Edge to bend and parameter on it: the thinner edge if it is long enough, else the other one.
fn place(frame: &Frame, overlap: &Overlap) -> Option<(EdgeId, f64)> {
    let at = |i: usize| {
        let edge = overlap.edges[i];
        let tube = frame.skeleton.tube(edge);
        let length = tube.length();
        let margin = SHORTEST * tube.max_radius() / length;
        let own = (overlap.points[i] - tube.a).norm() / length;
        // Both pieces must be long enough.
        (margin <= 0.5).then(|| (edge, own.clamp(margin, 1.0 - margin), length / tube.max_radius(), tube.max_radius()))
    };
    let mut both: Vec<_> = [0, 1].into_iter().filter_map(at).collect();
    // Thinner edge first; among equals, the one that is longer relative to its radius.
    both.sort_by(|x, y| x.3.total_cmp(&y.3).then(y.2.total_cmp(&x.2)).then(x.0.cmp(&y.0)));
    both.first().map(|&(edge, t, ..)| (edge, t))
}
