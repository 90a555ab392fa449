//! Options for the regions around a lumen.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::exit::Failure;
use super::network::NetworkArgs;
use super::numbers::{above_zero, number};
use super::units::Units;
use anastomesh_domain::{
    CutNetwork, DomainError, DomainPlan, EmbedPlan, ShellPlan, Thickness, TissuePlan, TissueRegion, TissueShape,
    VesselEnds,
};
use anastomesh_io::network::{NetworkFile, NetworkFormat, NetworkNote};
use anastomesh_io::surface::read_surface;
use anastomesh_mesh::TriMesh;
use anastomesh_skeleton::NodeId;

/// Options that need a lumen.
const NOT_EMBEDDED: [&str; 30] = [
    "annulus",
    "as_is",
    "core",
    "data",
    "dir",
    "drop_islands",
    "dry_run",
    "dump_dir",
    "follow",
    "frozen_joints",
    "joint",
    "keep_going",
    "layers",
    "order",
    "prisms",
    "refine",
    "refined",
    "report",
    "rho",
    "root",
    "shell",
    "size_at",
    "sizes_from",
    "split_regions",
    "stretch",
    "tissue_ends",
    "tissue_region",
    "tissue_remesh",
    "wall",
    "without",
];

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Regions")]
#[command(group = clap::ArgGroup::new("around").args(["tissue", "embed"]).multiple(true))]
pub struct DomainArgs {
    /// Vessel wall of this thickness: 0.05, 5um, 0.2r (r: radius), 5um+0.1r
    ///
    /// The name of an array gives the thickness at each node.
    #[arg(long, value_name = "THICKNESS", value_parser = checked::<ThicknessArg>, allow_hyphen_values = true)]
    wall: Option<String>,
    /// Number of layers of the vessel wall
    #[arg(long, value_name = "N", default_value_t = 2, requires = "wall")]
    wall_layers: u32,
    /// Ratio of the thickness of each layer of the wall to that of the previous one, outwards
    #[arg(long, value_name = "G", default_value_t = 1.0, value_parser = number, requires = "wall", allow_negative_numbers = true)]
    wall_growth: f64,
    /// Perivascular space around the wall, or around the lumen without one; THICKNESS as for `--wall`
    #[arg(long, value_name = "THICKNESS[:LAYERS]", value_parser = checked::<LayeredArg>, allow_hyphen_values = true)]
    annulus: Option<String>,
    /// Further shell outside these, for example `adventitia=0.1r:2`; repeatable, from the inside outwards
    #[arg(long, value_name = "NAME=THICKNESS[:LAYERS]", value_parser = checked::<ShellArg>)]
    shell: Vec<String>,
    /// Tissue: box, hull, box:MARGIN, hull:MARGIN, or a closed surface
    #[arg(long, value_name = "SHAPE", value_parser = checked::<TissueArg>)]
    tissue: Option<String>,
    /// Embed the vessels in the tissue as lines, for coupled 1D-3D models, instead of meshing them. Edges of the tissue are
    /// short at the vessels. `OUT_embedding.csv` lists the pieces of vessels in each cell (default: tissue in a box)
    #[arg(long, conflicts_with_all = NOT_EMBEDDED)]
    embed: bool,
    /// Edge length at embedded vessels: 5um, 2r (r: radius), 1um+0.5r, or the name of an array
    #[arg(long, value_name = "LENGTH", value_parser = checked::<ThicknessArg>, default_value = "2r", requires = "embed", allow_hyphen_values = true)]
    embed_size: String,
    /// Maximum edge length in the tissue (default: growth alone determines it)
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, requires = "around", allow_negative_numbers = true)]
    tissue_size: Option<f64>,
    /// Maximum ratio of edge lengths in adjacent layers of tetrahedra, away from the vessels
    #[arg(long, value_name = "G", default_value_t = TissuePlan::GROWTH, value_parser = number, requires = "around", allow_negative_numbers = true)]
    tissue_growth: f64,
    /// Remesh the surfaces of tissue and regions to `--tissue-size`, or with even triangles of their own size
    #[arg(long, requires = "tissue")]
    tissue_remesh: bool,
    /// End of vessels that leave the surface of a file around the tissue
    #[arg(long, value_enum, default_value_t = EndsArg::Surface, requires = "tissue")]
    tissue_ends: EndsArg,
    /// Maximum distance between a surface and the remeshed one (default: 0.001 of the diagonal)
    #[arg(long, value_name = "LENGTH", value_parser = above_zero, requires = "tissue_remesh", allow_negative_numbers = true)]
    tissue_tolerance: Option<f64>,
    /// Region of the tissue inside a closed surface, for example `tumour=tumour.stl`; repeatable
    #[arg(long, value_name = "NAME=SURFACE", value_parser = checked::<RegionArg>, requires = "tissue")]
    tissue_region: Vec<String>,
    /// Region to leave out of the result, for example lumen; repeatable
    #[arg(long, value_name = "REGION")]
    without: Vec<String>,
    /// Write each region to a file beside the output, too: `OUT_lumen.vtu`, `OUT_wall.vtu`, …. Points and cells have their
    /// numbers in the whole mesh (`GlobalNodeID`, `GlobalElementID`)
    #[arg(long)]
    split_regions: bool,
}

/// Ends of vessels that leave the organ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum EndsArg {
    /// At the surface, which is opened there
    Surface,
    /// Inside, at 1.5 outer radii from the surface
    Inside,
    /// Refuse such networks
    Refuse,
}

/// Text that can be read as a `T`.
fn checked<T: FromStr<Err = String>>(text: &str) -> Result<String, String> {
    text.parse::<T>().map(|_| text.to_owned())
}

/// Reads text that was checked.
fn read<T: FromStr<Err = String>>(text: &str) -> Result<T, Failure> {
    text.parse().map_err(Failure::usage)
}

/// Thickness on the command line.
#[derive(Clone, Debug, PartialEq)]
enum ThicknessArg {
    /// Lengths with their unit, and shares of the radius.
    Sum { lengths: Vec<(f64, Option<Units>)>, radii: f64 },
    /// Name of an array.
    Array(String),
}

/// Thickness with a number of layers.
#[derive(Clone, Debug, PartialEq)]
struct LayeredArg {
    thickness: ThicknessArg,
    layers: Option<u32>,
}

/// Shell with a name.
#[derive(Clone, Debug, PartialEq)]
struct ShellArg {
    name: String,
    layered: LayeredArg,
}

/// Region of the tissue with a name.
#[derive(Clone, Debug, PartialEq)]
struct RegionArg {
    name: String,
    surface: PathBuf,
}

#[derive(Clone, Debug, PartialEq)]
enum TissueArg {
    Box(Option<f64>),
    Hull(Option<f64>),
    Surface(PathBuf),
}

impl FromStr for ThicknessArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text.starts_with(|c: char| c.is_alphabetic() || c == '_') {
            return Ok(Self::Array(text.into()));
        }
        let (mut lengths, mut radii) = (Vec::new(), 0.0);
        for term in text.split('+').map(str::trim) {
            let end = term.find(|c: char| c.is_alphabetic() && c != 'e').unwrap_or(term.len());
            let (value, unit) = term.split_at(end);
            let value: f64 = value.trim().parse().map_err(|_| {
                format!("'{term}' is not a length or a share of the radius: give a number, 0.2r, or a sum of both")
            })?;
            match unit {
                "" => lengths.push((value, None)),
                "r" => radii += value,
                unit => lengths.push((value, Some(unit.parse()?))),
            }
        }
        Ok(Self::Sum { lengths, radii })
    }
}

impl FromStr for LayeredArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (thickness, layers) = match text.split_once(':') {
            Some((thickness, layers)) => {
                let count = layers.parse().map_err(|_| format!("'{layers}' is not a number of layers"))?;
                (thickness, Some(count))
            }
            None => (text, None),
        };
        Ok(Self { thickness: thickness.parse()?, layers })
    }
}

impl FromStr for ShellArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, layered) =
            text.split_once('=').ok_or_else(|| format!("'{text}' has no name: give NAME=THICKNESS[:LAYERS]"))?;
        Ok(Self { name: name.into(), layered: layered.parse()? })
    }
}

impl FromStr for RegionArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once('=') {
            Some((name, surface)) if !surface.is_empty() => Ok(Self { name: name.into(), surface: surface.into() }),
            _ => Err(format!("'{text}' has no name or no surface: give NAME=SURFACE")),
        }
    }
}

impl FromStr for TissueArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (shape, margin) = text.split_once(':').map_or((text, None), |(shape, margin)| (shape, Some(margin)));
        let margin = || {
            let read = |margin: &str| margin.parse().map_err(|_| format!("'{margin}' is not a margin"));
            margin.map(read).transpose()
        };
        match shape {
            "box" => Ok(Self::Box(margin()?)),
            "hull" => Ok(Self::Hull(margin()?)),
            _ => Ok(Self::Surface(text.into())),
        }
    }
}

impl ThicknessArg {
    /// Thickness in the unit of the network.
    fn of(&self, network: &NetworkArgs) -> Result<Thickness, Failure> {
        let name = match self {
            Self::Sum { lengths, radii } => {
                let mut length = 0.0;
                for &(value, unit) in lengths {
                    length += value * unit.map_or(Ok(1.0), |unit| factor(unit, network))?;
                }
                return Ok(Thickness::Law { length, radii: *radii });
            }
            Self::Array(name) => name,
        };
        if let Ok(NetworkFormat::Swc) = NetworkFormat::of(&network.network) {
            let path = network.network.display();
            return Err(Failure::input(format!(
                "{path}: SWC has no array '{name}': give a length or a share of the radius"
            )));
        }
        // The reader takes the array for radii.
        let options = network.options(true).radius_array(name.clone()).radius(None).diameters(false).radius_scale(None);
        let file = network.file_with(&options)?;
        Ok(Thickness::PerNode(file.skeleton.nodes.iter().map(|node| node.radius).collect()))
    }
}

/// Factor from a unit to that of the network.
fn factor(unit: Units, network: &NetworkArgs) -> Result<f64, Failure> {
    let [_, of_network] = network.units.map(Units::names).ok_or_else(|| {
        let [unit, _] = unit.names();
        Failure::usage(format!("a length in {unit} needs the unit of the network: give --units, or omit '{unit}'"))
    })?;
    let [from, _] = unit.names();
    let conversion: Units = format!("{from}:{of_network}").parse().map_err(Failure::usage)?;
    Ok(conversion.factor().unwrap_or(1.0))
}

impl DomainArgs {
    /// Requested regions. Reads the surface around the tissue, and arrays of the network.
    pub fn plan(&self, network: &NetworkArgs) -> Result<DomainPlan, Failure> {
        let mut shells = Vec::new();
        if let Some(wall) = &self.wall {
            let shell = ShellPlan::new("wall", read::<ThicknessArg>(wall)?.of(network)?);
            shells.push(shell.layers(self.wall_layers).growth(self.wall_growth));
        }
        if let Some(annulus) = &self.annulus {
            shells.push(read::<LayeredArg>(annulus)?.shell("annulus", network)?);
        }
        for shell in &self.shell {
            let ShellArg { name, layered } = read(shell)?;
            shells.push(layered.shell(&name, network)?);
        }
        let mut plan = DomainPlan::default().shells(shells).without(self.without.clone());
        if let Some(tissue) = &self.tissue {
            plan.tissue = Some(self.tissue(read::<TissueArg>(tissue)?)?);
        }
        plan.validate().map_err(|e| Failure::usage(e.to_string()))?;
        if self.split_regions && plan.is_plain() {
            return Err(Failure::usage(
                "--split-regions needs several regions: give --wall, --annulus, --shell or --tissue",
            ));
        }
        Ok(plan)
    }

    /// Cuts vessels that leave the organ, and adds their ends to the plan. `roots` are requested inlets.
    pub fn cut(&self, file: &mut NetworkFile, plan: &mut DomainPlan, roots: &[String]) -> Result<(), DomainError> {
        let (ends, Some(tissue)) = (self.tissue_ends, &plan.tissue) else { return Ok(()) };
        if ends == EndsArg::Refuse || !matches!(tissue.shape, TissueShape::Organ(_)) {
            return Ok(());
        }
        let ends = if ends == EndsArg::Inside { VesselEnds::Inside } else { VesselEnds::AtSurface };
        let asked = roots.iter().filter_map(|name| file.names.find(name, file.skeleton.nodes.len()));
        let roots: Vec<u32> = file.roots.iter().copied().chain(asked).map(|node| node.0).collect();
        let CutNetwork { network, gates, copies, report, .. } = CutNetwork::of(&file.skeleton, plan, ends, &roots)?;
        for copy in copies {
            file.names.add_copy(NodeId(copy));
            let arrays = plan.shells.iter_mut().filter_map(|shell| match &mut shell.thickness {
                Thickness::PerNode(values) => Some(values),
                _ => None,
            });
            arrays.for_each(|values| values.extend(values.get(copy as usize).copied()));
        }
        if let Some((node, at)) = report.first {
            let (vessels, removed) = (report.vessels, report.outside + report.inside);
            let node = file.names.of(NodeId(node));
            file.notes.push(NetworkNote::Cut { vessels, openings: gates.len(), node, at, removed });
        }
        file.skeleton = network;
        if let Some(tissue) = &mut plan.tissue {
            tissue.gates = gates;
        }
        Ok(())
    }

    fn tissue(&self, shape: TissueArg) -> Result<TissuePlan, Failure> {
        let regions: Result<_, Failure> =
            self.tissue_region.iter().map(|text| read::<RegionArg>(text)?.region()).collect();
        let tissue = TissuePlan::new(shape.shape()?).size(self.tissue_size).growth(self.tissue_growth);
        Ok(tissue.remesh(self.tissue_remesh).tolerance(self.tissue_tolerance).regions(regions?))
    }

    /// True if vessels are embedded in tissue instead of being meshed.
    pub fn embeds(&self) -> bool {
        self.embed
    }

    /// Requested embedding, with at most `max_tets` tetrahedra. Reads the surface around the tissue.
    pub fn embedding(&self, network: &NetworkArgs, max_tets: usize) -> Result<EmbedPlan, Failure> {
        let shape = self.tissue.as_ref().map_or(Ok(TissueArg::Box(None)), |tissue| read(tissue))?;
        let size = read::<ThicknessArg>(&self.embed_size)?.of(network)?;
        let plan = EmbedPlan::default().tissue(self.tissue(shape)?).size(size).max_tets(max_tets);
        plan.validate().map_err(|e| Failure::usage(e.to_string()))?;
        Ok(plan)
    }

    /// True if each region also gets a file of its own.
    pub fn splits(&self) -> bool {
        self.split_regions
    }

    /// Options as command-line text.
    pub fn typed(&self) -> String {
        let mut words = Vec::new();
        let mut add = |option: &str, value: &dyn fmt::Display| words.push(format!(" --{option} {value}"));
        if let Some(wall) = &self.wall {
            add("wall", wall);
            add("wall-layers", &self.wall_layers);
            add("wall-growth", &self.wall_growth);
        }
        self.annulus.iter().for_each(|annulus| add("annulus", annulus));
        self.shell.iter().for_each(|shell| add("shell", shell));
        if let Some(tissue) = &self.tissue {
            add("tissue", tissue);
            self.tissue_size.iter().for_each(|size| add("tissue-size", size));
            add("tissue-growth", &self.tissue_growth);
        }
        self.tissue_tolerance.iter().for_each(|tolerance| add("tissue-tolerance", tolerance));
        self.tissue_region.iter().for_each(|region| add("tissue-region", region));
        self.without.iter().for_each(|region| add("without", region));
        if self.embed {
            add("embed-size", &self.embed_size);
            words.push(" --embed".into());
        }
        if self.tissue.is_some() && self.tissue_ends == EndsArg::Inside {
            words.push(" --tissue-ends inside".into());
        }
        if self.tissue_remesh {
            words.push(" --tissue-remesh".into());
        }
        words.concat()
    }
}

impl LayeredArg {
    fn shell(&self, name: &str, network: &NetworkArgs) -> Result<ShellPlan, Failure> {
        let shell = ShellPlan::new(name, self.thickness.of(network)?);
        Ok(self.layers.map_or(shell.clone(), |layers| shell.layers(layers)))
    }
}

impl TissueArg {
    fn shape(self) -> Result<TissueShape, Failure> {
        match self {
            Self::Box(margin) => Ok(TissueShape::Box { margin }),
            Self::Hull(margin) => Ok(TissueShape::Hull { margin }),
            Self::Surface(path) => Ok(TissueShape::Organ(surface(&path)?)),
        }
    }
}

impl RegionArg {
    fn region(self) -> Result<TissueRegion, Failure> {
        Ok(TissueRegion::new(self.name, surface(&self.surface)?))
    }
}

fn surface(path: &Path) -> Result<TriMesh, Failure> {
    read_surface(path).map_err(|e| Failure::input(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thicknesses_are_sums_or_arrays() {
        let read = |text: &str| text.parse::<ThicknessArg>();
        let sum = |lengths: &[(f64, Option<Units>)], radii| Ok(ThicknessArg::Sum { lengths: lengths.to_vec(), radii });
        let um: Units = "um".parse().expect("a unit");
        assert_eq!(read("0.2r"), sum(&[], 0.2));
        assert_eq!(read("5um+0.1r"), sum(&[(5.0, Some(um))], 0.1));
        assert_eq!(read("1e-3"), sum(&[(1e-3, None)], 0.0));
        assert_eq!(read("wall_thickness"), Ok(ThicknessArg::Array("wall_thickness".into())));
        assert!(read("0.2q").is_err() && read("+").is_err() && read("1..2").is_err());
        let shell: ShellArg = "media=0.1r:3".parse().expect("a shell");
        assert_eq!((shell.name.as_str(), shell.layered.layers), ("media", Some(3)));
        assert!("0.1r".parse::<ShellArg>().is_err() && "a=0.1r:x".parse::<ShellArg>().is_err());
        assert_eq!("box:2.5".parse(), Ok(TissueArg::Box(Some(2.5))));
        assert_eq!("organ.stl".parse(), Ok(TissueArg::Surface("organ.stl".into())));
        assert_eq!("hull".parse(), Ok(TissueArg::Hull(None)));
        assert_eq!("boxes/organ.stl".parse(), Ok(TissueArg::Surface("boxes/organ.stl".into())));
        assert!("box:wide".parse::<TissueArg>().is_err() && "hull:".parse::<TissueArg>().is_err());
        let region: RegionArg = "tumour=a=b.stl".parse().expect("a region");
        assert_eq!((region.name.as_str(), region.surface), ("tumour", PathBuf::from("a=b.stl")));
        assert!("tumour.stl".parse::<RegionArg>().is_err() && "tumour=".parse::<RegionArg>().is_err());
    }
}
