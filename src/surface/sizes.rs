//! Target edge lengths of a wall: proportional to the vessel radius, with limited growth away from thin vessels.

use super::SurfaceParams;
use super::field::Field;
use super::halfedge::HalfEdges;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Section, Total};
use anastomesh_skeleton::FinePlace;
use anastomesh_skeleton::resolution::GROWTH;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Local refinement of edges. Edges grow from there and reach the usual length at the cuts, which other blocks share.
#[derive(Clone, Debug, Default)]
pub struct Finer {
    /// The refined places.
    places: Vec<FinePlace>,
    /// Search tree over them; `None` without places.
    tree: Option<Bvh>,
    /// The cuts at its ends.
    cuts: Vec<Section>,
    /// The smallest factor.
    least: f64,
}

impl Finer {
    /// Edges are shorter at `places`, in a block with these cuts.
    pub fn new(places: &[FinePlace], cuts: Vec<Section>) -> Self {
        let boxes: Vec<Aabb> = places.iter().map(|place| Aabb::of_points([&place.at]).grown(place.within)).collect();
        let tree = (!places.is_empty()).then(|| Bvh::of(boxes));
        let least = places.iter().map(|place| place.factor).fold(1.0, f64::min);
        Self { places: places.to_vec(), tree, cuts, least }
    }

    /// Number of additional relaxation rounds. Each round halves edges once.
    pub(super) fn rounds(&self) -> u32 {
        if self.tree.is_some() { libm::log2(1.0 / self.least).ceil() as u32 } else { 0 }
    }

    /// Factor on the target edge length `size` at a point of the wall.
    pub(super) fn factor(&self, p: &Point3, size: f64) -> f64 {
        let (Some(tree), mut factor) = (&self.tree, 1.0_f64) else { return 1.0 };
        let to_cut = self.cuts.iter().map(|cut| distance(cut, p)).fold(f64::INFINITY, f64::min);
        // Further away edges have grown to the usual length.
        let reach = (1.0 - self.least) * size / GROWTH;
        tree.query(&Aabb::of_points([p]).grown(reach), |i| {
            factor = factor.min(grown(&self.places[i as usize], p, size, to_cut));
        });
        factor
    }
}

/// Factor at a point at the distance `to_cut` from the nearest cut, as one place asks.
fn grown(place: &FinePlace, p: &Point3, size: f64, to_cut: f64) -> f64 {
    let away = ((p - place.at).norm() - place.within).max(0.0);
    if away == 0.0 {
        return place.factor;
    }
    // Growth as elsewhere, or faster where a cut is near.
    let share = away / (away + to_cut);
    place.factor + (GROWTH * away / size).max((1.0 - place.factor) * share)
}

/// Distance of a point from the disc of a cut.
fn distance(cut: &Section, p: &Point3) -> f64 {
    let height = cut.height(p);
    let across = (p - cut.origin - cut.axis * height).norm();
    libm::hypot(height, (across - cut.radius).max(0.0))
}

/// Target edge length at each vertex of a surface near the wall.
pub(super) fn wall_sizes(surface: &HalfEdges, field: &mut Field, params: &SurfaceParams, finer: &Finer) -> Vec<f64> {
    let mut sizes = graded(surface, field, params);
    if finer.tree.is_some() {
        sizes.iter_mut().zip(&surface.points).for_each(|(size, p)| *size *= finer.factor(p, *size));
    }
    sizes
}

/// Target edge lengths from the radius alone.
fn graded(surface: &HalfEdges, field: &mut Field, params: &SurfaceParams) -> Vec<f64> {
    if params.edge_at(field.largest_radius()) <= params.edge_at(0.0) {
        return vec![params.edge_at(0.0); surface.points.len()];
    }
    let mut sizes: Vec<f64> = surface.points.iter().map(|p| params.edge_at(field.radius(p))).collect();
    grade(surface, &mut sizes);
    sizes
}

/// Lowers sizes until neighbours differ by at most [`GROWTH`] times their distance.
fn grade(surface: &HalfEdges, sizes: &mut [f64]) {
    let lowers = |sizes: &[f64], v: u32, h: u32| {
        let (size, there) = (sizes[v as usize], sizes[surface.to(h) as usize]);
        there > size && there > size + GROWTH * surface.length(h)
    };
    let is_source = |&v: &u32| surface.has_vertex(v) && surface.fan(v).any(|h| lowers(sizes, v, h));
    let sources = (0..sizes.len() as u32).filter(is_source);
    // The smallest size first (Dijkstra's algorithm), so that each vertex is final when its turn comes.
    let mut heap: BinaryHeap<Reverse<(Total, u32)>> = sources.map(|v| Reverse((Total(sizes[v as usize]), v))).collect();
    while let Some(Reverse((Total(size), v))) = heap.pop() {
        if size > sizes[v as usize] {
            continue;
        }
        for h in surface.fan(v) {
            if lowers(sizes, v, h) {
                let to = surface.to(h);
                sizes[to as usize] = size + GROWTH * surface.length(h);
                heap.push(Reverse((Total(sizes[to as usize]), to)));
            }
        }
    }
}
