//! Polylines keep their shape: the nodes along a vessel move with their neighbours.

use super::frame::{Chain, Frame};
use crate::geometry::Vec3;
use rayon::prelude::*;

/// How strongly neighbours along a vessel move together, against what is asked of each.
const STIFFNESS: f64 = 2.0;

/// Replaces the steps of the nodes inside each chain by smooth ones: Σ w |x − step|² + Σ k |difference|² is least, w
/// being 1 where something was asked of a node and 0 elsewhere, k = `STIFFNESS` times radius over length. Ends keep their
/// steps.
pub(super) fn smooth_steps(frame: &Frame, steps: &mut [Vec3], asked: &[u32]) {
    let smooth: Vec<Vec<Vec3>> = frame
        .chains
        .par_iter()
        .map(|chain| if chain.nodes.len() > 2 { along(frame, chain, steps, asked) } else { Vec::new() })
        .collect();
    for (chain, inner) in frame.chains.iter().zip(smooth) {
        for (node, step) in chain.nodes[1..].iter().zip(inner) {
            if frame.mobility[node.index()] > 0.0 {
                steps[node.index()] = step;
            }
        }
    }
}

/// The tridiagonal system of one chain, solved by elimination.
fn along(frame: &Frame, chain: &Chain, steps: &[Vec3], asked: &[u32]) -> Vec<Vec3> {
    let n = chain.nodes.len();
    let spring = |i: usize| {
        let edge = chain.edges[i];
        let tube = frame.skeleton.tube(edge);
        // A bend is there to bend.
        let bend = [chain.nodes[i], chain.nodes[i + 1]].iter().any(|m| frame.is_bend[m.index()]);
        let k = STIFFNESS * 0.5 * (tube.ra + tube.rb) / tube.length().max(1e-9 * tube.max_radius());
        if bend { 1e-2 * k } else { k }
    };
    let springs: Vec<f64> = (0..n - 1).map(spring).collect();
    let step = |i: usize| steps[chain.nodes[i].index()];
    let (mut factors, mut values) = (Vec::with_capacity(n - 2), Vec::with_capacity(n - 2));
    let (mut above, mut value) = (0.0, step(0));
    for i in 1..n - 1 {
        let weight = if asked[chain.nodes[i].index()] > 0 { 1.0 } else { 0.0 };
        let left = springs[i - 1];
        let diagonal = weight + left * (1.0 - above) + springs[i];
        value = (step(i) * weight + value * left) / diagonal;
        above = springs[i] / diagonal;
        factors.push(above);
        values.push(value);
    }
    let mut next = step(n - 1);
    for (value, factor) in values.iter_mut().zip(&factors).rev() {
        *value += next * *factor;
        next = *value;
    }
    values
}
