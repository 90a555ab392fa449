//! Shape of a fork, and its cell.

use crate::partition::{Cluster, ClusterEnd, CutId, EndKind, ForkCells};
use anastomesh_mesh::geometry::{Point3, Section, Tube, Vec3};
use anastomesh_skeleton::NodeId;
use std::f64::consts::TAU;

/// Size of a cell.
#[derive(Clone, Copy)]
struct Steps {
    /// In radians.
    azimuth: f64,
    height: f64,
    /// Of the logarithms of radii and lengths.
    radius: f64,
    length: f64,
}

const FINE: Steps = Steps { azimuth: TAU / 18.0, height: 0.3, radius: 0.25, length: 0.3 };
const COARSE: Steps = Steps { azimuth: TAU / 12.0, height: 0.4, radius: 0.4, length: 0.45 };
/// Length of a vessel in the middle of a cell, in radii: about the distance of most cuts.
const USUAL_LENGTH: f64 = 2.2;
/// Largest sine of the angle between the axis of a vessel at its cut and its chord.
const STRAIGHT: f64 = 1e-3;

/// Side of a terminal.
pub const TIP: u8 = 2;

/// Vessel of a fork, from its node to its cut or terminal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Unit vector from the node.
    pub axis: Vec3,
    /// Frame of the end: two unit vectors that form a right-handed system with the axis.
    pub frame: [Vec3; 2],
    /// Length up to the end.
    pub length: f64,
    /// Radii at the node and at the end.
    pub radii: [f64; 2],
    /// Side of the cut, or [`TIP`].
    pub side: u8,
    /// Index of the end in the cluster.
    pub end: u32,
}

/// Bifurcation of three straight vessels up to their cuts or terminals.
#[derive(Clone, Debug, PartialEq)]
pub struct Fork {
    pub node: Point3,
    /// Largest radius at the node, the unit of lengths of the canonical fork.
    pub radius: f64,
    /// Vessels: terminal ones first, then those that end at the node, each by radius.
    pub limbs: [Limb; 3],
}

/// Number of coordinates of a shape.
const PLACES: usize = 12;

/// Cell of similar forks: sides of the ends, and steps of the coordinates ([`Fork::places`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Cell {
    is_coarse: bool,
    sides: [u8; 3],
    steps: [i8; PLACES],
}

impl Fork {
    /// Shape of a cluster; `None` if it is no fork of straight vessels whose frames are normal to its plane.
    pub fn of(cluster: &Cluster) -> Option<Self> {
        let [_, _, _] = cluster.ends.as_slice() else { return None };
        if cluster.tubes.len() != 6 {
            return None;
        }
        let up = cluster.ends.iter().find_map(|end| end.section.up);
        let mut node = None;
        let mut limbs = Vec::with_capacity(3);
        for (end, index) in cluster.ends.iter().zip(0..) {
            let side = match end.kind {
                EndKind::Cut { side, .. } if end.section.up == up => side,
                EndKind::Cut { .. } => return None,
                EndKind::Terminal(_) => TIP,
            };
            let (from, radii) = vessel(cluster, end)?;
            if *node.get_or_insert(from) != from {
                return None;
            }
            let chord = end.section.origin - from;
            let length = chord.norm();
            let (u, w) = Section { up: Some(up?), ..end.section }.frame();
            if !(length > 0.0 && chord.cross(&end.section.axis).norm() <= STRAIGHT * length) {
                return None;
            }
            limbs.push(Limb { axis: end.section.axis, frame: [u, w], length, radii, side, end: index });
        }
        limbs.sort_by(|a, b| b.side.cmp(&a.side).then(b.radii[1].total_cmp(&a.radii[1])));
        let radius = limbs.iter().map(|limb| limb.radii[0]).fold(0.0, f64::max);
        Some(Self { node: node?, radius, limbs: limbs.try_into().ok()? })
    }

    /// Normal of the plane of the fork, on the side of the frames.
    fn normal(&self) -> Option<Vec3> {
        let [a, b, c] = self.limbs.map(|limb| limb.axis);
        let normal = (a - c).cross(&(b - c)).try_normalize(0.0)?;
        Some(if normal.dot(&self.limbs[0].frame[0]) < 0.0 { -normal } else { normal })
    }

    /// Coordinates of the shape in steps of a cell: height and two azimuths, then radius at the node, taper and length of each
    /// vessel.
    fn places(&self, steps: Steps) -> Option<[f64; PLACES]> {
        let normal = self.normal()?;
        let across = self.limbs.map(|limb| limb.axis - normal * normal.dot(&limb.axis));
        let azimuth = |limb: usize| {
            let (x, y) = (across[0].dot(&across[limb]), normal.dot(&across[0].cross(&across[limb])));
            libm::atan2(y, x) / steps.azimuth
        };
        let radius = |[r, of]: [f64; 2]| libm::log(r / of) / steps.radius;
        let mut places = [0.0; PLACES];
        places[..3].copy_from_slice(&[normal.dot(&self.limbs[0].axis) / steps.height, azimuth(1), azimuth(2)]);
        for (limb, places) in self.limbs.iter().zip(places[3..].chunks_mut(3)) {
            let length = libm::log(limb.length / (USUAL_LENGTH * limb.radii[1])) / steps.length;
            let [near, far] = limb.radii;
            places.copy_from_slice(&[radius([near, self.radius]), radius([far, near]), length]);
        }
        Some(places)
    }

    /// Cell of a fork; `None` if a step is out of range.
    pub fn cell(&self, cells: ForkCells) -> Option<Cell> {
        let (is_coarse, rank) = match cells {
            ForkCells::None => return None,
            ForkCells::Fine(rank) => (false, rank),
            ForkCells::Coarse(rank) => (true, rank),
        };
        let places = self.places(steps(is_coarse))?;
        let away = rounded_away(&places, rank);
        let mut cell = Cell { is_coarse, sides: self.limbs.map(|limb| limb.side), steps: [0; PLACES] };
        for (i, (step, place)) in cell.steps.iter_mut().zip(places).enumerate() {
            let nearest = place.round();
            let next = if place < nearest { nearest - 1.0 } else { nearest + 1.0 };
            let chosen = if away >> i & 1 == 1 { next } else { nearest };
            *step = (chosen.abs() <= 100.0).then_some(chosen as i8)?;
        }
        Some(cell)
    }
}

/// Set of coordinates, as bits, that are rounded to the next step instead of the nearest one. Sets are ranked by the sum of
/// the further distances.
fn rounded_away(places: &[f64; PLACES], rank: u8) -> u16 {
    let further = |i: usize| (1.0 - 2.0 * (places[i] - places[i].round()).abs(), i);
    let mut costs: [(f64, usize); PLACES] = std::array::from_fn(further);
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Sets that may be next: sum, the last term, and the terms as bits. Each comes from a set with a smaller sum, with the
    // next term beside the last one or in its place.
    let mut open = vec![(costs[0].0, 0, 1_u16)];
    let mut found = 0;
    for _ in 0..rank {
        let Some(least) = (0..open.len()).min_by(|&a, &b| open[a].0.total_cmp(&open[b].0)) else { break };
        let (sum, last, terms) = open.swap_remove(least);
        if let Some(&(cost, _)) = costs.get(last + 1) {
            open.push((sum + cost, last + 1, terms | 1 << (last + 1)));
            open.push((sum + cost - costs[last].0, last + 1, terms & !(1 << last) | 1 << (last + 1)));
        }
        found = terms;
    }
    (0..PLACES).filter(|i| found >> i & 1 == 1).fold(0, |bits, i| bits | 1 << costs[i].1)
}

/// Start and radii of the vessel that ends at a cut, if it is one tube.
fn vessel(cluster: &Cluster, end: &ClusterEnd) -> Option<(Point3, [f64; 2])> {
    let at = end.section.origin;
    let is_vessel = |(i, tube): &(u32, &Tube)| *i != end.overrun && (tube.a == at || tube.b == at);
    let mut vessels = (0..).zip(&cluster.tubes).filter(is_vessel);
    let (_, tube) = vessels.next()?;
    if vessels.next().is_some() {
        return None;
    }
    Some(if tube.b == at { (tube.a, [tube.ra, tube.rb]) } else { (tube.b, [tube.rb, tube.ra]) })
}

impl Cell {
    /// Fork in the middle of the cell, with its node at the origin and radius 1, as a cluster. `overrun`: length of the
    /// extension beyond a cut, in radii. `stretch`: factor of all lengths.
    pub fn cluster(&self, overrun: f64, stretch: f64) -> Cluster {
        let steps = steps(self.is_coarse);
        let place = |i: usize| f64::from(self.steps[i]);
        let height = (steps.height * place(0)).clamp(-0.9, 0.9);
        let across = (1.0 - height * height).sqrt();
        let mut cluster = Cluster::default();
        for i in 0..3 {
            let azimuth = if i == 0 { 0.0 } else { steps.azimuth * place(i) };
            let (y, x) = libm::sincos(azimuth);
            let axis = Vec3::new(across * x, across * y, height);
            let [radius, taper, length] = [0, 1, 2].map(|k| place(3 + 3 * i + k));
            let [from, to] = [radius, radius + taper].map(|place| libm::exp(steps.radius * place));
            let length = stretch * USUAL_LENGTH * to * libm::exp(steps.length * length);
            let at = Point3::from(axis * length);
            let index = cluster.tubes.len() as u32 + 1;
            cluster.tubes.push(Tube { a: Point3::origin(), b: at, ra: from, rb: to });
            cluster.tubes.push(Tube { a: at, b: at + axis * (overrun * to), ra: to, rb: to });
            let section = Section { up: Some(Vec3::z()), ..Section::new(at, axis, to) };
            let kind = match self.sides[i] {
                TIP => EndKind::Terminal(NodeId(i as u32)),
                side => EndKind::Cut { cut: CutId(i as u32), side },
            };
            cluster.ends.push(ClusterEnd { section, kind, overrun: index });
        }
        cluster
    }
}

fn steps(is_coarse: bool) -> Steps {
    if is_coarse { COARSE } else { FINE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_ranked_by_distance() {
        let places: [f64; PLACES] = std::array::from_fn(|i| 0.37 * i as f64 - 2.0);
        let further = |bits: u16| -> f64 {
            let cost = |i: usize| 1.0 - 2.0 * (places[i] - places[i].round()).abs();
            (0..PLACES).filter(|i| bits >> i & 1 == 1).map(cost).sum()
        };
        let found: Vec<u16> = (0..=255).map(|rank| rounded_away(&places, rank)).collect();
        // No set that is missing has a smaller distance than the last one.
        let mut nearest: Vec<f64> = (0..1 << PLACES).map(further).collect();
        nearest.sort_by(f64::total_cmp);
        for (bits, distance) in found.iter().zip(nearest) {
            assert!((further(*bits) - distance).abs() < 1e-9, "{bits:b}");
        }
        let mut distinct = found.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!((distinct.len(), found[0]), (found.len(), 0));
    }
}
