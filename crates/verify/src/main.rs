//! Program `anastomesh-verify`: one line per mesh, `valid` or the violated conditions.

use anastomesh_verify::{Demands, Report, certificate, read_mesh, read_network, read_surface, verify};
use anyhow::{Context as _, Result};
use clap::error::ErrorKind;
use clap::{CommandFactory as _, Parser};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Check tetrahedral meshes, independently of the mesher
#[derive(Parser)]
#[command(version, args_override_self = true)]
#[command(after_help = "Exit codes: 0 valid, 1 not valid, 2 bad arguments, 3 unreadable file")]
struct Args {
    /// .vtu, .msh (Gmsh 4.1 or 2.2 text) or .ele (TetGen)
    #[arg(value_name = "MESH", required_unless_present = "list")]
    meshes: Vec<PathBuf>,
    /// Check the meshes that a file names, one a line
    #[arg(long, value_name = "FILE", value_parser = read_list)]
    list: Option<List>,
    /// Require each triangle of an .off, .stl or .ply as a boundary face
    #[arg(long, value_name = "FILE")]
    surface: Option<PathBuf>,
    /// Require the wall near the vessels of an .swc or .vtp
    #[arg(long, value_name = "FILE")]
    network: Option<PathBuf>,
    /// Maximum distance of the wall from the vessels, in radii
    #[arg(long, value_name = "R", default_value = "0.5", value_parser = positive)]
    tolerance: f64,
    /// Compare a certificate with the mesh
    #[arg(long, value_name = "FILE")]
    certificate: Option<PathBuf>,
    /// Network or surface that the certificate names
    #[arg(long, value_name = "FILE")]
    input: Option<PathBuf>,
    /// Key of the certificate's seal
    #[arg(long, value_name = "FILE")]
    key: Option<PathBuf>,
    /// Write a certificate
    #[arg(long, value_name = "FILE")]
    write_certificate: Option<PathBuf>,
    /// Print a JSON object per mesh
    #[arg(long)]
    json: bool,
}

#[derive(Clone)]
struct List(Vec<PathBuf>);

fn read_list(file: &str) -> std::io::Result<List> {
    let text = std::fs::read_to_string(file)?;
    Ok(List(text.lines().filter(|line| !line.is_empty()).map(PathBuf::from).collect()))
}

fn positive(text: &str) -> std::result::Result<f64, &'static str> {
    text.parse().ok().filter(|&number| number > 0.0).ok_or("a positive number is needed")
}

fn main() -> ExitCode {
    let mut args = Args::parse();
    args.meshes.extend(args.list.take().into_iter().flat_map(|list| list.0));
    let is_single = args.certificate.is_some() || args.write_certificate.is_some();
    match args.meshes.len() {
        0 => Args::command().error(ErrorKind::MissingRequiredArgument, "no mesh").exit(),
        2.. if is_single => {
            Args::command().error(ErrorKind::TooManyValues, "a certificate belongs to one mesh").exit();
        }
        _ => {}
    }
    run(&args).map_or_else(
        |error| {
            eprintln!("error: {error:#}");
            ExitCode::from(3)
        },
        ExitCode::from,
    )
}

/// Checks all meshes; the exit code is the largest of all.
fn run(args: &Args) -> Result<u8> {
    let network = args.network.as_deref().map(read_network).transpose()?;
    let demands = Demands {
        surface: args.surface.as_deref().map(read_surface).transpose()?,
        network: network.map(|cones| (cones, args.tolerance)),
    };
    let mut code = 0;
    for mesh in &args.meshes {
        let (line, own) = line(mesh, report(args, &demands, mesh), args.json);
        code = code.max(own);
        // The reader of the output has closed it.
        if writeln!(std::io::stdout(), "{line}").is_err() {
            break;
        }
    }
    Ok(code)
}

/// Line and exit code of a mesh.
fn line(path: &Path, report: Result<Report>, is_json: bool) -> (String, u8) {
    let shown = path.to_string_lossy();
    match report {
        Err(error) if is_json => (serde_json::json!({"file": shown, "error": format!("{error:#}")}).to_string(), 3),
        Err(error) => (format!("{shown}: unreadable: {error:#}"), 3),
        Ok(report) => {
            let mut json = report.to_json();
            json["file"] = shown.as_ref().into();
            let line = if is_json { json.to_string() } else { format!("{shown}: {report}") };
            (line, u8::from(!report.is_valid()))
        }
    }
}

fn report(args: &Args, demands: &Demands, path: &Path) -> Result<Report> {
    let mut report = verify(&read_mesh(path)?, demands);
    let read = |file: &PathBuf| std::fs::read(file).with_context(|| file.display().to_string());
    let (input, key) = (args.input.as_deref(), args.key.as_ref().map(read).transpose()?);
    if let Some(file) = &args.certificate {
        let text = String::from_utf8(read(file)?).with_context(|| file.display().to_string())?;
        certificate::check(&text, path, input, key.as_deref(), &mut report)?;
    }
    if let Some(file) = &args.write_certificate {
        let text = certificate::write(&report, path, input, key.as_deref())?;
        std::fs::write(file, text).with_context(|| file.display().to_string())?;
    }
    Ok(report)
}
