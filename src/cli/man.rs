//! `anastomesh man`: the manual's pages, made from the definition of the command line.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use clap::builder::PossibleValue;
use clap::{Arg, Command};
use clap_mangen::Man;

use super::exit::{Exit, Failure};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The verb whose page is printed (default: the page of the program, which lists them)
    #[arg(value_name = "VERB")]
    verb: Option<String>,
    /// Print all options of all verbs with their defaults as Markdown
    #[arg(long, conflicts_with = "verb")]
    markdown: bool,
}

/// Prints a page.
pub fn run(args: &Args, command: &Command) -> Result<Exit, Failure> {
    let page = if args.markdown { markdown(command).into_bytes() } else { page(command, args.verb.as_deref())? };
    super::log::print_bytes(&page)?;
    Ok(Exit::Fine)
}

/// Number of commands from which on an option is listed once, among the shared options.
const SHARED: usize = 3;

/// Tables of all options by heading: the shared options first, then those of each command.
fn markdown(command: &Command) -> String {
    let verbs: Vec<&Command> = command.get_subcommands().filter(|verb| verb.get_name() != "help").collect();
    let mut users: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    for verb in &verbs {
        for arg in shown(verb) {
            users.entry(row(arg)).or_default().push(verb.get_name());
        }
    }
    let is_shared = |arg: &&Arg| users[&row(arg)].len() >= SHARED;
    let mut seen = BTreeSet::new();
    let shared = verbs.iter().flat_map(|verb| shown(verb)).filter(is_shared).filter(|arg| seen.insert(row(arg)));
    let mut out = String::from(
        "# Options\n\nMade by `anastomesh man --markdown`. Lengths are in the network's unit unless an option says otherwise.\n\n\
         ## Shared options\n\nOptions of three or more commands. The last column names the commands.\n",
    );
    let line = |arg: &Arg| format!("{} {} |", row(arg), users[&row(arg)].join(", "));
    tables(&mut out, &shared.collect::<Vec<_>>(), "| option | default | effect | commands |\n|---|---|---|---|", line);
    for verb in verbs {
        let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
        let (shared, own): (Vec<&Arg>, Vec<&Arg>) = shown(verb).partition(is_shared);
        // Writing to a string cannot fail.
        let _ = write!(out, "\n## {}\n\n{about}.\n", verb.get_name());
        tables(&mut out, &own, "| option | default | effect |\n|---|---|---|", row);
        let names: Vec<String> = shared.into_iter().map(name).collect();
        let _ = write!(out, "\n[Shared options](#shared-options): {}\n", names.join(", "));
    }
    out
}

/// A table for each heading.
fn tables(out: &mut String, args: &[&Arg], head: &str, line: impl Fn(&Arg) -> String) {
    let mut headings: Vec<&str> = Vec::new();
    for arg in args {
        let heading = arg.get_help_heading().unwrap_or("");
        if !headings.contains(&heading) {
            headings.push(heading);
        }
    }
    for heading in headings {
        let title = if heading.is_empty() { String::new() } else { format!("\n**{heading}**\n") };
        let _ = write!(out, "{title}\n{head}\n");
        for arg in args.iter().filter(|arg| arg.get_help_heading().unwrap_or("") == heading) {
            let _ = writeln!(out, "{}", line(arg));
        }
    }
}

fn row(arg: &Arg) -> String {
    format!("| {} | {} | {} |", name(arg), default(arg), help(arg))
}

fn shown(verb: &Command) -> impl Iterator<Item = &Arg> {
    verb.get_arguments().filter(|arg| !arg.is_hide_set() && !matches!(arg.get_id().as_str(), "help" | "version"))
}

/// How it is typed.
fn name(arg: &Arg) -> String {
    let takes = arg.get_action().takes_values();
    let value = arg.get_value_names().filter(|_| takes).and_then(|names| names.first()).map(|name| format!("<{name}>"));
    let value = value.or_else(|| takes.then(|| format!("<{}>", arg.get_id().as_str().to_uppercase())));
    let words = [arg.get_short().map(|c| format!("-{c}")), arg.get_long().map(|long| format!("--{long}"))];
    let names = words.into_iter().flatten().collect::<Vec<_>>().join(", ");
    format!("`{}`", format!("{names} {}", value.unwrap_or_default()).trim()).replace('|', "\\|")
}

fn default(arg: &Arg) -> String {
    let values: Vec<_> = arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if values.is_empty() || !arg.get_action().takes_values() {
        String::new()
    } else {
        format!("`{}`", values.join(","))
    }
}

/// What it does, and what it can be.
fn help(arg: &Arg) -> String {
    let mut text = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let values = arg.get_possible_values();
    if arg.get_action().takes_values() && !values.is_empty() {
        let one = |value: &PossibleValue| {
            let about = value.get_help().map_or_else(String::new, |help| format!(" ({help})"));
            format!("`{}`{about}", value.get_name())
        };
        let _ = write!(text, ": {}", values.iter().map(one).collect::<Vec<_>>().join(", "));
    }
    text.replace('\n', " ").replace('|', "\\|")
}

/// The page of a verb, or of the program.
fn page(command: &Command, verb: Option<&str>) -> Result<Vec<u8>, Failure> {
    let shown = match verb {
        None => command.clone(),
        Some(verb) => {
            let found = command.get_subcommands().find(|known| known.get_name() == verb);
            found.ok_or_else(|| Failure::usage(format!("there is no verb '{verb}': see --help")))?.clone()
        }
    };
    let mut out = Vec::new();
    let rendered = Man::new(shown).manual("Anastomesh").render(&mut out);
    rendered.map_err(|e| Failure::stage(format!("the page cannot be made: {e}")))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(verb: Option<&str>) -> String {
        // A dash that is one in the output is escaped.
        String::from_utf8(page(&crate::cli::definition(), verb).expect("a page")).expect("text").replace("\\-", "-")
    }

    #[test]
    fn every_verb_and_option_has_its_place() {
        let all = text(None);
        for verb in crate::cli::definition().get_subcommands() {
            let name = verb.get_name();
            assert!(all.contains(&format!("anastomesh-{name}(1)")), "{name}: {all}");
            let own = text(Some(name));
            for option in verb.get_arguments().filter_map(clap::Arg::get_long) {
                assert!(own.contains(&format!("--{option}")), "{name} --{option}: {own}");
            }
        }
        assert!(all.contains("130 stopped"), "{all}");
    }

    #[test]
    fn a_verb_that_is_none_is_refused() {
        let refused = page(&crate::cli::definition(), Some("knit")).expect_err("refused");
        assert_eq!(refused.exit, Exit::Usage);
    }
}
