//! `anastomesh man`: the manual's pages, made from the definition of the command line.

use clap::Command;
use clap_mangen::Man;

use super::exit::{Exit, Failure};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The verb whose page is printed (default: the page of the program, which lists them)
    #[arg(value_name = "VERB")]
    verb: Option<String>,
}

/// Prints a page.
pub fn run(args: &Args, command: &Command) -> Result<Exit, Failure> {
    let page = page(command, args.verb.as_deref());
    super::common::print_bytes(&page?)?;
    Ok(Exit::Fine)
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
