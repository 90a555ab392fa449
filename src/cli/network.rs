//! A network from the command line: read, cleaned.

use std::path::PathBuf;

use super::exit::Failure;
use crate::io::network::{NetworkNote, NetworkOptions, read_network};
use crate::prepare::{PrepareParams, PrepareReport, Prepared, prepare};
use crate::report::prepare::text;
use crate::skeleton::{CleanReport, Skeleton, clean};

/// Arguments of every verb that reads a network.
#[derive(Debug, clap::Args)]
pub struct NetworkArgs {
    /// The network: SWC, or VTP with lines and a radius array
    #[arg(value_name = "NETWORK")]
    pub network: PathBuf,
    /// Array that holds the radius, on points or lines (default: found by its name)
    #[arg(long, value_name = "NAME")]
    pub radius_array: Option<String>,
}

/// A network ready for use.
#[derive(Debug)]
pub struct Network {
    /// The cleaned skeleton.
    pub skeleton: Skeleton,
    /// What the reader decided.
    pub notes: Vec<NetworkNote>,
    /// What cleaning did.
    pub cleaned: CleanReport,
}

/// A network ready for use, and what was done so that it is.
#[derive(Debug)]
pub struct PreparedNetwork {
    /// As the file has it, cleaned and with usable radii.
    pub given: Skeleton,
    /// The same with as many points as its shape needs.
    pub outline: Skeleton,
    /// The prepared skeleton.
    pub skeleton: Skeleton,
    /// What the reader decided.
    pub notes: Vec<NetworkNote>,
    /// What was done.
    pub report: PrepareReport,
}

impl NetworkArgs {
    /// Reads the network and applies cures to it.
    pub fn prepared(&self, params: &PrepareParams) -> Result<PreparedNetwork, Failure> {
        let options = NetworkOptions { radius_array: self.radius_array.clone(), any_radii: params.radii };
        let file = read_network(&self.network, &options).map_err(|e| Failure::input(e.to_string()))?;
        let prepared = prepare(&file.skeleton, params);
        let prepared = prepared.map_err(|e| Failure::input(format!("{}: {e}", self.network.display())))?;
        let Prepared { skeleton, given, outline, report } = prepared;
        Ok(PreparedNetwork { given, outline, skeleton, notes: file.notes, report })
    }

    /// Reads and cleans the network.
    pub fn read(&self) -> Result<Network, Failure> {
        let options = NetworkOptions { radius_array: self.radius_array.clone(), ..NetworkOptions::default() };
        let file = read_network(&self.network, &options).map_err(|e| Failure::input(e.to_string()))?;
        let (skeleton, cleaned) =
            clean(&file.skeleton).map_err(|e| Failure::input(format!("{}: {e}", self.network.display())))?;
        Ok(Network { skeleton, notes: file.notes, cleaned })
    }
}

impl Network {
    /// Lines for people on what was read and cleaned.
    pub fn remarks(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.notes.iter().map(ToString::to_string).collect();
        lines.extend(self.cleaned.counts().iter().map(|(count, what)| format!("{count} {what}")));
        lines
    }
}

impl PreparedNetwork {
    /// Lines for people on what was read and done.
    pub fn remarks(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.notes.iter().map(ToString::to_string).collect();
        if self.report.changed() {
            lines.extend(text(&self.report).lines().map(ToString::to_string));
        }
        lines
    }
}
