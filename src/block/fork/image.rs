//! Image of a canonical fork.

use super::canonical::Canonical;
use super::crotch::{Shifts, crotches};
use super::shape::{Fork, LIMBS, Limb, TIP};
use crate::block::hull::{Triangles, hull};
use crate::block::layered::disc_at_end;
use crate::block::params::BlockParams;
use crate::block::topology::Topology;
use crate::partition::Cluster;
use crate::surface::Field;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::{all_have_ratio, dihedral_range, has_ratio};
use anastomesh_tet::Effort;
use anastomesh_tet::parts::{OptimizeOptions, optimize};
use std::sync::Arc;

/// Decrease of a limb's weight per length of the limb.
const SHARPNESS: f64 = 6.0;
/// Decrease of a limb's score per radius of distance from its axis, beyond a distance in radii.
const ASIDE: f64 = 0.5;
const FREE: f64 = 1.25;
/// Newton steps of a point of the wall, its largest deviation from its level after them, and its largest displacement in
/// radii.
const STEPS: usize = 6;
const OFF_LEVEL: f64 = 2e-3;
const FAR: f64 = 0.5;
/// Maximum stretch. With a larger one, more images have poor tetrahedra in the crotch, and few are saved.
const STRETCH: f64 = 1.25;
/// Minimum radius ratio of an image's tetrahedra, and their minimum dihedral angle in degrees.
const LEAST: f64 = 0.3;
const LEAST_ANGLE: f64 = 16.0;
/// Minima for an image that has been improved: it is still better than the worst contoured forks.
const MENDED: f64 = 0.2;
const MENDED_ANGLE: f64 = 13.0;
/// Minimum radius ratio of an image that is improved.
const MENDABLE: f64 = 0.01;
/// Tetrahedra with a larger radius ratio have larger angles.
const ANGULAR: f64 = 0.6;

/// Stretch of images, for one of tubes: that of the lengths of vessels from a canonical fork to an image.
pub fn stretch(of_tubes: f64) -> f64 {
    of_tubes.clamp(1.0, STRETCH)
}

/// Fork or bend filled with tetrahedra.
pub struct FilledFork {
    /// Points and tetrahedra.
    pub mesh: TetMesh,
    /// Triangles of the discs, in the order of the cluster's ends, facing outwards.
    pub discs: Vec<Triangles>,
    /// Triangles of the wall, facing outwards.
    pub wall: Triangles,
    /// Topology of the tetrahedra, with the discs in the same order.
    pub topology: Arc<Topology>,
}

impl FilledFork {
    /// Returns points and tetrahedra, or points and closed surface if `hollow`, with the discs.
    pub fn kept(self, hollow: bool) -> (TetMesh, Triangles, Vec<Triangles>) {
        if hollow { hull(&self.mesh.points, &self.discs, &self.wall) } else { (self.mesh, Vec::new(), self.discs) }
    }
}

/// Returns the image; `None` if it does not fit or has poor tetrahedra.
pub fn image(canonical: &Canonical, fork: &Fork, cluster: &Cluster, params: &BlockParams) -> Option<FilledFork> {
    let mut field = Field::new(&cluster.tubes, params.kappa).ok()?;
    let moved = |p: &Point3| moved(p, &canonical.fork, fork);
    let shifts = Shifts::new(&canonical.fork, [canonical.crotches, crotches(fork, &mut field)], moved);
    let mut points: Vec<Point3> = canonical.points.iter().map(|p| moved(p) + shifts.at(p)).collect();
    let mut discs = vec![Triangles::new(); fork.limbs.len()];
    for (i, limb) in fork.limbs.iter().enumerate() {
        discs[limb.end as usize].clone_from(&canonical.discs[i]);
        if limb.side == TIP {
            for &v in &canonical.topology.discs[i].vertices {
                points[v as usize] = on_cap(&canonical.points[v as usize], &canonical.fork, fork, i);
            }
            continue;
        }
        let disc = disc_at_end(&cluster.ends[limb.end as usize].section, limb.side, params)?;
        let vertices = &canonical.topology.discs[i].vertices;
        if disc.points.len() != vertices.len() {
            return None;
        }
        for (&v, p) in vertices.iter().zip(&disc.points) {
            points[v as usize] = *p;
        }
    }
    for level in &canonical.levels {
        let p = &mut points[level.vertex as usize];
        let plane = level.rim.map(|limb| fork.limbs[limb].axis);
        *p = at_level(&mut field, *p, level.value, plane, FAR * fork.radius)?;
    }
    let tets = canonical.tets.iter().map(|t| t.map(u32::from)).collect();
    let (mut mesh, wall) = (TetMesh { points, tets }, canonical.wall.clone());
    let stretch = stretch(params.stretch);
    if is_above(&mesh, LEAST / stretch, LEAST_ANGLE / stretch) {
        // Limb of each end.
        let mut order: Vec<usize> = (0..discs.len()).collect();
        order.sort_by_key(|&limb| fork.limbs[limb].end);
        return Some(FilledFork { mesh, discs, wall, topology: canonical.topology.ordered(&order) });
    }
    // Improvement needs positive tetrahedra. From flat ones it seldom succeeds.
    if !is_above(&mesh, MENDABLE, 0.0) {
        return None;
    }
    let options = OptimizeOptions { fixed_points: canonical.boundary_points, ..OptimizeOptions::of(Effort::Fast) };
    optimize(&mut mesh, &options).ok()?;
    if !is_above(&mesh, MENDED / stretch, MENDED_ANGLE / stretch) {
        return None;
    }
    let topology = Topology::of(&mesh, discs.iter().map(Vec::as_slice)).ok()?;
    Some(FilledFork { mesh, discs, wall, topology: Arc::new(topology) })
}

/// Moves a point with the limbs of a fork: the mean of its images in their frames.
fn moved(p: &Point3, from: &Fork, to: &Fork) -> Point3 {
    let w = p - from.node;
    let (mut shares, mut scores) = ([0.0; LIMBS], [f64::NEG_INFINITY; LIMBS]);
    for (i, limb) in from.limbs.iter().enumerate() {
        shares[i] = w.dot(&limb.axis) / limb.length;
        scores[i] = score(&w, shares[i], limb);
    }
    let largest = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut total) = (Vec3::zeros(), 0.0);
    for i in 0..from.limbs.len() {
        let weight = if scores[i] == largest { 1.0 } else { libm::exp(SHARPNESS * (scores[i] - largest)) };
        sum += with_limb(&w, shares[i], [&from.limbs[i], &to.limbs[i]]) * weight;
        total += weight;
    }
    to.node + sum / total
}

/// Logarithm of a limb's weight, over [`SHARPNESS`]: the share of its length, less what a point is beyond its end or beside
/// it. A long limb may pass the end of a short one.
fn score(w: &Vec3, share: f64, limb: &Limb) -> f64 {
    let [near, far] = limb.radii;
    let radius = near + (far - near) * share.clamp(0.0, 1.0);
    let aside = (w - limb.axis * (share * limb.length)).norm() / radius;
    share.min(2.0 - share) - ASIDE * (aside - FREE).max(0.0)
}

/// Image of an offset from the node, at a share of a limb's length, in the frame of the other limb.
fn with_limb(w: &Vec3, share: f64, [from, to]: [&Limb; 2]) -> Vec3 {
    let radius = |[near, far]: [f64; 2]| near + (far - near) * share.clamp(0.0, 1.0);
    let scale = radius(to.radii) / radius(from.radii);
    let [x, y] = from.frame.map(|u| w.dot(&u) * scale);
    to.axis * (share * to.length) + to.frame[0] * x + to.frame[1] * y
}

/// Image of a point of a cap: in the plane of the terminal.
fn on_cap(p: &Point3, from: &Fork, to: &Fork, limb: usize) -> Point3 {
    to.node + with_limb(&(p - from.node), 1.0, [&from.limbs[limb], &to.limbs[limb]])
}

/// Moves a point to a level of the field; `None` if it does not get there, or moves further than `far`. `plane`: normal of
/// the plane that the point stays in.
fn at_level(field: &mut Field, start: Point3, level: f64, plane: Option<Vec3>, far: f64) -> Option<Point3> {
    let mut p = start;
    for _ in 0..=STEPS {
        let (value, gradient) = field.value_and_gradient(&p);
        if (value - level).abs() <= OFF_LEVEL {
            return ((p - start).norm() <= far).then_some(p);
        }
        let gradient = gradient - plane.map_or(Vec3::zeros(), |normal| normal * normal.dot(&gradient));
        let square = gradient.norm_squared();
        if square == 0.0 {
            return None;
        }
        p -= gradient * ((value - level) / square);
    }
    None
}

/// True if no tetrahedron has a smaller radius ratio or, in degrees, a smaller dihedral angle.
fn is_above(mesh: &TetMesh, least: f64, angle: f64) -> bool {
    all_have_ratio(mesh, ANGULAR, |corners| {
        has_ratio(corners, least) && dihedral_range(corners).0.to_degrees() >= angle
    })
}
