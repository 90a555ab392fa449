//! Options on the difference between a result and the given network, and the verdict of a run.

use std::fmt::Display;

use super::common::Common;
use super::exit::{Exit, Failure};
use super::log;
use super::numbers::number;
use crate::fidelity::Displaced;
use crate::pipeline::RunReport;
use crate::report::fidelity::{displaced, required};
use crate::report::verdict::{Verdict, reason};
use crate::run::{Defect, Limits};
use anastomesh_network::NameOf;

/// Limits on the difference from the given network; beyond them the exit code is 1.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Fidelity")]
pub struct FidelityArgs {
    /// Maximum distance of the axis from the input, in radii; exit code 1 if exceeded. Default: 1 for measured networks, at
    /// 99 % of the axis and where no repair or overlap requires more; no limit for others
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = number)]
    max_displacement: Option<f64>,
    /// Warn instead of failing when the axis exceeds the limit
    #[arg(long)]
    allow_displaced: bool,
    /// Maximum relative difference between the volume and that of the given lumen; exit code 1 if exceeded
    #[arg(long, value_name = "SHARE", default_value_t = 0.1, allow_negative_numbers = true, value_parser = number)]
    max_lumen_error: f64,
    /// Warn instead of failing when repairs drop more than 2 radii of a vessel, or more than double the length of one
    #[arg(long)]
    allow_dropped: bool,
}

impl FidelityArgs {
    /// Limits of the run.
    ///
    /// # Errors
    /// A limit is negative or NaN.
    pub fn limits(&self) -> Result<Limits, Failure> {
        let check = |option: &str, value: f64, unit: &dyn Display| {
            if value >= 0.0 {
                return Ok(());
            }
            Err(Failure::usage(format!("{option} {value}: give a number {unit} of at least 0")))
        };
        check("--max-displacement", self.max_displacement.unwrap_or(0.0), &"of radii")?;
        check("--max-lumen-error", self.max_lumen_error, &"(0.1 is 10 %)")?;
        Ok(Limits::default().displacement(self.max_displacement).lumen(self.max_lumen_error))
    }

    /// True if the options accept a defect.
    fn accepts(&self, defect: &Defect) -> bool {
        match defect {
            Defect::Displaced { .. } => self.allow_displaced,
            Defect::Dropped { .. } | Defect::Extended { .. } => self.allow_dropped,
            _ => false,
        }
    }

    /// Defects that are not accepted.
    pub fn refused<'a>(&self, defects: &'a [Defect]) -> Vec<&'a Defect> {
        defects.iter().filter(|defect| !self.accepts(defect)).collect()
    }

    /// Prints the places that are displaced, and warnings on accepted defects. `excused`: the furthest displacement that listed
    /// changes require.
    pub fn tell(
        &self,
        common: &Common,
        (defects, excused): (&[Defect], Option<&Displaced>),
        run: &RunReport,
        name: NameOf,
    ) {
        if common.quiet {
            return;
        }
        if let Some(place) = excused {
            log::note(&required(place, name));
        }
        for defect in defects {
            let is_accepted = self.accepts(defect);
            match defect {
                Defect::Displaced { bound, places, .. } if is_accepted => {
                    log::warning(&displaced(places, *bound, name));
                }
                Defect::Displaced { bound, places, .. } => log::note(&displaced(places, *bound, name)),
                Defect::Dropped { .. } | Defect::Extended { .. } if is_accepted => {
                    log::warning(&format!("accepted: {}", reason(defect, run, name).unwrap_or_default()));
                }
                Defect::Dropped { .. } | Defect::Extended { .. } => {
                    log::note("--allow-dropped accepts dropped vessels and extended tips; `prepare` shows the repairs");
                }
                Defect::Lumen { .. } => {
                    log::note(
                        "--max-lumen-error sets the limit; a finer --rho or a repair of the network reduces the error",
                    );
                }
                _ => {}
            }
        }
    }
}

/// Prints the verdict of a run as its last line, and returns the exit code. With `--quiet`, success has no line. With
/// `--json`, the report on standard output contains a success.
pub fn conclude(common: &Common, verdict: &Verdict) -> Exit {
    match (verdict.is_good, common.quiet) {
        (true, quiet) if quiet || common.json => {}
        (true, _) => log::result(&verdict.text),
        (false, true) => log::error(&verdict.text),
        (false, false) => log::failure(&verdict.text),
    }
    if verdict.is_good { Exit::Fine } else { Exit::GateNotMet }
}
