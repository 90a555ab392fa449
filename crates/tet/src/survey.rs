//! Search for the triangles and edges of a surface that a complex already has.

use super::complex::Complex;
use super::input::SurfaceEdges;
use super::star::Star;
use anastomesh_mesh::TriMesh;

/// Freezes the triangles of the surface that are faces. Returns the missing edges and triangles, in ascending order.
/// One pass over the faces finds the triangles. Edges of present triangles exist, so only the others are searched.
pub(super) fn survey(c: &mut Complex, surface: &TriMesh, edges: &SurfaceEdges) -> (Vec<[u32; 2]>, Vec<u32>) {
    let triangles = ByLowest::new(surface);
    let mut found = vec![false; surface.triangles.len()];
    let n = surface.points.len() as u32;
    for t in 0..c.slots() as u32 {
        if !c.is_alive(t) {
            continue;
        }
        let cell = *c.cell(t);
        // Ghosts have a number above all points'.
        let others = cell.verts.iter().filter(|&&v| v >= n).count();
        if others > 1 {
            continue;
        }
        for i in 0..4 {
            let half = 4 * t + i as u32;
            // Only the first of two mates is tested, and only the face opposite a vertex off the surface.
            if half > cell.mates[i] || (others == 1 && cell.verts[i] < n) {
                continue;
            }
            let face = c.face(half);
            for &i in triangles.at(face) {
                if same_vertices(surface.triangles[i as usize], face) {
                    found[i as usize] = true;
                    c.freeze(half);
                }
            }
        }
    }
    let lost: Vec<u32> = (0..).zip(&found).filter(|(_, found)| !**found).map(|(i, _)| i).collect();
    let closed = 2 * edges.edges.len() == 3 * surface.triangles.len();
    if lost.is_empty() && closed {
        return (Vec::new(), lost);
    }
    let mut there = vec![false; edges.edges.len()];
    for (t, _) in surface.triangles.iter().zip(&found).filter(|(_, found)| **found) {
        for i in 0..3 {
            if let Some(e) = edges.position(t[i], t[(i + 1) % 3]) {
                there[e] = true;
            }
        }
    }
    let mut star = Star::default();
    let unseen = edges.edges.iter().zip(there).filter(|(_, there)| !there).map(|(&e, _)| e);
    (unseen.filter(|e| star.find_edge(c, e[0], e[1]).is_none()).collect(), lost)
}

#[inline]
fn same_vertices(a: [u32; 3], b: [u32; 3]) -> bool {
    let has = |v: u32| v == b[0] || v == b[1] || v == b[2];
    has(a[0]) && has(a[1]) && has(a[2])
}

/// Triangles by their lowest vertex.
struct ByLowest {
    /// `list[end[v − 1]..end[v]]` are those of `v`.
    end: Vec<u32>,
    list: Vec<u32>,
}

fn lowest(t: &[u32; 3]) -> usize {
    t[0].min(t[1]).min(t[2]) as usize
}

impl ByLowest {
    fn new(surface: &TriMesh) -> Self {
        let n = surface.points.len();
        let mut end = vec![0u32; n + 1];
        for t in &surface.triangles {
            end[lowest(t) + 1] += 1;
        }
        for v in 0..n {
            end[v + 1] += end[v];
        }
        let mut list = vec![0u32; surface.triangles.len()];
        for (i, t) in (0..).zip(&surface.triangles) {
            let slot = &mut end[lowest(t)];
            list[*slot as usize] = i;
            *slot += 1;
        }
        Self { end, list }
    }

    /// Triangles with the same lowest vertex as a face of surface points.
    #[inline]
    fn at(&self, face: [u32; 3]) -> &[u32] {
        let v = lowest(&face);
        let start = if v == 0 { 0 } else { self.end[v - 1] };
        &self.list[start as usize..self.end[v] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::TetMesh;
    use anastomesh_mesh::geometry::Point3;

    /// Two tetrahedra on one face, and a surface that lacks only the faces at its last point in the complex.
    #[test]
    fn what_is_missing_is_listed_and_the_rest_is_frozen() {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let points = vec![p(0., 0., 0.), p(2., 0., 0.), p(0., 2., 0.), p(0.5, 0.5, 1.), p(0.5, 0.5, -1.)];
        let mesh = TetMesh { points: points.clone(), tets: vec![[0, 1, 2, 3], [0, 2, 1, 4]] };
        let mut c = Complex::from_mesh(mesh.points, &mesh.tets).unwrap();
        let surface = TriMesh { points, triangles: vec![[0, 2, 1], [0, 1, 3], [3, 1, 4], [1, 2, 3], [3, 4, 0]] };
        let edges = crate::input::validate(&surface, &[[4, 3]], crate::InputKind::Plc).unwrap();
        let (lost_edges, lost) = survey(&mut c, &surface, &edges);
        assert_eq!((lost_edges, lost), (vec![[3, 4]], vec![2, 4]));
        let frozen = (0..8).filter(|&half| c.is_frozen(half)).count();
        // The common face is frozen on both sides.
        assert_eq!(frozen, 4);
    }
}
