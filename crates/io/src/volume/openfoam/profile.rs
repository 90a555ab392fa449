//! Velocities on the faces of an inlet with a parabolic or Womersley profile.

use super::joined::CellFaces;
use crate::flow::{Flow, Harmonic, Profile, Role, Waveform, poiseuille, womersley};
use anastomesh_mesh::faces::Faces;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::nalgebra::Complex;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::stacks::Cells;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::io;

/// Faces of an inlet.
#[derive(Default)]
pub(super) struct InletFaces {
    /// Centres as OpenFOAM has them.
    pub(super) centres: Vec<Point3>,
    /// Area vectors, which point out of the mesh.
    areas: Vec<Vec3>,
}

impl InletFaces {
    /// Faces of all inlets, by patch.
    pub(super) fn of(mesh: &dyn MeshSource, faces: &Faces, cells: Option<&Cells>) -> io::Result<BTreeMap<i32, Self>> {
        let is_inlet = |id: i32| mesh.patches().iter().any(|patch| patch.id == id && Role::of(patch) == Role::Inlet);
        let mut found: Vec<(i32, Vec<u32>)> = Vec::new();
        faces.each_with(
            |_, _, part| Ok(CellFaces::of(part, cells).outer),
            |_, outer| {
                let inlets = outer.into_iter().filter(|face| is_inlet(face.patch));
                found.extend(inlets.map(|face| (face.patch, face.face.vertices().to_vec())));
                Ok(())
            },
        )?;
        let mut ids: Vec<u32> = found.iter().flat_map(|(_, vertices)| vertices).copied().collect();
        ids.sort_unstable();
        ids.dedup();
        let points = mesh.points_of(&ids)?;
        let mut inlets: BTreeMap<i32, Self> = BTreeMap::new();
        for (patch, vertices) in found {
            let corners: Vec<Point3> =
                vertices.iter().filter_map(|v| points.get(ids.partition_point(|id| id < v)).copied()).collect();
            let (centre, area) = centre_and_area(&corners);
            let inlet = inlets.entry(patch).or_default();
            inlet.centres.push(centre);
            inlet.areas.push(area);
        }
        Ok(inlets)
    }
}

/// Centre and area vector of a polygon, by the triangles around the mean of its corners.
fn centre_and_area(corners: &[Point3]) -> (Point3, Vec3) {
    let mean = corners.iter().map(|p| p.coords).sum::<Vec3>() / corners.len().max(1) as f64;
    let next = corners.iter().cycle().skip(1);
    let triangles = corners.iter().zip(next).map(|(a, b)| {
        let half = (a.coords - mean).cross(&(b.coords - mean)) * 0.5;
        (half, (a.coords + b.coords + mean) / 3.0)
    });
    let (mut area, mut sum, mut size) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    for (half, centre) in triangles {
        area += half;
        sum += half.norm() * centre;
        size += half.norm();
    }
    (Point3::from(if size > 0.0 { sum / size } else { mean }), area)
}

/// Round section of an inlet.
pub(super) struct Disc {
    pub(super) center: Point3,
    /// Unit vector out of the mesh.
    pub(super) normal: Vec3,
    pub(super) radius: f64,
}

impl Disc {
    /// Disc of the same centre and area as some faces.
    pub(super) fn around(faces: &InletFaces) -> Self {
        let normal: Vec3 = faces.areas.iter().sum();
        let size: f64 = faces.areas.iter().map(Vec3::norm).sum();
        let sum: Vec3 = faces.centres.iter().zip(&faces.areas).map(|(centre, area)| centre.coords * area.norm()).sum();
        Self {
            center: Point3::from(sum / size.max(f64::MIN_POSITIVE)),
            normal: normal.try_normalize(0.0).unwrap_or_default(),
            radius: (size / PI).sqrt(),
        }
    }
}

/// Velocity profile of an inlet, scaled so that the faces carry the flow rate exactly.
pub(super) struct Velocities<'a> {
    normal: Vec3,
    /// Velocity of the mean's profile per flow rate, by face.
    steady: Vec<f64>,
    /// Velocities of each harmonic per flow rate, by face.
    harmonics: Vec<(Harmonic, Vec<Complex<f64>>)>,
    waveform: Option<&'a Waveform>,
    mean: f64,
}

impl<'a> Velocities<'a> {
    pub(super) fn new(faces: &InletFaces, disc: &Disc, flow: &Flow, waveform: Option<&'a Waveform>, mean: f64) -> Self {
        let shares: Vec<f64> = faces.centres.iter().map(|centre| (centre - disc.center).norm() / disc.radius).collect();
        let areas: Vec<f64> = faces.areas.iter().map(|area| area.dot(&disc.normal)).collect();
        let mut steady: Vec<f64> = shares.iter().map(|&share| poiseuille(share)).collect();
        let rate: f64 = steady.iter().zip(&areas).map(|(speed, area)| speed * area).sum();
        if rate > 0.0 {
            for speed in &mut steady {
                *speed /= rate;
            }
        }
        let nu = flow.viscosity / flow.density;
        let of_harmonic = |harmonic: Harmonic| {
            let alpha = disc.radius * (harmonic.frequency / nu).sqrt();
            let mut speeds: Vec<Complex<f64>> = shares.iter().map(|&share| womersley(alpha, share)).collect();
            let rate: Complex<f64> = speeds.iter().zip(&areas).map(|(speed, area)| speed * area).sum();
            if rate.norm() > 0.0 {
                for speed in &mut speeds {
                    *speed /= rate;
                }
            }
            (harmonic, speeds)
        };
        let harmonics = match (flow.profile, waveform) {
            (Profile::Womersley, Some(waveform)) => Harmonic::of(waveform).into_iter().map(of_harmonic).collect(),
            _ => Vec::new(),
        };
        Self { normal: disc.normal, steady, harmonics, waveform, mean }
    }

    /// Velocity of each face at a time.
    pub(super) fn at(&self, time: f64) -> impl ExactSizeIterator<Item = Vec3> {
        let rate = self.waveform.map_or(self.mean, |waveform| waveform.at(time));
        let values: Vec<Complex<f64>> = self.harmonics.iter().map(|(harmonic, _)| harmonic.at(time)).collect();
        // What the harmonics leave has the mean's profile.
        let left = rate - values.iter().map(|value| value.re).sum::<f64>();
        self.steady.iter().enumerate().map(move |(face, steady)| {
            let harmonics = self.harmonics.iter().zip(&values);
            let pulse: f64 = harmonics.map(|((_, speeds), value)| (speeds[face] * value).re).sum();
            self.normal * -(steady * left + pulse)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces of a unit disc in rings of quadrilaterals.
    fn disc() -> InletFaces {
        let (rings, sectors) = (12, 24);
        let mut faces = InletFaces::default();
        let point = |ring: i32, sector: i32| {
            let (r, angle) = (f64::from(ring) / f64::from(rings), 2.0 * PI * f64::from(sector) / f64::from(sectors));
            Point3::new(r * libm::cos(angle), r * libm::sin(angle), 0.0)
        };
        for (ring, sector) in (0..rings).flat_map(|ring| (0..sectors).map(move |sector| (ring, sector))) {
            let [a, b] = [point(ring, sector), point(ring + 1, sector)];
            let [c, d] = [point(ring + 1, sector + 1), point(ring, sector + 1)];
            let (centre, area) = centre_and_area(&[a, b, c, d]);
            faces.centres.push(centre);
            faces.areas.push(area);
        }
        faces
    }

    #[test]
    fn faces_carry_the_flow_rate_at_any_time() {
        let faces = disc();
        let around = Disc::around(&faces);
        assert!((around.radius - 1.0).abs() < 0.02 && around.center.coords.norm() < 1e-12 && around.normal.z == 1.0);
        let pulse = Waveform::new(vec![0.0, 0.2, 1.0], vec![1.0, 4.0, 1.0]).unwrap();
        for profile in [Profile::Parabolic, Profile::Womersley] {
            let flow = Flow::new(1.0, 0.05).profile(profile);
            let speeds = Velocities::new(&faces, &around, &flow, Some(&pulse), 2.5);
            for time in [0.0, 0.13, 0.2, 0.7, 1.1] {
                let rate: f64 = speeds.at(time).zip(&faces.areas).map(|(speed, area)| -speed.dot(area)).sum();
                assert!((rate - pulse.at(time)).abs() < 1e-12, "{profile:?} {time} {rate}");
            }
        }
        let flow = Flow::new(1.0, 0.05).profile(Profile::Parabolic);
        let steady = Velocities::new(&faces, &around, &flow, None, 3.0);
        let fastest = steady.at(0.0).map(|speed| -speed.z).fold(0.0, f64::max);
        assert!((fastest / (2.0 * 3.0 / PI) - 1.0).abs() < 0.02, "{fastest}");
    }
}
