//! The straight tube of radius 1 that other tubes are images of: made once for each number of corners and each length, with
//! the wall of a connector and points inside that stand in rings as those of the wall do, then improved as far as improvement
//! goes, and kept.

use crate::block::connector_surface::{ConnectorSurface, Division, connector_surface};
use crate::block::corners::part_corners;
use crate::block::free_ends::FreeEnds;
use crate::block::layered::{Walled, discs_first, renumbered};
use crate::block::params::BlockParams;
use crate::partition::{Cut, CutId};
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_mesh::quality::radius_ratio;
use anastomesh_mesh::{TetMesh, TriMesh};
use anastomesh_skeleton::BranchId;
use anastomesh_tet::parts::{Inset, OptimizeOptions, Watch, fill_outward, optimize};
use anastomesh_tet::{Effort, Interior, Layers, TetError, Tetrahedralizer};
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
const LATTICE: (u32, [f64; 2]) = (16, [1.2, 0.3]);

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
    /// How many of the tetrahedra, the first ones, are in layers.
    pub layers: usize,
    /// The smallest radius ratio of those, before the length was taken out.
    pub least: f64,
}

/// What a template is found by: the number of corners of its discs, the power of its length, which of its ends are caps, and
/// its layers: how many, and the bits of growth and thickness; and the bits of how long edges are on its axis.
type Key = (u32, i32, [bool; 2], Option<(u32, [u64; 2])>, u64);
/// None: it cannot be made.
type Kept = Arc<OnceLock<Option<Template>>>;

static TEMPLATES: LazyLock<RwLock<FxHashMap<Key, Kept>>> = LazyLock::new(RwLock::default);

/// The template of a length near to `length` radii, for discs that have so many corners. Ends that are caps are on the boundary
/// of the whole. Of the parameters, ρ, core and layers count.
pub fn with<R>(
    params: &BlockParams,
    corners: u32,
    length: f64,
    caps: [bool; 2],
    then: impl FnOnce(&Template) -> R,
) -> Option<R> {
    let power = (length.ln() / STEP.ln()).round() as i32;
    let layers = params.layers.map(|layers| (layers.count, [layers.growth, layers.thickness].map(f64::to_bits)));
    let kept = slot((corners, power, caps, layers, params.core.to_bits()));
    kept.get_or_init(|| Template::best(params, STEP.powi(power), caps)).as_ref().map(then)
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
    fn best(params: &BlockParams, length: f64, caps: [bool; 2]) -> Option<Self> {
        let section = |z| Section { origin: Point3::new(0.0, 0.0, z), axis: Vec3::z(), radius: 1.0 };
        let cut =
            Cut { branch: BranchId(0), sides: Cut::NOWHERE, path: vec![section(0.0), section(length)], size: None };
        let ends = FreeEnds::new(CutId(0), &cut, &BlockParams::with_rho(params.rho)).ok()?;
        let corners = ends.discs[0].rim.len() as u32;
        let tube = connector_surface(&cut.path, ends.both(), DIVISION).ok()?;
        let rings = Rings { corners, length, rows: tube.rings + 1, radius: 1.0, core: params.core };
        let inside = match &params.layers {
            None => Inside::plain(&tube, |surface| core(surface, &rings), caps),
            Some(layers) => {
                let rings = Rings { radius: 1.0 - layers.thickness, ..rings };
                Inside::layered(&tube, &cut.path, layers, |surface| core(surface, &rings))
            }
        };
        let Inside { mesh, disc, ends, wall, layers } = inside.ok()??;
        let TetMesh { mut points, tets } = mesh;
        let least = radius_ratios(&points, &tets[..layers]).fold(1.0, f64::min);
        for point in &mut points {
            point.z /= length;
        }
        Some(Self { points, disc, ends, wall, tets, rings: tube.rings, layers, least })
    }
}

/// A straight tube, filled, under the numbers of a template.
struct Inside {
    mesh: TetMesh,
    disc: u32,
    ends: [Vec<[u32; 3]>; 2],
    wall: Vec<[u32; 3]>,
    layers: usize,
}

impl Inside {
    fn plain(
        tube: &ConnectorSurface,
        core: impl Fn(&TriMesh) -> Result<TetMesh, TetError>,
        caps: [bool; 2],
    ) -> Result<Option<Self>, TetError> {
        let mut mesh = core(&tube.surface)?;
        if caps != [false; 2] {
            let of_disc = tube.end_triangles as usize / 2;
            part_corners(&mut mesh, &tube.surface, |i| caps.get(i / of_disc).copied().unwrap_or(true));
        }
        let (ends, wall) = faces(tube);
        Ok(Some(Self { mesh, disc: tube.shared.len() as u32 / 2, ends, wall, layers: 0 }))
    }

    /// With layers; none where they come out thinner than asked for.
    fn layered(
        tube: &ConnectorSurface,
        path: &[Section],
        layers: &Layers,
        core: impl Fn(&TriMesh) -> Result<TetMesh, TetError>,
    ) -> Result<Option<Self>, TetError> {
        let of_disc = tube.end_triangles as usize / 2;
        let centres = (0..tube.surface.triangles.len()).map(|i| path.get(i / of_disc).map(|section| section.origin));
        let axes = path.windows(2).map(|pair| [pair[0].origin, pair[1].origin]).collect();
        let walled = Walled { surface: &tube.surface, caps: centres.collect(), axes };
        let (Inset { mesh, numbers, of_layers, .. }, thin) = walled.fill(layers, core)?;
        if thin.is_some() {
            return Ok(None);
        }
        let plain = tube.shared.len() as u32 / 2;
        let (counts, renamed) = discs_first(&numbers, [0..plain, plain..2 * plain], layers.count, mesh.points.len());
        let (ends, wall) = faces(tube);
        let rename = |list: Vec<[u32; 3]>| list.into_iter().map(|t| t.map(|v| renamed[v as usize])).collect();
        let ends = ends.map(|disc| rename(numbers.disc(&disc)));
        Ok(Some(Self {
            mesh: renumbered(mesh, &renamed),
            disc: counts[0],
            ends,
            wall: rename(wall),
            layers: of_layers,
        }))
    }
}

/// The triangles of the two discs of a tube, and of its wall.
fn faces(tube: &ConnectorSurface) -> ([Vec<[u32; 3]>; 2], Vec<[u32; 3]>) {
    let (discs, wall) = tube.surface.triangles.split_at(tube.end_triangles as usize);
    let (first, second) = discs.split_at(discs.len() / 2);
    ([first.to_vec(), second.to_vec()], wall.to_vec())
}

/// A tube filled in the best of all ways to place points inside, and improved.
fn core(surface: &TriMesh, inside: &Rings) -> Result<TetMesh, TetError> {
    let (corners, [cell, clearance]) = LATTICE;
    let lattice = (inside.corners >= corners).then_some(Interior::Local { cell: cell * inside.core, clearance });
    let ways = [0, 1].map(|shift| Interior::Points(inside.points(shift)));
    let mut best: Result<(f64, TetMesh), TetError> = Err(TetError::Flat);
    for interior in ways.into_iter().chain(lattice) {
        let tetrahedralizer = Tetrahedralizer::new().interior(interior).effort(Effort::Quick);
        let made = fill_outward(&tetrahedralizer, surface, &Watch::NOBODY).map(|mesh| (worth(&mesh), mesh));
        if best.as_ref().map_or(f64::NEG_INFINITY, |best| best.0)
            < made.as_ref().map_or(f64::NEG_INFINITY, |made| made.0)
        {
            best = made;
        }
    }
    let (_, mut mesh) = best?;
    // What cannot be improved stays as it is.
    let _ = optimize(&mut mesh, &OptimizeOptions { fixed_points: surface.points.len(), ..HARD });
    Ok(mesh)
}

/// Points inside a tube along z, in rings round its axis.
struct Rings {
    /// Points in each ring of the wall.
    corners: u32,
    length: f64,
    /// Strips of the wall.
    rows: u32,
    radius: f64,
    /// How much longer than at the wall edges are on the axis; in between, in proportion.
    core: f64,
}

impl Rings {
    /// Rings each turned by half a step against the one before it, in as many rows as the wall has strips. Rings next to each
    /// other across the tube stand at half a row from each other, beginning with that next to the wall (`shift`: from the first
    /// row or half a row later).
    fn points(&self, shift: u32) -> Vec<Point3> {
        let Self { corners, length, rows, radius: wall, .. } = *self;
        // Between that along the wall, which layers leave as it is, and that round it, which they shorten.
        let edge = TAU * wall.sqrt() / f64::from(corners);
        let layers = (wall * self.steps() / (0.87 * edge)).round().max(1.0) as u32;
        let mut points = Vec::new();
        for layer in 0..layers {
            let share = self.share(f64::from(layer) / f64::from(layers));
            let longer = self.core + (1.0 - self.core) * share;
            let count =
                ((SPARSER * share * f64::from(corners) / longer).round() as u32).max(if layer == 0 { 1 } else { 4 });
            let half = 0.5 * f64::from((layers - 1 - layer + shift) % 2);
            let rows = (f64::from(rows) / longer).round().max(1.0) as u32;
            let row = length / f64::from(rows);
            for k in 0..=rows {
                let z = (f64::from(k) + half) * row;
                if z < CLEAR * row || z > length - CLEAR * row {
                    continue;
                }
                let angle = |i: u32| TAU * (f64::from(i) + 0.5 * f64::from(k % 2)) / f64::from(count);
                let radius = wall * share;
                points.extend((0..count).map(|i| Point3::new(radius * angle(i).cos(), radius * angle(i).sin(), z)));
            }
        }
        points
    }

    /// From the axis to the wall in edges, which grow inwards, over the same in edges as at the wall.
    fn steps(&self) -> f64 {
        if self.core == 1.0 { 1.0 } else { self.core.ln() / (self.core - 1.0) }
    }

    /// How much of the radius lies within this share of these edges.
    fn share(&self, of_steps: f64) -> f64 {
        if self.core == 1.0 { of_steps } else { self.core * (1.0 - self.core.powf(-of_steps)) / (self.core - 1.0) }
    }
}

/// Mean and smallest radius ratio, the smallest counting as much as would lift all by a tenth of it.
fn worth(mesh: &TetMesh) -> f64 {
    let ratios = radius_ratios(&mesh.points, &mesh.tets);
    let (sum, least) = ratios.fold((0.0, 1.0_f64), |(sum, least), r| (sum + r, least.min(r)));
    sum / mesh.tets.len().max(1) as f64 + 0.1 * least
}

fn radius_ratios(points: &[Point3], tets: &[[u32; 4]]) -> impl Iterator<Item = f64> {
    tets.iter().map(|t| {
        let [a, b, c, d] = t.map(|v| &points[v as usize]);
        radius_ratio(a, b, c, d)
    })
}
