//! End surface: the triangle disc that ends a block at a cut (section 3.2.2 of the paper), and its invariants.

use crate::partition::CutId;
use crate::surface::SharedDisc;
use anastomesh_mesh::geometry::{Point3, Section};

/// End of a cluster at a cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutEnd {
    pub cut: CutId,
    /// Side of the cut on which the cluster lies.
    pub side: u8,
    /// Cut plane; its axis points out of the cluster.
    pub section: Section,
}

/// Triangles at a cut.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EndSurface {
    /// The cut.
    pub cut: CutId,
    /// Side of the cut.
    pub side: u8,
    /// Cut plane; its axis points out of the cluster.
    pub section: Section,
    /// Triangles as indices into the cluster's points, oriented out of the cluster.
    pub triangles: Vec<[u32; 3]>,
    /// Boundary loop, counter-clockwise about the section's axis, starting at its smallest vertex.
    pub rim: Vec<u32>,
}

/// End surface with its own points only.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StoredEnd {
    /// The surface.
    pub surface: EndSurface,
    /// Points of the surface.
    pub points: Vec<Point3>,
}

/// Violated invariant of an end surface.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EndFault {
    /// A triangle's projection onto the cut plane is not positive.
    #[error("triangle {0} folds in projection")]
    Fold(u32),
    /// A directed edge occurs twice, the boundary is not one simple loop, or the Euler number is not 1.
    #[error("not a disc")]
    NotADisc,
    /// The projected boundary loop intersects itself.
    #[error("rim edges {0} and {1} cross in projection")]
    RimCrosses(u32, u32),
}

/// Plane coordinates of points in a section's frame, on an integer grid. The grid is fine enough that snapping is
/// negligible and coarse enough that `cross` is exact.
pub(crate) struct CutPlane {
    section: Section,
    u: anastomesh_mesh::geometry::Vec3,
    w: anastomesh_mesh::geometry::Vec3,
    scale: f64,
}

/// Grid coordinates stay below 2^26 in magnitude: differences below 2^27, products below 2^54, sums below 2^55.
const GRID: f64 = (1u64 << 25) as f64;

impl CutPlane {
    /// `extent` bounds the distance of projected points from the axis.
    pub(crate) fn new(section: &Section, extent: f64) -> Self {
        let (u, w) = section.frame();
        Self { section: *section, u, w, scale: GRID / extent }
    }

    pub(crate) fn snap(&self, p: &Point3) -> [i64; 2] {
        let d = p - self.section.origin;
        let grid = |x: f64| (x * self.scale).round().clamp(-2.0 * GRID, 2.0 * GRID) as i64;
        [grid(d.dot(&self.u)), grid(d.dot(&self.w))]
    }
}

/// Twice the signed area of a triangle of grid points, exact.
pub(crate) fn cross(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// True if two segments without a common end point intersect.
fn segments_meet(a: [i64; 2], b: [i64; 2], c: [i64; 2], d: [i64; 2]) -> bool {
    let within =
        |p: [i64; 2], q: [i64; 2], x: [i64; 2]| (0..2).all(|k| p[k].min(q[k]) <= x[k] && x[k] <= p[k].max(q[k]));
    let (s1, s2) = (cross(a, b, c).signum(), cross(a, b, d).signum());
    let (s3, s4) = (cross(c, d, a).signum(), cross(c, d, b).signum());
    (s1 != s2 && s3 != s4 && s1 * s2 <= 0 && s3 * s4 <= 0)
        || (s1 == 0 && within(a, b, c))
        || (s2 == 0 && within(a, b, d))
        || (s3 == 0 && within(c, d, a))
        || (s4 == 0 && within(c, d, b))
}

/// First pair of edges of a closed polygon that intersect elsewhere than in a common end point.
pub(crate) fn crossing(polygon: &[[i64; 2]]) -> Option<(u32, u32)> {
    let n = polygon.len();
    for i in 0..n {
        let (a, b) = (polygon[i], polygon[(i + 1) % n]);
        if a == b {
            return Some((i as u32, i as u32));
        }
        for j in i + 1..n {
            let (c, d) = (polygon[j], polygon[(j + 1) % n]);
            let crosses = if (i + 1) % n == j {
                folds_back(a, b, d)
            } else if (j + 1) % n == i {
                folds_back(c, d, b)
            } else {
                segments_meet(a, b, c, d)
            };
            if crosses {
                return Some((i as u32, j as u32));
            }
        }
    }
    None
}

/// True if b→c overlaps a→b in the opposite direction.
fn folds_back(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> bool {
    cross(a, b, c) == 0 && (a[0] - b[0]) * (c[0] - b[0]) + (a[1] - b[1]) * (c[1] - b[1]) > 0
}

/// Boundary loop of an oriented triangle set, starting at its smallest vertex. Returns `None` unless the set is one
/// connected disc: no repeated directed edge, one simple loop, Euler number 1.
pub(crate) fn disc_rim(triangles: &[[u32; 3]]) -> Option<Vec<u32>> {
    // Directed edges with their triangles, and the tails of those without a neighbour.
    let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    for (&[a, b, c], i) in triangles.iter().zip(0..) {
        edges.extend([[a, b], [b, c], [c, a]].map(|edge| (edge, i)));
    }
    edges.sort_unstable();
    if edges.windows(2).any(|pair| pair[0].0 == pair[1].0) {
        return None;
    }
    let beyond = |[a, b]: [u32; 2]| edges.binary_search_by_key(&[b, a], |(edge, _)| *edge).ok().map(|i| edges[i].1);
    let boundary: Vec<[u32; 2]> = edges.iter().map(|(edge, _)| *edge).filter(|&edge| beyond(edge).is_none()).collect();
    // Sorted by tail, so that a repeated tail is a pinched vertex.
    if boundary.is_empty() || boundary.windows(2).any(|pair| pair[0][0] == pair[1][0]) {
        return None;
    }
    let [first, mut at] = boundary[0];
    let mut rim = vec![first];
    while at != first {
        if rim.len() > boundary.len() {
            return None;
        }
        rim.push(at);
        let k = boundary.binary_search_by_key(&at, |edge| edge[0]).ok()?;
        at = boundary[k][1];
    }
    if rim.len() != boundary.len() || !is_connected(triangles, beyond) {
        return None;
    }
    let mut vertices: Vec<u32> = edges.iter().map(|(edge, _)| edge[0]).collect();
    vertices.dedup();
    let edge_count = usize::midpoint(edges.len(), boundary.len());
    (vertices.len() + triangles.len() == edge_count + 1).then_some(rim)
}

/// True if the triangles are connected by edges. `beyond` gives the triangle on the other side of a directed edge.
fn is_connected(triangles: &[[u32; 3]], beyond: impl Fn([u32; 2]) -> Option<u32>) -> bool {
    let mut seen = vec![false; triangles.len()];
    let mut stack = vec![0u32];
    seen[0] = true;
    let mut count = 1;
    while let Some(i) = stack.pop() {
        let [a, b, c] = triangles[i as usize];
        for j in [[a, b], [b, c], [c, a]].into_iter().filter_map(&beyond) {
            if !std::mem::replace(&mut seen[j as usize], true) {
                count += 1;
                stack.push(j);
            }
        }
    }
    count == triangles.len()
}

impl EndSurface {
    /// End surface of a vessel piece that ends in a disc; its vertices are those of the disc.
    pub fn of_disc(disc: &SharedDisc, cut: CutId, side: u8, outward: Section) -> Self {
        let mut rim = disc.rim.clone();
        if let Some(first) = (0..rim.len()).min_by_key(|&i| rim[i]) {
            rim.rotate_left(first);
        }
        Self { cut, side, section: outward, triangles: disc.triangles.clone(), rim }
    }

    /// Checks that the surface is one disc and projection flat. Positive triangles with a simple polygon as boundary
    /// cover every point of the plane at most once.
    ///
    /// # Errors
    /// Returns the first fault found.
    pub fn check(&self, points: &[Point3]) -> Result<(), EndFault> {
        if disc_rim(&self.triangles).as_ref() != Some(&self.rim) {
            return Err(EndFault::NotADisc);
        }
        self.check_flat(points)
    }

    /// Checks a surface with the rim of [`disc_rim`].
    ///
    /// # Errors
    /// See [`EndSurface::check`].
    pub fn check_flat(&self, points: &[Point3]) -> Result<(), EndFault> {
        let extent = self
            .triangles
            .iter()
            .flatten()
            .map(|&v| (points[v as usize] - self.section.origin).norm())
            .fold(self.section.radius, f64::max);
        let plane = CutPlane::new(&self.section, extent);
        for (i, t) in self.triangles.iter().enumerate() {
            let [a, b, c] = t.map(|v| plane.snap(&points[v as usize]));
            if cross(a, b, c) <= 0 {
                return Err(EndFault::Fold(i as u32));
            }
        }
        let polygon: Vec<[i64; 2]> = self.rim.iter().map(|&v| plane.snap(&points[v as usize])).collect();
        crossing(&polygon).map_or(Ok(()), |(i, j)| Err(EndFault::RimCrosses(i, j)))
    }

    /// Vertices of the surface, in ascending order.
    pub fn vertices(&self) -> Vec<u32> {
        let mut v: Vec<u32> = self.triangles.iter().flatten().copied().collect();
        v.sort_unstable();
        v.dedup();
        v
    }
}
