//! Mutation tests of parts of the workspace: `anastomesh-mutants --help`.

mod build;
mod cli;
mod list;
mod parts;
mod rewrite;
mod trial;

use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::run(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
