//! In-sphere test without ties.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::{insphere_exact, orient3d};
use std::cmp::Ordering;

/// As [`in_sphere_close`], for any points.
#[inline]
#[cfg(test)]
pub fn in_sphere_perturbed(p: [&Point3; 4], e: &Point3) -> bool {
    let s = anastomesh_mesh::geometry::predicates::insphere(p[0], p[1], p[2], p[3], e);
    if s == 0.0 { tie(p, e) } else { s > 0.0 }
}

/// Decides cospherical points. The in-sphere determinant is linear in the lifts; the coefficient of a point's lift is
/// the orientation of the other four. The first non-zero one decides, from the largest perturbation down. That of `e`
/// is never zero, since `p` is positive, so the search ends there at the latest.
#[cold]
fn tie(p: [&Point3; 4], e: &Point3) -> bool {
    let all = [p[0], p[1], p[2], p[3], e];
    let mut left = [true; 5];
    for _ in 0..5 {
        let Some(last) = (0..5).filter(|&i| left[i]).max_by(|&i, &j| lexicographic(all[i], all[j])) else { break };
        left[last] = false;
        if last == 4 {
            // Raised above the others, e lies outside.
            return false;
        }
        let mut q = p;
        q[last] = e;
        let o = orient3d(q[0], q[1], q[2], q[3]);
        if o != 0.0 {
            return o > 0.0;
        }
    }
    false
}

/// True if `e` lies inside the circumsphere of the positive tetrahedron `p`. For cospherical points, each lift is
/// raised by an infinitesimal, larger by orders of magnitude for later points in lexicographic order. Points must be
/// distinct. Exact; meant for determinants that no filter separates from zero.
pub(super) fn in_sphere_close(p: [&Point3; 4], e: &Point3) -> bool {
    let s = insphere_exact(p[0], p[1], p[2], p[3], e);
    if s == 0.0 { tie(p, e) } else { s > 0.0 }
}

fn lexicographic(a: &Point3, b: &Point3) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}
