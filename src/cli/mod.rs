//! Command line: options, progress bars, exit codes. One file per command.

mod bar;
mod blocks;
mod certificate;
mod check;
mod clock;
mod colours;
mod common;
mod completions;
mod config;
mod convert;
mod domain;
mod dual;
mod edge_values;
mod embed;
mod exit;
mod fidelity;
mod flow;
mod format;
mod generate;
mod grid;
mod help;
mod hint;
mod info;
mod kind;
mod layers;
mod limits;
mod log;
mod man;
mod mesh;
mod network;
mod network_flow;
mod numbers;
mod order;
mod page;
mod picture;
mod prepare;
mod progress;
mod refine;
mod regions;
mod render;
mod replay;
mod run;
mod stop;
mod surface;
mod tetrahedralize;
mod units;
mod values;
mod view;
mod work;
mod wrap;

use std::process::ExitCode;

use std::path::PathBuf;

use clap::{ArgMatches, Command, CommandFactory, FromArgMatches, Parser, Subcommand};
pub use exit::Exit;
use exit::Failure;
use log::LogFormat;

/// Makes tetrahedral volume meshes of vascular networks.
#[derive(Debug, Parser)]
#[command(
    name = "anastomesh",
    version,
    propagate_version = true,
    arg_required_else_help = true,
    args_override_self = true
)]
#[command(
    after_help = "Exit codes: 0 success, 1 validation failed, 2 usage error, 3 invalid input, 4 a stage failed, \
                        70 internal error, 130 stopped by Ctrl-C."
)]
struct Args {
    /// Read options from a file, by their long names; command-line options take precedence. The resolved options are
    /// written to `OUTPUT_plan.toml`
    #[arg(long, global = true, value_name = "PLAN.toml", help_heading = "General", hide_short_help = true)]
    config: Option<PathBuf>,
    /// Format of messages
    #[arg(long, global = true, value_enum, default_value_t = LogFormat::Text, help_heading = "General", hide_short_help = true)]
    log_format: LogFormat,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Mesh a network with tetrahedra
    Mesh(Box<mesh::Args>),
    /// Write the wall surface of a network (STL, PLY, OBJ, GLB, 3MF)
    Surface(surface::Args),
    /// Repair a measured network: duplicate lines, spurs, missing radii, point spacing
    Prepare(prepare::Args),
    /// Move overlapping vessels of a network apart
    Refine(refine::Args),
    /// Grow a second tree that shares the terminals of the first, such as veins
    Dual(dual::Args),
    /// Grow a vessel network that fills an organ
    Generate(generate::Args),
    /// Mesh a surface, a facet complex or points with tetrahedra
    Tetrahedralize(tetrahedralize::Args),
    /// Solve for the one-dimensional flow through a network; write models for 0D and 1D solvers, or results along vessels
    Flow(Box<network_flow::Args>),
    /// Convert a volume mesh, a surface or a network to another format, or a mesh to its boundary
    Convert(convert::Args),
    /// Draw a mesh, a surface or a network as a PNG image
    Render(Box<render::Args>),
    /// Write an interactive 3D viewer of a mesh, a surface or a network as an HTML page
    View(Box<view::Args>),
    /// Check the validity of a volume mesh
    Check(check::Args),
    /// Repeat a failed block from its dump
    Replay(replay::Args),
    /// Print the properties of a network
    Info(info::Args),
    /// Print shell completions
    Completions(completions::Args),
    /// Print a manual page
    Man(man::Args),
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    clock::begin();
    install_panic_note();
    LogFormat::of_words(&std::env::args_os().collect::<Vec<_>>()).set();
    let (words, config) = match config::expanded(std::env::args_os().collect(), &definition()) {
        Ok(expanded) => expanded,
        Err(failure) => return failed(&failure),
    };
    LogFormat::of_words(&words).set();
    let parsed = help::shortened(Args::command()).try_get_matches_from(words);
    let parsed = parsed.and_then(|matches| Ok((Args::from_arg_matches(&matches)?, matches)));
    let (args, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => {
            // Help and version are also reported as errors by clap.
            let exit = if error.use_stderr() { Exit::Usage } else { Exit::Fine };
            if error.use_stderr() && log::is_json() {
                let message = error.render().to_string();
                return failed(&Failure::usage(message.strip_prefix("error: ").unwrap_or(&message)));
            }
            return if error.print().is_ok() { exit.into() } else { Exit::BadInput.into() };
        }
    };
    args.log_format.set();
    keep_options(&matches);
    let result = std::panic::catch_unwind(|| match &args.verb {
        Verb::Mesh(args) => mesh::run(args),
        Verb::Surface(args) => surface::run(args),
        Verb::Prepare(args) => prepare::run(args),
        Verb::Refine(args) => refine::run(args),
        Verb::Dual(args) => dual::run(args),
        Verb::Generate(args) => generate::run(args),
        Verb::Tetrahedralize(args) => tetrahedralize::run(args),
        Verb::Flow(args) => network_flow::run(args),
        Verb::Convert(args) => convert::run(args),
        Verb::Render(args) => render::run(args),
        Verb::View(args) => view::run(args),
        Verb::Check(args) => check::run(args),
        Verb::Replay(args) => replay::run(args),
        Verb::Info(args) => info::run(args),
        Verb::Completions(args) => completions::run(args, definition()),
        Verb::Man(args) => man::run(args, &definition()),
    });
    // The options of a failed run are written, too.
    let plan = config.map_or(Ok(()), |_| write_plan(&matches));
    match (result, plan) {
        (Ok(Ok(exit)), Ok(())) => exit.into(),
        (Ok(Ok(_)), Err(failure)) | (Ok(Err(failure)), _) => failed(&failure),
        (Err(_), _) => Exit::Bug.into(),
    }
}

/// Prints a failure and returns its exit code.
fn failed(Failure { exit, message }: &Failure) -> ExitCode {
    log::error(message);
    (*exit).into()
}

/// Keeps the options in force for the report.
fn keep_options(matches: &ArgMatches) {
    let definition = definition();
    let verb = matches.subcommand().and_then(|(name, matches)| Some((definition.find_subcommand(name)?, matches)));
    if let Some((verb, matches)) = verb {
        config::keep_options(verb, matches);
    }
}

/// Writes the resolved options.
fn write_plan(matches: &ArgMatches) -> Result<(), Failure> {
    let definition = definition();
    let Some((name, matches)) = matches.subcommand() else { return Ok(()) };
    definition.find_subcommand(name).map_or(Ok(()), |verb| config::write_resolved(verb, matches))
}

/// Definition of the command line, with global options.
fn definition() -> Command {
    let mut definition = Args::command();
    definition.build();
    definition
}

/// Adds a note to panic messages: a panic is always an internal error.
fn install_panic_note() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if log::is_json() {
            log::error(&info.to_string());
        } else {
            usual(info);
        }
        log::error("internal error: please report it with the input and the options");
    }));
}
