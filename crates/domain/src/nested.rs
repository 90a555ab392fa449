//! Regions of the tissue with surfaces of their own, one inside another.

use super::error::DomainError;
use super::inside::{Closed, meeting};
use super::plan::{TISSUE, TissuePlan};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Point3};

/// Name of the region inside a surface: that of the tissue for the first.
pub fn name_of(plan: &TissuePlan, surface: usize) -> &str {
    let region = surface.checked_sub(1).and_then(|i| plan.regions.get(i));
    region.map_or(TISSUE, |region| region.name.as_str())
}

/// Checks that regions lie inside the first surface, and that no two surfaces touch.
pub fn check_nested(surfaces: &[TriMesh], plan: &TissuePlan) -> Result<(), DomainError> {
    let boxes: Vec<Aabb> = surfaces.iter().map(|surface| Aabb::of_points(&surface.points)).collect();
    for (j, second) in surfaces.iter().enumerate() {
        for (i, first) in surfaces[..j].iter().enumerate().filter(|(i, _)| boxes[*i].overlaps(&boxes[j])) {
            let met = meeting(second, first);
            if let Some(&t) = met.first() {
                let at = second.points[second.triangles[t as usize][0] as usize].coords.into();
                let regions = [i, j].map(|surface| name_of(plan, surface).to_owned());
                return Err(DomainError::SurfacesMeet { regions, count: met.len(), at });
            }
        }
    }
    let Some((organ, nested)) = surfaces.split_first().filter(|(_, nested)| !nested.is_empty()) else { return Ok(()) };
    let closed = Closed::new(organ);
    for (i, surface) in nested.iter().enumerate() {
        let outside: Vec<&Point3> = surface.points.iter().filter(|p| !closed.contains(p)).collect();
        if let Some(first) = outside.first() {
            let region = name_of(plan, i + 1).to_owned();
            return Err(DomainError::RegionOutside { region, count: outside.len(), at: first.coords.into() });
        }
    }
    Ok(())
}

/// Surface that directly contains each of several surfaces. They do not touch, and the first contains all.
pub fn parents(surfaces: &[TriMesh]) -> Vec<usize> {
    let closed: Vec<Closed> = surfaces.iter().map(Closed::new).collect();
    let around = |j: usize| -> Vec<usize> {
        let Some(p) = surfaces[j].points.first() else { return Vec::new() };
        (1..surfaces.len()).filter(|&i| i != j && closed[i].contains(p)).collect()
    };
    let around: Vec<Vec<usize>> = (0..surfaces.len()).map(around).collect();
    // The innermost one has most surfaces around it.
    let parent = |own: &Vec<usize>| own.iter().copied().max_by_key(|&i| around[i].len()).unwrap_or(0);
    around.iter().map(parent).collect()
}

#[cfg(test)]
mod tests {
    use super::super::plan::{TissueRegion, TissueShape};
    use super::*;
    use anastomesh_mesh::geometry::Vec3;
    use anastomesh_mesh::shapes::sphere_surface;

    fn ball(x: f64, radius: f64) -> TriMesh {
        let ball = sphere_surface(2);
        let points = ball.points.iter().map(|p| p * radius + Vec3::x() * x).collect();
        TriMesh { points, ..ball }
    }

    fn plan(nested: &[TriMesh]) -> TissuePlan {
        let named = ["a", "b", "c"].iter().zip(nested).map(|(name, surface)| TissueRegion::new(*name, surface.clone()));
        TissuePlan::new(TissueShape::Box { margin: None }).regions(named.collect())
    }

    #[test]
    fn the_innermost_surface_contains_a_region() {
        let all = [ball(0.0, 9.0), ball(1.0, 1.0), ball(1.0, 3.0), ball(-5.0, 1.0)];
        assert!(check_nested(&all, &plan(&all[1..])).is_ok());
        assert_eq!(parents(&all), [0, 2, 0, 0]);
    }

    #[test]
    fn regions_that_meet_or_leave_are_named() {
        let fault = |all: &[TriMesh]| check_nested(all, &plan(&all[1..])).expect_err("refused").to_string();
        let meet = fault(&[ball(0.0, 9.0), ball(1.0, 1.0), ball(2.0, 1.0)]);
        assert!(meet.starts_with("the surfaces of a and b meet at"), "{meet}");
        let organ = fault(&[ball(0.0, 3.0), ball(2.5, 1.0)]);
        assert!(organ.starts_with("the surfaces of tissue and a meet at"), "{organ}");
        let outside = fault(&[ball(0.0, 3.0), ball(6.0, 1.0)]);
        assert!(outside.starts_with("in a, 162 points lie outside"), "{outside}");
    }
}
