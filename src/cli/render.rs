//! `anastomesh render`: picture of a mesh, a surface or a network.

use std::path::{Path, PathBuf};

use super::common::{ended, thread_pool};
use super::exit::{Exit, Failure};
use super::kind::{DRAWN, FileKind, OpenedMesh, boundary_of, left_in};
use super::limits;
use super::log;
use super::network::NetworkArgs;
use super::picture::{PictureArgs, vessels};
use super::values::{ArrayName, ArrayValues};
use crate::picture::{Colour, Image, Legend, Shown};
use crate::report::rows::row;
use anastomesh_io::surface::read_surface;
use anastomesh_io::{ensure_text_writable, write_bytes};
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::Skeleton;
use std::num::NonZeroUsize;

#[derive(Debug, clap::Args)]
#[command(mut_arg("network", |arg| arg.value_name("INPUT").help(DRAWN)))]
pub struct Args {
    #[command(flatten)]
    input: NetworkArgs,
    /// Output file
    #[arg(short, long, value_name = "PICTURE.png", help_heading = "Output")]
    output: PathBuf,
    /// Network of the mesh, for colours by radius or order
    #[arg(long = "network", value_name = "NETWORK")]
    made_of: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureArgs,
    /// Memory limit for VTU files of `mesh`, which are then read block by block. Other files are loaded completely
    #[arg(long, value_name = "SIZE", default_value = "2GiB", value_parser = limits::size)]
    memory: u64,
    /// Number of threads (default: all cores); the result does not depend on it
    #[arg(short = 'j', long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Draws a file.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let unwritable = |e: std::io::Error| Failure::unwritable(&args.output, &e);
    if args.output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("png")) {
        return Err(Failure::input(format!("{}: unrecognised picture extension; known: .png", args.output.display())));
    }
    ensure_text_writable(&args.output).map_err(unwritable)?;
    let pool = thread_pool(args.threads)?;
    let (image, shown) = pool.install(|| args.draw())?;
    let mut bytes = Vec::new();
    image.write_png(&mut bytes).map_err(unwritable)?;
    write_bytes(&args.output, &bytes).map_err(unwritable)?;
    if !args.quiet {
        let colours =
            told(shown, args.picture.data.as_ref()).map_or_else(String::new, |colours| row("colours", &colours));
        log::result(&(colours + &ended(&[&args.output]).rows(&[])));
    }
    Ok(Exit::Fine)
}

impl Args {
    fn draw(&self) -> Result<(Image, Shown), Failure> {
        let path: &Path = &self.input.network;
        if let Some(left) = left_in(path)? {
            return self.draw_mesh(&left.whole(&()));
        }
        match FileKind::of(path, "render")? {
            FileKind::Network => {
                let (network, roots) = vessels(&self.input)?;
                let values = self.values(&self.input, &network)?;
                self.picture.network(&network, &roots, values.as_ref())
            }
            FileKind::Surface => {
                let surface = read_surface(path).map_err(|e| Failure::input(e.to_string()))?;
                self.draw_mesh(&boundary_of(surface))
            }
            FileKind::Mesh => {
                let mut opened = OpenedMesh::open(path, self.memory)?;
                opened.label_boundary();
                self.draw_mesh(opened.source())
            }
        }
    }

    /// Draws a mesh, with its network if given.
    fn draw_mesh(&self, mesh: &dyn MeshSource) -> Result<(Image, Shown), Failure> {
        let path: &Path = &self.input.network;
        let Some(network) = &self.made_of else { return self.picture.mesh(path, mesh, None) };
        let args = NetworkArgs { network: network.clone(), ..self.input.clone() };
        let network = vessels(&args)?.0;
        let values = self.values(&args, &network)?;
        self.picture.mesh(path, mesh, Some((&network, values.as_ref())))
    }

    /// Values of the requested array.
    fn values(&self, args: &NetworkArgs, network: &Skeleton) -> Result<Option<ArrayValues>, Failure> {
        self.picture.data.as_ref().map(|array| ArrayValues::read(args, array, network)).transpose()
    }
}

/// Text on the meaning of the colours.
fn told(shown: Shown, data: Option<&ArrayName>) -> Option<String> {
    let scale =
        |what: &str| shown.legend.map(|l| format!("{what} from {:.4} (dark violet) to {:.4} (yellow)", l.low, l.high));
    match shown.colour {
        Colour::Radius => scale("radius (logarithmic)"),
        Colour::Order => scale("Strahler order"),
        Colour::Quality => Some("radius ratio from 0 (red) to 1 (blue)".into()),
        Colour::Patch => Some("wall red, inlets blue, outlets yellow, interior cream".into()),
        Colour::Values => {
            let Legend { low, high, logarithmic } = shown.legend?;
            let logarithmic = if logarithmic { " (logarithmic)" } else { "" };
            let title = data?.title();
            Some(format!("{title}{logarithmic} from {low:.4e} (dark violet) to {high:.4e} (yellow); none: grey"))
        }
        Colour::Plain | Colour::Block => None,
    }
}
