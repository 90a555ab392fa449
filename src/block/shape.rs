//! Quality measures for building blocks.

use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::triangle_ratio;

/// Cosine of the angle (45°) between normal and outward direction up to which a wall triangle has full quality. Walls
/// of tapers and bends deviate less, folds more.
const FACING: f64 = 0.7;

/// Radius ratio of a tube's wall triangle, reduced if it does not face `outward`, the direction away from the axis.
/// Negative if it faces the axis.
pub(super) fn facing_ratio(p: &[Point3; 3], outward: &Vec3) -> f64 {
    let normal = (p[1] - p[0]).cross(&(p[2] - p[0]));
    let cosine = normal.dot(outward) / (normal.norm() * outward.norm()).max(f64::MIN_POSITIVE);
    triangle_ratio(p) * (cosine / FACING).min(1.0)
}
