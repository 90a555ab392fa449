//! Convex hull of spheres at a distance: the organ's hull around a network.
//!
//! The hull of spheres, enlarged by a margin, has a support point in each direction: the extreme sphere's centre, and
//! from there radius and margin along the direction. The hull of many such points is a closed convex surface.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::shapes::sphere_surface;
use anastomesh_tet::parts::{Watch, remesh_closed};
use anastomesh_tet::{TetError, Tetrahedralizer};
use rayon::prelude::*;

/// Levels of the subdivided icosahedron whose 642 vertices are the directions. They are 8° apart.
const LEVEL: usize = 3;
/// Distance between the hull and its remeshed surface, relative to the margin.
const TOLERANCE: f64 = 0.05;

/// Sphere: centre and radius.
pub type Sphere = (Point3, f64);

/// Closed convex surface around spheres, at a margin above 0. Edges have about this length, and less at bends.
///
/// # Errors
/// [`TetError::Cancelled`], or a fault of the spheres.
pub fn hull(spheres: &[Sphere], margin: f64, side: f64, watch: &Watch) -> Result<TriMesh, TetError> {
    let directions: Vec<Vec3> = sphere_surface(LEVEL).points.iter().map(|p| p.coords).collect();
    let extremes: Vec<Sphere> = directions.par_iter().filter_map(|way| extreme(spheres, way)).collect();
    watch.ask()?;
    let reached = |by: f64| directions.iter().zip(&extremes).map(move |(way, (p, r))| p + way * (r + by));
    let inner = convex(reached(0.0).collect())?;
    let planes: Vec<(Vec3, [Point3; 3])> = inner.triangles.iter().filter_map(|t| plane(&inner, t)).collect();
    // Spheres between the directions may rise above.
    let above = |(p, r): &Sphere| planes.iter().map(|(n, [a, ..])| n.dot(&(p - a)) + r).fold(0.0, f64::max);
    let offset = margin + spheres.par_iter().map(above).reduce(|| 0.0, f64::max);
    let flat = planes.iter().flat_map(|(n, corners)| corners.map(|p| p + n * offset));
    let outer = convex(reached(offset).chain(flat).collect())?;
    watch.ask()?;
    let markers = vec![0; outer.triangles.len()];
    let (surface, _) = remesh_closed(&outer, &markers, (Some(side), Some(TOLERANCE * margin)), watch)?;
    Ok(surface)
}

/// Sphere that reaches furthest in a direction.
fn extreme(spheres: &[Sphere], way: &Vec3) -> Option<Sphere> {
    let reach = |(p, r): &Sphere| p.coords.dot(way) + r;
    let further = |best: Option<(f64, Sphere)>, sphere: &Sphere| match best {
        Some((most, _)) if most >= reach(sphere) => best,
        _ => Some((reach(sphere), *sphere)),
    };
    spheres.iter().fold(None, further).map(|(_, sphere)| sphere)
}

/// Convex hull of points, oriented outwards.
fn convex(mut points: Vec<Point3>) -> Result<TriMesh, TetError> {
    // Negative zeros equal positive ones.
    points.iter_mut().for_each(|p| *p += Vec3::zeros());
    points.sort_unstable_by_key(|p| [p.x, p.y, p.z].map(f64::to_bits));
    points.dedup();
    let made = Tetrahedralizer::new().delaunay(&points)?;
    Ok(super::inside::tidy(&TriMesh { points, triangles: made.faces }))
}

/// Unit normal and corners of a triangle; `None` without area.
fn plane(surface: &TriMesh, t: &[u32; 3]) -> Option<(Vec3, [Point3; 3])> {
    let corners = t.map(|v| surface.points[v as usize]);
    let [a, b, c] = corners;
    let normal = (b - a).cross(&(c - a)).try_normalize(f64::MIN_POSITIVE)?;
    Some((normal, corners))
}

#[cfg(test)]
mod tests {
    use super::super::inside::Closed;
    use super::*;

    /// Distance of the nearest sphere from a surface.
    fn clearance(surface: &TriMesh, spheres: &[Sphere]) -> f64 {
        let corners = |t: &[u32; 3]| t.map(|v| surface.points[v as usize]);
        let distance = |(p, r): &Sphere| {
            let to = |t: &[u32; 3]| {
                let [a, b, c] = corners(t);
                anastomesh_mesh::geometry::point_triangle(p, [&a, &b, &c]).1 - r
            };
            surface.triangles.iter().map(to).fold(f64::INFINITY, f64::min)
        };
        spheres.iter().map(distance).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn hulls_are_closed_and_clear_by_the_margin() {
        let line: Vec<Sphere> = (0..9).map(|i| (Point3::new(f64::from(i), 0.0, 0.0), 0.3)).collect();
        let flat: Vec<Sphere> =
            (0..40).map(|i| (Point3::new(f64::from(i % 8), 0.0, f64::from(i / 8 * i % 7)), 0.1)).collect();
        let one = vec![(Point3::new(1e3, -2e3, 5.0), 0.5)];
        for (spheres, margin) in [(line, 0.2), (flat, 1.0), (one, 0.1)] {
            let surface = hull(&spheres, margin, 2.0 * margin, &Watch::NOBODY).expect("made");
            Tetrahedralizer::new().check(&surface).expect("closed");
            let closed = Closed::new(&surface);
            assert!(spheres.iter().all(|(p, _)| closed.contains(p)));
            let clear = clearance(&surface, &spheres);
            assert!((0.9..1.1).contains(&(clear / margin)), "{clear} {margin}");
            let longest = surface.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let longest = longest.map(|e| (surface.points[e[0] as usize] - surface.points[e[1] as usize]).norm());
            assert!(longest.fold(0.0, f64::max) < 4.0 * margin);
        }
    }

    #[test]
    fn no_spheres_have_no_hull() {
        assert!(hull(&[], 1.0, 1.0, &Watch::NOBODY).is_err());
    }
}
