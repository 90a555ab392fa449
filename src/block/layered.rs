//! Blocks with layers along their wall.
//!
//! The discs in which blocks meet have the layers as rings, by the vessel alone, as all of the disc: what lies within the rim is
//! drawn towards the centre. So are caps. Elsewhere layers are as thick as the radius there has it, the distance to the nearest
//! axis.

use super::params::BlockParams;
use crate::surface::SharedDisc;
use anastomesh_mesh::geometry::{Point3, Section, point_segment};
use anastomesh_mesh::{TetMesh, TriMesh};
use anastomesh_tet::Layers;
use anastomesh_tet::TetError;
use anastomesh_tet::parts::{Directions, Inset, Numbers, Places, inset, rims, toward};
use std::ops::Range;

/// Layers are called thin below this share of what was asked for: curved walls and forks take some.
const THIN: f64 = 0.5;

/// Where layers of a block are thinner than asked for.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ThinLayers {
    /// How thick they are at the thinnest place, as a share of what was asked for; 0 where there are none.
    pub share: f64,
    /// Where that is.
    pub at: [f64; 3],
    /// Points of the wall where they are less than half as thick as asked for, those where there are none included.
    pub points: u32,
    /// Points of the wall where there are none.
    pub without: u32,
}

/// The disc that ends the piece of a vessel on one `side` of a cut (see [`SharedDisc::at_end`]), with the layers that are asked
/// for.
pub(super) fn disc_at_end(outward: &Section, side: u8, params: &BlockParams) -> Option<SharedDisc> {
    let plain = SharedDisc::at_end(outward, side, params.rho)?;
    Some(match params.layers {
        Some(layers) => layered_disc(plain, &outward.origin, &layers),
        None => plain,
    })
}

/// A disc with rings along its rim: its points, those within the rim drawn in; then for each of the rim its copies.
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

/// A block's closed surface, and what its layers depend on.
pub(super) struct Walled<'a> {
    pub surface: &'a TriMesh,
    /// For each triangle the centre of the cap or disc that it belongs to; none for the wall.
    pub caps: Vec<Option<Point3>>,
    /// The axes of its vessels.
    pub axes: Vec<[Point3; 2]>,
}

impl Walled<'_> {
    /// Fills it with layers along its wall.
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
        // Those without a way in, too.
        wall.iter().flatten().filter(|&&v| made.numbers.copy(v, 1) == v).for_each(|&v| shares[v as usize] = 0.0);
        let thin = thin(points, &shares);
        Ok((made, thin))
    }

    /// Distance to the nearest axis.
    fn radius(&self, p: &Point3) -> f64 {
        self.axes.iter().map(|[a, b]| point_segment(p, a, b).1).fold(f64::INFINITY, f64::min)
    }
}

/// New numbers for the points of a tube's mesh, so that those of its two discs come first, one disc after the other. `plain`:
/// where points of the discs are without their copies. How many each disc has, and the new number of each point.
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

/// A mesh with its points under new numbers.
pub(super) fn renumbered(mesh: TetMesh, renamed: &[u32]) -> TetMesh {
    let TetMesh { points, tets } = mesh;
    let mut moved = points.clone();
    for (p, &new) in points.into_iter().zip(renamed) {
        moved[new as usize] = p;
    }
    TetMesh { points: moved, tets: tets.into_iter().map(|tet| tet.map(|v| renamed[v as usize])).collect() }
}

/// Where layers are thin; none where they are as asked for everywhere.
fn thin(points: &[Point3], shares: &[f64]) -> Option<ThinLayers> {
    let (at, &share) =
        shares.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).filter(|(_, share)| **share < THIN)?;
    let below = |most: f64| shares.iter().filter(|share| **share <= most).count() as u32;
    Some(ThinLayers { share, at: points[at].coords.into(), points: below(THIN), without: below(0.0) })
}
