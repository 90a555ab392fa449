//! The program `anastomesh-mutants`.

use std::process::ExitCode;

fn main() -> ExitCode {
    anastomesh_mutants::program()
}
