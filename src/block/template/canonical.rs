//! Straight template tube of radius 1, cached for each corner count and length. It has the wall of a connector and
//! inner points in rings like those of the wall, and is then optimized.

use crate::block::connector_surface::{ConnectorSurface, Division, connector_surface};
use crate::block::free_ends::FreeEnds;
use crate::block::layered::{Walled, discs_first, renumbered};
use crate::block::params::BlockParams;
use crate::block::topology::Topology;
use crate::partition::{Cut, CutId};
use anastomesh_mesh::check::parts::{Link, PartView};
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_mesh::quality::radius_ratio;
use anastomesh_mesh::{TetMesh, TriMesh};
use anastomesh_skeleton::BranchId;
use anastomesh_tet::parts::{Inset, OptimizeOptions, Watch, fill_outward, optimize, split_corner_tets};
use anastomesh_tet::{Effort, Interior, Layers, TetError, Tetrahedralizer};
use rustc_hash::FxHashMap;
use std::f64::consts::TAU;
use std::sync::{Arc, LazyLock, OnceLock, PoisonError, RwLock};

/// Ratio of consecutive template lengths, which are powers of it. A tube is stretched or shrunk by at most half a step.
const STEP: f64 = 1.1;

/// Density of wall rings, slightly below that of equilateral triangles. With equal spacing of inner rings, tetrahedra
/// have better shapes.
const DIVISION: Division = Division::Rings(0.8);

/// Minimum distance of inner rings from a disc, in rows.
const CLEAR: f64 = 0.3;
/// Density of inner ring points relative to the wall: their spacing is slightly larger.
const SPARSER: f64 = 0.9;
/// Minimum corner count for a lattice attempt, and the lattice's cell size and clearance: it fills the core of wide
/// tubes.
const LATTICE: (u32, [f64; 2]) = (16, [1.2, 0.3]);

/// Optimizer options for templates: every tetrahedron with full effort.
const HARD: OptimizeOptions = OptimizeOptions {
    fixed_points: 0,
    rounds: 12,
    smooth_below: 1.1,
    flip_below: 0.95,
    stubborn_below: 0.6,
    keep_points: false,
    attempts_per_tet: 400,
    effort: Effort::Full,
    spare_needles: false,
};

/// Tube of radius 1 along z from 0 to 1: the length is scaled out.
#[derive(Clone, Debug, PartialEq)]
pub struct Template {
    /// Points of the discs at both ends, then those of the wall, then inner ones.
    pub points: Vec<Point3>,
    /// Number of points of each disc.
    pub disc: u32,
    /// Triangles of the two discs, facing outwards.
    pub ends: [Vec<[u32; 3]>; 2],
    /// Triangles of the wall, facing outwards.
    pub wall: Vec<[u32; 3]>,
    /// Tetrahedra, those in layers first.
    pub tets: Vec<[u32; 4]>,
    /// Number of rings between the rims.
    pub rings: u32,
    /// Number of tetrahedra in layers.
    pub layers: usize,
    /// Smallest radius ratio of those, at the original length.
    pub least: f64,
    /// Topology of the tetrahedra, with both discs.
    pub topology: Arc<Topology>,
    /// The template as a link of a tube of several ones; `None` for a cap.
    pub link: Option<Link>,
}

/// Cache key: corner count and rotation, length exponent, cap flags, layers (count, bits of growth and thickness), bits of
/// the core factor.
type TemplateKey = ([u32; 2], i32, [bool; 2], Option<(u32, [u64; 2])>, u64);
/// Cached template; `None` if it cannot be made.
type CacheEntry = Arc<OnceLock<Option<Arc<Template>>>>;

static TEMPLATES: LazyLock<RwLock<FxHashMap<TemplateKey, CacheEntry>>> = LazyLock::new(RwLock::default);

/// Returns the template nearest to `length` radii for discs with this corner count, the second one rotated by a number of
/// corners. `caps` marks ends on the boundary of the whole mesh. Depends on ρ, core and layers of the parameters.
pub fn template(params: &BlockParams, corners: [u32; 2], length: f64, caps: [bool; 2]) -> Option<Arc<Template>> {
    let power = (libm::log(length) / libm::log(STEP)).round() as i32;
    let layers = params.layers.map(|layers| (layers.count, [layers.growth, layers.thickness].map(f64::to_bits)));
    let kept = slot((corners, power, caps, layers, params.core.to_bits()));
    kept.get_or_init(|| Template::best(params, corners, STEP.powi(power), caps).map(Arc::new)).clone()
}

fn slot(key: TemplateKey) -> CacheEntry {
    // A panicked thread leaves only complete entries.
    if let Some(kept) = TEMPLATES.read().unwrap_or_else(PoisonError::into_inner).get(&key) {
        return Arc::clone(kept);
    }
    Arc::clone(TEMPLATES.write().unwrap_or_else(PoisonError::into_inner).entry(key).or_default())
}

impl Template {
    /// Best template among the placements of inner points, optimized.
    fn best(params: &BlockParams, [corners, rotation]: [u32; 2], length: f64, caps: [bool; 2]) -> Option<Self> {
        let (y, x) = libm::sincos(TAU * f64::from(rotation) / f64::from(corners));
        let first = Section::new(Point3::origin(), Vec3::z(), 1.0);
        let last = Section { origin: Point3::new(0.0, 0.0, length), up: Some(Vec3::new(x, y, 0.0)), ..first };
        let cut = Cut { branch: BranchId(0), sides: Cut::NOWHERE, path: vec![first, last], size: None };
        let ends = FreeEnds::new(CutId(0), &cut, &BlockParams::with_rho(params.rho)).ok()?;
        if ends.discs[0].rim.len() != corners as usize {
            return None;
        }
        let tube = connector_surface(&cut.path, ends.both(), DIVISION).ok()?;
        let rings = Rings { corners, length, rows: tube.rings + 1, radius: 1.0, core: params.core };
        let inside = match &params.layers {
            None => TubeInterior::plain(&tube, |surface| core(surface, &rings), caps),
            Some(layers) => {
                let rings = Rings { radius: 1.0 - layers.thickness, ..rings };
                TubeInterior::layered(&tube, &cut.path, layers, |surface| core(surface, &rings))
            }
        };
        let TubeInterior { mesh, disc, ends, wall, layers } = inside.ok()??;
        let topology = Arc::new(Topology::of(&mesh, ends.iter().map(Vec::as_slice)).ok()?);
        let is_link = caps == [false; 2];
        let link = if is_link { Link::new(&PartView { mesh: &mesh, joints: &ends, caps: &[] }) } else { None };
        let TetMesh { mut points, tets } = mesh;
        let least = radius_ratios(&points, &tets[..layers]).fold(1.0, f64::min);
        for point in &mut points {
            point.z /= length;
        }
        Some(Self { points, disc, ends, wall, tets, rings: tube.rings, layers, least, topology, link })
    }
}

/// Filled straight tube with template numbering.
struct TubeInterior {
    mesh: TetMesh,
    disc: u32,
    ends: [Vec<[u32; 3]>; 2],
    wall: Vec<[u32; 3]>,
    layers: usize,
}

impl TubeInterior {
    fn plain(
        tube: &ConnectorSurface,
        core: impl Fn(&TriMesh) -> Result<TetMesh, TetError>,
        caps: [bool; 2],
    ) -> Result<Option<Self>, TetError> {
        let mut mesh = core(&tube.surface)?;
        if caps != [false; 2] {
            let of_disc = tube.end_triangles as usize / 2;
            split_corner_tets(&mut mesh, &tube.surface, |i| caps.get(i / of_disc).copied().unwrap_or(true));
        }
        let (ends, wall) = faces(tube);
        Ok(Some(Self { mesh, disc: tube.shared.len() as u32 / 2, ends, wall, layers: 0 }))
    }

    /// Tube with layers; `None` if they are thinner than requested.
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

/// Triangles of the two discs of a tube, and of its wall.
fn faces(tube: &ConnectorSurface) -> ([Vec<[u32; 3]>; 2], Vec<[u32; 3]>) {
    let (discs, wall) = tube.surface.triangles.split_at(tube.end_triangles as usize);
    let (first, second) = discs.split_at(discs.len() / 2);
    ([first.to_vec(), second.to_vec()], wall.to_vec())
}

/// Fills a tube with the best placement of inner points, and optimizes it.
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
    // A failed optimization leaves the mesh unchanged.
    let _ = optimize(&mut mesh, &OptimizeOptions { fixed_points: surface.points.len(), ..HARD });
    Ok(mesh)
}

/// Inner points of a tube along z, in rings around its axis.
struct Rings {
    /// Number of points in each ring of the wall.
    corners: u32,
    length: f64,
    /// Number of strips of the wall.
    rows: u32,
    radius: f64,
    /// Edge length on the axis relative to the wall; linear in between.
    core: f64,
}

impl Rings {
    /// Inner points in as many rows as the wall has strips. Each ring is rotated by half a step relative to the
    /// previous one. Radially adjacent layers are offset by half a row; `shift` selects if the outermost layer starts
    /// at the first row or half a row later.
    fn points(&self, shift: u32) -> Vec<Point3> {
        let Self { corners, length, rows, radius: wall, .. } = *self;
        // Between the axial edge length, which layers keep, and the circumferential one, which they shorten.
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
                points.extend(
                    (0..count).map(|i| Point3::new(radius * libm::cos(angle(i)), radius * libm::sin(angle(i)), z)),
                );
            }
        }
        points
    }

    /// Number of edges from axis to wall, which grow inwards, relative to uniform edges.
    fn steps(&self) -> f64 {
        if self.core == 1.0 { 1.0 } else { libm::log(self.core) / (self.core - 1.0) }
    }

    /// Fraction of the radius within a fraction of these edges.
    fn share(&self, of_steps: f64) -> f64 {
        if self.core == 1.0 {
            of_steps
        } else {
            self.core * (1.0 - libm::pow(self.core, -of_steps)) / (self.core - 1.0)
        }
    }
}

/// Mean radius ratio plus a tenth of the minimum.
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
