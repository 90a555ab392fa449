//! Surfaces around the tissue: the organ's surface, and those of regions in it.

use super::error::DomainError;
use super::gate::{Gate, Opening, open};
use super::hull::{RATIO, Sphere, hull};
use super::inside::{Closed, meeting, tidy};
use super::nested::{check_nested, parents};
use super::plan::{TissuePlan, TissueShape};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Point3, Vec3};
use anastomesh_tet::parts::{Watch, remesh_closed};
use rustc_hash::FxHashMap;

/// Margin of a box or hull, relative to the diagonal of the vessels.
const MARGIN: f64 = 0.05;
/// Maximum number of edges along the diagonal of a box or hull.
const SQUARES: f64 = 40.0;

/// Vessels, or their network before it is meshed.
pub struct Vessels<'a> {
    /// Surface of the lumen. It may lack triangles.
    pub surface: &'a TriMesh,
    /// Thickness of the shells at each point.
    pub thickness: &'a [f64],
    /// Largest outer radius.
    pub outer: f64,
}

/// Surfaces around the tissue.
pub struct Surroundings {
    /// Surface of the organ with its openings, then those of the regions in it, outwards.
    pub surfaces: Vec<TriMesh>,
    /// Openings of the organ's surface where vessels leave.
    pub openings: Vec<Opening>,
    /// Surface that directly contains each; 0 for the first.
    pub parents: Vec<usize>,
}

impl Surroundings {
    /// Surfaces around vessels, which they touch only at gates.
    pub fn of(plan: &TissuePlan, vessels: &Vessels, gates: Vec<Gate>, watch: &Watch) -> Result<Self, DomainError> {
        let mut surfaces = vec![organ(plan, vessels, watch)?];
        surfaces.extend(plan.regions.iter().map(|region| tidy(&region.surface)));
        if plan.remesh {
            // A box or hull has its size already.
            let given = usize::from(!matches!(plan.shape, TissueShape::Organ(_)));
            remesh(&mut surfaces[given..], (plan.size, plan.tolerance), watch)?;
        }
        check_nested(&surfaces, plan)?;
        let (opened, openings) = open(&surfaces[0], gates)?;
        holds(&surfaces[0], vessels.surface, (&opened, &openings))?;
        surfaces[0] = opened;
        for (surface, region) in surfaces[1..].iter().zip(&plan.regions) {
            let met = meeting(vessels.surface, surface);
            if let Some(&t) = met.first() {
                let at = first_corner(vessels.surface, vessels.surface.triangles[t as usize]);
                return Err(DomainError::VesselsMeet { region: region.name.clone(), count: met.len(), at });
            }
        }
        let parents = parents(&surfaces);
        Ok(Self { surfaces, openings, parents })
    }

    /// All surfaces as one.
    pub fn joined(&self) -> TriMesh {
        joined(&self.surfaces).0
    }

    /// Innermost surface around each of some points.
    pub fn homes(&self, points: &[Point3]) -> Vec<usize> {
        let mut homes = vec![0; points.len()];
        let depth = |mut i: usize| {
            let mut depth = 0;
            while i != 0 {
                (i, depth) = (self.parents[i], depth + 1);
            }
            depth
        };
        for (i, surface) in self.surfaces.iter().enumerate().skip(1) {
            let closed = Closed::new(surface);
            for (home, p) in homes.iter_mut().zip(points) {
                if closed.contains(p) && depth(i) > depth(*home) {
                    *home = i;
                }
            }
        }
        homes
    }
}

/// Surface of the organ.
pub fn organ(plan: &TissuePlan, vessels: &Vessels, watch: &Watch) -> Result<TriMesh, DomainError> {
    let Vessels { surface, thickness, outer } = *vessels;
    match &plan.shape {
        TissueShape::Organ(surface) => Ok(tidy(surface)),
        TissueShape::Box { margin } => {
            let margin = margin.unwrap_or_else(|| usual_margin(surface, outer));
            let thickest = thickness.iter().copied().fold(0.0, f64::max);
            if margin <= thickest {
                return Err(DomainError::NoSpace { margin, thickness: thickest });
            }
            Ok(box_around(surface, margin, plan.size))
        }
        TissueShape::Hull { margin } => {
            let spheres: Vec<Sphere> = surface.points.iter().copied().zip(thickness.iter().copied()).collect();
            let margin = margin.unwrap_or_else(|| usual_margin(surface, outer));
            let extent = Aabb::of_points(&surface.points).diagonal();
            if margin * RATIO < extent {
                return Err(DomainError::Margin { margin, least: extent / RATIO });
            }
            let longest = (extent + 2.0 * margin) / SQUARES;
            let side = plan.size.unwrap_or(margin).max(longest);
            hull(&spheres, margin, side, watch).map_err(DomainError::Hull)
        }
    }
}

/// Default margin. Shells take a part of the space.
pub fn usual_margin(vessels: &TriMesh, outer: f64) -> f64 {
    (MARGIN * Aabb::of_points(&vessels.points).diagonal()).max(outer)
}

pub fn box_around(vessels: &TriMesh, margin: f64, size: Option<f64>) -> TriMesh {
    let inner = Aabb::of_points(&vessels.points);
    let [low, high] = [inner.min - Vec3::repeat(margin), inner.max + Vec3::repeat(margin)];
    let longest = (high - low).norm() / SQUARES;
    let side = size.unwrap_or_else(|| margin.max(longest)).max(longest);
    grid_box(low, high, side)
}

/// Surfaces as one, and the number of the surface of each triangle.
fn joined(surfaces: &[TriMesh]) -> (TriMesh, Vec<i32>) {
    let (mut all, mut numbers) = (TriMesh::default(), Vec::new());
    for (i, surface) in (0..).zip(surfaces) {
        let first = all.points.len() as u32;
        all.points.extend_from_slice(&surface.points);
        all.triangles.extend(surface.triangles.iter().map(|t| t.map(|v| v + first)));
        numbers.resize(all.triangles.len(), i);
    }
    (all, numbers)
}

/// Remeshes surfaces together, so that they stay apart, with an edge length and a tolerance.
fn remesh(surfaces: &mut [TriMesh], by: (Option<f64>, Option<f64>), watch: &Watch) -> Result<(), DomainError> {
    let (all, numbers) = joined(surfaces);
    let (made, numbers) = remesh_closed(&all, &numbers, by, watch).map_err(DomainError::Remesh)?;
    for (i, surface) in (0..).zip(surfaces) {
        let own = made.triangles.iter().zip(&numbers).filter(|(_, number)| **number == i);
        let triangles = own.map(|(t, _)| *t).collect();
        *surface = tidy(&TriMesh { points: made.points.clone(), triangles });
    }
    Ok(())
}

/// Box whose sides are divided into squares of about this side, each of two triangles.
fn grid_box(low: Point3, high: Point3, side: f64) -> TriMesh {
    let extent = high - low;
    let counts: [u32; 3] = std::array::from_fn(|axis| (extent[axis] / side).ceil().max(1.0) as u32);
    let mut mesh = TriMesh::default();
    let mut known = FxHashMap::default();
    let mut number = |mesh: &mut TriMesh, at: [u32; 3]| {
        *known.entry(at).or_insert_with(|| {
            let place = |axis: usize| match at[axis] {
                0 => low[axis],
                i if i == counts[axis] => high[axis],
                i => low[axis] + extent[axis] * f64::from(i) / f64::from(counts[axis]),
            };
            mesh.points.push(Point3::new(place(0), place(1), place(2)));
            mesh.points.len() as u32 - 1
        })
    };
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for (end, is_high) in [(0, false), (counts[axis], true)] {
            for i in 0..counts[u] {
                for j in 0..counts[v] {
                    let mut corner = |di: u32, dj: u32| {
                        let mut at = [0; 3];
                        (at[axis], at[u], at[v]) = (end, i + di, j + dj);
                        number(&mut mesh, at)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    // Diagonals alternate, so that no corner of the box is cut off by one.
                    let two = if (i + j).is_multiple_of(2) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                    mesh.triangles.extend(two.map(|[a, b, c]| if is_high { [a, b, c] } else { [a, c, b] }));
                }
            }
        }
    }
    mesh
}

fn first_corner(surface: &TriMesh, t: [u32; 3]) -> [f64; 3] {
    surface.points[t[0] as usize].coords.into()
}

/// Checks that vessels lie inside a closed surface, except at its openings, and do not touch it. `opened` is the surface
/// with the openings.
fn holds(organ: &TriMesh, vessels: &TriMesh, (opened, openings): (&TriMesh, &[Opening])) -> Result<(), DomainError> {
    let meeting = meeting(vessels, opened);
    if let Some(&t) = meeting.first() {
        let at = first_corner(vessels, vessels.triangles[t as usize]);
        return Err(DomainError::VesselsOutside { count: meeting.len(), outside: false, at });
    }
    let organ = Closed::new(organ);
    if openings.is_empty() && organ.holds(vessels) {
        return Ok(());
    }
    let mut outside = organ.outside(vessels);
    outside.retain(|t| openings.iter().all(|opening| !opening.gate.is_near(&vessels.points[t[0] as usize])));
    match outside.first() {
        Some(&t) => {
            Err(DomainError::VesselsOutside { count: outside.len(), outside: true, at: first_corner(vessels, t) })
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::sphere_surface;
    use anastomesh_tet::Tetrahedralizer;

    #[test]
    fn boxes_are_closed_and_hold_the_vessels() {
        let ball = sphere_surface(2);
        for (margin, size) in [(usual_margin(&ball, 0.1), None), (0.5, Some(0.7)), (2.0, Some(50.0))] {
            let around = box_around(&ball, margin, size);
            Tetrahedralizer::new().check(&around).expect("closed");
            assert!(holds(&around, &ball, (&around, &[])).is_ok());
            let fault = holds(&ball, &around, (&ball, &[]));
            assert!(matches!(fault, Err(DomainError::VesselsOutside { outside: true, .. })), "{fault:?}");
        }
    }

    #[test]
    fn vessels_that_leave_the_organ_are_named() {
        let ball = sphere_surface(2);
        let moved = TriMesh { points: ball.points.iter().map(|p| p + Vec3::x()).collect(), ..ball.clone() };
        match holds(&ball, &moved, (&ball, &[])) {
            Err(DomainError::VesselsOutside { count, outside: false, at }) => {
                assert!(count > 4 && (Vec3::from(at).norm() - 1.0).abs() < 0.5, "{count} {at:?}");
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn remeshed_surfaces_stay_apart_and_follow_the_size() {
        let ball = sphere_surface(3);
        let inner = TriMesh { points: ball.points.iter().map(|p| p * 0.97).collect(), ..ball.clone() };
        let count = |size: f64, tolerance: f64| {
            let mut both = [ball.clone(), inner.clone()];
            remesh(&mut both, (Some(size), Some(tolerance)), &Watch::NOBODY).expect("remeshed");
            assert!(meeting(&both[0], &both[1]).is_empty());
            assert!(Closed::new(&both[0]).outside(&both[1]).is_empty());
            both.map(|surface| surface.triangles.len())
        };
        let given = ball.triangles.len();
        assert!(count(0.6, 0.02).iter().all(|&own| own < given));
        assert!(count(0.08, 0.02).iter().all(|&own| own > given));
    }

    #[test]
    fn boxes_have_space_for_shells() {
        let ball = sphere_surface(2);
        let plan = TissuePlan::new(TissueShape::Box { margin: Some(0.2) });
        let thick = vec![0.3; ball.points.len()];
        let vessels = Vessels { surface: &ball, thickness: &thick, outer: 1.3 };
        let fault = organ(&plan, &vessels, &Watch::NOBODY);
        assert!(matches!(fault, Err(DomainError::NoSpace { .. })), "{fault:?}");
    }
}
