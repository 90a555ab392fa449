//! Surface around the tissue.

use super::error::DomainError;
use super::plan::{TissuePlan, TissueShape};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::predicates::{orient2d, orient3d};
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Vec3, crossing, self_intersections};
use anastomesh_skeleton::{Edge, NodeId, Skeleton};
use anastomesh_tet::Tetrahedralizer;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Margin of a box, relative to the diagonal of the vessels.
const MARGIN: f64 = 0.05;
/// Maximum number of squares along the diagonal of a box.
const SQUARES: f64 = 40.0;

/// Surface around the tissue. `outer` is the largest outer radius of a vessel.
pub fn organ(plan: &TissuePlan, vessels: &TriMesh, outer: f64) -> Result<TriMesh, DomainError> {
    match &plan.shape {
        TissueShape::Box { margin } => Ok(box_around(vessels, *margin, outer, plan.size)),
        TissueShape::Organ(surface) => {
            let surface = outward(surface.clone());
            holds(&surface, vessels)?;
            Ok(surface)
        }
    }
}

/// Checks before meshing that an organ's surface is closed and contains the nodes of a network. `closed`: nodes exactly on
/// the surface are inside.
pub fn check_organ(
    organ: &TriMesh,
    network: &Skeleton,
    closed: bool,
    name: &dyn Fn(u32) -> String,
) -> Result<(), DomainError> {
    Tetrahedralizer::new().check(organ).map_err(DomainError::Organ)?;
    let vessels = axes(network);
    let outside = outside(organ, &vessels, closed);
    match outside.first() {
        Some(&[v, ..]) => {
            let at = vessels.points[v as usize].coords.into();
            Err(DomainError::NodesOutside { count: outside.len(), node: name(network.nodes[v as usize].original), at })
        }
        None => Ok(()),
    }
}

/// Nodes of a network, each with a triangle of its own.
pub fn axes(network: &Skeleton) -> TriMesh {
    let points = network.nodes.iter().map(|node| node.position).collect();
    TriMesh { points, triangles: (0..network.nodes.len() as u32).map(|v| [v; 3]).collect() }
}

pub fn box_around(vessels: &TriMesh, margin: Option<f64>, outer: f64, size: Option<f64>) -> TriMesh {
    let inner = Aabb::of_points(&vessels.points);
    let diagonal = (inner.max - inner.min).norm();
    // Shells take a part of the space.
    let margin = margin.unwrap_or_else(|| (MARGIN * diagonal).max(outer));
    let [low, high] = [inner.min - Vec3::repeat(margin), inner.max + Vec3::repeat(margin)];
    let longest = (high - low).norm() / SQUARES;
    let side = size.unwrap_or_else(|| margin.max(longest)).max(longest);
    grid_box(low, high, side)
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

/// The surface oriented outwards as a whole.
pub fn outward(mut surface: TriMesh) -> TriMesh {
    let Some(&from) = surface.points.first() else { return surface };
    let volume: f64 = surface
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| surface.points[v as usize] - from);
            a.cross(&b).dot(&c)
        })
        .sum();
    if volume < 0.0 {
        surface.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    surface
}

/// Checks that vessels lie inside a closed surface and do not touch it.
fn holds(organ: &TriMesh, vessels: &TriMesh) -> Result<(), DomainError> {
    let place = |t: [u32; 3]| vessels.points[t[0] as usize].coords.into();
    let first = vessels.points.len() as u32;
    let wall = vessels.triangles.len() as u32;
    let mut all = vessels.clone();
    all.points.extend_from_slice(&organ.points);
    all.triangles.extend(organ.triangles.iter().map(|t| t.map(|v| v + first)));
    let mut meeting: Vec<u32> = self_intersections(&all.points, &all.triangles)
        .into_iter()
        .filter(|&(a, b)| (a < wall) != (b < wall))
        .map(|(a, b)| a.min(b))
        .collect();
    meeting.sort_unstable();
    meeting.dedup();
    if let Some(&t) = meeting.first() {
        let at = place(vessels.triangles[t as usize]);
        return Err(DomainError::VesselsOutside { count: meeting.len(), outside: false, at });
    }
    let outside = outside(organ, vessels, false);
    match outside.first() {
        Some(&t) => Err(DomainError::VesselsOutside { count: outside.len(), outside: true, at: place(t) }),
        None => Ok(()),
    }
}

/// Triangles of the vessels that begin outside a closed surface. `closed`: the surface itself is inside.
fn outside(organ: &TriMesh, vessels: &TriMesh, closed: bool) -> Vec<[u32; 3]> {
    let corners = |t: u32| organ.triangles[t as usize].map(|v| &organ.points[v as usize]);
    let boxes: Vec<Aabb> = (0..organ.triangles.len() as u32).map(|t| Aabb::of_points(corners(t))).collect();
    let tree = Bvh::new(&boxes);
    let touches = |p: &Point3| {
        let mut touched = false;
        tree.query(&Aabb { min: *p, max: *p }, |t| touched |= is_on(p, corners(t)));
        touched
    };
    let is_outside = |p: &Point3| {
        let mut winding = 0;
        let ray = Aabb { min: *p, max: Point3::new(f64::INFINITY, p.y, p.z) };
        tree.query(&ray, |t| winding += crossing(p, corners(t)).unwrap_or_default());
        winding % 2 == 0 && !(closed && touches(p))
    };
    vessels.triangles.par_iter().copied().filter(|t| is_outside(&vessels.points[t[0] as usize])).collect()
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

/// Checks that no edge of a network properly crosses an organ's surface. Edges that only touch it pass.
pub fn check_edges(organ: &TriMesh, network: &Skeleton, name: &dyn Fn(u32) -> String) -> Result<(), DomainError> {
    let corners = |t: u32| organ.triangles[t as usize].map(|v| &organ.points[v as usize]);
    let boxes: Vec<Aabb> = (0..organ.triangles.len() as u32).map(|t| Aabb::of_points(corners(t))).collect();
    let tree = Bvh::of(boxes);
    let crossed = |edge: &Edge| {
        let [p, q] = edge.nodes.map(|node| &network.nodes[node.index()].position);
        let mut first = u32::MAX;
        tree.query(&Aabb::of_points([p, q]), |t| {
            if crosses([p, q], corners(t)) {
                first = first.min(t);
            }
        });
        (first != u32::MAX).then(|| (edge.nodes, corners(first)[0].coords.into()))
    };
    let leaving: Vec<([NodeId; 2], [f64; 3])> = network.edges.par_iter().filter_map(crossed).collect();
    match leaving.first() {
        Some(&(ends, at)) => {
            let ends = ends.map(|node| name(network.nodes[node.index()].original));
            Err(DomainError::EdgesOutside { count: leaving.len(), ends, at })
        }
        None => Ok(()),
    }
}

/// True if a segment passes from one side of a triangle to the other through its interior.
fn crosses([p, q]: [&Point3; 2], [a, b, c]: [&Point3; 3]) -> bool {
    let (from, to) = (orient3d(a, b, c, p), orient3d(a, b, c, q));
    let turns = || [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    let one_turn = |turns: [f64; 3]| turns.iter().all(|&t| t > 0.0) || turns.iter().all(|&t| t < 0.0);
    (from < 0.0 && to > 0.0 || from > 0.0 && to < 0.0) && one_turn(turns())
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::sphere_surface;
    use anastomesh_tet::Tetrahedralizer;

    #[test]
    fn boxes_are_closed_and_hold_the_vessels() {
        let ball = sphere_surface(2);
        for (margin, size) in [(None, None), (Some(0.5), Some(0.7)), (Some(2.0), Some(50.0))] {
            let around = box_around(&ball, margin, 0.1, size);
            Tetrahedralizer::new().check(&around).expect("closed");
            assert!(holds(&around, &ball).is_ok());
            let fault = holds(&ball, &around);
            assert!(matches!(fault, Err(DomainError::VesselsOutside { outside: true, .. })), "{fault:?}");
        }
    }

    #[test]
    fn vessels_that_leave_the_organ_are_named() {
        let ball = sphere_surface(2);
        let moved = TriMesh { points: ball.points.iter().map(|p| p + Vec3::x()).collect(), ..ball.clone() };
        match holds(&ball, &moved) {
            Err(DomainError::VesselsOutside { count, outside: false, at }) => {
                assert!(count > 4 && (Vec3::from(at).norm() - 1.0).abs() < 0.5, "{count} {at:?}");
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn surfaces_are_turned_outwards() {
        let ball = sphere_surface(1);
        let turned = TriMesh { triangles: ball.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..ball.clone() };
        assert!(outward(turned.clone()) != turned && outward(ball.clone()) == ball);
    }
}
