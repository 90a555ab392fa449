//! Shape preservation of polylines: the nodes along a vessel move with their neighbours.

use super::frame::{Chain, Frame};
use anastomesh_mesh::geometry::Vec3;
use rayon::prelude::*;

/// Smoothing length along a vessel, in radii.
const REACH: f64 = 4.0;

/// Smooths the steps of the nodes inside each chain. The ends keep their steps.
pub(super) fn smooth_steps(frame: &Frame, steps: &mut [Vec3], asked: &[u32]) {
    let smooth: Vec<Vec<Vec3>> = frame
        .chains
        .par_iter()
        .map(|chain| if chain.nodes.len() > 2 { smoothed(frame, &chain, steps, asked) } else { Vec::new() })
        .collect();
    for (chain, values) in frame.chains.iter().zip(smooth) {
        let inner = chain.nodes.iter().zip(values).skip(1).take(chain.nodes.len() - 2);
        for (node, step) in inner {
            if frame.mobility[node.index()] > 0.0 {
                steps[node.index()] = step;
            }
        }
    }
}

/// Smoothed steps of a chain's nodes. Nodes without a request first follow the others. A second pass over all nodes
/// removes the kinks at requests.
fn smoothed(frame: &Frame, chain: &Chain, steps: &[Vec3], asked: &[u32]) -> Vec<Vec3> {
    let springs: Vec<f64> = (0..chain.edges.len()).map(|i| spring(frame, chain, i)).collect();
    let mut values: Vec<Vec3> = chain.nodes.iter().map(|n| steps[n.index()]).collect();
    along(&springs, &mut values, |i| if asked[chain.nodes[i].index()] > 0 { 1.0 } else { 0.0 });
    along(&springs, &mut values, |_| 1.0);
    values
}

/// Spring constant between the nodes of a chain's edge: (`REACH` radii over length)². A step then decays by a factor e
/// over `REACH` radii.
fn spring(frame: &Frame, chain: &Chain, i: usize) -> f64 {
    let tube = frame.skeleton.tube(chain.edges[i]);
    let k = (REACH * 0.5 * (tube.ra + tube.rb) / tube.length().max(1e-3 * tube.max_radius())).powi(2);
    // Bends are free to bend.
    let bend = [chain.nodes[i], chain.nodes[i + 1]].iter().any(|m| frame.is_bend[m.index()]);
    if bend { 1e-2 * k } else { k }
}

/// Minimizes Σ weight |x − value|² + Σ spring |difference|² over the inner values. The tridiagonal system is solved by
/// elimination.
fn along(springs: &[f64], values: &mut [Vec3], weight: impl Fn(usize) -> f64) {
    let n = values.len();
    let (mut above, mut before) = (0.0, values[0]);
    let mut factors = vec![0.0; n];
    for i in 1..n - 1 {
        let (weight, left) = (weight(i), springs[i - 1]);
        let diagonal = weight + left * (1.0 - above) + springs[i];
        before = (values[i] * weight + before * left) / diagonal;
        above = springs[i] / diagonal;
        (factors[i], values[i]) = (above, before);
    }
    for i in (1..n - 1).rev() {
        let next = values[i + 1];
        values[i] += next * factors[i];
    }
}
