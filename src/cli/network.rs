//! Network options, and reading of networks.

use std::path::PathBuf;

use super::exit::Failure;
use super::hint;
use super::numbers::above_zero;
use super::units::Units;
use crate::run::without_islands;
use anastomesh_flow::Inlets;
use anastomesh_io::network::{NetworkFile, NetworkFormat, NetworkNote, NetworkOptions, NodeNames, read_network};
use anastomesh_network::{PrepareParams, PrepareReport, Prepared, prepare};
use anastomesh_skeleton::{CleanReport, NodeId, Skeleton, clean};

/// Options shared by commands that read a network.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Network")]
pub struct NetworkArgs {
    /// Network file: .swc, .vtp, .vtk or .vtu (lines), .am (Amira text), .csv (nodes and edges), .graphml, .gxl, .net or
    /// .pajek, .json (node-link), .vmv (`VessMorphoVis`), .h5 (vascpy), .npyd (folder of `NumPy` arrays), .in (`SimVascular` 1D), .edge
    /// (with .node of the same name)
    #[arg(value_name = "NETWORK")]
    pub network: PathBuf,
    /// Name of the array, column or attribute with radii of nodes or vessels (default: detected by name)
    #[arg(long, value_name = "NAME")]
    pub radius_array: Option<String>,
    /// Radius of all vessels, for a file without radii
    #[arg(long, value_name = "R", value_parser = above_zero, allow_negative_numbers = true, conflicts_with = "radius_array")]
    pub radius: Option<f64>,
    /// Treat all radii as diameters (default: only arrays with the name of a diameter are halved)
    #[arg(long)]
    pub diameters: bool,
    /// Multiply radii by a factor, for example if their unit differs from that of positions
    #[arg(long, value_name = "FACTOR", value_parser = above_zero, allow_negative_numbers = true)]
    pub radius_scale: Option<f64>,
    /// Multiply positions and radii by a factor
    #[arg(long, value_name = "FACTOR", value_parser = above_zero, allow_negative_numbers = true)]
    pub scale: Option<f64>,
    /// Length unit of the network (m, cm, mm, um), or a conversion: um:m converts micrometres to metres
    #[arg(long, value_name = "UNIT[:UNIT]", conflicts_with = "scale")]
    pub units: Option<Units>,
}

/// A network ready for use.
#[derive(Debug)]
pub struct Network {
    /// The cleaned skeleton.
    pub skeleton: Skeleton,
    /// Decisions of the reader.
    pub notes: Vec<NetworkNote>,
    /// Report of the cleaning.
    pub cleaned: CleanReport,
    /// Node names in the file.
    pub names: NodeNames,
    /// Roots of the trees in the file.
    roots: Vec<NodeId>,
}

/// Prepared network with its report.
#[derive(Debug)]
pub struct PreparedNetwork {
    /// The prepared skeleton.
    pub skeleton: Skeleton,
    /// Network as given, with usable radii and without islands that were to be removed.
    pub given: Skeleton,
    /// `given` with as many points as its shape needs.
    pub outline: Skeleton,
    /// Node names in the file.
    pub names: NodeNames,
    /// Roots of the trees in the file.
    pub roots: Vec<NodeId>,
    /// Decisions of the reader.
    pub notes: Vec<NetworkNote>,
    /// Report of the preparation.
    pub report: PrepareReport,
}

impl NetworkArgs {
    /// Options of the reader.
    pub fn options(&self, any_radii: bool) -> NetworkOptions {
        NetworkOptions::default()
            .radius_array(self.radius_array.clone())
            .radius(self.radius)
            .diameters(self.diameters)
            .radius_scale(self.radius_scale)
            .scale(self.scale.or(self.units.and_then(Units::factor)))
            .any_radii(any_radii)
    }

    /// Reads the network without changes.
    pub fn file(&self, any_radii: bool) -> Result<NetworkFile, Failure> {
        self.file_with(&self.options(any_radii))
    }

    /// Reads the network with options.
    pub fn file_with(&self, options: &NetworkOptions) -> Result<NetworkFile, Failure> {
        if let (Some(name), Ok(NetworkFormat::Swc)) = (&self.radius_array, NetworkFormat::of(&self.network)) {
            let path = self.network.display();
            return Err(Failure::usage(format!("{path}: SWC has no named arrays: omit --radius-array {name}")));
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
        let NetworkFile { skeleton, notes, groups, names, roots, .. } = self.file(params.radii)?;
        let prepared = prepare(&skeleton, &groups, params);
        let prepared = prepared.map_err(|e| {
            let (path, error) = (self.network.display(), hint::of_skeleton(&e, &names));
            Failure::input(format!("{path}: {error}; correct the file"))
        })?;
        let Prepared { skeleton, given, outline, report } = prepared;
        let [given, outline] = [given, outline].map(|network| without_islands(network, &report.islands));
        Ok(PreparedNetwork { skeleton, given, outline, names, roots, notes, report })
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
    /// Selects the inlets.
    pub fn inlets(&self) -> Result<Inlets, Failure> {
        Inlets::of(&self.skeleton, &self.names, &self.roots, &[]).map_err(|e| Failure::input(e.to_string()))
    }

    /// Text lines on reading and cleaning.
    pub fn remarks(&self) -> Vec<String> {
        let mut lines: Vec<String> = self.notes.iter().map(hint::of_note).collect();
        lines.extend(self.cleaned.changes());
        lines
    }
}
