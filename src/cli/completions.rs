//! `anastomesh completions`: shell completions.

use clap::Command;
use clap_complete::Shell;

use super::exit::{Exit, Failure};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the script.
pub fn run(args: &Args, command: Command) -> Result<Exit, Failure> {
    super::log::print_bytes(&script(args.shell, command))?;
    Ok(Exit::Fine)
}

fn script(shell: Shell, mut command: Command) -> Vec<u8> {
    let mut out = Vec::new();
    clap_complete::generate(shell, &mut command, "anastomesh", &mut out);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::ValueEnum;

    #[test]
    fn every_shell_knows_every_verb_and_option() {
        for &shell in Shell::value_variants() {
            let script = String::from_utf8(script(shell, crate::cli::definition())).expect("text");
            // The fish writes the names of long options without dashes.
            let dashes = if shell == Shell::Fish { "-l " } else { "--" };
            for verb in crate::cli::definition().get_subcommands() {
                assert!(script.contains(verb.get_name()), "{shell}: {}", verb.get_name());
                for option in verb.get_arguments().filter_map(clap::Arg::get_long) {
                    assert!(script.contains(&format!("{dashes}{option}")), "{shell}: {} --{option}", verb.get_name());
                }
            }
        }
    }
}
