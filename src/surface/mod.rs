//! Wall of a vessel cluster (section 3.2.2 of the paper): the level set of a convolution field. It is contoured on a
//! sparse grid and relaxed into well-shaped triangles.

mod cap;
mod cases;
mod contour;
mod disc;
mod erf;
mod field;
mod graded;
pub(crate) mod halfedge;
mod params;
pub(crate) mod relax;
mod shared_disc;
mod sizes;
pub(crate) mod strip;
#[cfg(test)]
mod tests;

pub use cap::{CapError, CapFailure, CappedSurface, Closing, cap_terminals};
pub use field::Field;
pub(crate) use params::MAX_CELLS;
pub use params::{SurfaceError, SurfaceParams};
pub use shared_disc::SharedDisc;
pub use sizes::Finer;

use anastomesh_mesh::Kept;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::DisjointSets;
use anastomesh_mesh::geometry::{Point3, Tube, Vec3, place_key, point_segment};
use anastomesh_skeleton::cuttability::THIN;
use anastomesh_tet::parts::Watch;
use halfedge::HalfEdges;
use relax::Relaxation;
use rustc_hash::FxHashMap;

/// Returns the wall of the vessels `tubes`, at the radii of the tubes: a closed 2-manifold, oriented outwards.
///
/// # Errors
/// The tubes or the parameters are invalid, or the wall is too large, not resolved by the grid, or disconnected.
pub fn vessel_surface(tubes: &[Tube], params: &SurfaceParams) -> Result<TriMesh, SurfaceError> {
    vessel_wall(tubes, params, &Finer::default(), &Watch::NOBODY).map(|wall| wall.mesh)
}

/// A wall and its target edge lengths.
#[derive(Clone, Debug)]
pub struct SizedWall {
    /// Closed, oriented outwards.
    pub mesh: TriMesh,
    /// Target edge length at each vertex.
    pub sizes: Vec<f64>,
    /// Places where the target is shorter than the radius asks for.
    pub finer: Finer,
    /// Half-edge structure of the mesh.
    pub(crate) halves: HalfEdges,
}

/// Returns the wall like [`vessel_surface`], with its target edge lengths, which `finer` shortens locally.
///
/// # Errors
/// See [`vessel_surface`]; `Stopped` if the watch stops it.
pub fn vessel_wall(
    tubes: &[Tube],
    params: &SurfaceParams,
    finer: &Finer,
    watch: &Watch,
) -> Result<SizedWall, SurfaceError> {
    Contour::of(tubes, params, watch)?.relaxed(params, finer, watch)
}

/// Contour of vessels. It has the topology of their wall, as relaxation changes none.
pub struct Contour {
    mesh: TriMesh,
    field: Field,
}

impl Contour {
    /// Contours the field of tubes.
    ///
    /// # Errors
    /// See [`vessel_wall`].
    pub fn of(tubes: &[Tube], params: &SurfaceParams, watch: &Watch) -> Result<Self, SurfaceError> {
        check(params)?;
        let mut field = Field::new(tubes, params.kappa)?;
        let estimate = estimated_cells(tubes, params.voxel, params.follow);
        if estimate > params.max_cells as f64 {
            return Err(SurfaceError::TooLarge { cells: estimate, limit: params.max_cells });
        }
        let mesh = if is_graded(tubes, params.follow) {
            contour_graded(tubes, &mut field, params, watch)?
        } else {
            contour_field(tubes, &mut field, params, watch)?
        };
        Ok(Self { mesh, field })
    }

    /// Number of handles.
    pub fn handles(&self) -> i64 {
        1 - euler_characteristic(&self.mesh) / 2
    }

    /// Moves the triangles to the radius and improves their shape.
    ///
    /// # Errors
    /// See [`vessel_wall`].
    pub fn relaxed(self, params: &SurfaceParams, finer: &Finer, watch: &Watch) -> Result<SizedWall, SurfaceError> {
        let Self { mesh, mut field } = self;
        let mut surface = HalfEdges::new(&mesh).map_err(|edge| SurfaceError::NotManifold { edge })?;
        let sizes = sizes::wall_sizes(&surface, &mut field, params, finer);
        watch.spend(surface.points.len() + field.operations())?;
        let mut relaxation = Relaxation::new(&mut surface, &mut field, sizes, Vec::new(), *watch);
        relaxation.run((params.rounds + finer.rounds()) as usize)?;
        let sizes = relaxation.sizes;
        let (surface, map) = surface.compacted();
        let kept = sizes.into_iter().zip(map).filter(|(_, new)| *new != halfedge::NONE);
        let sizes = kept.map(|(size, _)| size).collect();
        let relaxed = surface.to_mesh().0;
        debug_assert_eq!(euler_characteristic(&relaxed), euler_characteristic(&mesh));
        Ok(SizedWall { mesh: relaxed, sizes, finer: finer.clone(), halves: surface })
    }
}

/// Euler characteristic `V − E + F` of a closed triangle surface: 2 per component, less 2 per handle.
pub fn euler_characteristic(mesh: &TriMesh) -> i64 {
    mesh.points.len() as i64 - mesh.triangles.len() as i64 / 2
}

fn check(params: &SurfaceParams) -> Result<(), SurfaceError> {
    let positive = [("voxel", params.voxel), ("edge", params.edge), ("thin", params.thin)];
    for (name, value) in positive {
        if !(value > 0.0 && value.is_finite()) {
            return Err(SurfaceError::InvalidParameter { name, value });
        }
    }
    if !(0.0..=1.0).contains(&params.follow) {
        return Err(SurfaceError::InvalidParameter { name: "follow", value: params.follow });
    }
    match params.shift.iter().find(|x| x.is_nan() || x.abs() > 1.0) {
        Some(&value) => Err(SurfaceError::InvalidParameter { name: "shift", value }),
        None => Ok(()),
    }
}

/// Estimates the number of cells that the wall crosses: 1.5 per cell face of its area. Cells have the side `voxel` at the thinnest
/// tube.
pub(crate) fn estimated_cells(tubes: &[Tube], voxel: f64, follow: f64) -> f64 {
    let thinnest = tubes.iter().map(Tube::min_radius).fold(f64::INFINITY, f64::min);
    let is_graded = is_graded(tubes, follow);
    let cells = |(t, length): (&Tube, f64)| {
        let wider = if is_graded { libm::pow(0.5 * (t.ra + t.rb) / thinnest, follow) } else { 1.0 };
        1.5 * std::f64::consts::PI * (t.ra + t.rb) * length / (voxel * wider).powi(2)
    };
    tubes.iter().zip(lengths_outside(tubes)).map(cells).sum()
}

/// Lengths of tubes, less their parts within much wider ones at their ends.
pub(crate) fn lengths_outside(tubes: &[Tube]) -> Vec<f64> {
    let ends = |t: &Tube| [(place_key(&t.a), t.ra), (place_key(&t.b), t.rb)];
    let mut widest = FxHashMap::default();
    for (place, radius) in tubes.iter().flat_map(ends) {
        let most: &mut f64 = widest.entry(place).or_insert(radius);
        *most = most.max(radius);
    }
    let within = |(place, radius)| if radius < THIN * widest[&place] { widest[&place] } else { 0.0 };
    tubes.iter().map(|t| (t.length() - ends(t).into_iter().map(within).sum::<f64>()).max(0.0)).collect()
}

/// Ratios of edge lengths for which the grid is graded. Coordinates have too few bits for more.
const GRADED: std::ops::Range<f64> = 1.0 / THIN..1.0001e8;

/// True if the grid is graded. `follow`: exponent of the growth of edges with the radius.
fn is_graded(tubes: &[Tube], follow: f64) -> bool {
    let thinnest = tubes.iter().map(Tube::min_radius).fold(f64::INFINITY, f64::min);
    let widest = tubes.iter().map(Tube::max_radius).fold(0.0, f64::max);
    GRADED.contains(&libm::pow(widest / thinnest, follow))
}

/// Contours the field on a graded grid and returns the outer surface around the tubes.
fn contour_graded(
    tubes: &[Tube],
    field: &mut Field,
    params: &SurfaceParams,
    watch: &Watch,
) -> Result<TriMesh, SurfaceError> {
    let mesh = graded::contour(tubes, field, params, watch)?;
    outer_component(mesh, |mesh, of, c| {
        let p = of.iter().position(|&other| other == c).map_or(Point3::origin(), |v| mesh.points[v]);
        let away = |t: &Tube| {
            let (share, distance) = point_segment(&p, &t.a, &t.b);
            distance - t.radius(share)
        };
        let nearest = (0..).zip(tubes).min_by(|(_, a), (_, b)| away(a).total_cmp(&away(b)));
        nearest.map_or(0, |(tube, _)| tube)
    })
}

/// Contours the field on the grid and returns the outer surface around the tubes. There must be exactly one.
fn contour_field(
    tubes: &[Tube],
    field: &mut Field,
    params: &SurfaceParams,
    watch: &Watch,
) -> Result<TriMesh, SurfaceError> {
    let grid = Grid::new(field, params)?;
    let mut seeds = Vec::with_capacity(2 * tubes.len());
    let mut owners = Vec::with_capacity(2 * tubes.len());
    for (i, tube) in tubes.iter().enumerate() {
        if tube.length() > 0.0 {
            let found = grid.seeds(field, tube);
            watch.spend(field.operations())?;
            let found = found.ok_or(SurfaceError::Unresolved { tube: i as u32, voxel: params.voxel })?;
            seeds.extend(found);
            owners.extend([i as u32; 2]);
        }
    }
    let sampled = SampledField { field, grid: &grid };
    let (mut mesh, at_seeds) = contour::contour(&seeds, params.max_cells, sampled, watch)?;
    for p in &mut mesh.points {
        *p = grid.origin + p.coords * grid.voxel;
    }
    outer_component(mesh, |_, of, c| at_seeds.iter().position(|&v| of[v as usize] == c).map_or(0, |i| owners[i]))
}

/// Keeps the only component with outward orientation; drops voids inside the vessels. `owner`: tube of a component, from the mesh
/// and the component of each vertex.
fn outer_component(mesh: TriMesh, owner: impl Fn(&TriMesh, &[u32], u32) -> u32) -> Result<TriMesh, SurfaceError> {
    let component = components(&mesh);
    let count = component.iter().max().map_or(0, |&c| c as usize + 1);
    if count == 1 {
        return Ok(mesh);
    }
    let mut volume = vec![0.0; count];
    let Some(&reference) = mesh.points.first() else { return Err(SurfaceError::Empty) };
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.points[v as usize] - reference);
        volume[component[t[0] as usize] as usize] += a.dot(&b.cross(&c));
    }
    let outer: Vec<u32> = (0..count as u32).filter(|&c| volume[c as usize] > 0.0).collect();
    let owner = |c: u32| owner(&mesh, &component, c);
    match outer[..] {
        [] => Err(SurfaceError::Empty),
        [one] => Ok(restricted(&mesh, &component, one)),
        [a, b, ..] => Err(SurfaceError::Disconnected { components: outer.len() as u32, tubes: [owner(a), owner(b)] }),
    }
}

/// Component of each vertex, numbered by first vertex.
fn components(mesh: &TriMesh) -> Vec<u32> {
    let mut sets = DisjointSets::new(mesh.points.len());
    for &[a, b, c] in &mesh.triangles {
        sets.join(a, b);
        sets.join(a, c);
    }
    sets.numbered()
}

fn restricted(mesh: &TriMesh, component: &[u32], keep: u32) -> TriMesh {
    let kept = Kept::of(component.iter().map(|&c| c == keep));
    let triangles = mesh.triangles.iter().filter(|t| component[t[0] as usize] == keep);
    TriMesh { points: kept.select(&mesh.points), triangles: triangles.map(|t| kept.cell(t)).collect() }
}

/// Field on the nodes of a grid, shifted so that the wall is its zero level.
struct SampledField<'a> {
    field: &'a mut Field,
    grid: &'a Grid,
}

impl contour::Sampled for SampledField<'_> {
    #[inline]
    fn value(&mut self, n: contour::Node) -> f64 {
        self.field.value(&self.grid.point(n)) - 1.0
    }

    fn operations(&mut self) -> usize {
        self.field.operations()
    }
}

/// Sampling grid of the field.
struct Grid {
    origin: Point3,
    voxel: f64,
}

impl Grid {
    fn new(field: &Field, params: &SurfaceParams) -> Result<Self, SurfaceError> {
        let (lo, hi) = field.bounds();
        let cells = (hi - lo).amax() / params.voxel;
        if cells >= f64::from(contour::MAX_COORDINATE) {
            return Err(SurfaceError::TooLarge { cells, limit: contour::MAX_COORDINATE as usize });
        }
        let origin = nalgebra::center(&lo, &hi) + Vec3::from(params.shift) * params.voxel;
        Ok(Self { origin, voxel: params.voxel })
    }

    fn point(&self, n: contour::Node) -> Point3 {
        self.origin + Vec3::new(f64::from(n[0]), f64::from(n[1]), f64::from(n[2])) * self.voxel
    }

    /// Cells in which a grid line through the middle of the tube, across it, leaves the vessels on either side. Returns
    /// `None` if no node near the middle is inside.
    fn seeds(&self, field: &mut Field, tube: &Tube) -> Option<[contour::Node; 2]> {
        let at = (tube.point(0.5) - self.origin) / self.voxel;
        let low: contour::Node = std::array::from_fn(|i| at[i].floor() as i32);
        let mut corners: [contour::Node; 8] =
            std::array::from_fn(|c| std::array::from_fn(|i| low[i] + (c >> i & 1) as i32));
        let distance = |n: &contour::Node| (0..3).map(|i| (f64::from(n[i]) - at[i]).powi(2)).sum::<f64>();
        corners.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        let start = *corners.iter().find(|&&n| field.value(&self.point(n)) < 1.0)?;
        let axis = (tube.b - tube.a).iamin();
        let mut march = |step: i32| {
            let mut n = start;
            // Terminates because the field ends within its bounds.
            loop {
                let mut m = n;
                m[axis] += step;
                if field.value(&self.point(m)) >= 1.0 {
                    return if step > 0 { n } else { m };
                }
                n = m;
            }
        };
        Some([march(1), march(-1)])
    }
}
