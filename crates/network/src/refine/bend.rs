//! Bends: additional nodes in the middle of stuck vessels.
//!
//! A straight vessel between terminals on either side of a thick vessel cannot leave it. Two long vessels that leave a
//! node side by side would have to move as a whole. A bend lets them separate at the overlap.

use super::frame::Frame;
use anastomesh_skeleton::{EdgeId, Overlap, Overlaps};

/// Minimum length, in radii, of the pieces on both sides of a bend.
const SHORTEST: f64 = 5.0;

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
