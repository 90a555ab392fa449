//! Criteria for splitting a tetrahedron.

use anastomesh_mesh::Bounds;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::dihedral_range;

/// Maximum edge length relative to the size wanted. Edges of the graded lattice are up to 1.9 times as long.
const LONGER: f64 = 2.2;

/// Cubed edge length of a regular tetrahedron over its volume.
const REGULAR: f64 = 8.485_281_374;

/// Targets for each tetrahedron, as far as the boundary allows.
#[derive(Clone, Copy, Default)]
pub struct Goals<'a> {
    /// Bounds on shape and volume.
    pub bounds: Bounds,
    /// Edge length wanted at a point.
    pub size: Option<&'a dyn Fn(&Point3) -> f64>,
    /// Maximum points added.
    pub max_points: Option<usize>,
    /// Further goals in each region.
    pub regions: &'a [RegionGoals],
}

/// Edge length as a function of the position.
pub type SizeFunction = Box<dyn Fn(&Point3) -> f64>;

/// Goals in a region, in addition to the general ones.
#[derive(Default)]
pub struct RegionGoals {
    /// Maximum volume.
    pub max_volume: Option<f64>,
    /// Edge length wanted at a point.
    pub size: Option<SizeFunction>,
}

impl std::fmt::Debug for RegionGoals {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("RegionGoals").field("max_volume", &self.max_volume).field("size", &self.size.is_some()).finish()
    }
}

impl std::fmt::Debug for Goals<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Goals")
            .field("bounds", &self.bounds)
            .field("size", &self.size.is_some())
            .field("max_points", &self.max_points)
            .field("regions", &self.regions)
            .finish()
    }
}

/// Violation of the goals by a tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// Ratio to the bound: above 1, larger is worse.
    pub excess: f64,
    /// Minimum length of new edges.
    pub spacing: f64,
    /// True for a violation of the radius-edge ratio alone.
    pub is_ratio: bool,
}

impl Goals<'_> {
    /// Worst violation of the goals by a tetrahedron of a region, if any.
    pub fn fault(&self, p: [&Point3; 4], region: Option<u32>) -> Option<Fault> {
        let region = region.and_then(|r| self.regions.get(r as usize));
        let edges = [p[1] - p[0], p[2] - p[0], p[3] - p[0], p[2] - p[1], p[3] - p[1], p[3] - p[2]].map(|e| e.norm());
        let longest = edges.iter().copied().fold(0.0, f64::max);
        let shortest = edges.iter().copied().fold(f64::INFINITY, f64::min);
        let mut worst: Option<Fault> = None;
        let mut note = |excess: f64, spacing: f64, is_ratio: bool| {
            if excess > 1.0 && worst.is_none_or(|w| excess > w.excess) {
                worst = Some(Fault { excess, spacing, is_ratio });
            }
        };
        let here = region.and_then(|r| r.max_volume).unwrap_or(f64::INFINITY);
        let volume = here.min(self.bounds.max_volume.unwrap_or(f64::INFINITY));
        if volume < f64::INFINITY {
            let own = (p[1] - p[0]).cross(&(p[2] - p[0])).dot(&(p[3] - p[0])) / 6.0;
            note(libm::cbrt(own / volume), 0.5 * libm::cbrt(REGULAR * volume), false);
        }
        let here = region.and_then(|r| r.size.as_deref());
        if self.size.is_some() || here.is_some() {
            let sum: Vec3 = p.iter().map(|x| x.coords).sum();
            let middle = Point3::from(sum / 4.0);
            let wanted =
                self.size.map_or(f64::INFINITY, |f| f(&middle)).min(here.map_or(f64::INFINITY, |f| f(&middle)));
            if wanted > 0.0 {
                note(longest / (LONGER * wanted), 0.6 * wanted, false);
            }
        }
        if let Some(bound) = self.bounds.max_radius_edge {
            let radius = circumcenter(p).map_or(f64::INFINITY, |c| (c - p[0]).norm());
            note((radius / shortest / bound).min(1e3), shortest, true);
        }
        if let Some(bound) = self.bounds.min_dihedral {
            let angle = dihedral_range(p).0.to_degrees();
            note((bound / angle).min(1e3), shortest, false);
        }
        worst
    }
}

/// True if a point lies in the smallest sphere through the corners of a triangle.
pub(super) fn encroaches(p: &Point3, corners: [&Point3; 3]) -> bool {
    smallest_sphere(corners).is_some_and(|(center, square)| (p - center).norm_squared() < square)
}

/// Centre and squared radius of the smallest sphere through the corners of a triangle; `None` for a triangle without area.
pub(crate) fn smallest_sphere([a, b, c]: [&Point3; 3]) -> Option<(Point3, f64)> {
    let (u, v) = (b - a, c - a);
    let normal = u.cross(&v);
    let area = normal.norm_squared();
    let offset = (v.cross(&normal) * -u.norm_squared() + u.cross(&normal) * v.norm_squared()) / (-2.0 * area);
    (area > 0.0).then(|| (a + offset, offset.norm_squared()))
}

/// Circumcentre of four points; `None` if it is not finite.
pub(crate) fn circumcenter(p: [&Point3; 4]) -> Option<Point3> {
    let (u, v, w) = (p[1] - p[0], p[2] - p[0], p[3] - p[0]);
    let (vw, wu, uv) = (v.cross(&w), w.cross(&u), u.cross(&v));
    let c = (vw * u.norm_squared() + wu * v.norm_squared() + uv * w.norm_squared()) / (2.0 * uv.dot(&w));
    c.iter().all(|x| x.is_finite()).then(|| p[0] + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_sphere_of_a_triangle_has_its_circumcentre() {
        let p = Point3::new;
        let t = [p(0.0, 0.0, 0.0), p(4.0, 0.0, 0.0), p(0.0, 3.0, 0.0)];
        let t = t.each_ref();
        // The circumcentre is (2, 1.5, 0), with radius 2.5.
        for (inside, q) in
            [(true, p(2.0, 1.5, 2.49)), (false, p(2.0, 1.5, -2.51)), (true, p(4.0, 3.0, 0.0) - Vec3::x() * 0.01)]
        {
            assert_eq!(encroaches(&q, t), inside, "{q}");
        }
        assert!(encroaches(&p(-0.4, 1.5, 0.0), t) && !encroaches(&p(-0.6, 1.5, 0.0), t));
    }
}
