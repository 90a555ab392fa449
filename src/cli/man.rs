//! `anastomesh man`: the manual's pages, made from the definition of the command line.

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

/// A table of options for each verb and heading.
fn markdown(command: &Command) -> String {
    let mut out = String::from(
        "# Options\n\nMade by `anastomesh man --markdown`. Lengths are in the network's unit unless an option says otherwise.\n",
    );
    for verb in command.get_subcommands().filter(|verb| verb.get_name() != "help") {
        let about = verb.get_about().map(ToString::to_string).unwrap_or_default();
        // Writing to a string cannot fail.
        let _ = write!(out, "\n## {}\n\n{about}.\n", verb.get_name());
        let mut headings: Vec<&str> = Vec::new();
        for arg in shown(verb) {
            let heading = arg.get_help_heading().unwrap_or("");
            if !headings.contains(&heading) {
                headings.push(heading);
            }
        }
        for heading in headings {
            let title = if heading.is_empty() { String::new() } else { format!("\n**{heading}**\n") };
            let _ = write!(out, "{title}\n| option | default | |\n|---|---|---|\n");
            for arg in shown(verb).filter(|arg| arg.get_help_heading().unwrap_or("") == heading) {
                let _ = writeln!(out, "| {} | {} | {} |", name(arg), default(arg), help(arg));
            }
        }
    }
    out
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
