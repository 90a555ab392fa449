//! Floor 8: what was typed, resolved into one plan; progress bars; exit codes. One file per verb.

mod blocks;
mod check;
mod colours;
mod common;
mod completions;
mod config;
mod convert;
mod dual;
mod exit;
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
mod page;
mod picture;
mod prepare;
mod progress;
mod refine;
mod render;
mod replay;
mod run;
mod stop;
mod surface;
mod tetrahedralize;
mod units;
mod view;
mod work;

use std::process::ExitCode;

use std::path::PathBuf;

use clap::{ArgMatches, Command, CommandFactory, FromArgMatches, Parser, Subcommand};
pub use exit::Exit;
use exit::Failure;
use log::LogFormat;

/// From the skeleton of a vascular network to one valid tetrahedral volume mesh.
#[derive(Debug, Parser)]
#[command(
    name = "anastomesh",
    version,
    propagate_version = true,
    arg_required_else_help = true,
    args_override_self = true
)]
#[command(after_help = "Exit codes: 0 fine, 1 a gate is not met (the mesh is not valid), 2 usage, 3 bad input, \
                        4 a stage failed, 70 a fault of the program, 130 stopped by Ctrl-C.")]
struct Args {
    /// Take options from a file, by their long names: what is typed comes after it and wins; the resolved plan is written
    /// beside the output as `OUTPUT_plan.toml`
    #[arg(long, global = true, value_name = "PLAN.toml", help_heading = "General", hide_short_help = true)]
    config: Option<PathBuf>,
    /// How messages are written
    #[arg(long, global = true, value_enum, default_value_t = LogFormat::Text, help_heading = "General", hide_short_help = true)]
    log_format: LogFormat,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Mesh a network: skeleton in, labelled tetrahedral mesh out
    Mesh(Box<mesh::Args>),
    /// Make the wall of a network alone, for pictures and printers: STL, PLY, OBJ, GLB, 3MF
    Surface(surface::Args),
    /// Make a measured network one graph: doubled lines merged, spurs off, radii filled, points as needed
    Prepare(prepare::Args),
    /// Move the nodes of a network until its vessels do not overlap and can be cut
    Refine(refine::Args),
    /// Grow a second tree that shares the terminals of the first, as veins do with arteries
    Dual(dual::Args),
    /// Grow a network of vessels that fills an organ
    Generate(generate::Args),
    /// Fill a surface, a complex of facets or points with tetrahedra
    Tetrahedralize(tetrahedralize::Args),
    /// Write a volume mesh, a surface or a network in another format, or a volume mesh's boundary
    Convert(convert::Args),
    /// Draw a mesh, a surface or a network as a PNG picture
    Render(Box<render::Args>),
    /// Make a page of a mesh, a surface or a network that turns it in any browser
    View(Box<view::Args>),
    /// Verify a volume mesh line by line
    Check(check::Args),
    /// Make a block again that failed, from what `mesh` left of it
    Replay(replay::Args),
    /// Print what a network holds
    Info(info::Args),
    /// Print what a shell needs to complete this command line
    Completions(completions::Args),
    /// Print a page of the manual
    Man(man::Args),
}

/// Runs the program on the process's arguments.
pub fn main() -> ExitCode {
    common::begin();
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
            // Help and version come this way too, and are no errors.
            let exit = if error.use_stderr() { Exit::Usage } else { Exit::Fine };
            if error.use_stderr() && log::is_json() {
                return failed(&Failure::usage(error.render().to_string()));
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
        Verb::Convert(args) => convert::run(args),
        Verb::Render(args) => render::run(args),
        Verb::View(args) => view::run(args),
        Verb::Check(args) => check::run(args),
        Verb::Replay(args) => replay::run(args),
        Verb::Info(args) => info::run(args),
        Verb::Completions(args) => completions::run(args, definition()),
        Verb::Man(args) => man::run(args, &definition()),
    });
    // A run that failed is to be run again, too.
    let plan = config.map_or(Ok(()), |_| write_plan(&matches));
    match (result, plan) {
        (Ok(Ok(exit)), Ok(())) => exit.into(),
        (Ok(Ok(_)), Err(failure)) | (Ok(Err(failure)), _) => failed(&failure),
        (Err(_), _) => Exit::Bug.into(),
    }
}

/// Says why it ends.
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

/// Writes the options as they were resolved.
fn write_plan(matches: &ArgMatches) -> Result<(), Failure> {
    let definition = definition();
    let Some((name, matches)) = matches.subcommand() else { return Ok(()) };
    definition.find_subcommand(name).map_or(Ok(()), |verb| config::write_resolved(verb, matches))
}

/// The command line, with the options that every verb has.
fn definition() -> Command {
    let mut definition = Args::command();
    definition.build();
    definition
}

/// A panic is always a fault of the program: say so beside the usual message.
fn install_panic_note() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if log::is_json() {
            log::error(&info.to_string());
        } else {
            usual(info);
        }
        log::error("this is a fault of the program; please report it with the input and the options");
    }));
}
