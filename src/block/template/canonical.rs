//! The straight tube of radius 1 that other tubes are images of: made once for each number of corners and each length, with
//! the wall of a connector and points inside that stand in rings as those of the wall do, then improved as far as improvement
//! goes, and kept.

use crate::block::connector_surface::{ConnectorSurface, Division, connector_surface};
use crate::block::corners::part_corners;
use crate::block::free_ends::FreeEnds;
use crate::block::params::BlockParams;
use crate::geometry::{Point3, Section, Vec3};
use crate::mesh::TetMesh;
use crate::mesh::quality::radius_ratio;
use crate::partition::{Cut, CutId};
use crate::skeleton::BranchId;
use crate::tet::optimize::{Effort, OptimizeOptions, optimize};
use crate::tet::{Interior, TetOptions, tetrahedralize};
use rustc_hash::FxHashMap;
use std::f64::consts::TAU;
use std::sync::{Arc, LazyLock, OnceLock, PoisonError, RwLock};

/// Lengths of templates, in radii, are powers of this: a tube is stretched or shrunk by half of the step at most.
const STEP: f64 = 1.05;

/// Rings of the wall are a little further from each other than triangles of equal sides have it: with the rings inside as far
/// from each other, tetrahedra come out rounder.
const DIVISION: Division = Division::Rings(0.8);

/// No ring inside is nearer to a disc than this, in rows.
const CLEAR: f64 = 0.3;
/// Points in a ring inside for each of the wall and each share of its radius: they are a little further from each other.
const SPARSER: f64 = 0.9;
/// Side and clearance of the lattice that is tried, too, where discs have so many corners: of wide tubes it fills the core.
const LATTICE: (u32, Interior) = (16, Interior::Local { cell: 1.2, clearance: 0.3 });

/// How a template is improved: every tetrahedron, with everything there is.
const HARD: OptimizeOptions = OptimizeOptions {
    fixed_points: 0,
    rounds: 12,
    smooth_below: 1.1,
    flip_below: 0.95,
    stubborn_below: 0.6,
    keep_points: false,
    attempts_per_tet: 400,
    effort: Effort::Full,
};

/// A tube of radius 1 along z from 0 to 1: its length is taken out.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// First the points of the discs at the two ends, then those of the wall, then those inside.
    pub points: Vec<Point3>,
    /// Points of each disc.
    pub disc: u32,
    /// Triangles of the two discs, outwards.
    pub ends: [Vec<[u32; 3]>; 2],
    /// Triangles of the wall, outwards.
    pub wall: Vec<[u32; 3]>,
    /// The tetrahedra.
    pub tets: Vec<[u32; 4]>,
    /// Rings between the rims.
    pub rings: u32,
}

/// What a template is found by: the number of corners of its discs, the power of its length, and which of its ends are caps.
type Key = (u32, i32, [bool; 2]);
/// None: it cannot be made.
type Kept = Arc<OnceLock<Option<Template>>>;

static TEMPLATES: LazyLock<RwLock<FxHashMap<Key, Kept>>> = LazyLock::new(RwLock::default);

/// The template of a length near to `length` radii, for discs of resolution ρ that have so many corners. Ends that are caps are
/// on the boundary of the whole.
pub fn with<R>(rho: f64, corners: u32, length: f64, caps: [bool; 2], then: impl FnOnce(&Template) -> R) -> Option<R> {
    let power = (length.ln() / STEP.ln()).round() as i32;
    let kept = slot((corners, power, caps));
    kept.get_or_init(|| Template::best(rho, STEP.powi(power), caps)).as_ref().map(then)
}

fn slot(key: Key) -> Kept {
    // A thread that panicked left whole entries only.
    if let Some(kept) = TEMPLATES.read().unwrap_or_else(PoisonError::into_inner).get(&key) {
        return Arc::clone(kept);
    }
    Arc::clone(TEMPLATES.write().unwrap_or_else(PoisonError::into_inner).entry(key).or_default())
}

impl Template {
    /// The best of what the ways to place points inside give, improved.
    fn best(rho: f64, length: f64, caps: [bool; 2]) -> Option<Self> {
        let best = Filled::all(rho, length)?.reduce(|a, b| if b.worth > a.worth { b } else { a })?;
        let Filled { surface: ConnectorSurface { surface, end_triangles, rings, shared }, mut mesh, .. } = best;
        let boundary = surface.points.len();
        // What cannot be improved stays as it is.
        let _ = optimize(&mut mesh, &OptimizeOptions { fixed_points: boundary, ..HARD });
        if caps != [false; 2] {
            let of_disc = end_triangles as usize / 2;
            part_corners(&mut mesh, &surface, |i| caps.get(i / of_disc).copied().unwrap_or(true));
        }
        let (discs, wall) = surface.triangles.split_at(end_triangles as usize);
        let (first, second) = discs.split_at(discs.len() / 2);
        let TetMesh { mut points, tets } = mesh;
        for point in &mut points {
            point.z /= length;
        }
        let disc = shared.len() as u32 / 2;
        let ends = [first.to_vec(), second.to_vec()];
        Some(Self { points, disc, ends, wall: wall.to_vec(), tets, rings })
    }
}

/// A tube on the way to a template.
struct Filled {
    surface: ConnectorSurface,
    mesh: TetMesh,
    worth: f64,
}

impl Filled {
    /// All ways to place points inside.
    fn all(rho: f64, length: f64) -> Option<impl Iterator<Item = Self>> {
        let section = |z| Section { origin: Point3::new(0.0, 0.0, z), axis: Vec3::z(), radius: 1.0 };
        let cut = Cut { branch: BranchId(0), sides: Cut::NOWHERE, path: vec![section(0.0), section(length)] };
        let ends = FreeEnds::new(CutId(0), &cut, &BlockParams::with_rho(rho)).ok()?;
        let corners = ends.discs[0].rim.len() as u32;
        let surface = connector_surface(&cut.path, ends.both(), DIVISION).ok()?;
        let lattice = (corners >= LATTICE.0).then_some(LATTICE.1);
        let ways = [0, 1].map(|shift| Interior::Points(rings(corners, length, surface.rings + 1, shift)));
        Some(ways.into_iter().chain(lattice).filter_map(move |interior| {
            let options = TetOptions::default().interior(interior).effort(Effort::Quick).certify(false);
            let mesh = tetrahedralize(&surface.surface, &options).ok()?;
            Some(Self { surface: surface.clone(), worth: worth(&mesh), mesh })
        }))
    }
}

/// Points inside a tube of radius 1, in rings round its axis, each turned by half a step against the one before it, in as many
/// rows as the wall has strips. Rings next to each other across the tube stand at half a row from each other, beginning with
/// that next to the wall (`shift`: from the first row or half a row later).
fn rings(corners: u32, length: f64, rows: u32, shift: u32) -> Vec<Point3> {
    let edge = TAU / f64::from(corners);
    let layers = (1.0 / (0.87 * edge)).round().max(1.0) as u32;
    let row = length / f64::from(rows);
    let mut points = Vec::new();
    for layer in 0..layers {
        let radius = f64::from(layer) / f64::from(layers);
        let count = ((SPARSER * radius * f64::from(corners)).round() as u32).max(if layer == 0 { 1 } else { 4 });
        let half = 0.5 * f64::from((layers - 1 - layer + shift) % 2);
        for k in 0..=rows {
            let z = (f64::from(k) + half) * row;
            if z < CLEAR * row || z > length - CLEAR * row {
                continue;
            }
            let angle = |i: u32| TAU * (f64::from(i) + 0.5 * f64::from(k % 2)) / f64::from(count);
            points.extend((0..count).map(|i| Point3::new(radius * angle(i).cos(), radius * angle(i).sin(), z)));
        }
    }
    points
}

/// Mean and smallest radius ratio, the smallest counting as much as would lift all by a tenth of it.
fn worth(mesh: &TetMesh) -> f64 {
    let ratios = mesh.tets.iter().map(|t| {
        let [a, b, c, d] = t.map(|v| &mesh.points[v as usize]);
        radius_ratio(a, b, c, d)
    });
    let (sum, least) = ratios.fold((0.0, 1.0_f64), |(sum, least), r| (sum + r, least.min(r)));
    sum / mesh.tets.len().max(1) as f64 + 0.1 * least
}
