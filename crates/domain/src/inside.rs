//! Closed surfaces: points inside, and contacts between two surfaces.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::adjacency::vertices_of;
use anastomesh_mesh::geometry::predicates::{collinear, orient2d, orient3d};
use anastomesh_mesh::geometry::{Aabb, Bvh, Contact, DisjointSets, Point3, Triangle, classify_triangles, crossing};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

/// Closed surface with a search tree of its triangles.
pub struct Closed<'a> {
    surface: &'a TriMesh,
    tree: Bvh,
}

impl<'a> Closed<'a> {
    pub fn new(surface: &'a TriMesh) -> Self {
        let corners = |t: &[u32; 3]| t.map(|v| &surface.points[v as usize]);
        Self { surface, tree: Bvh::of(surface.triangles.iter().map(|t| Aabb::of_points(corners(t))).collect()) }
    }

    pub fn corners(&self, t: u32) -> [&Point3; 3] {
        self.surface.triangles[t as usize].map(|v| &self.surface.points[v as usize])
    }

    /// Triangles near a box.
    pub fn near(&self, place: &Aabb) -> Vec<u32> {
        let mut found = Vec::new();
        self.tree.query(place, |t| found.push(t));
        found
    }

    /// True if a ray from a point crosses the surface an odd number of times.
    pub fn contains(&self, p: &Point3) -> bool {
        let mut winding = 0;
        let ray = Aabb { min: *p, max: Point3::new(f64::INFINITY, p.y, p.z) };
        self.tree.query(&ray, |t| winding += crossing(p, self.corners(t)).unwrap_or_default());
        winding % 2 != 0
    }

    /// True if a point lies exactly on the surface.
    pub fn touches(&self, p: &Point3) -> bool {
        self.near(&Aabb { min: *p, max: *p }).into_iter().any(|t| is_on(p, self.corners(t)))
    }

    /// True if another surface, which does not touch this one, lies inside.
    pub fn holds(&self, other: &TriMesh) -> bool {
        let mut parts = DisjointSets::new(other.points.len());
        for &[a, b, c] in &other.triangles {
            parts.join(a, b);
            parts.join(b, c);
        }
        let roots: FxHashSet<u32> = other.triangles.iter().map(|t| parts.find(t[0])).collect();
        roots.into_iter().all(|v| self.contains(&other.points[v as usize]))
    }

    /// Triangles that begin outside.
    pub fn outside(&self, other: &TriMesh) -> Vec<[u32; 3]> {
        let is_outside = |t: &[u32; 3]| !self.contains(&other.points[t[0] as usize]);
        other.triangles.par_iter().copied().filter(is_outside).collect()
    }
}

/// True if a point lies exactly on a triangle.
fn is_on(p: &Point3, [a, b, c]: [&Point3; 3]) -> bool {
    let flat = |p: &Point3, axis: usize| [p[(axis + 1) % 3], p[(axis + 2) % 3]];
    let within = |axis: usize| {
        let turn = |a, b, c| orient2d(flat(a, axis), flat(b, axis), flat(c, axis));
        let turns = [turn(a, b, p), turn(b, c, p), turn(c, a, p)];
        turns.iter().all(|&t| t >= 0.0) || turns.iter().all(|&t| t <= 0.0)
    };
    orient3d(a, b, c, p) == 0.0 && (0..3).all(within)
}

/// True if a segment passes from one side of a triangle to the other. `touching`: also through an edge or corner.
pub fn passes([p, q]: [&Point3; 2], [a, b, c]: [&Point3; 3], touching: bool) -> bool {
    let (from, to) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    let turns = || [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    let is_inner = |turn: f64| turn > 0.0 || touching && turn == 0.0;
    let one_turn = |turns: [f64; 3]| turns.iter().all(|&t| is_inner(t)) || turns.iter().all(|&t| is_inner(-t));
    (from < 0.0 && to > 0.0 || from > 0.0 && to < 0.0) && one_turn(turns())
}

/// Triangles of the first surface that touch the second one, ascending. Those without area touch nothing.
pub fn meeting(first: &TriMesh, second: &TriMesh) -> Vec<u32> {
    let (other, from) = (Closed::new(second), first.points.len() as u32);
    let touches = |t: u32| {
        let ids = first.triangles[t as usize];
        let own = Triangle { ids, corners: ids.map(|v| &first.points[v as usize]) };
        let is_met = |near: u32| {
            let ids = second.triangles[near as usize].map(|v| v + from);
            let other = Triangle { ids, corners: other.corners(near) };
            has_area(&other) && matches!(classify_triangles(own, other), Contact::Improper(_))
        };
        let near = other.near(&Aabb::of_points(own.corners));
        !near.is_empty() && has_area(&own) && near.into_iter().any(is_met)
    };
    (0..first.triangles.len() as u32).into_par_iter().filter(|&t| touches(t)).collect()
}

fn has_area(triangle: &Triangle) -> bool {
    let [a, b, c] = triangle.corners;
    !collinear(a, b, c)
}

/// The surface without unused points, oriented outwards as a whole.
pub fn tidy(surface: &TriMesh) -> TriMesh {
    outward(compact(surface).0)
}

/// The surface without unused points, and the new number of each point that is used.
pub fn compact(surface: &TriMesh) -> (TriMesh, Vec<u32>) {
    let used = vertices_of(&surface.triangles, surface.points.len());
    let (mut number, mut points) = (vec![0; used.len()], Vec::new());
    for v in (0..used.len()).filter(|&v| used[v]) {
        number[v] = points.len() as u32;
        points.push(surface.points[v]);
    }
    let triangles = surface.triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
    (TriMesh { points, triangles }, number)
}

fn outward(mut surface: TriMesh) -> TriMesh {
    let Some(&from) = surface.points.first() else { return surface };
    let six_volumes = surface.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| surface.points[v as usize] - from);
        a.cross(&b).dot(&c)
    });
    if six_volumes.sum::<f64>() < 0.0 {
        surface.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    surface
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Vec3;
    use anastomesh_mesh::shapes::sphere_surface;

    #[test]
    fn surfaces_are_turned_outwards_and_lose_unused_points() {
        let ball = sphere_surface(1);
        let mut turned =
            TriMesh { triangles: ball.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..ball.clone() };
        turned.points.push(Point3::new(9.0, 9.0, 9.0));
        assert!(tidy(&turned) == ball && tidy(&ball) == ball);
    }

    #[test]
    fn contacts_and_points_inside_are_found() {
        let ball = sphere_surface(2);
        let moved = |way: Vec3, scale: f64| TriMesh {
            points: ball.points.iter().map(|p| p * scale + way).collect(),
            triangles: ball.triangles.clone(),
        };
        assert!(meeting(&ball, &moved(Vec3::x(), 1.0)).len() > 4);
        let small = moved(Vec3::x() * 0.2, 0.5);
        assert!(meeting(&small, &ball).is_empty());
        let closed = Closed::new(&ball);
        assert!(closed.outside(&small).is_empty() && closed.contains(&small.points[0]));
        assert_eq!(closed.outside(&moved(Vec3::x() * 4.0, 1.0)).len(), ball.triangles.len());
    }
}
