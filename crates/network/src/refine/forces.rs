//! The three forces of the paper (section 3.1), with corrected signs and ranges.

use super::contact::Contacts;
use super::cut_length;
use super::frame::{Chain, Frame};
use super::push::Push;
use anastomesh_mesh::geometry::Vec3;
use anastomesh_skeleton::{Barrier, NARROW, NodeId};
use rayon::prelude::*;

/// Lower bound λ of the angle in (9).
const LEAST_ANGLE: f64 = 0.1;
/// Maximum angle at which the angle force acts, in `NARROW`. Without it the force would move every node of a network
/// without need.
const WIDE: f64 = 1.5;
/// Range of the repelling force, as a multiple of the length that a cut needs.
const REACH: f64 = 1.2;

/// Rates ℓ1, ℓ2, ℓ3.
#[derive(Clone, Copy)]
pub(super) struct Rates {
    pub barrier: f64,
    pub repel: f64,
    pub angle: f64,
}

/// Steps of all forces for one iteration: angle, repel, barrier.
pub(super) fn pushes(frame: &Frame, contacts: &Contacts, barrier: &Barrier, rates: Rates) -> Vec<Push> {
    let nodes = (0..frame.origin.len() as u32).into_par_iter().with_min_len(512).fold(Vec::new, |mut out, node| {
        angle(frame, NodeId(node), rates.angle, &mut out);
        out
    });
    let chains = frame.chains.par_iter().with_min_len(512).fold(Vec::new, |mut out, chain| {
        repel(frame, &chain, rates.repel, &mut out);
        out
    });
    let pairs = contacts.pairs.par_iter().with_min_len(256).fold(Vec::new, |mut out, pair| {
        if !pair.is_near_along() {
            push_barrier(frame, pair.edges, barrier, rates.barrier, &mut out);
        }
        out
    });
    let mut all = nodes.collect::<Vec<_>>().concat();
    all.extend(chains.collect::<Vec<_>>().concat());
    all.extend(pairs.collect::<Vec<_>>().concat());
    all
}

fn capped(step: Vec3, cap: f64) -> Vec3 {
    let length = step.norm();
    if length > cap { step * (cap / length) } else { step }
}

/// Adds a capped step for a movable node.
fn add(frame: &Frame, node: NodeId, step: Vec3, cap: f64, out: &mut Vec<Push>) {
    let step = capped(step, cap);
    if frame.mobility[node.index()] > 0.0 && step.iter().all(|x| x.is_finite()) && step.norm_squared() > 0.0 {
        out.push((node, step));
    }
}

/// Equation (7): descends the gradient of the barrier, for both edges of the pair.
fn push_barrier(
    frame: &Frame,
    edges: [anastomesh_skeleton::EdgeId; 2],
    barrier: &Barrier,
    rate: f64,
    out: &mut Vec<Push>,
) {
    let [a, b] = edges.map(|e| frame.skeleton.tube(e));
    let Some(gradient) = barrier.pair(&a, &b) else { return };
    let nodes = edges.map(|e| frame.skeleton.edge(e).nodes);
    let cap = 0.25 * (a.min_radius() + b.min_radius());
    for (node, g) in nodes.into_iter().flatten().zip(gradient.by_end) {
        add(frame, node, g * (-rate * barrier.unit * barrier.unit), cap, out);
    }
}

/// Equation (8): the ends of a vessel repel each other while it is too short for a cut.
fn repel(frame: &Frame, chain: &Chain, rate: f64, out: &mut Vec<Push>) {
    let Some(need) = cut_length::need(frame, chain) else { return };
    let length: f64 = chain.edges.iter().map(|&e| frame.skeleton.length(e)).sum();
    let weight = 1.5 * spline(2.0 * length / (REACH * need));
    if weight <= 0.0 {
        return;
    }
    let last = chain.edges.len() - 1;
    for (node, edge) in chain.ends().into_iter().zip([chain.edges[0], chain.edges[last]]) {
        let away = frame.at(node) - frame.at(frame.lever(node, edge));
        let step = away.try_normalize(0.0).unwrap_or_else(Vec3::zeros) * (rate * weight * length);
        add(frame, node, step, 0.5 * frame.radius_at(edge, node), out);
    }
}

/// Cubic B-spline.
fn spline(x: f64) -> f64 {
    match x {
        x if x < 1.0 => 2.0 / 3.0 - x * x + 0.5 * x * x * x,
        x if x < 2.0 => (2.0 - x).powi(3) / 6.0,
        _ => 0.0,
    }
}

/// Equations (9), (10): steps towards the mean midpoint of neighbour pairs, weighted by narrowness.
fn angle(frame: &Frame, node: NodeId, rate: f64, out: &mut Vec<Push>) {
    let edges = frame.adjacency.edges(node);
    if edges.len() < 3 || frame.mobility[node.index()] <= 0.0 {
        return;
    }
    let here = frame.at(node);
    let (mut sum, mut weights, mut narrowest) = (Vec3::zeros(), 0.0, f64::INFINITY);
    for (i, &e) in edges.iter().enumerate() {
        for &f in &edges[..i] {
            let [u, v] = [e, f].map(|e| frame.at(frame.lever(node, e)) - here);
            let angle = libm::atan2(u.cross(&v).norm(), u.dot(&v));
            let weight = 1.0 / angle.max(LEAST_ANGLE);
            sum += (u + v) * (0.5 * weight);
            weights += weight;
            narrowest = narrowest.min(angle);
        }
    }
    if narrowest < WIDE * NARROW {
        add(frame, node, sum * (rate / weights), 0.5 * frame.skeleton.node(node).radius, out);
    }
}
