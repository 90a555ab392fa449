//! Shape of a fork or of a bend, and its cell.

use crate::partition::{Cluster, ClusterEnd, CutId, EndKind, FORK_PLACES, ForkCell};
use anastomesh_mesh::geometry::{Point3, Section, Tube, Vec3};
use anastomesh_skeleton::NodeId;
use std::f64::consts::TAU;

/// Size of a cell: steps in a turn, of the height, and of the logarithms of radii and lengths.
const TURN: f64 = 18.0;
const HEIGHT: f64 = 0.3;
const RADIUS: f64 = 0.25;
const LENGTH: f64 = 0.3;
/// Length of a vessel in the middle of a cell, in radii: about the distance of most cuts.
const USUAL_LENGTH: f64 = 2.2;
/// Largest sine of the angle between the axis of a vessel at its cut and its chord.
const STRAIGHT: f64 = 1e-3;

/// Coordinates of a shape that are azimuths.
const AZIMUTHS: std::ops::Range<usize> = 1..3;

/// Side of a terminal.
pub const TIP: u8 = 2;
/// Side of the third vessel of a bend, which has two.
const NONE: u8 = 3;
/// Largest number of vessels.
pub const LIMBS: usize = 3;

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

/// Bifurcation of three straight vessels, or bend of two, up to their cuts or terminals.
#[derive(Clone, Debug, PartialEq)]
pub struct Fork {
    pub node: Point3,
    /// Largest radius at the node, the unit of lengths of the canonical fork.
    pub radius: f64,
    /// Vessels: terminal ones first, then those that end at the node, each by radius.
    pub limbs: Vec<Limb>,
}

/// Shape of a fork.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Sides of the ends of the vessels.
    pub sides: [u8; LIMBS],
    /// Coordinates in steps of a cell.
    places: [f32; FORK_PLACES],
}

impl Shape {
    /// Cell that it is in; `None` if a step is out of range.
    pub fn cell(&self) -> Option<ForkCell> {
        let Self { sides, places } = *self;
        let is_in_range = places.iter().all(|place| place.abs() <= 100.0);
        let mut steps = places.map(|place| place.round() as i8);
        // Half a turn has two names.
        let half = (TURN / 2.0) as i8;
        steps[AZIMUTHS].iter_mut().filter(|step| **step == -half).for_each(|step| *step = half);
        is_in_range.then_some(ForkCell { sides, steps })
    }

    /// Leading steps of the cells whose middle may be within a distance.
    pub fn leading(&self, most: f32) -> Vec<[i8; 3]> {
        let near = |place: f32| (place - most).ceil() as i8..=(place + most).floor() as i8;
        let half = (TURN / 2.0) as i8;
        let turned = |step: i8| {
            if step > half {
                step - 2 * half
            } else if step <= -half {
                step + 2 * half
            } else {
                step
            }
        };
        let [height, first, second] = [0, 1, 2].map(|i| near(self.places[i]));
        let mut leading = Vec::new();
        for h in height {
            for a in first.clone() {
                leading.extend(second.clone().map(|b| [h, turned(a), turned(b)]));
            }
        }
        leading
    }

    /// Square of the distance from the middle of a cell, in steps; `None` if it is larger than `most`.
    pub fn distance(&self, cell: &ForkCell, most: f32) -> Option<f32> {
        let mut sum = 0.0;
        for (i, (place, &step)) in self.places.iter().zip(&cell.steps).enumerate() {
            let along = (place - f32::from(step)).abs();
            let along = if AZIMUTHS.contains(&i) { along.min(TURN as f32 - along) } else { along };
            sum += along * along;
            if sum > most * most {
                return None;
            }
        }
        Some(sum)
    }
}

impl Fork {
    /// Shape of a cluster; `None` if it is no fork or bend of straight vessels whose frames are normal to its plane.
    pub fn of(cluster: &Cluster) -> Option<Self> {
        let ends = cluster.ends.len();
        if !(2..=LIMBS).contains(&ends) || cluster.tubes.len() != 2 * ends {
            return None;
        }
        let up = cluster.ends.iter().find_map(|end| end.section.up);
        let mut node = None;
        let mut limbs = Vec::with_capacity(ends);
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
        let fork = Self { node: node?, radius, limbs };
        // The frames of a straight vessel may be those of a bifurcation at its other end.
        let is_along = |limb: &Limb| up.is_some_and(|up| limb.axis.dot(&up).abs() <= STRAIGHT * up.norm());
        (ends > 2 || fork.limbs.iter().all(is_along)).then_some(fork)
    }

    /// Normal of the plane of the fork, on the side of the frames.
    fn normal(&self) -> Option<Vec3> {
        let c = self.limbs.get(2).map_or(Vec3::zeros(), |limb| limb.axis);
        let [a, b] = [0, 1].map(|i| self.limbs[i].axis);
        let normal = (a - c).cross(&(b - c)).try_normalize(0.0)?;
        Some(if normal.dot(&self.limbs[0].frame[0]) < 0.0 { -normal } else { normal })
    }

    /// Shape, with its coordinates in steps of a cell: height and two azimuths, then radius at the node, taper and length of each
    /// vessel. Lengths are divided by `stretch`.
    pub fn shape(&self, stretch: f64) -> Option<Shape> {
        let normal = self.normal()?;
        let across = |limb: &Limb| limb.axis - normal * normal.dot(&limb.axis);
        let first = across(&self.limbs[0]);
        let azimuth = |limb: &Limb| {
            let other = across(limb);
            libm::atan2(normal.dot(&first.cross(&other)), first.dot(&other)) * TURN / TAU
        };
        let radius = |[r, of]: [f64; 2]| libm::log(r / of) / RADIUS;
        let mut places = [0.0; FORK_PLACES];
        places[0] = normal.dot(&self.limbs[0].axis) / HEIGHT;
        for (limb, place) in self.limbs[1..].iter().zip(&mut places[AZIMUTHS]) {
            *place = azimuth(limb);
        }
        for (limb, places) in self.limbs.iter().zip(places[3..].chunks_mut(3)) {
            let length = libm::log(limb.length / (stretch * USUAL_LENGTH * limb.radii[1])) / LENGTH;
            let [near, far] = limb.radii;
            places.copy_from_slice(&[radius([near, self.radius]), radius([far, near]), length]);
        }
        let sides = std::array::from_fn(|i| self.limbs.get(i).map_or(NONE, |limb| limb.side));
        Some(Shape { sides, places: places.map(|place| place as f32) })
    }
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

/// Fork in the middle of a cell, with its node at the origin and radius 1, as a cluster. `overrun`: length of the extension
/// beyond a cut, in radii. `stretch`: factor of all lengths.
pub fn middle(cell: &ForkCell, overrun: f64, stretch: f64) -> Cluster {
    let place = |i: usize| f64::from(cell.steps[i]);
    let height = (HEIGHT * place(0)).clamp(-0.9, 0.9);
    let across = (1.0 - height * height).sqrt();
    let mut cluster = Cluster::default();
    for (i, side) in cell.sides.into_iter().enumerate().filter(|(_, side)| *side != NONE) {
        let azimuth = if i == 0 { 0.0 } else { TAU / TURN * place(i) };
        let (y, x) = libm::sincos(azimuth);
        let axis = Vec3::new(across * x, across * y, height);
        let [radius, taper, length] = [0, 1, 2].map(|k| place(3 + 3 * i + k));
        let [from, to] = [radius, radius + taper].map(|place| libm::exp(RADIUS * place));
        let length = stretch * USUAL_LENGTH * to * libm::exp(LENGTH * length);
        let at = Point3::from(axis * length);
        let index = cluster.tubes.len() as u32 + 1;
        cluster.tubes.push(Tube { a: Point3::origin(), b: at, ra: from, rb: to });
        cluster.tubes.push(Tube { a: at, b: at + axis * (overrun * to), ra: to, rb: to });
        let section = Section { up: Some(Vec3::z()), ..Section::new(at, axis, to) };
        let kind = match side {
            TIP => EndKind::Terminal(NodeId(i as u32)),
            side => EndKind::Cut { cut: CutId(i as u32), side },
        };
        cluster.ends.push(ClusterEnd { section, kind, overrun: index });
    }
    cluster
}
