//! Layers along a closed surface, or along its triangles with certain markers.

use super::caps::{Cap, caps, shrunk};
use super::direction::Directions;
use super::half_width::half_widths;
use super::inset::{Inset, Places, inset, lower};
use super::stack::rims;
use crate::certify::{Place, certify_facets};
use crate::error::TetError;
use crate::fill::fill;
use crate::input;
use crate::layer::Layers;
use crate::optimize::OptimizeReport;
use crate::options::Interior;
use crate::plc::InputKind;
use crate::recover::RecoverySummary;
use crate::refine::RefineReport;
use crate::request::{Filled, Request};
use anastomesh_mesh::adjacency::{face_vertices, tet_adjacency};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::{TetMesh, TriMesh, face_key};
use rustc_hash::FxHashMap;

/// Maximum difference of neighbouring thicknesses, relative to their distance.
const GRADE: f64 = 0.3;
/// Fraction of the thickness asked for below which layers count as thin.
const THIN: f64 = 0.5;

/// Summary of the layers along a surface.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LayerSummary {
    /// Number of layer tetrahedra, which come first in the mesh.
    pub tets: usize,
    /// Vertices with less than half of the thickness asked for.
    pub thin: usize,
    /// Vertex with the thinnest layers and their fraction of the thickness asked for; `None` if all are complete.
    pub thinnest: Option<(u32, f64)>,
    /// Vertices without layers. No direction leads away from all their triangles, or the inside is too narrow. Others are on
    /// the rim of a cap that keeps its triangles.
    pub without: Vec<u32>,
    /// Flat parts without layers that shrank in their plane, with a ring of layers around them.
    pub shrunk_caps: usize,
    /// Parts without layers that keep their triangles, because they are not flat or not convex enough.
    pub kept_caps: usize,
}

/// Filled surface with layers.
pub struct Layered {
    pub filled: Filled,
    pub summary: LayerSummary,
    /// Layer of each tetrahedron, counted from 1 at the wall; 0 inside the layers.
    pub of_tets: Vec<i32>,
    /// Outer surface and the input triangle of each of its triangles, if caps have other triangles than the input.
    pub outer: Option<(TriMesh, Vec<u32>)>,
}

/// Fills a closed surface as requested, with layers along the triangles with one of the markers `on`. An empty list
/// stands for all triangles.
pub fn layered(r: &Request, layers: &Layers, (markers, on): (&[i32], &[i32])) -> Result<Layered, TetError> {
    // Without inner points: this only finds the filled side of each triangle and checks feasibility.
    let plain = fill(&Request { interior: &Interior::None, refinement: None, optimize: false, ..*r })?;
    let outward = |(t, place): (&[u32; 3], &Place)| if *place == Place::Reversed { [t[0], t[2], t[1]] } else { *t };
    let triangles = r.surface.triangles.iter().zip(&plain.places).map(outward).collect();
    let surface = TriMesh { points: r.surface.points.clone(), triangles };
    let is_wall: Vec<bool> =
        (0..surface.triangles.len()).map(|t| on.is_empty() || markers.get(t).is_some_and(|m| on.contains(m))).collect();
    let mut caps = caps(&surface, &is_wall, markers);
    let wall = Wall::new(&surface, &is_wall, layers);
    let (inset, about) = match wall.inset(r, layers, &caps) {
        Err(error) if !error.is_stop() && caps.iter().any(|cap| cap.centre.is_some()) => {
            for cap in &mut caps {
                cap.centre = None;
            }
            wall.inset(r, layers, &caps)?
        }
        made => made?,
    };
    let reached = |v: usize| inset.shares[v] * (about.wanted[v] - surface.points[v]).norm();
    // At a cap that shrinks, the share of its own size is asked for.
    let of_cap = |(v, p): (usize, Option<Point3>)| p.map(|p| (p - surface.points[v]).norm()).filter(|d| *d > 0.0);
    let of_caps = shrunk(&surface, &caps, layers.thickness).into_iter().enumerate().map(of_cap);
    let asked: Vec<f64> = wall.asked.iter().zip(of_caps).map(|(asked, of_cap)| of_cap.unwrap_or(*asked)).collect();
    let mut summary = summary(&asked, reached, inset.of_layers, &wall.triangles);
    summary.shrunk_caps = caps.iter().filter(|cap| cap.centre.is_some()).count();
    summary.kept_caps = caps.len() - summary.shrunk_caps;
    let regions = regions(&inset.mesh, &plain);
    let outer = (summary.shrunk_caps > 0).then(|| outer_surface(&inset, (&surface, &is_wall), &caps));
    let kept = outer.as_ref().map_or(r.surface, |(surface, _)| surface);
    let places = certify_facets(&inset.mesh, kept, r.kind, &regions)?;
    let mut of_tets = inset.numbers.layers_at(&wall.triangles);
    of_tets.resize(inset.mesh.tets.len(), 0);
    let Core { recovery, optimize, refine, .. } = about;
    let filled = Filled { mesh: inset.mesh, places, regions, recovery, optimize, refine, ..plain };
    Ok(Layered { filled, summary, of_tets, outer })
}

/// Part of a surface that gets layers.
struct Wall<'a> {
    surface: &'a TriMesh,
    triangles: Vec<[u32; 3]>,
    is_rim: Vec<bool>,
    /// Inward direction at each vertex.
    ways: Vec<Vec3>,
    /// Offset asked for at each vertex.
    asked: Vec<f64>,
}

/// Wanted inner positions, and results of filling inside the layers.
struct Core {
    wanted: Vec<Point3>,
    recovery: RecoverySummary,
    optimize: Option<OptimizeReport>,
    refine: Option<RefineReport>,
}

impl<'a> Wall<'a> {
    fn new(surface: &'a TriMesh, is_wall: &[bool], layers: &Layers) -> Self {
        let triangles: Vec<[u32; 3]> =
            surface.triangles.iter().zip(is_wall).filter(|(_, wall)| **wall).map(|(t, _)| *t).collect();
        let ways = Directions::new(&surface.points, &triangles).ways;
        let asked = half_widths(surface, &ways).into_iter().map(|half| layers.thickness * half).collect();
        Self { surface, triangles, is_rim: rims(surface, |t| is_wall[t]), ways, asked }
    }

    /// Fills the surface inside the layers, which end at caps.
    fn inset(&self, r: &Request, layers: &Layers, caps: &[Cap]) -> Result<(Inset, Core), TetError> {
        let points = &self.surface.points;
        let held = shrunk(self.surface, caps, layers.thickness);
        let of_cap = |v: usize| held[v].map(|p| (p - points[v]).norm());
        let mut heights: Vec<f64> = (0..points.len()).map(|v| of_cap(v).unwrap_or(self.asked[v])).collect();
        lower(&mut heights, points, &self.triangles, GRADE);
        let wanted = |v: usize| held[v].unwrap_or_else(|| points[v] + self.ways[v] * heights[v]);
        let places = Places {
            surface: self.surface,
            wall: &self.triangles,
            is_rim: self.is_rim.clone(),
            wanted: (0..points.len()).map(wanted).collect(),
            is_held: held.iter().map(Option::is_some).collect(),
            is_narrow: true,
        };
        let (mut recovery, mut optimize, mut refine) = Default::default();
        let made = inset(&places, &layers.depths(), |inner| {
            let edges = input::validate(inner, &[], InputKind::Closed)?;
            let filled = fill(&Request { surface: inner, edges: &edges, certify: false, label: false, ..*r })?;
            (recovery, optimize, refine) = (filled.recovery, filled.optimize, filled.refine);
            Ok(filled.mesh)
        })?;
        Ok((made, Core { wanted: places.wanted, recovery, optimize, refine }))
    }
}

/// Outer surface of a mesh with shrunk caps, and the input triangle of each triangle. Those of rings around a cap have
/// the first triangle of the cap.
fn outer_surface(inset: &Inset, (surface, is_wall): (&TriMesh, &[bool]), caps: &[Cap]) -> (TriMesh, Vec<u32>) {
    let mut origins: Vec<u32> = (0..surface.triangles.len() as u32).filter(|&t| is_wall[t as usize]).collect();
    let mut triangles: Vec<[u32; 3]> = origins.iter().map(|&t| surface.triangles[t as usize]).collect();
    for cap in caps {
        let own: Vec<[u32; 3]> = cap.triangles.iter().map(|&t| surface.triangles[t as usize]).collect();
        let disc = inset.numbers.disc(&own);
        origins.extend(&cap.triangles);
        origins.extend(std::iter::repeat_n(cap.triangles[0], disc.len() - own.len()));
        triangles.extend(disc);
    }
    let points = inset.mesh.points[..inset.numbers.len() as usize].to_vec();
    (TriMesh { points, triangles }, origins)
}

fn summary(asked: &[f64], reached: impl Fn(usize) -> f64, tets: usize, wall: &[[u32; 3]]) -> LayerSummary {
    let mut on_wall: Vec<u32> = wall.as_flattened().to_vec();
    on_wall.sort_unstable();
    on_wall.dedup();
    let share = |v: u32| match asked[v as usize] {
        0.0 => 0.0,
        asked => reached(v as usize) / asked,
    };
    let shares: Vec<(u32, f64)> = on_wall.into_iter().map(|v| (v, share(v))).collect();
    let (without, with): (Vec<_>, Vec<_>) = shares.into_iter().partition(|(_, share)| *share == 0.0);
    LayerSummary {
        tets,
        thin: with.iter().filter(|(_, share)| *share < THIN).count(),
        thinnest: with.into_iter().filter(|(_, share)| *share < 1.0 - 1e-9).min_by(|a, b| a.1.total_cmp(&b.1)),
        without: without.into_iter().map(|(v, _)| v).collect(),
        ..LayerSummary::default()
    }
}

/// Region of each tetrahedron, taken from the plain mesh behind the same boundary faces.
fn regions(mesh: &TetMesh, plain: &Filled) -> Vec<i32> {
    if plain.regions.is_empty() {
        return Vec::new();
    }
    let boundary = |mesh: &TetMesh| tet_adjacency(&mesh.tets, mesh.points.len());
    let before = boundary(&plain.mesh);
    let named = before
        .boundary()
        .map(|half| (face_key(face_vertices(&plain.mesh.tets, half)), plain.regions[half as usize / 4]));
    let of_face: FxHashMap<[u32; 3], i32> = named.collect();
    let adjacency = boundary(mesh);
    let mut regions: Vec<Option<i32>> = vec![None; mesh.tets.len()];
    let mut reached: Vec<u32> = Vec::new();
    for half in adjacency.boundary() {
        let region = of_face.get(&face_key(face_vertices(&mesh.tets, half))).copied();
        regions[half as usize / 4] = region;
        reached.extend(region.map(|_| half / 4));
    }
    while let Some(tet) = reached.pop() {
        for &mate in &adjacency.neighbors[tet as usize] {
            if mate != u32::MAX && regions[mate as usize / 4].is_none() {
                regions[mate as usize / 4] = regions[tet as usize];
                reached.push(mate / 4);
            }
        }
    }
    regions.into_iter().map(Option::unwrap_or_default).collect()
}
