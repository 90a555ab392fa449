//! Short help (`-h`): the most common options, and a list of the other groups.

use clap::{Arg, ArgAction, Command};

/// Groups that appear in the short help of at most one command, with that command.
const GROUPS: [(&str, &str); 4] =
    [("Preparation", "prepare"), ("Refinement", "refine"), ("Flow", ""), ("VTU and PVTU", "convert")];

/// Options that only the long help lists.
const RARE: [&str; 71] = [
    "allow-displaced",
    "allow-dropped",
    "angle-rate",
    "annulus",
    "array",
    "barrier-rate",
    "certificate",
    "config",
    "core",
    "data",
    "diameters",
    "drop-islands",
    "dump-dir",
    "embed",
    "embed-size",
    "every",
    "follow",
    "format",
    "free-terminals",
    "from",
    "frozen-joints",
    "hole",
    "joint",
    "keep-going",
    "keep-joints",
    "keep-short-tips",
    "layer-growth",
    "layer-thickness",
    "layers",
    "layers-in",
    "log-format",
    "make-missing",
    "max-displacement",
    "max-lumen-error",
    "max-radius-edge",
    "max-tets",
    "metrics",
    "order",
    "parts",
    "plot",
    "prisms",
    "progress",
    "radius-array",
    "radius-scale",
    "refined",
    "region",
    "region-growth",
    "region-size",
    "repel-rate",
    "restart",
    "samples",
    "scale",
    "shard",
    "shell",
    "size-at",
    "sizes-from",
    "smooth-noise",
    "split-regions",
    "stretch",
    "tissue-growth",
    "tissue-region",
    "tissue-ends",
    "tissue-remesh",
    "tissue-size",
    "tissue-tolerance",
    "to",
    "uniform",
    "version",
    "wall-growth",
    "wall-layers",
    "without",
];

/// Shortens the short help of all commands.
pub fn shortened(command: Command) -> Command {
    let names: Vec<String> = command.get_subcommands().map(|verb| verb.get_name().to_owned()).collect();
    names.into_iter().fold(command, |command, name| command.mut_subcommand(name, of_verb))
}

fn of_verb(verb: Command) -> Command {
    let name = verb.get_name().to_owned();
    let is_rare = |arg: &Arg| {
        let elsewhere = |(heading, of): &(&str, &str)| arg.get_help_heading() == Some(heading) && *of != name;
        GROUPS.iter().any(elsewhere) || arg.get_long().is_some_and(|long| RARE.contains(&long))
    };
    let mut more: Vec<String> = Vec::new();
    for arg in verb.get_arguments().filter(|arg| is_rare(arg) && !matches!(arg.get_action(), ArgAction::Version)) {
        let heading = arg.get_help_heading().unwrap_or("Options").to_owned();
        if !more.contains(&heading) {
            more.push(heading);
        }
    }
    let all = format!("`anastomesh {name} --help` shows all options");
    let text = if more.is_empty() { all } else { format!("{all}, including the groups {}", more.join(", ")) };
    let long = "docs/options.md lists all options of all commands with their defaults";
    verb.mut_args(|arg| if is_rare(&arg) { arg.hide_short_help(true) } else { arg })
        .after_help(text)
        .after_long_help(long)
}
