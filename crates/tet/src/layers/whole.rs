//! Layers along the facets of a complex: each region is filled inside its own boundary, and the regions are joined.

use super::local::{Local, Spent};
use super::region::{FilledRegion, Wall, fill_plain};
use super::regions::{RegionShape, region_shapes};
use crate::certify::{certify_facets, certify_left_out, certify_segments};
use crate::error::{LayersConflict, TetError};
use crate::fill::fill;
use crate::layer::Layers;
use crate::optimize::OptimizeReport;
use crate::options::Interior;
use crate::outside::without;
use crate::recover::RecoverySummary;
use crate::refine::RefineReport;
use crate::request::{Filled, Request};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{TetMesh, TriMesh};
use rustc_hash::FxHashMap;

/// Fraction of the thickness asked for below which layers count as thin.
const THIN: f64 = 0.5;
/// Tetrahedra of a layer at a triangle.
const TETS_OF_PRISM: usize = 3;

/// Summary of the layers along a surface, or along both sides of the facets of a complex.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LayerSummary {
    /// Number of layer tetrahedra, which come first in the mesh.
    pub tets: usize,
    /// Number of regions with layers.
    pub regions: usize,
    /// Vertices with less than half of the thickness asked for, counted in each region.
    pub thin: usize,
    /// Vertex with the thinnest layers and their fraction of the thickness asked for; `None` if all are complete.
    pub thinnest: Option<(u32, f64)>,
    /// Vertices without layers in one of their regions. No direction leads away from all their triangles, or the inside is
    /// too narrow. Others are on the rim of a cap that keeps its triangles, or on a segment or baffle inside the region.
    pub without: Vec<u32>,
    /// Flat parts without layers that shrank in their plane, or whose vertices at the wall moved in it. A ring of layers takes
    /// the rest of their area.
    pub shrunk_caps: usize,
    /// Parts without layers that keep their triangles, because they are not flat, not convex enough, or shared.
    pub kept_caps: usize,
}

/// Filled complex with layers.
pub struct Layered {
    pub filled: Filled,
    pub summary: LayerSummary,
    /// Layer of each tetrahedron, counted from 1 at the wall; 0 inside the layers.
    pub of_tets: Vec<i32>,
    /// Facets and the input triangle of each, if some differ from those of the input.
    pub outer: Option<(TriMesh, Vec<u32>)>,
}

/// Facets and regions that get layers.
#[derive(Clone, Copy)]
pub struct LayerSides<'a> {
    /// Marker of each triangle of the input.
    pub markers: &'a [i32],
    /// Markers with layers; an empty list stands for all triangles.
    pub on: &'a [i32],
    /// Ids of regions with layers; an empty list stands for all regions.
    pub within: &'a [i32],
}

impl LayerSides<'_> {
    /// True for each triangle of a region's boundary that gets layers in this region.
    fn walls(&self, shape: &RegionShape) -> Vec<bool> {
        let is_within = self.within.is_empty() || self.within.contains(&shape.id);
        let marker = |t: u32| self.markers.get(t as usize);
        let is_on = |t: u32| self.on.is_empty() || marker(t).is_some_and(|m| self.on.contains(m));
        shape.boundary.iter().map(|side| is_within && is_on(side.triangle)).collect()
    }
}

/// Fills a complex as requested, with layers along some of its facets.
pub fn layered(r: &Request, layers: &Layers, sides: &LayerSides) -> Result<Layered, TetError> {
    // Without inner points: this only finds the regions at each triangle, and checks feasibility.
    let plain = fill(&Request { interior: &Interior::None, refinement: None, optimize: false, ..*r })?;
    let shapes = region_shapes(r, &plain);
    if sides.within.iter().any(|id| shapes.iter().all(|shape| shape.id != *id)) {
        return Err(TetError::LayersAlong(LayersConflict::Region));
    }
    let walls: Vec<Vec<bool>> = shapes.iter().map(|shape| sides.walls(shape)).collect();
    if !walls.iter().flatten().any(|&is_wall| is_wall) {
        return Err(TetError::LayersAlong(LayersConflict::Baffles));
    }
    let mut uses = vec![0_u32; r.surface.points.len()];
    r.surface.triangles.as_flattened().iter().for_each(|&v| uses[v as usize] += 1);
    let mut joint = Joint::new(r.surface);
    for (shape, is_wall) in shapes.iter().zip(&walls) {
        let triangles = is_wall.iter().filter(|is_wall| **is_wall).count();
        let spent = joint.spent(TETS_OF_PRISM * layers.count as usize * triangles);
        let local = Local::new(r, shape, spent);
        let made = if triangles > 0 {
            let markers: Vec<i32> =
                shape.boundary.iter().filter_map(|s| sides.markers.get(s.triangle as usize).copied()).collect();
            joint.summary.regions += 1;
            Wall::new(&local, is_wall, (&markers, &uses), layers).fill(r)
        } else {
            fill_plain(r, &local)
        };
        joint.add(shape, made.map_err(|error| local.as_given(error, spent))?);
    }
    joint.finish(r, plain)
}

/// Regions joined so far.
struct Joint {
    points: Vec<Point3>,
    /// Layer tetrahedra, with their layers and regions.
    in_layers: Vec<([u32; 4], i32, i32)>,
    /// Other tetrahedra, with their regions.
    inside: Vec<([u32; 4], i32)>,
    /// New vertices of triangles of the input.
    replaced: FxHashMap<u32, [u32; 3]>,
    /// Triangles of rings, and the input triangle of each.
    rings: Vec<([u32; 3], u32)>,
    summary: LayerSummary,
    recovery: RecoverySummary,
    optimize: Option<OptimizeReport>,
    refine: Option<RefineReport>,
}

impl Joint {
    fn new(surface: &TriMesh) -> Self {
        Self {
            points: surface.points.clone(),
            in_layers: Vec::new(),
            inside: Vec::new(),
            replaced: FxHashMap::default(),
            rings: Vec::new(),
            summary: LayerSummary::default(),
            recovery: RecoverySummary::default(),
            optimize: None,
            refine: None,
        }
    }

    /// Number of tetrahedra.
    fn tets(&self) -> usize {
        self.in_layers.len() + self.inside.len()
    }

    /// Tetrahedra and points of the earlier regions, and tetrahedra in the layers of the next one.
    fn spent(&self, in_layers: usize) -> Spent {
        Spent { tets: self.tets() + in_layers, points: self.refine.as_ref().map_or(0, |refine| refine.points) }
    }

    /// Adds a filled region.
    fn add(&mut self, shape: &RegionShape, region: FilledRegion) {
        let FilledRegion { mesh, of_layers, shares, discs, kept_caps, recovery, optimize, refine } = region;
        let (given, first) = (shape.points.len(), self.points.len());
        let number = |v: u32| shape.points.get(v as usize).copied().unwrap_or((first + v as usize - given) as u32);
        // Vertices of shrunk caps have moved.
        shape.points.iter().zip(&mesh.points).for_each(|(&v, p)| self.points[v as usize] = *p);
        self.points.extend_from_slice(&mesh.points[given..]);
        let tets = mesh.tets.iter().map(|tet| tet.map(number));
        self.in_layers.extend(tets.clone().zip(&of_layers).map(|(tet, &layer)| (tet, layer, shape.id)));
        self.inside.extend(tets.skip(of_layers.len()).map(|tet| (tet, shape.id)));
        for disc in &discs {
            let origins: Vec<u32> = disc.triangles.iter().map(|&t| shape.boundary[t as usize].triangle).collect();
            let mut faces = disc.faces.iter().map(|face| face.map(number));
            self.replaced.extend(origins.iter().copied().zip(faces.by_ref()));
            self.rings.extend(faces.map(|face| (face, origins[0])));
        }
        self.summary.tets += of_layers.len();
        self.summary.shrunk_caps += discs.len();
        self.summary.kept_caps += kept_caps;
        self.add_shares(shares.into_iter().map(|(v, share)| (number(v), share)));
        self.recovery.add(&recovery);
        self.optimize = joined(self.optimize.take(), optimize, OptimizeReport::add);
        self.refine = joined(self.refine.take(), refine, RefineReport::add);
    }

    /// Adds the relative thicknesses at vertices.
    fn add_shares(&mut self, shares: impl Iterator<Item = (u32, f64)>) {
        let LayerSummary { thin, thinnest, without, .. } = &mut self.summary;
        for (v, share) in shares {
            if share == 0.0 {
                without.push(v);
                continue;
            }
            *thin += usize::from(share < THIN);
            if share < thinnest.map_or(1.0 - 1e-9, |(_, least)| least) {
                *thinnest = Some((v, share));
            }
        }
    }

    /// Certifies the whole mesh against the whole input.
    fn finish(mut self, r: &Request, plain: Filled) -> Result<Layered, TetError> {
        let all = self.in_layers.iter().map(|(_, _, id)| *id).chain(self.inside.iter().map(|(_, id)| *id));
        let regions: Vec<i32> = if plain.regions.is_empty() { Vec::new() } else { all.collect() };
        let mut of_tets: Vec<i32> = self.in_layers.iter().map(|(_, layer, _)| *layer).collect();
        of_tets.resize(self.tets(), 0);
        let tets = self.in_layers.iter().map(|(tet, ..)| *tet).chain(self.inside.iter().map(|(tet, _)| *tet));
        let mesh = TetMesh { tets: tets.collect(), points: std::mem::take(&mut self.points) };
        let outer = (self.summary.shrunk_caps > 0).then(|| self.outer(r, &plain, &mesh.points));
        let kept = plain.left_out.kept_surface(r.surface);
        let kept = outer.as_ref().map_or(&*kept, |(surface, _)| surface);
        let places = certify_facets(&mesh, kept, r.kind, &regions)?;
        certify_segments(&mesh, &without(r.segments, &plain.left_out.segments))?;
        certify_left_out(&mesh, r.surface, r.segments, &plain.left_out)?;
        self.summary.without.sort_unstable();
        self.summary.without.dedup();
        let Self { summary, recovery, optimize, refine, .. } = self;
        let filled = Filled { mesh, places, regions, recovery, optimize, refine, ..plain };
        Ok(Layered { filled, summary, of_tets, outer })
    }

    /// Facets of a mesh with shrunk caps, and the input triangle of each. Those of rings around a cap have the first
    /// triangle of the cap.
    fn outer(&self, r: &Request, plain: &Filled, points: &[Point3]) -> (TriMesh, Vec<u32>) {
        let all: Vec<u32> = (0..r.surface.triangles.len() as u32).collect();
        let mut origins = without(&all, &plain.left_out.triangles);
        let current = |t: &u32| self.replaced.get(t).copied().unwrap_or(r.surface.triangles[*t as usize]);
        let mut triangles: Vec<[u32; 3]> = origins.iter().map(current).collect();
        triangles.extend(self.rings.iter().map(|(face, _)| *face));
        origins.extend(self.rings.iter().map(|(_, origin)| *origin));
        (TriMesh { points: points.to_vec(), triangles }, origins)
    }
}

/// Joins the optional reports of two parts.
fn joined<T>(all: Option<T>, part: Option<T>, add: impl Fn(&mut T, &T)) -> Option<T> {
    match (all, part) {
        (Some(mut all), Some(part)) => {
            add(&mut all, &part);
            Some(all)
        }
        (all, part) => all.or(part),
    }
}
