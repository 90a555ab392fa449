//! Checks of a plan before a network is meshed.

use super::error::DomainError;
use super::inside::{Closed, passes, tidy};
use super::nested::{check_nested, name_of};
use super::organ::{Vessels, organ};
use super::plan::{DomainPlan, Site, TissuePlan, TissueShape};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Point3, Tube, Vec3, point_triangle, segment_segment};
use anastomesh_mesh::quality::volume6;
use anastomesh_skeleton::{EdgeId, Node, Skeleton};
use anastomesh_tet::Tetrahedralizer;
use anastomesh_tet::parts::{Watch, ensure_countable};
use rayon::prelude::*;

/// Fraction of the radius within which a surface certainly meets the lumen, whose radius is exact to a few percent.
const CERTAIN: f64 = 0.95;
/// Distance from the end of a vessel, in its radii, within which it may meet the surface where it leaves.
const AT_GATE: f64 = 3.0;

impl DomainPlan {
    /// Checks names and ranges, and the surfaces around the tissue and in it. These must be closed, must not meet each other or
    /// vessels, and the outer one must contain all. A size with too many tetrahedra is refused. `name` is the name of a node in
    /// the file.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self, network: &Skeleton, name: &dyn Fn(u32) -> String) -> Result<(), DomainError> {
        self.validate()?;
        let Some(tissue) = &self.tissue else { return Ok(()) };
        if let TissueShape::Organ(surface) = &tissue.shape {
            Tetrahedralizer::new().check(surface).map_err(DomainError::Organ)?;
            contains_nodes(surface, network, &tissue.gates, false, name)?;
            crosses_none(surface, 0, (tissue, network), name)?;
        }
        for region in &tissue.regions {
            let fault = |source| DomainError::Region { region: region.name.clone(), source };
            Tetrahedralizer::new().check(&region.surface).map_err(fault)?;
        }
        let is_nested = matches!(tissue.shape, TissueShape::Box { .. }) || !tissue.regions.is_empty();
        let organ =
            if is_nested || tissue.size.is_some() { self.expected_organ(tissue, network)? } else { TriMesh::default() };
        let of_organ = volume(&organ);
        if is_nested {
            let mut surfaces = vec![organ];
            surfaces.extend(tissue.regions.iter().map(|region| tidy(&region.surface)));
            check_nested(&surfaces, tissue)?;
        }
        for (i, region) in (1..).zip(&tissue.regions) {
            crosses_none(&region.surface, i, (tissue, network), name)?;
        }
        if let Some(size) = tissue.size {
            let free = of_organ - self.volume_of_vessels(network);
            ensure_countable(free.max(0.0), size, tissue.max_tets).map_err(DomainError::Tissue)?;
        }
        Ok(())
    }

    /// Volume of the vessels with their shells. Parts in which vessels overlap count several times.
    fn volume_of_vessels(&self, network: &Skeleton) -> f64 {
        let frustum = |edge: EdgeId| {
            let ends = network.edge(edge).nodes.map(|node| network.node(node).original);
            let tube = network.tube(edge);
            let [a, b] =
                [(tube.ra, 0.0), (tube.rb, 1.0)].map(|(radius, t)| radius + self.thickness(&Site { radius, ends, t }));
            std::f64::consts::PI / 3.0 * tube.length() * (a * a + a * b + b * b)
        };
        network.edge_ids().map(frustum).sum()
    }

    /// Surface of the organ, with a sphere at each node for the vessels.
    fn expected_organ(&self, tissue: &TissuePlan, network: &Skeleton) -> Result<TriMesh, DomainError> {
        let (mut points, mut thickness, mut outer) = (Vec::new(), Vec::new(), 0.0_f64);
        for edge in &network.edges {
            let ends = edge.nodes.map(|node| network.node(node).original);
            for (i, t) in [0.0, 1.0].into_iter().enumerate() {
                let (p, radius) = (network.node(edge.nodes[i]).position, edge.radii[i]);
                let own = self.thickness(&Site { radius, ends, t });
                outer = outer.max(radius + own);
                if let TissueShape::Hull { .. } = tissue.shape {
                    points.push(p);
                    thickness.push(radius + own);
                } else {
                    points.extend([p - Vec3::repeat(radius), p + Vec3::repeat(radius)]);
                    thickness.extend([own; 2]);
                }
            }
        }
        let surface = TriMesh { points, triangles: Vec::new() };
        organ(tissue, &Vessels { surface: &surface, thickness: &thickness, outer }, &Watch::NOBODY)
    }
}

/// Checks that an organ's surface contains the nodes of a network, except at gates. `touching`: nodes exactly on the surface
/// are inside.
pub fn contains_nodes(
    organ: &TriMesh,
    network: &Skeleton,
    gates: &[u32],
    touching: bool,
    name: &dyn Fn(u32) -> String,
) -> Result<(), DomainError> {
    let closed = Closed::new(organ);
    let is_inside = |p: &Point3| closed.contains(p) || touching && closed.touches(p);
    let is_fault = |node: &&Node| !gates.contains(&node.original) && !is_inside(&node.position);
    let outside: Vec<_> = network.nodes.par_iter().filter(is_fault).collect();
    match outside.first() {
        Some(node) => {
            let (node, at) = (name(node.original), node.position.coords.into());
            Err(DomainError::NodesOutside { count: outside.len(), node, at })
        }
        None => Ok(()),
    }
}

/// Checks that no vessel crosses a surface.
fn crosses_none(
    surface: &TriMesh,
    number: usize,
    (plan, network): (&TissuePlan, &Skeleton),
    name: &dyn Fn(u32) -> String,
) -> Result<(), DomainError> {
    let closed = Closed::new(surface);
    let edges: Vec<EdgeId> = network.edge_ids().collect();
    let gates = if number == 0 { ends(plan, network) } else { Vec::new() };
    let crossing = |&edge: &EdgeId| Some((edge, contact(&closed, &network.tube(edge), &gates)?));
    let found: Vec<(EdgeId, Point3)> = edges.par_iter().filter_map(crossing).collect();
    let Some(&(edge, at)) = found.first() else { return Ok(()) };
    Err(DomainError::VesselsCross {
        region: name_of(plan, number).to_owned(),
        is_organ: number == 0,
        count: found.len(),
        nodes: network.edge(edge).nodes.map(|node| name(network.node(node).original)),
        at: at.coords.into(),
    })
}

/// Places and radii of the vessels' ends where they leave the organ.
pub fn ends(plan: &TissuePlan, network: &Skeleton) -> Vec<(Point3, f64)> {
    let adjacency = network.adjacency();
    let terminals = adjacency.terminals().into_iter().map(|node| network.node(node));
    let leaving = terminals.filter(|node| plan.gates.contains(&node.original));
    leaving.map(|node| (node.position, node.radius)).collect()
}

/// Place where a surface meets a tube, away from gates.
fn contact(closed: &Closed, tube: &Tube, gates: &[(Point3, f64)]) -> Option<Point3> {
    let place = Aabb::of_points([&tube.a, &tube.b]).grown(tube.max_radius());
    let mut near = closed.near(&place);
    near.sort_unstable();
    let is_apart = |p: &Point3| gates.iter().all(|(end, radius)| (p - end).norm() > AT_GATE * radius);
    near.into_iter().filter_map(|t| meets(tube, closed.corners(t))).find(is_apart)
}

/// Place where a triangle meets the inner part of a tube.
fn meets(tube: &Tube, corners: [&Point3; 3]) -> Option<Point3> {
    let [a, b, c] = corners;
    for (p, radius) in [(&tube.a, tube.ra), (&tube.b, tube.rb)] {
        let (nearest, distance) = point_triangle(p, corners);
        if distance < CERTAIN * radius {
            return Some(nearest);
        }
    }
    for side in [[a, b], [b, c], [c, a]] {
        let pair = segment_segment([&tube.a, &tube.b], side);
        if pair.distance < CERTAIN * tube.radius(pair.s) {
            return Some(side[0] + (side[1] - side[0]) * pair.t);
        }
    }
    passes([&tube.a, &tube.b], corners, true).then(|| middle(corners))
}

fn volume(surface: &TriMesh) -> f64 {
    let apex = surface.points.first().copied().unwrap_or_default();
    let signed = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| &surface.points[v as usize]);
        volume6(&apex, a, b, c)
    };
    (surface.triangles.iter().map(signed).sum::<f64>() / 6.0).abs()
}

fn middle([a, b, c]: [&Point3; 3]) -> Point3 {
    Point3::from((a.coords + b.coords + c.coords) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::super::plan::{ShellPlan, Thickness, TissueRegion};
    use super::*;
    use anastomesh_mesh::shapes::sphere_surface;
    use anastomesh_skeleton::fixtures::network;
    use anastomesh_tet::TetError;

    fn ball(z: f64, radius: f64) -> TriMesh {
        let ball = sphere_surface(2);
        let points = ball.points.iter().map(|p| p * radius + Vec3::z() * z).collect();
        TriMesh { points, ..ball }
    }

    fn line() -> Skeleton {
        network(&[[0.0, 0.0, 0.0], [0.0, 0.0, 10.0]], 1.0, &[(0, 1)])
    }

    fn checked(tissue: TissuePlan) -> Result<(), DomainError> {
        DomainPlan::default().tissue(tissue).check(&line(), &|node| format!("n{node}"))
    }

    fn organ_with(surface: TriMesh, region: Option<TriMesh>) -> TissuePlan {
        let regions = region.into_iter().map(|surface| TissueRegion::new("tumour", surface)).collect();
        TissuePlan::new(TissueShape::Organ(surface)).regions(regions)
    }

    #[test]
    fn vessels_may_lie_inside_or_outside_a_region() {
        for region in [ball(5.0, 9.0), ball(-3.0, 1.0)] {
            checked(organ_with(ball(5.0, 20.0), Some(region))).expect("valid");
        }
    }

    #[test]
    fn vessels_that_cross_a_surface_are_named() {
        // Across the axis, around a part of it, touching the tube only, and inside the tube.
        for region in [ball(0.0, 4.0), ball(5.0, 2.0), ball(-2.5, 1.8), ball(5.0, 0.4)] {
            match checked(organ_with(ball(5.0, 20.0), Some(region))) {
                Err(DomainError::VesselsCross { nodes, region, is_organ: false, count: 1, .. }) => {
                    assert_eq!((nodes, region.as_str()), (["n0".into(), "n1".into()], "tumour"));
                }
                other => panic!("{other:?}"),
            }
        }
        let organ = checked(organ_with(ball(5.0, 5.6), None));
        assert!(matches!(organ, Err(DomainError::VesselsCross { is_organ: true, .. })), "{organ:?}");
    }

    #[test]
    fn bad_surfaces_are_refused_before_the_work() {
        let mut open = ball(-5.0, 1.0);
        open.triangles.pop();
        let fault = checked(organ_with(ball(5.0, 20.0), Some(open)));
        assert!(matches!(fault, Err(DomainError::Region { .. })), "{fault:?}");
        let boxed = |z| {
            TissuePlan::new(TissueShape::Box { margin: Some(4.0) }).regions(vec![TissueRegion::new("a", ball(z, 0.5))])
        };
        checked(boxed(-3.0)).expect("inside");
        assert!(matches!(checked(boxed(-9.0)), Err(DomainError::RegionOutside { .. })));
        assert!(matches!(checked(boxed(-5.0)), Err(DomainError::SurfacesMeet { .. })));
        let hull = |z| TissuePlan { shape: TissueShape::Hull { margin: Some(4.0) }, ..boxed(z) };
        checked(hull(-3.0)).expect("inside");
        assert!(matches!(checked(hull(-9.0)), Err(DomainError::RegionOutside { .. })));
    }

    #[test]
    fn sizes_with_too_many_tetrahedra_are_refused() {
        for shape in
            [TissueShape::Box { margin: None }, TissueShape::Hull { margin: None }, TissueShape::Organ(ball(5.0, 20.0))]
        {
            let tissue = |size: f64| TissuePlan::new(shape.clone()).size(size).max_tets(1_000_000);
            checked(tissue(1.0)).expect("few");
            for size in [0.05, 1e-5, 1e-300] {
                let fault = checked(tissue(size));
                let is_refused = matches!(fault, Err(DomainError::Tissue(TetError::TooMany { limit: 1_000_000, .. })));
                assert!(is_refused, "{size} {fault:?}");
            }
        }
    }

    #[test]
    fn boxes_within_the_shells_are_refused() {
        let wall = ShellPlan::new("wall", Thickness::Law { length: 0.0, radii: 0.5 });
        let plan =
            DomainPlan::default().shells(vec![wall]).tissue(TissuePlan::new(TissueShape::Box { margin: Some(0.4) }));
        let fault = plan.check(&line(), &|node| node.to_string());
        assert!(matches!(fault, Err(DomainError::NoSpace { .. })), "{fault:?}");
    }
}
