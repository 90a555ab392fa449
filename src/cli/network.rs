//! A network from the command line: read, cleaned.

use std::path::PathBuf;

use super::exit::Failure;
use super::hint;
use super::units::Units;
use crate::prepare::{PrepareParams, PrepareReport, Prepared, prepare_lines};
use crate::report::inlets::{Inlets, NoTerminal};
use crate::report::prepare::text;
use anastomesh_io::network::{NetworkFile, NetworkFormat, NetworkNote, NetworkOptions, NodeNames, read_network};
use anastomesh_skeleton::{BadSize, CleanReport, NodeId, NodeSizes, SizeAt, Skeleton, clean};

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
    /// What the file calls its nodes.
    pub names: NodeNames,
    /// Roots of the trees in the file.
    roots: Vec<NodeId>,
    /// The numbers of the array that was asked for, one for each node of the file.
    node_values: Vec<f64>,
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

    fn file_with(&self, options: &NetworkOptions) -> Result<NetworkFile, Failure> {
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
        self.prepared_with(params, None)
    }

    /// The same with the numbers of an array on its nodes.
    pub fn prepared_with(&self, params: &PrepareParams, array: Option<&str>) -> Result<PreparedNetwork, Failure> {
        let file = self.file_with(&self.options(params.radii).node_array(array.map(str::to_owned)))?;
        let prepared = prepare_lines(&file.skeleton, &file.groups, params);
        let prepared =
            prepared.map_err(|e| Failure::input(format!("{}: {e}; correct the file", self.network.display())))?;
        let Prepared { skeleton, given, outline, report } = prepared;
        let NetworkFile { notes, names, roots, node_values, .. } = file;
        Ok(PreparedNetwork { given, outline, skeleton, notes, report, names, roots, node_values })
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
    /// The terminals that become inlets, of which some may be asked for as the file calls them.
    pub fn inlets(&self, asked: &[String]) -> Result<Inlets, Failure> {
        inlets(&self.skeleton, &self.names, &self.roots, asked)
    }

    /// Lines for people on what was read and cleaned.
    pub fn remarks(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.notes.iter().map(hint::of_note).collect();
        lines.extend(self.cleaned.counts().iter().map(|(count, what)| format!("{count} {what}")));
        lines
    }
}

impl PreparedNetwork {
    /// How long edges are asked to be by an array of the file.
    pub fn sizes(&self, array: &str) -> Result<SizeAt, Failure> {
        let sizes = NodeSizes::new(array, &self.node_values).map_err(|BadSize { node, value }| {
            Failure::input(format!(
                "--size-at {array}: node {} has the value {value}; each node needs a finite number above zero (1: edges as \
                 rho has them): correct the array",
                self.names.of(node)
            ))
        });
        sizes.map(SizeAt::Nodes)
    }

    /// Nothing but what is to be meshed: large networks ask for the room of the rest.
    pub fn into_skeleton(self) -> Skeleton {
        self.skeleton
    }

    /// Without what a mesh would be held against, where there will be none.
    pub fn without_given(self) -> Self {
        Self { given: Skeleton::default(), outline: Skeleton::default(), ..self }
    }

    /// The terminals that become inlets, of which some may be asked for as the file calls them.
    pub fn inlets(&self, asked: &[String]) -> Result<Inlets, Failure> {
        inlets(&self.skeleton, &self.names, &self.roots, asked)
    }

    /// Lines for people on what was read and done; with `all` at length.
    pub fn remarks(&self, all: bool) -> Vec<String> {
        let mut lines: Vec<String> = self.notes.iter().map(hint::of_note).collect();
        if self.report.changed() {
            lines.extend(text(&self.report, all).lines().map(ToString::to_string));
        }
        lines
    }
}

fn inlets(skeleton: &Skeleton, names: &NodeNames, roots: &[NodeId], asked: &[String]) -> Result<Inlets, Failure> {
    Inlets::of(skeleton, names, roots, asked).map_err(|NoTerminal { node, vessels }| {
        Failure::usage(match vessels {
            Some(vessels) => format!(
                "--root: node {node} is no terminal, as {vessels} vessels meet there; name a node with one vessel"
            ),
            None => format!("--root: node {node} is not in the network; name a terminal as the file does"),
        })
    })
}
