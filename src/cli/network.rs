//! A network from the command line: read, cleaned.

use std::path::PathBuf;

use super::exit::Failure;
use super::hint;
use super::units::Units;
use crate::pipeline::Inlets;
use anastomesh_io::network::{NetworkFile, NetworkFormat, NetworkNote, NetworkOptions, NodeNames, read_network};
use anastomesh_network::{PrepareParams, PrepareReport, Prepared, prepare};
use anastomesh_skeleton::{CleanReport, NodeId, Skeleton, clean};

/// Arguments of every verb that reads a network.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Network")]
pub struct NetworkArgs {
    /// The network: .swc; .vtp or .vtk with lines; .am (Amira, text); .csv (nodes and edges); .graphml, .gxl; .net (Pajek);
    /// .json (node-link); .npyd (`NumPy`'s arrays, a folder); .in (SimVascular 1D)
    #[arg(value_name = "NETWORK")]
    pub network: PathBuf,
    /// Array, column or attribute that holds the radius, on nodes or vessels (default: found by its name)
    #[arg(long, value_name = "NAME")]
    pub radius_array: Option<String>,
    /// What the file has for radii are diameters (without this, those that are called so are halved)
    #[arg(long)]
    pub diameters: bool,
    /// Multiply radii alone, as when they are in another unit than the positions
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_negative_numbers = true)]
    pub radius_scale: Option<f64>,
    /// Multiply positions and radii
    #[arg(long, value_name = "FACTOR", value_parser = factor, allow_negative_numbers = true)]
    pub scale: Option<f64>,
    /// Unit of the network's lengths (m, cm, mm, um), or from one to another: um:m reads micrometres and goes on in metres
    #[arg(long, value_name = "UNIT[:UNIT]", conflicts_with = "scale")]
    pub units: Option<Units>,
}

fn factor(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|e| format!("{e}"))?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("a finite number above zero".into()) }
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
    /// What the file calls its nodes.
    names: NodeNames,
    /// Roots of the trees in the file.
    roots: Vec<NodeId>,
}

/// A network ready for use, and what was done so that it is.
#[derive(Debug)]
pub struct PreparedNetwork {
    /// The prepared skeleton.
    pub skeleton: Skeleton,
    /// What the reader decided.
    pub notes: Vec<NetworkNote>,
    /// What was done.
    pub report: PrepareReport,
}

impl NetworkArgs {
    /// How the network is to be read.
    pub fn options(&self, any_radii: bool) -> NetworkOptions {
        NetworkOptions::default()
            .radius_array(self.radius_array.clone())
            .diameters(self.diameters)
            .radius_scale(self.radius_scale)
            .scale(self.scale.or(self.units.and_then(Units::factor)))
            .any_radii(any_radii)
    }

    /// Reads the network as it stands in its file.
    pub fn file(&self, any_radii: bool) -> Result<NetworkFile, Failure> {
        self.file_with(&self.options(any_radii))
    }

    /// Reads the network with options.
    pub fn file_with(&self, options: &NetworkOptions) -> Result<NetworkFile, Failure> {
        if let (Some(name), Ok(NetworkFormat::Swc)) = (&self.radius_array, NetworkFormat::of(&self.network)) {
            let path = self.network.display();
            return Err(Failure::usage(format!(
                "{path}: SWC has one column of radii, without a name: leave --radius-array {name} out, or give --radius-scale"
            )));
        }
        let file = read_network(&self.network, options);
        let mut file = file.map_err(|e| Failure::input(hint::of_file(&e)))?;
        if let Some([from, to]) = self.units.map(Units::names) {
            file.notes.push(NetworkNote::Unit { from, to });
        }
        Ok(file)
    }

    /// Reads the network and applies cures to it.
    pub fn prepared(&self, params: &PrepareParams) -> Result<PreparedNetwork, Failure> {
        let NetworkFile { skeleton, notes, groups, .. } = self.file(params.radii)?;
        let prepared = prepare(&skeleton, &groups, params);
        let prepared =
            prepared.map_err(|e| Failure::input(format!("{}: {e}; correct the file", self.network.display())))?;
        let Prepared { skeleton, report, .. } = prepared;
        Ok(PreparedNetwork { skeleton, notes, report })
    }

    /// Reads and cleans the network.
    pub fn read(&self) -> Result<Network, Failure> {
        let file = self.file(false)?;
        let (skeleton, cleaned) =
            clean(&file.skeleton).map_err(|e| Failure::input(format!("{}: {e}", self.network.display())))?;
        Ok(Network { skeleton, notes: file.notes, cleaned, names: file.names, roots: file.roots })
    }
}

impl Network {
    /// The terminals that become inlets.
    pub fn inlets(&self) -> Result<Inlets, Failure> {
        Inlets::of(&self.skeleton, &self.names, &self.roots, &[]).map_err(|e| Failure::input(e.to_string()))
    }

    /// Lines for people on what was read and cleaned.
    pub fn remarks(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.notes.iter().map(hint::of_note).collect();
        lines.extend(self.cleaned.counts().iter().map(|(count, what)| format!("{count} {what}")));
        lines
    }
}
