//! How the blocks of a network are made: arguments of every verb that makes them.

use super::exit::Failure;
use super::limits::size;
use super::log;
use super::network::NetworkArgs;
use crate::pipeline::{MeshPlan, RunReport};
use crate::report::advice::advice;
use anastomesh_io::network::NetworkFile;
use anastomesh_skeleton::resolution::{FOLLOW, RHO};
use anastomesh_skeleton::{BadSize, NodeSizes, SizeAt};
use std::fmt;
use std::str::FromStr;

/// What `--size-at` is given.
#[derive(Clone, Debug, PartialEq)]
pub enum SizeArg {
    /// A factor at forks.
    Forks(f64),
    /// The name of an array.
    Array(String),
}

impl FromStr for SizeArg {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(text.parse().map_or_else(|_| Self::Array(text.to_owned()), Self::Forks))
    }
}

impl fmt::Display for SizeArg {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Forks(factor) => write!(f, "{factor}"),
            Self::Array(name) => write!(f, "{name}"),
        }
    }
}

impl SizeArg {
    /// What is known of it before the network is.
    fn planned(&self) -> Option<SizeAt> {
        match self {
            Self::Forks(factor) => Some(SizeAt::Forks(*factor)),
            Self::Array(name) => NodeSizes::new(name, &[]).ok().map(SizeAt::Nodes),
        }
    }
}

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Blocks")]
pub struct BlockArgs {
    /// Resolution: voxels across the thinnest vessel of a cluster; larger is finer
    #[arg(long, default_value_t = RHO, allow_negative_numbers = true)]
    pub rho: f64,
    /// How far edges follow the radius of wider vessels: 1 in proportion, so that each has RHO voxels across; 0 not at all,
    /// so that all of a cluster is as fine as its thinnest vessel
    #[arg(long, default_value_t = FOLLOW, allow_negative_numbers = true)]
    pub follow: f64,
    /// How much longer than wide tetrahedra are along vessels, in tubes between forks and caps: 1 to 20
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    pub stretch: f64,
    /// Shorter edges at forks: so many times as long as RHO has them, 0.25 to 1, growing again towards the tubes; or by an array
    /// of the network's nodes, in which numbers below 1 make forks finer, and those above 1 stretch tubes
    #[arg(long, value_name = "FACTOR|ARRAY", allow_negative_numbers = true)]
    pub size_at: Option<SizeArg>,
    /// Memory that may be used, such as 2GiB or 500MB, however large the network
    #[arg(long, value_name = "SIZE", default_value = "2GiB", value_parser = size)]
    pub memory: u64,
    /// Refine the network first, in at most N iterations, so that its vessels do not overlap and can be cut
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "200")]
    pub refine: Option<usize>,
    /// Leave out blocks that fail, say so, and exit 4 all the same
    #[arg(long)]
    pub keep_going: bool,
}

impl BlockArgs {
    /// Prints the options that may help.
    pub fn advise(&self, run: &RunReport, invalid: bool) {
        for line in self.advice(run, invalid) {
            log::note(&line);
        }
    }

    /// Options that may help.
    pub fn advice(&self, run: &RunReport, invalid: bool) -> Vec<String> {
        advice(run, invalid, self.refine.is_some(), self.rho)
    }

    /// The plan that they ask for. `fuse`: vessels that overlap once the network is refined are meshed together.
    pub fn plan(&self, fuse: bool) -> MeshPlan {
        MeshPlan {
            rho: self.rho,
            follow: self.follow,
            stretch: self.stretch,
            size_at: self.size_at.as_ref().and_then(SizeArg::planned),
            memory: self.memory,
            fuse: self.refine.is_some() && fuse,
            keep_going: self.keep_going,
            ..MeshPlan::default()
        }
    }

    /// Reads the network that they are for, with what it says of their blocks, which goes into the plan.
    pub fn read(&self, network: &NetworkArgs, any_radii: bool, plan: &mut MeshPlan) -> Result<NetworkFile, Failure> {
        let Some(SizeArg::Array(array)) = &self.size_at else { return network.file(any_radii) };
        let options = network.options(any_radii).node_array(Some(array.clone()));
        let file = network.file_with(&options)?;
        plan.size_at = Some(sizes(array, &file)?);
        Ok(file)
    }

    /// What of them a mesh depends on, as they are typed.
    pub fn typed(&self) -> String {
        let refine = self.refine.map_or_else(String::new, |n| format!(" --refine {n}"));
        let stretch = if self.stretch == 1.0 { String::new() } else { format!(" --stretch {}", self.stretch) };
        let size = self.size_at.as_ref().map_or_else(String::new, |size| format!(" --size-at {size}"));
        format!("--rho {} --follow {}{stretch}{size}{refine}", self.rho, self.follow)
    }
}

/// Lengths of edges by an array of the file.
fn sizes(array: &str, file: &NetworkFile) -> Result<SizeAt, Failure> {
    let sizes = NodeSizes::new(array, &file.node_values).map_err(|BadSize { node, value }| {
        Failure::input(format!(
            "--size-at {array}: node {} has the value {value}; each node needs a finite number above zero (1: edges as \
             rho has them): correct the array",
            file.names.of(node)
        ))
    });
    sizes.map(SizeAt::Nodes)
}
