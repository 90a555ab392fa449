//! Blocks with boundary layers along their wall.
//!
//! Shared discs contain the layers as rings, derived from the vessel alone: the interior of the disc is scaled towards
//! its centre. Caps are treated likewise. Elsewhere the layer thickness is proportional to the local radius, the
//! distance to the nearest axis.

use super::params::BlockParams;
use crate::surface::SharedDisc;
use anastomesh_mesh::geometry::{Point3, Section, point_segment};
use anastomesh_mesh::{TetMesh, TriMesh};
use anastomesh_tet::Layers;
use anastomesh_tet::TetError;
use anastomesh_tet::parts::{Directions, Inset, Numbers, Places, inset, rims, toward};
use std::ops::Range;

/// Relative thickness below which layers are reported as thin: curved walls and bifurcations reduce it.
const THIN: f64 = 0.5;

/// Report of layers that are thinner than requested.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ThinLayers {
    /// Minimum thickness relative to the request; 0 if a point has no layers.
    pub share: f64,
    /// Position of the minimum.
    pub at: [f64; 3],
    /// Number of wall points with less than half the requested thickness, including those without layers.
    pub points: u32,
    /// Number of wall points without layers.
    pub without: u32,
}

/// Disc at the end of the vessel piece on one `side` of a cut (see [`SharedDisc::at_end`]), with the requested layers.
pub(super) fn disc_at_end(outward: &Section, side: u8, params: &BlockParams) -> Option<SharedDisc> {
    let plain = SharedDisc::at_end(outward, side, params.rho)?;
    Some(match params.layers {
        Some(layers) => layered_disc(plain, &outward.origin, &layers),
        None => plain,
    })
}

/// Disc with rings along its rim: points with a scaled interior, then the copies of each rim point.
fn layered_disc(disc: SharedDisc, centre: &Point3, layers: &Layers) -> SharedDisc {
    let SharedDisc { points, triangles, rim, edge } = disc;
    let mut is_rim = vec![false; points.len()];
    for &v in &rim {
        is_rim[v as usize] = true;
    }
    let inner: Vec<Point3> = points.iter().map(|p| toward(p, centre, layers.thickness)).collect();
    let numbers = Numbers::new(is_rim.clone(), is_rim, layers.count);
    let points = numbers.points(&points, &inner, &layers.depths());
    SharedDisc { points, triangles: numbers.disc(&triangles), rim, edge }
}

/// Closed surface of a block, with the data for its layers.
pub(super) struct Walled<'a> {
    pub surface: &'a TriMesh,
    /// Centre of the cap or disc of each triangle; `None` for the wall.
    pub caps: Vec<Option<Point3>>,
    /// Axes of the block's vessels.
    pub axes: Vec<[Point3; 2]>,
}

impl Walled<'_> {
    /// Fills the block with layers along its wall.
    pub fn fill(
        &self,
        layers: &Layers,
        fill: impl FnMut(&TriMesh) -> Result<TetMesh, TetError>,
    ) -> Result<(Inset, Option<ThinLayers>), TetError> {
        let TriMesh { points, triangles } = self.surface;
        let is_wall = |i: usize| self.caps[i].is_none();
        let wall: Vec<[u32; 3]> = (0..triangles.len()).filter(|&i| is_wall(i)).map(|i| triangles[i]).collect();
        let mut centres: Vec<Option<Point3>> = vec![None; points.len()];
        for (triangle, cap) in triangles.iter().zip(&self.caps).filter(|(_, cap)| cap.is_some()) {
            for &v in triangle {
                centres[v as usize] = *cap;
            }
        }
        let is_held: Vec<bool> = centres.iter().map(Option::is_some).collect();
        let mut ways = Directions::new(points, &wall);
        for (way, (p, centre)) in ways.ways.iter_mut().zip(points.iter().zip(&centres)) {
            if let Some(centre) = centre {
                *way = (centre - p).try_normalize(0.0).unwrap_or_default();
            }
        }
        ways.smooth(&wall, &is_held);
        let wanted = |((p, way), centre): ((&Point3, _), &Option<Point3>)| match centre {
            Some(centre) => toward(p, centre, layers.thickness),
            None => p + way * (layers.thickness * self.radius(p)),
        };
        let wanted = points.iter().zip(&ways.ways).zip(&centres).map(wanted).collect();
        let is_rim = rims(self.surface, is_wall);
        let places = Places { surface: self.surface, wall: &wall, is_rim, wanted, is_held, is_narrow: false };
        let made = inset(&places, &layers.depths(), fill)?;
        let mut shares = made.shares.clone();
        // Includes points without an inward direction.
        wall.iter().flatten().filter(|&&v| made.numbers.copy(v, 1) == v).for_each(|&v| shares[v as usize] = 0.0);
        let thin = thin(points, &shares);
        Ok((made, thin))
    }

    /// Distance to the nearest axis.
    fn radius(&self, p: &Point3) -> f64 {
        self.axes.iter().map(|[a, b]| point_segment(p, a, b).1).fold(f64::INFINITY, f64::min)
    }
}

/// Renumbers the points of a tube's mesh so that those of its two discs come first. `plain` are the disc points without
/// their copies. Returns the point count of each disc, and the new number of each point.
pub(super) fn discs_first(
    numbers: &Numbers,
    plain: [Range<u32>; 2],
    layers: u32,
    points: usize,
) -> ([u32; 2], Vec<u32>) {
    let mut order: Vec<u32> = Vec::with_capacity(points);
    let counts = plain.map(|range| {
        let before = order.len();
        order.extend(range.clone());
        let copies = |v: u32| (1..=layers).map(move |layer| numbers.copy(v, layer)).filter(move |&copy| copy != v);
        order.extend(range.flat_map(copies));
        (order.len() - before) as u32
    });
    let mut renamed = vec![u32::MAX; points];
    for (new, &old) in (0..).zip(&order) {
        renamed[old as usize] = new;
    }
    let others = renamed.iter_mut().filter(|name| **name == u32::MAX);
    others.zip(order.len() as u32..).for_each(|(name, new)| *name = new);
    (counts, renamed)
}

/// Applies a renumbering of points to a mesh.
pub(super) fn renumbered(mesh: TetMesh, renamed: &[u32]) -> TetMesh {
    let TetMesh { points, tets } = mesh;
    let mut moved = points.clone();
    for (p, &new) in points.into_iter().zip(renamed) {
        moved[new as usize] = p;
    }
    TetMesh { points: moved, tets: tets.into_iter().map(|tet| tet.map(|v| renamed[v as usize])).collect() }
}

/// Report of thin layers; `None` if all have the requested thickness.
fn thin(points: &[Point3], shares: &[f64]) -> Option<ThinLayers> {
    let (at, &share) =
        shares.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).filter(|(_, share)| **share < THIN)?;
    let below = |most: f64| shares.iter().filter(|share| **share <= most).count() as u32;
    Some(ThinLayers { share, at: points[at].coords.into(), points: below(THIN), without: below(0.0) })
}
