//! `anastomesh view`: a mesh or a network as a page that opens in any browser.

use std::fs;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use super::common::thread_pool;
use super::exit::{Exit, Failure};
use super::kind::{Kind, OpenedMesh, boundary_of};
use super::network::NetworkArgs;
use super::picture::vessels;
use super::room;
use crate::block::BlockDump;
use crate::io::surface::read_surface;
use crate::io::{ensure_text_writable, write_text};
use crate::mesh::check::{check_tets, check_volume};
use crate::mesh::source::MeshSource;
use crate::pipeline::{Datum, VesselData};
use crate::skeleton::{NodeId, Skeleton};
use crate::view::{Fault, Page, Wall, WallOptions, add_network, add_tets};

/// A mesh of no more tetrahedra is checked, so that its faults can be seen.
const CHECKED: usize = 2_000_000;

#[derive(Debug, clap::Args)]
#[command(mut_arg("network", |arg| arg.value_name("INPUT").help(
    "A volume mesh (.vtu, .pvtu, .msh, .mesh, .ele), a surface (.stl, .ply, .obj, .off) or a network (as `mesh` reads)")))]
pub struct Args {
    #[command(flatten)]
    input: NetworkArgs,
    /// Where the page goes (default: the input with .html for its extension)
    #[arg(short, long, value_name = "PAGE.html")]
    output: Option<PathBuf>,
    /// The network that the mesh was made of: colours by radius and order, and a click names vessel and node
    #[arg(long = "network", value_name = "NETWORK")]
    made_of: Option<PathBuf>,
    /// Folder with the dumps of blocks that failed (default: the input with `.failed` appended, if that is there)
    #[arg(long, value_name = "DIR")]
    dump_dir: Option<PathBuf>,
    /// Do not check the mesh (meshes of more than two million tetrahedra are never checked here; `check --report` shows their
    /// faults)
    #[arg(long)]
    no_check: bool,
    /// Memory to keep to with a VTU file of the verb mesh: when it needs more, it is read block by block. All other files are
    /// held as a whole
    #[arg(long, value_name = "SIZE", default_value = "1GiB", value_parser = room::size)]
    memory: u64,
    /// Number of threads (default: all cores); the page does not depend on it
    #[arg(short = 'j', long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

/// Writes the page.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let input: &Path = &args.input.network;
    let output = args.output.clone().unwrap_or_else(|| input.with_extension("html"));
    let unwritable = |e: io::Error| Failure::input(format!("{}: cannot be written: {e}", output.display()));
    if output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("html")) {
        return Err(Failure::input(format!("{}: pages are written as .html", output.display())));
    }
    ensure_text_writable(&output).map_err(unwritable)?;
    let kind = Kind::of(input, "view")?;
    let title = input.file_name().unwrap_or(input.as_os_str()).to_string_lossy().into_owned();
    let pool = thread_pool(args.threads)?;
    let page = pool.install(|| args.page(kind, Page::new(&title)))?;
    let html = page.html().map_err(unwritable)?;
    write_text(&output, &html).map_err(unwritable)?;
    if !args.quiet {
        eprintln!("{} ({:.1} MB): open it in a browser", output.display(), html.len() as f64 / 1e6);
    }
    Ok(Exit::Fine)
}

impl Args {
    fn page(&self, kind: Kind, mut page: Page) -> Result<Page, Failure> {
        let path: &Path = &self.input.network;
        let mut faults = self.dumps()?;
        match kind {
            Kind::Network => {
                let (network, inlets) = vessels(&self.input)?;
                faults.extend(Fault::of_overlaps(&network));
                know_network(&mut page, &network, &inlets);
            }
            Kind::Surface => {
                let surface = read_surface(path).map_err(|e| Failure::input(e.to_string()))?;
                self.add_mesh(&mut page, &boundary_of(surface))?;
            }
            Kind::Mesh => {
                let mut opened = OpenedMesh::open(path, self.memory)?;
                if !self.no_check {
                    faults.extend(faults_of(&opened));
                }
                opened.label_boundary();
                self.add_mesh(&mut page, opened.source())?;
            }
        }
        page.add_faults(&faults);
        Ok(page)
    }

    fn add_mesh(&self, page: &mut Page, mesh: &dyn MeshSource) -> Result<(), Failure> {
        let path = self.input.network.display();
        let failed = |e: io::Error| Failure::input(format!("{path}: {e}; run `anastomesh check`"));
        let network = match &self.made_of {
            Some(network) => Some(vessels(&NetworkArgs { network: network.clone(), ..self.input.clone() })?),
            None => None,
        };
        let data =
            network.as_ref().map(|(network, _)| VesselData::new(vec![Datum::Radius, Datum::Strahler], network, mesh));
        let options = WallOptions { vessels: data.as_ref().map(|data| data as _) };
        let wall = Wall::of(mesh, &options).map_err(failed)?;
        if wall.triangles() == 0 {
            return Err(Failure::input(format!("{path}: there is nothing to be seen: it has no boundary")));
        }
        let tets = add_tets(mesh, &wall, &mut page.pack).map_err(failed)?;
        page.know("tets", tets);
        page.add_wall(wall, mesh.patches());
        if let Some((network, inlets)) = &network {
            know_network(page, network, inlets);
        }
        Ok(())
    }

    /// The blocks that failed, by their dumps.
    fn dumps(&self) -> Result<Vec<Fault>, Failure> {
        let beside = || {
            let mut name = self.input.network.clone().into_os_string();
            name.push(".failed");
            PathBuf::from(name)
        };
        let folder = self.dump_dir.clone().unwrap_or_else(beside);
        if self.dump_dir.is_none() && !folder.is_dir() {
            return Ok(Vec::new());
        }
        let unreadable = |e: io::Error| Failure::input(format!("{}: cannot be read: {e}", folder.display()));
        let mut files = Vec::new();
        for entry in fs::read_dir(&folder).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            if path.extension().is_some_and(|e| e == "json") {
                files.push(path);
            }
        }
        files.sort_unstable();
        // What is no dump says nothing of the mesh.
        let fault = |path: &PathBuf| {
            let dump = BlockDump::from_json(&fs::read(path).ok()?).ok()?;
            Fault::of_dump(&dump)
        };
        Ok(files.iter().filter_map(fault).collect())
    }
}

fn know_network(page: &mut Page, network: &Skeleton, inlets: &[NodeId]) {
    let fact = add_network(network, inlets, &mut page.pack);
    page.know("network", fact);
}

/// What a check finds in a mesh that is not too large for it.
fn faults_of(opened: &OpenedMesh) -> Vec<Fault> {
    let OpenedMesh::Whole(file) = opened else { return Vec::new() };
    if file.volume.mesh.tets.len() > CHECKED {
        return Vec::new();
    }
    let expectation = file.notes.expectation.as_ref();
    let check = if file.labelled {
        check_volume(&file.volume, expectation)
    } else {
        check_tets(&file.volume.mesh, expectation)
    };
    Fault::of_check(&check)
}
