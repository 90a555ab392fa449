//! Local refinement of a surface by bisection of longest edges (Rivara, 1984).

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use rustc_hash::FxHashMap;

/// Maximum number of bisections.
const MAX_BISECTIONS: usize = 100_000;

/// Surface whose edges can be bisected.
struct Bisected<'a> {
    surface: &'a mut TriMesh,
    /// Triangles at each edge.
    at: FxHashMap<[u32; 2], Vec<u32>>,
}

/// Bisects edges until no triangle is too long. New points are midpoints of edges.
pub fn bisect(surface: &mut TriMesh, is_long: &dyn Fn([&Point3; 3]) -> bool) {
    let corners =
        |surface: &TriMesh, t: u32| is_long(surface.triangles[t as usize].map(|v| &surface.points[v as usize]));
    let mut long: Vec<u32> = (0..surface.triangles.len() as u32).filter(|&t| corners(surface, t)).collect();
    if long.is_empty() {
        return;
    }
    let mut at: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
    for (t, triangle) in (0..).zip(&surface.triangles) {
        for edge in edges(*triangle) {
            at.entry(edge).or_default().push(t);
        }
    }
    let mut bisected = Bisected { surface, at };
    for _ in 0..MAX_BISECTIONS {
        let Some(t) = long.pop() else { return };
        if corners(bisected.surface, t) {
            long.push(t);
            let changed = bisected.bisect(bisected.last_edge(t));
            long.extend(changed);
        }
    }
}

/// Edges of a triangle, smaller vertex first.
pub fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
}

impl Bisected<'_> {
    /// Length and ends of the longest edge of a triangle. No two edges of the surface are equal.
    fn longest(&self, t: u32) -> (f64, [u32; 2]) {
        let sized = edges(self.surface.triangles[t as usize]).map(|edge| {
            let [a, b] = edge.map(|v| self.surface.points[v as usize]);
            ((a - b).norm_squared(), edge)
        });
        let longer = |x: (f64, [u32; 2]), y: (f64, [u32; 2])| if (y.0, y.1) > (x.0, x.1) { y } else { x };
        longer(longer(sized[0], sized[1]), sized[2])
    }

    /// Edge at the end of the path of longest edges from a triangle: the longest one of all its triangles.
    fn last_edge(&self, t: u32) -> [u32; 2] {
        let mut own = self.longest(t);
        loop {
            let beside = self.at[&own.1].iter().map(|&u| self.longest(u));
            let longest = beside.fold(own, |x, y| if (y.0, y.1) > (x.0, x.1) { y } else { x });
            if longest.1 == own.1 {
                return own.1;
            }
            own = longest;
        }
    }

    /// Bisects an edge with its triangles, and returns these and the new ones.
    fn bisect(&mut self, edge: [u32; 2]) -> Vec<u32> {
        let [a, b] = edge;
        let middle = self.surface.points.len() as u32;
        let [p, q] = edge.map(|v| self.surface.points[v as usize]);
        self.surface.points.push(Point3::from((p.coords + q.coords) / 2.0));
        let mut changed = self.at.remove(&edge).unwrap_or_default();
        for i in 0..changed.len() {
            let (t, new) = (changed[i], self.surface.triangles.len() as u32);
            let old = self.surface.triangles[t as usize];
            let half = |end: u32| old.map(|v| if v == end { middle } else { v });
            self.surface.triangles[t as usize] = half(b);
            self.surface.triangles.push(half(a));
            let apex = old.into_iter().find(|v| !edge.contains(v)).unwrap_or(a);
            let moved = [b.min(apex), b.max(apex)];
            self.at.entry(moved).or_default().iter_mut().filter(|u| **u == t).for_each(|u| *u = new);
            self.at.entry([apex, middle]).or_default().extend([t, new]);
            self.at.entry([a, middle]).or_default().push(t);
            self.at.entry([b, middle]).or_default().push(new);
            changed.push(new);
        }
        changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::point_triangle;
    use anastomesh_mesh::shapes::sphere_surface;
    use anastomesh_tet::Tetrahedralizer;

    #[test]
    fn triangles_get_short_near_a_point_and_the_surface_stays_closed() {
        let ball = sphere_surface(1);
        let mut fine = ball.clone();
        let at = ball.points[0];
        let is_long = |corners: [&Point3; 3]| {
            let [a, b, c] = corners;
            let longest = (a - b).norm().max((b - c).norm()).max((c - a).norm());
            longest > 0.05 + 0.5 * point_triangle(&at, corners).1
        };
        bisect(&mut fine, &is_long);
        assert!(fine.triangles.iter().all(|t| !is_long(t.map(|v| &fine.points[v as usize]))));
        Tetrahedralizer::new().check(&fine).expect("closed");
        assert!((200..2000).contains(&fine.triangles.len()), "{}", fine.triangles.len());
        let before = fine.clone();
        bisect(&mut fine, &is_long);
        assert_eq!(fine, before);
    }
}
