//! Inlets: conditions of the velocity, and the files with their flow rates or velocities in time.

use super::boundary::{Boundary, FoamPatch};
use super::profile::{Disc, InletFaces, Velocities};
use crate::file::AtomicFolder;
use crate::flow::{Flow, Profile, Role, Transient, Waveform};
use anastomesh_mesh::geometry::Vec3;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fmt::Write;
use std::io;

/// Folder of the waveforms.
pub(super) const WAVEFORMS: &str = "constant/inflow";
/// Folder of velocities on the faces of inlets, by which `timeVaryingMappedFixedValue` finds them.
pub(super) const VELOCITIES: &str = "constant/boundaryData";

/// Minimum number of velocity files per period and per ramp. Velocities are linear in time between them.
const STEPS: u32 = 40;

/// True if velocities of faces are written: the solver has no condition for the profile.
pub(super) fn is_mapped(flow: &Flow) -> bool {
    matches!(flow.profile, Profile::Parabolic | Profile::Womersley)
}

/// Factor of the flow rate in a ramp from rest, as OpenFOAM's `halfCosineRamp`.
fn ramp(time: f64, transient: &Transient) -> f64 {
    if time >= transient.ramp { 1.0 } else { 0.5 * (1.0 - libm::cos(PI * (time / transient.ramp).max(0.0))) }
}

/// Entries of all inlets in `0/U`.
pub(super) fn entries(boundary: &Boundary, flow: &Flow) -> String {
    if is_mapped(flow) && boundary.with_role(Role::Inlet).next().is_some() {
        return "    // Velocities of the faces, in constant/boundaryData.\n    \"inlet.*\"\n    {\n        type \
                timeVaryingMappedFixedValue;\n        mapMethod nearest;\n        setAverage off;\n        value uniform (0 0 \
                0);\n    }\n"
            .into();
    }
    boundary.with_role(Role::Inlet).map(|inlet| entry(inlet, flow)).collect()
}

fn entry(inlet: &FoamPatch, flow: &Flow) -> String {
    let cap = flow.at(&inlet.patch);
    let value = match (&flow.transient, &cap.waveform) {
        (Some(_), Some(_)) => {
            format!("{{ type tableFile; outOfBounds repeat; file \"<{WAVEFORMS}/{}\"; }}", inlet.name)
                .replace("<constant/", "<constant>/")
        }
        _ => format!("constant {:e};", cap.flow),
    };
    let rate = match &flow.transient {
        Some(Transient { ramp, .. }) if *ramp > 0.0 => format!(
            "\n        {{\n            type scale;\n            // From rest.\n            scale {{ type halfCosineRamp; start \
             0; duration {ramp:e}; }}\n            value {value}\n        }}"
        ),
        _ => format!(" {value}"),
    };
    format!(
        "    {}\n    {{\n        type flowRateInletVelocity;\n        volumetricFlowRate{rate}\n        value uniform (0 0 \
         0);\n    }}\n",
        inlet.name
    )
}

/// Writes the waveforms, or the velocities of the faces.
pub(super) fn write(
    folder: &AtomicFolder,
    boundary: &Boundary,
    flow: &Flow,
    faces: &BTreeMap<i32, InletFaces>,
) -> io::Result<()> {
    for inlet in boundary.with_role(Role::Inlet) {
        let cap = flow.at(&inlet.patch);
        // Without a time, a pulsatile flow rate has its mean.
        let waveform = flow.transient.and(cap.waveform.as_ref());
        if let Some(faces) = faces.get(&inlet.patch.id).filter(|_| is_mapped(flow)) {
            write_velocities(folder, inlet, flow, faces, waveform, cap.flow)?;
        } else if let Some(waveform) = waveform {
            let samples = waveform.times().iter().zip(waveform.rates());
            let lines: String = samples.map(|(time, rate)| format!("    ({time} {rate:e})\n")).collect();
            folder.put(&format!("{WAVEFORMS}/{}", inlet.name), format!("(\n{lines})\n").as_bytes())?;
        }
    }
    Ok(())
}

fn write_velocities(
    folder: &AtomicFolder,
    inlet: &FoamPatch,
    flow: &Flow,
    faces: &InletFaces,
    waveform: Option<&Waveform>,
    mean: f64,
) -> io::Result<()> {
    let around = || Disc::around(faces);
    let disc = inlet.patch.cap.as_ref().map_or_else(around, |cap| Disc {
        center: cap.center,
        normal: cap.normal,
        radius: cap.radius,
    });
    let place = format!("{VELOCITIES}/{}", inlet.name);
    let points = vectors(faces.centres.iter().map(|centre| centre.coords));
    folder.put(&format!("{place}/points"), points.as_bytes())?;
    let velocities = Velocities::new(faces, &disc, flow, waveform, mean);
    let times = flow.transient.as_ref().map_or_else(|| vec![0.0], |transient| times(transient, waveform, flow.profile));
    for time in times {
        let factor = flow.transient.as_ref().map_or(1.0, |transient| ramp(time, transient));
        let values = vectors(velocities.at(time).map(|velocity| velocity * factor));
        folder.put(&format!("{place}/{time}/U"), values.as_bytes())?;
    }
    Ok(())
}

/// Times of velocity files: the samples of the waveform in each period, and steps in between.
fn times(transient: &Transient, waveform: Option<&Waveform>, profile: Profile) -> Vec<f64> {
    let Transient { period, periods, ramp, .. } = *transient;
    let steps = |duration: f64| (0..=STEPS).map(move |i| duration * f64::from(i) / f64::from(STEPS));
    let mut in_period: Vec<f64> = waveform.map_or_else(|| vec![0.0], |waveform| waveform.times().to_vec());
    if profile == Profile::Womersley {
        in_period.extend(steps(period));
    }
    let mut times: Vec<f64> = (0..periods)
        .flat_map(|cycle| in_period.iter().map(move |time| time + period * f64::from(cycle)))
        .chain(if ramp > 0.0 { steps(ramp).collect() } else { Vec::new() })
        .chain([transient.end()])
        // As file names: without the noise of rounding, which would make two of one.
        .map(|time| (time * 1e9).round() / 1e9)
        .filter(|time| *time <= transient.end() + 1e-9)
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

fn vectors(values: impl ExactSizeIterator<Item = Vec3>) -> String {
    let mut text = format!("{}\n(\n", values.len());
    for value in values {
        let _ = writeln!(text, "({:e} {:e} {:e})", value.x, value.y, value.z);
    }
    text + ")\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_contain_samples_and_ramp_in_all_periods() {
        let waveform = Waveform::new(vec![0.0, 0.3, 0.8], vec![1.0, 2.0, 1.0]).unwrap();
        let transient = Transient::new(0.8).periods(2).ramp(0.0);
        assert_eq!(times(&transient, Some(&waveform), Profile::Parabolic), [0.0, 0.3, 0.8, 1.1, 1.6]);
        assert_eq!(times(&transient, None, Profile::Parabolic), [0.0, 0.8, 1.6]);
        let ramped = times(&transient.ramp(0.4), Some(&waveform), Profile::Womersley);
        assert!(ramped.is_sorted() && ramped.contains(&0.01) && ramped.contains(&0.82) && ramped.contains(&1.1));
        assert!((ramp(0.1, &transient.ramp(0.2)) - 0.5).abs() < 1e-15 && ramp(0.3, &transient.ramp(0.2)) == 1.0);
    }
}
