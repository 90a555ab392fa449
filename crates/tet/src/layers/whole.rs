//! Layers along all of a closed surface.

use super::direction::Directions;
use super::inset::{Inset, Places, inset, lower};
use super::room::half_widths;
use crate::certify::{Place, certify_facets};
use crate::error::TetError;
use crate::fill::fill;
use crate::input;
use crate::layer::Layers;
use crate::options::Interior;
use crate::plc::InputKind;
use crate::request::{Filled, Request};
use anastomesh_mesh::adjacency::{face_vertices, tet_adjacency};
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
    /// Vertices without layers, since no direction leads away from all their triangles or the inside is too narrow.
    pub without: Vec<u32>,
}

/// Fills a closed surface as requested, with layers along it.
pub fn layered(r: &Request, layers: &Layers) -> Result<(Filled, LayerSummary), TetError> {
    // Without inner points: this only finds the filled side of each triangle and checks feasibility.
    let plain = fill(&Request { interior: &Interior::None, refinement: None, optimize: false, ..*r })?;
    let outward = |(t, place): (&[u32; 3], &Place)| if *place == Place::Reversed { [t[0], t[2], t[1]] } else { *t };
    let triangles = r.surface.triangles.iter().zip(&plain.places).map(outward).collect();
    let surface = TriMesh { points: r.surface.points.clone(), triangles };
    let (places, asked) = places(&surface, layers);
    let core = |inner: &TriMesh| -> Result<Filled, TetError> {
        let edges = input::validate(inner, &[], InputKind::Closed)?;
        let lone = Request { surface: inner, edges: &edges, certify: false, label: false, ..*r };
        fill(&lone)
    };
    let (mut recovery, mut optimize, mut refine) = Default::default();
    let Inset { mesh, of_layers, shares, .. } = inset(&places, &layers.depths(), |inner| {
        let filled = core(inner)?;
        (recovery, optimize, refine) = (filled.recovery, filled.optimize, filled.refine);
        Ok(filled.mesh)
    })?;
    let reached = |v: usize| shares[v] * (places.wanted[v] - surface.points[v]).norm();
    let summary = summary(&asked, reached, of_layers, places.wall);
    let regions = regions(&mesh, &plain);
    let places = certify_facets(&mesh, r.surface, r.kind, &regions)?;
    Ok((Filled { mesh, places, regions, recovery, optimize, refine, ..plain }, summary))
}

/// Wanted inner positions of the vertices of a surface, and the offsets asked for.
fn places<'a>(surface: &'a TriMesh, layers: &Layers) -> (Places<'a>, Vec<f64>) {
    let points = &surface.points;
    let ways = Directions::new(points, &surface.triangles).ways;
    let asked: Vec<f64> = half_widths(surface, &ways).into_iter().map(|half| layers.thickness * half).collect();
    let mut heights = asked.clone();
    lower(&mut heights, points, &surface.triangles, GRADE);
    let wanted = points.iter().zip(ways.iter().zip(&heights)).map(|(p, (way, height))| p + way * *height);
    let none = vec![false; points.len()];
    let wanted = wanted.collect();
    (Places { surface, wall: &surface.triangles, is_rim: none.clone(), wanted, is_held: none, is_narrow: true }, asked)
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
