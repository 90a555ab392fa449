//! Program `anastomesh-trials`.

use std::process::ExitCode;

fn main() -> ExitCode {
    anastomesh_trials::program()
}
