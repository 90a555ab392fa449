//! Edge or triangle to recover, and the edges and faces that flips may make beside it.
//!
//! A flip that removes a crossing must not make another one. The number of crossings then falls with every flip. In a
//! plane such a flip always exists (Hanke, Ottmann, Schuierer, 'The edge-flipping distance of triangulations', 1996).

use super::march::pierces;
use crate::complex::Complex;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::{orient2d, orient3d};

/// Part of the surface that flips try to recover.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Aim {
    /// None: flips may make any edge and face.
    Any,
    /// Edge with these ends.
    Edge([u32; 2]),
    /// Triangle with these corners.
    Triangle([u32; 3]),
}

impl Aim {
    /// True if an edge, with faces to two apices, may be made.
    pub(super) fn allows_edge(self, c: &Complex, edge: [u32; 2], apices: [u32; 2]) -> bool {
        match self {
            Self::Any => true,
            Self::Edge(aim) => {
                let crosses = |apex: u32| pierces(c, aim, [edge[0], edge[1], apex]);
                !apices.into_iter().any(crosses) && !meet(c, aim, edge)
            }
            Self::Triangle(aim) => !pierces(c, edge, aim),
        }
    }

    /// True if a face may be made.
    pub(super) fn allows_face(self, c: &Complex, face: [u32; 3]) -> bool {
        if let Self::Edge(aim) = self { !pierces(c, aim, face) } else { true }
    }
}

/// True if two segments meet in their interiors.
fn meet(c: &Complex, [a, b]: [u32; 2], [x, y]: [u32; 2]) -> bool {
    if [a, b].contains(&x) || [a, b].contains(&y) {
        return false;
    }
    let [a, b, x, y] = [a, b, x, y].map(|v| &c.points[v as usize]);
    if orient3d(a, b, x, y) != 0.0 {
        return false;
    }
    // The four points are coplanar, so signs in a projection along an axis are exact, unless the axis lies in the plane.
    (0..3).any(|axis| {
        let side = |p: &Point3, q: &Point3, r: &Point3| {
            let [p, q, r] = [p, q, r].map(|v| [v[(axis + 1) % 3], v[(axis + 2) % 3]]);
            orient2d(p, q, r)
        };
        let opposite = |s: f64, t: f64| (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0);
        opposite(side(a, b, x), side(a, b, y)) && opposite(side(x, y, a), side(x, y, b))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complex() -> Complex {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        Complex::new(vec![
            p(0.0, 0.0, 0.0),
            p(4.0, 0.0, 0.0),
            p(1.0, -1.0, 0.0),
            p(1.0, 1.0, 0.0),
            p(1.0, 0.0, 1.0),
            p(1.0, 0.0, -1.0),
            p(9.0, 1.0, 0.0),
            p(1.0, 1.0, -1.0),
        ])
    }

    #[test]
    fn an_edge_that_meets_the_wanted_one_is_refused() {
        let c = complex();
        let aim = Aim::Edge([0, 1]);
        // In the plane of the wanted edge.
        assert!(!aim.allows_edge(&c, [2, 3], [4, 5]));
        assert!(aim.allows_edge(&c, [2, 6], [4, 5]) && aim.allows_edge(&c, [0, 3], [4, 5]));
        // Its faces are pierced.
        assert!(!aim.allows_edge(&c, [4, 2], [7, 5]));
        assert!(!aim.allows_face(&c, [2, 4, 7]) && aim.allows_face(&c, [3, 4, 6]));
        assert!(Aim::Any.allows_edge(&c, [2, 3], [4, 5]));
    }

    #[test]
    fn an_edge_that_pierces_the_wanted_triangle_is_refused() {
        let mut c = complex();
        c.points[4].y = 0.1;
        c.points[5].y = 0.1;
        assert!(!Aim::Triangle([0, 1, 3]).allows_edge(&c, [4, 5], [2, 6]));
        assert!(Aim::Triangle([0, 1, 3]).allows_edge(&c, [4, 6], [2, 5]));
    }

    #[test]
    fn segments_meet_in_any_plane() {
        // A cross, a segment beyond either end, one beside, and one that only touches.
        let flat = [
            [0.0, 0.0],
            [4.0, 0.0],
            [1.0, -1.0],
            [2.0, 1.0],
            [5.0, -1.0],
            [5.0, 2.0],
            [1.0, 2.0],
            [3.0, 0.0],
            [3.0, 1.0],
        ];
        let planes: [fn([f64; 2]) -> [f64; 3]; 5] = [
            |[x, y]| [x, y, 0.0],
            |[x, y]| [0.0, x, y],
            |[x, y]| [y, 0.0, x],
            |[x, y]| [x, y, x - y],
            |[x, y]| [y, x, 2.0],
        ];
        for plane in planes {
            let c = Complex::new(flat.into_iter().map(plane).map(Point3::from).collect());
            for aim in [[0, 1], [1, 0]] {
                let met = |[x, y]: [u32; 2]| [[x, y], [y, x]].map(|edge| meet(&c, aim, edge));
                assert_eq!(met([2, 3]), [true; 2]);
                for other in [[4, 5], [3, 6], [7, 8], [2, 4], [0, 3], [1, 3]] {
                    assert_eq!(met(other), [false; 2], "{other:?}");
                }
            }
            assert!(meet(&c, [2, 3], [0, 7]) && !meet(&c, [2, 8], [0, 3]));
        }
        let skew = Complex::new(
            [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, -1.0, 1.0], [2.0, 1.0, 1.0]].map(Point3::from).into(),
        );
        assert!(!meet(&skew, [0, 1], [2, 3]));
    }

    #[test]
    fn only_edges_are_a_matter_of_a_wanted_triangle() {
        let c = complex();
        assert!(Aim::Triangle([0, 1, 3]).allows_face(&c, [4, 5, 6]) && Aim::Any.allows_face(&c, [2, 4, 7]));
    }
}
