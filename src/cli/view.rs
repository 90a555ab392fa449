//! `anastomesh view`: interactive 3D viewer as an HTML page.

use std::fs;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use super::check::check_opened;
use super::common::{ended, thread_pool};
use super::edge_values::EdgeValues;
use super::exit::{Exit, Failure};
use super::kind::{DRAWN, FileKind, OpenedMesh, boundary_of, left_in};
use super::limits;
use super::log;
use super::network::NetworkArgs;
use super::picture::vessels;
use super::values::{ArrayName, ArrayValues};
use crate::block::BlockDump;
use crate::picture::Legend;
use crate::view::{FaultGroup, Scale, ViewerPage, Wall, WallOptions, add_network, add_tets, add_values};
use anastomesh_flow::{Datum, VesselData};
use anastomesh_io::surface::read_surface;
use anastomesh_io::{ensure_text_writable, write_text};
use anastomesh_mesh::NamedRegion;
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::{NodeId, Skeleton};

/// Maximum number of tetrahedra of a mesh that is checked by default.
const CHECKED: usize = 2_000_000;

#[derive(Debug, clap::Args)]
#[command(mut_arg("network", |arg| arg.value_name("INPUT").help(DRAWN)))]
pub struct Args {
    #[command(flatten)]
    input: NetworkArgs,
    /// Output file (default: the input with the extension .html)
    #[arg(short, long, value_name = "PAGE.html")]
    output: Option<PathBuf>,
    /// Network of the mesh, for colours by radius and order, and for names of vessels and nodes
    #[arg(long = "network", value_name = "NETWORK")]
    made_of: Option<PathBuf>,
    /// Array of nodes or vessels shown by colours, with the unit of its values: Pressure:Pa
    #[arg(long, value_name = "NAME[:UNIT]")]
    data: Option<ArrayName>,
    /// Folder with dumps of failed blocks (default: the input with `.failed` appended, if it exists)
    #[arg(long, value_name = "DIR")]
    dump_dir: Option<PathBuf>,
    /// Check the mesh and mark failures in the viewer, for any size (default: up to 2 million tetrahedra)
    #[arg(long, conflicts_with = "no_check")]
    check: bool,
    /// Do not check the mesh
    #[arg(long)]
    no_check: bool,
    /// Memory limit for VTU files of `mesh`, which are then read block by block. Other files are loaded completely
    #[arg(long, value_name = "SIZE", default_value = "1GiB", value_parser = limits::size)]
    memory: u64,
    /// Number of threads (default: all cores); the result does not depend on it
    #[arg(short = 'j', long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Writes the page.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let input: &Path = &args.input.network;
    let output = args.output.clone().unwrap_or_else(|| input.with_extension("html"));
    let unwritable = |e: io::Error| Failure::unwritable(&output, &e);
    if output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("html")) {
        return Err(Failure::input(format!("{}: unrecognised viewer extension; known: .html", output.display())));
    }
    ensure_text_writable(&output).map_err(unwritable)?;
    let title = input.file_name().unwrap_or(input.as_os_str()).to_string_lossy().into_owned();
    let pool = thread_pool(args.threads)?;
    let page = pool.install(|| args.page(ViewerPage::new(&title)))?;
    let html = page.html().map_err(unwritable)?;
    write_text(&output, &html).map_err(unwritable)?;
    if !args.quiet {
        log::result(&format!("{}open it in a browser", ended(&[&output]).rows(&[])));
    }
    Ok(Exit::Fine)
}

impl Args {
    fn page(&self, mut page: ViewerPage) -> Result<ViewerPage, Failure> {
        let path: &Path = &self.input.network;
        page.know("unit", self.input.units.map(|units| units.names()[1]).into());
        let mut faults: Vec<FaultGroup> = self.dumps()?.into_iter().collect();
        if let Some(left) = left_in(path)? {
            page.add_check(Err("`view` checks finished meshes only"));
            faults.extend(self.add_mesh(&mut page, &left.whole(&()), &[])?);
            page.add_faults(&faults);
            return Ok(page);
        }
        match FileKind::of(path, "view")? {
            FileKind::Network => {
                let (network, inlets) = vessels(&self.input)?;
                faults.extend(FaultGroup::of_overlaps(&network));
                know_network(&mut page, &network, &inlets)?;
                self.add_values(&mut page, &self.input, &network)?;
            }
            FileKind::Surface => {
                let surface = read_surface(path).map_err(|e| Failure::input(e.to_string()))?;
                faults.extend(self.add_mesh(&mut page, &boundary_of(surface), &[])?);
            }
            FileKind::Mesh => {
                let mut opened = OpenedMesh::open(path, self.memory)?;
                faults.extend(self.faults_of(&mut page, &opened)?);
                opened.label_boundary();
                faults.extend(self.add_mesh(&mut page, opened.source(), &opened.notes().regions)?);
            }
        }
        page.add_faults(&faults);
        Ok(page)
    }

    /// Checks a mesh unless it is large or `--no-check` is given, and returns its faults.
    fn faults_of(&self, page: &mut ViewerPage, opened: &OpenedMesh) -> Result<Vec<FaultGroup>, Failure> {
        let skipped = if self.no_check {
            Some("--no-check was given")
        } else if !self.check && opened.source().counts().tets > CHECKED {
            Some("the mesh has more than 2 million tetrahedra; --check checks it")
        } else {
            None
        };
        let check = match skipped {
            Some(reason) => Err(reason),
            None => check_opened(&self.input.network, opened, self.memory)?
                .ok_or("the file cannot be checked within --memory"),
        };
        page.add_check(check.as_ref().map_err(|reason| *reason));
        Ok(check.map_or_else(|_| Vec::new(), |check| FaultGroup::of_check(&check)))
    }

    /// Adds a mesh, and returns the positions of missing blocks.
    fn add_mesh(
        &self,
        page: &mut ViewerPage,
        mesh: &dyn MeshSource,
        regions: &[NamedRegion],
    ) -> Result<Option<FaultGroup>, Failure> {
        let path = self.input.network.display();
        let failed = |e: io::Error| Failure::input(format!("{path}: {e}; run `anastomesh check`"));
        let args = self.made_of.clone().map(|network| NetworkArgs { network, ..self.input.clone() });
        let network = args.as_ref().map(vessels).transpose()?;
        if self.data.is_some() && network.is_none() {
            return Err(Failure::usage("--data needs the network with the array: give --network NETWORK"));
        }
        let data = |(network, _): &(Skeleton, _)| VesselData::new(vec![Datum::Radius, Datum::Strahler], network, mesh);
        let data = network.as_ref().map(data).transpose()?;
        let array = match args.as_ref().zip(network.as_ref()) {
            Some((args, (network, _))) => self
                .add_values(page, args, network)?
                .map(|(found, scale)| (EdgeValues::new(network, found.values), scale)),
            None => None,
        };
        let options = WallOptions {
            vessels: data.as_ref().map(|data| data as _),
            values: array.as_ref().map(|(values, _)| values as _),
        };
        let wall = Wall::of(mesh, &options).map_err(failed)?;
        if wall.triangles() == 0 {
            return Err(Failure::input(format!("{path}: the mesh has no boundary to show")));
        }
        let tets = add_tets(mesh, &wall, !regions.is_empty(), &mut page.pack).map_err(failed)?;
        page.know("tets", tets);
        let missing = FaultGroup::of_missing(&wall, mesh.patches());
        page.add_wall(wall, mesh.patches(), regions, array.map(|(_, scale)| scale));
        if let Some((network, inlets)) = &network {
            know_network(page, network, inlets)?;
        }
        Ok(missing)
    }

    /// Adds the requested array of a network, and returns its values with their scale.
    fn add_values(
        &self,
        page: &mut ViewerPage,
        args: &NetworkArgs,
        network: &Skeleton,
    ) -> Result<Option<(ArrayValues, Scale)>, Failure> {
        let Some(array) = &self.data else { return Ok(None) };
        let found = ArrayValues::read(args, array, network)?;
        let Legend { low, high, logarithmic } = found.legend;
        let scale = Scale { low, high, logarithmic };
        add_values(&found.values, scale, &mut page.pack);
        page.know("data", serde_json::json!({ "name": array.name, "unit": array.unit, "scale": scale }));
        Ok(Some((found, scale)))
    }

    /// Failed blocks, from their dumps.
    fn dumps(&self) -> Result<Option<FaultGroup>, Failure> {
        let beside = || {
            let mut name = self.input.network.clone().into_os_string();
            name.push(".failed");
            PathBuf::from(name)
        };
        let folder = self.dump_dir.clone().unwrap_or_else(beside);
        if self.dump_dir.is_none() && !folder.is_dir() {
            return Ok(None);
        }
        let unreadable = |e: io::Error| Failure::unreadable(&folder, &e);
        let mut files = Vec::new();
        for entry in fs::read_dir(&folder).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            if path.extension().is_some_and(|e| e == "json") {
                files.push(path);
            }
        }
        files.sort_unstable();
        // Other files in the folder are ignored.
        let dump = |path: &PathBuf| BlockDump::from_json(&fs::read(path).ok()?).ok();
        Ok(FaultGroup::of_dumps(files.iter().filter_map(dump)))
    }
}

fn know_network(page: &mut ViewerPage, network: &Skeleton, inlets: &[NodeId]) -> Result<(), Failure> {
    let fact = add_network(network, inlets, &mut page.pack)?;
    page.know("network", fact);
    Ok(())
}
