//! Corrections that conditions request of nodes.
//!
//! Conditions are solved by projection (position based dynamics; Müller, Heidelberger, Hennix, Ratcliff 2007). Each
//! violated condition requests the smallest move, weighted by mobility, that satisfies it to first order.

use super::frame::Frame;
use anastomesh_mesh::geometry::Vec3;
use anastomesh_skeleton::NodeId;

/// Move of one node that one condition requests.
pub(super) type Push = (NodeId, Vec3);

/// Adds the moves that satisfy a condition with the given `deficit`. `gradient` holds its derivatives by its nodes.
/// Each move is at most `cap` long.
pub(super) fn project(frame: &Frame, gradient: &[(NodeId, Vec3)], deficit: f64, cap: f64, out: &mut Vec<Push>) {
    let mobility = |n: NodeId| frame.mobility[n.index()];
    let below: f64 = gradient.iter().map(|(n, g)| mobility(*n) * g.norm_squared()).sum();
    if below.is_nan() || below <= 0.0 {
        return;
    }
    let largest = gradient.iter().map(|(n, g)| mobility(*n) * g.norm()).fold(0.0, f64::max);
    let factor = (deficit / below).min(cap / largest);
    if !factor.is_finite() {
        return;
    }
    for &(node, g) in gradient {
        let weight = factor * mobility(node);
        if weight > 0.0 {
            out.push((node, g * weight));
        }
    }
}
