//! Program `anastomesh-verify`: one line per mesh, `valid` or the violated conditions.

use anastomesh_verify::{Demands, Read, ReadError, certificate, read_mesh, read_network, read_surface, verify};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const HELP: &str = "\
Check tetrahedral meshes, independently of the mesher

Usage: anastomesh-verify [OPTIONS] MESH...

Arguments:
  MESH...                   .vtu, .msh (Gmsh 4.1 or 2.2 text) or .ele (TetGen)

Options:
  --list FILE               Check the meshes that a file names, one a line
  --surface FILE            Require each triangle of an .off, .stl or .ply as a boundary face
  --network FILE            Require the wall near the vessels of an .swc or .vtp
  --tolerance R             Maximum distance of the wall from the vessels, in radii [default: 0.5]
  --certificate FILE        Compare a certificate with the mesh
  --input FILE              Network or surface that the certificate names
  --key FILE                Key of the certificate's seal
  --write-certificate FILE  Write a certificate
  --json                    Print a JSON object per mesh
  -h, --help                Print help
  -V, --version             Print version

Exit codes: 0 valid, 1 not valid, 2 bad arguments, 3 unreadable file
";

#[derive(Default)]
struct Args {
    meshes: Vec<PathBuf>,
    surface: Option<PathBuf>,
    network: Option<PathBuf>,
    tolerance: Option<f64>,
    certificate: Option<PathBuf>,
    write_certificate: Option<PathBuf>,
    input: Option<PathBuf>,
    key: Option<PathBuf>,
    json: bool,
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words.iter().any(|word| ["-h", "--help"].contains(&word.as_str())) {
        print!("{HELP}");
        return ExitCode::SUCCESS;
    }
    if words.iter().any(|word| ["-V", "--version"].contains(&word.as_str())) {
        println!("anastomesh-verify {}", env!("CARGO_PKG_VERSION"));
        return ExitCode::SUCCESS;
    }
    let args = match parse(words) {
        Ok(args) => args,
        Err(problem) => {
            eprintln!("error: {problem}; --help lists the options");
            return ExitCode::from(2);
        }
    };
    match run(&args) {
        Ok(code) => ExitCode::from(code),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}

fn parse(words: Vec<String>) -> Result<Args, String> {
    let (mut args, mut words) = (Args::default(), words.into_iter());
    while let Some(word) = words.next() {
        let mut value = || words.next().map(PathBuf::from).ok_or_else(|| format!("{word} needs a value"));
        match word.as_str() {
            "--json" => args.json = true,
            "--surface" => args.surface = Some(value()?),
            "--network" => args.network = Some(value()?),
            "--certificate" => args.certificate = Some(value()?),
            "--write-certificate" => args.write_certificate = Some(value()?),
            "--input" => args.input = Some(value()?),
            "--key" => args.key = Some(value()?),
            "--tolerance" => {
                let number = value()?.to_str().and_then(|text| text.parse().ok()).filter(|r: &f64| *r > 0.0);
                args.tolerance = Some(number.ok_or("--tolerance needs a positive number")?);
            }
            "--list" => {
                let list = value()?;
                let text = std::fs::read_to_string(&list).map_err(|e| format!("{}: {e}", list.display()))?;
                args.meshes.extend(text.lines().filter(|line| !line.is_empty()).map(PathBuf::from));
            }
            option if option.starts_with('-') => return Err(format!("unknown option {option}")),
            _ => args.meshes.push(word.into()),
        }
    }
    let is_single = args.certificate.is_some() || args.write_certificate.is_some();
    match args.meshes.len() {
        0 => Err("no mesh".into()),
        2.. if is_single => Err("a certificate belongs to one mesh".into()),
        _ => Ok(args),
    }
}

/// Checks all meshes; the exit code is the largest of all.
fn run(args: &Args) -> Read<u8> {
    let demands = Demands {
        surface: args.surface.as_deref().map(read_surface).transpose()?,
        network: match &args.network {
            Some(path) => Some((read_network(path)?, args.tolerance.unwrap_or(0.5))),
            None => None,
        },
    };
    let mut code = 0;
    for mesh in &args.meshes {
        let (line, own) = one(args, &demands, mesh);
        code = code.max(own);
        // The reader of the output has closed it.
        if writeln!(std::io::stdout(), "{line}").is_err() {
            break;
        }
    }
    Ok(code)
}

/// Line and exit code of a mesh.
fn one(args: &Args, demands: &Demands, path: &Path) -> (String, u8) {
    let shown = path.display();
    match report(args, demands, path) {
        Err(error) if args.json => (serde_json::json!({"file": path, "error": error.to_string()}).to_string(), 3),
        Err(error) => (format!("{shown}: unreadable: {error}"), 3),
        Ok(report) => {
            let code = u8::from(!report.is_valid());
            let mut json = report.to_json();
            json["file"] = path.to_string_lossy().into();
            (if args.json { json.to_string() } else { format!("{shown}: {report}") }, code)
        }
    }
}

fn report(args: &Args, demands: &Demands, path: &Path) -> Read<anastomesh_verify::Report> {
    let mut report = verify(&read_mesh(path)?, demands);
    let named = |file: &PathBuf, e| ReadError::of_file(file, &e);
    let key = args.key.as_ref().map(|key| std::fs::read(key).map_err(|e| named(key, e))).transpose()?;
    if let Some(file) = &args.certificate {
        let text = std::fs::read_to_string(file).map_err(|e| named(file, e))?;
        certificate::check(&text, path, args.input.as_deref(), key.as_deref(), &mut report)?;
    }
    if let Some(file) = &args.write_certificate {
        let text = certificate::write(&report, path, args.input.as_deref(), key.as_deref())?;
        std::fs::write(file, text).map_err(|e| named(file, e))?;
    }
    Ok(report)
}
