//! Files of flow rates and velocities at inlets.

use super::layout::{rates_path, velocities_path};
use super::sheet::CapSheet;
use super::steps::Steps;
use crate::flow::{CapFlow, Flow, Harmonic, Profile, Waveform, plain, poiseuille, womersley};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::nalgebra::Complex;
use anastomesh_mesh::quality::triangle_area_vector;
use anastomesh_mesh::{Cap, Patch};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Fourier modes per period, beside 4 per sample. The solver sums a Fourier series.
const MODES: usize = 128;
/// Samples of the ramp, and of a period of velocities.
const RAMP_SAMPLES: u32 = 20;
const PERIOD_SAMPLES: u32 = 100;

/// Inflow of a patch in the solver's terms.
pub(super) enum Inflow {
    /// File of flow rates, which rise linearly to a constant.
    Ramp,
    /// File of flow rates.
    Rates,
    /// File of velocities.
    Velocities,
}

impl Inflow {
    pub(super) fn of(at: &CapFlow, flow: &Flow) -> Self {
        match (&at.waveform, flow.profile) {
            (None, _) => Self::Ramp,
            (Some(_), Profile::Womersley) => Self::Velocities,
            (Some(_), _) => Self::Rates,
        }
    }
}

/// Name and contents of the file of an inlet. `cap` holds its faces.
pub(super) fn file(patch: &Patch, cap: &CapSheet, flow: &Flow, steps: &Steps) -> Option<(String, String)> {
    let (at, name) = (flow.at(patch), plain(&patch.name));
    match (Inflow::of(&at, flow), &at.waveform, patch.cap) {
        (Inflow::Velocities, Some(waveform), Some(disc)) => {
            Some((velocities_path(&name), velocities(waveform, cap, &disc, flow)))
        }
        (Inflow::Velocities, ..) => None,
        (_, Some(waveform), _) => Some((rates_path(&name), rates(waveform, flow))),
        (_, None, _) => Some((rates_path(&name), table(1, &[(0.0, 0.0), (steps.ramp, at.flow)]))),
    }
}

/// Table of the solver: numbers of samples and Fourier modes, then times with flow rates along the outward normal.
fn table(modes: usize, samples: &[(f64, f64)]) -> String {
    let mut text = format!("{} {modes}\n", samples.len());
    for (time, rate) in samples {
        // Inflow is opposite to the normal.
        let _ = writeln!(text, "{time:e} {:e}", 0.0 - rate);
    }
    text
}

fn rates(waveform: &Waveform, flow: &Flow) -> String {
    let times = times(waveform, flow, waveform.times());
    let modes = MODES.max(4 * waveform.times().len()) * periods(flow);
    let sample = |&time: &f64| (time, ramp(flow, time) * waveform.at(time));
    table(modes, &times.iter().map(sample).collect::<Vec<_>>())
}

/// Number of periods in a file. The solver repeats the file: with a ramp it must be longer than the simulation.
fn periods(flow: &Flow) -> usize {
    flow.transient.filter(|time| time.ramp > 0.0).map_or(1, |time| time.periods as usize + 1)
}

/// Factor of the flow rate at a time.
fn ramp(flow: &Flow, time: f64) -> f64 {
    flow.transient.filter(|at| at.ramp > 0.0).map_or(1.0, |at| (time / at.ramp).clamp(0.0, 1.0))
}

/// Times of a file: those of one period repeated, and those of the ramp.
fn times(waveform: &Waveform, flow: &Flow, of_period: &[f64]) -> Vec<f64> {
    let period = waveform.period();
    let again = |k: usize| of_period.iter().map(move |time| k as f64 * period + time);
    let mut times: Vec<f64> = (0..periods(flow)).flat_map(again).collect();
    if let Some(time) = flow.transient.filter(|time| time.ramp > 0.0) {
        times.extend((0..=RAMP_SAMPLES).map(|k| time.ramp * f64::from(k) / f64::from(RAMP_SAMPLES)));
    }
    times.sort_by(f64::total_cmp);
    times.dedup_by(|later, earlier| *later - *earlier < 1e-9 * period);
    times
}

/// Table of the solver: numbers of components, times and points, then times, then each point with its velocities.
fn velocities(waveform: &Waveform, cap: &CapSheet, disc: &Cap, flow: &Flow) -> String {
    let harmonics = Harmonic::of(waveform);
    let shapes = shapes(&harmonics, cap, disc, flow.viscosity / flow.density);
    let even: Vec<f64> =
        (0..=PERIOD_SAMPLES).map(|k| waveform.period() * f64::from(k) / f64::from(PERIOD_SAMPLES)).collect();
    let times = times(waveform, flow, &even);
    let rates: Vec<Vec<Complex<f64>>> = times.iter().map(|&time| parts(waveform, &harmonics, time)).collect();
    let mut text = format!("3 {} {}\n", times.len(), shapes.len());
    for time in &times {
        let _ = writeln!(text, "{time:e}");
    }
    for (id, shape) in cap.ids().iter().zip(&shapes) {
        let _ = writeln!(text, "{}", id + 1);
        for (rates, &time) in rates.iter().zip(&times) {
            let speed: f64 = shape.iter().zip(rates).map(|(shape, rate)| (shape * rate).re).sum();
            let velocity: Vec3 = disc.normal * -(speed * ramp(flow, time));
            let _ = writeln!(text, "{:e} {:e} {:e}", velocity.x, velocity.y, velocity.z);
        }
    }
    text
}

/// Parts of the flow rate at a time: mean and remainder of the series, then the harmonics.
fn parts(waveform: &Waveform, harmonics: &[Harmonic], time: f64) -> Vec<Complex<f64>> {
    let harmonics: Vec<Complex<f64>> = harmonics.iter().map(|harmonic| harmonic.at(time)).collect();
    let rest = waveform.at(time) - harmonics.iter().map(|value| value.re).sum::<f64>();
    std::iter::once(Complex::from(rest)).chain(harmonics).collect()
}

/// Profiles of these parts at the points of a cap: 0 on its rim, with a flux of exactly 1 through its faces.
fn shapes(harmonics: &[Harmonic], cap: &CapSheet, disc: &Cap, kinematic_viscosity: f64) -> Vec<Vec<Complex<f64>>> {
    let faces = cap.faces();
    let is_rim = rim(&faces, cap.points().len());
    let number = |harmonic: &Harmonic| disc.radius * (harmonic.frequency / kinematic_viscosity).sqrt();
    let numbers: Vec<f64> = harmonics.iter().map(number).collect();
    let at = |(point, is_rim): (&Point3, &bool)| -> Vec<Complex<f64>> {
        let share = if *is_rim { 1.0 } else { (point - disc.center).norm() / disc.radius };
        let steady = std::iter::once(Complex::from(poiseuille(share)));
        steady.chain(numbers.iter().map(|&number| womersley(number, share))).collect()
    };
    let mut shapes: Vec<Vec<Complex<f64>>> = cap.points().iter().zip(&is_rim).map(at).collect();
    let mut flux = vec![Complex::<f64>::default(); shapes.first().map_or(0, Vec::len)];
    for face in &faces {
        let nodes: Vec<Point3> = face.iter().map(|&node| cap.points()[node]).collect();
        for (&node, weight) in face.iter().zip(weights(&nodes)) {
            flux.iter_mut().zip(&shapes[node]).for_each(|(flux, shape)| *flux += shape * weight);
        }
    }
    for shape in &mut shapes {
        shape.iter_mut().zip(&flux).filter(|(_, flux)| flux.norm() > 0.0).for_each(|(shape, flux)| *shape /= flux);
    }
    shapes
}

/// Integrals of the basis functions of a flat face with three or six nodes. Edges of the latter may be curved.
fn weights(nodes: &[Point3]) -> Vec<f64> {
    if let [a, b, c] = nodes {
        return vec![triangle_area_vector(a, b, c).norm() / 3.0; 3];
    }
    let mut weights = vec![0.0; nodes.len()];
    for &(share, a) in &QUADRATURE {
        let b = 1.0 - 2.0 * a;
        for [x, y, z] in [[b, a, a], [a, b, a], [a, a, b]] {
            let along_x = [4.0 * x - 1.0, 0.0, 1.0 - 4.0 * z, 4.0 * y, -4.0 * y, 4.0 * (z - x)];
            let along_y = [0.0, 4.0 * y - 1.0, 1.0 - 4.0 * z, 4.0 * x, 4.0 * (z - y), -4.0 * x];
            let tangent = |slopes: [f64; 6]| slopes.iter().zip(nodes).map(|(d, node)| node.coords * *d).sum::<Vec3>();
            let area = tangent(along_x).cross(&tangent(along_y)).norm() / 2.0;
            let corners = [x, y, z].map(|x| x * (2.0 * x - 1.0));
            let values = corners.into_iter().chain([x * y, y * z, z * x].map(|product| 4.0 * product));
            weights.iter_mut().zip(values).for_each(|(weight, value)| *weight += share * area * value);
        }
    }
    weights
}

/// Weights and coordinates of a quadrature that is exact for polynomials of degree 4 on a triangle (Dunavant, 1985).
const QUADRATURE: [(f64, f64); 2] =
    [(0.223_381_589_678_011, 0.445_948_490_915_965), (0.109_951_743_655_322, 0.091_576_213_509_771)];

/// True for the nodes of edges with one face. Nodes of a face are its corners, then midpoints in VTK's order.
fn rim(faces: &[Vec<usize>], points: usize) -> Vec<bool> {
    let mut edges: BTreeMap<[usize; 2], (u32, usize)> = BTreeMap::new();
    for face in faces {
        for i in 0..3 {
            let (from, to) = (face[i], face[(i + 1) % 3]);
            let middle = face.get(3 + i).copied().unwrap_or(from);
            edges.entry([from.min(to), from.max(to)]).or_insert((0, middle)).0 += 1;
        }
    }
    let mut is_rim = vec![false; points];
    for ([a, b], (_, middle)) in edges.into_iter().filter(|(_, (faces, _))| *faces == 1) {
        for point in [a, b, middle] {
            is_rim[point] = true;
        }
    }
    is_rim
}
