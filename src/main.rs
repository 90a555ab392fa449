//! The command line: argv in, exit code out.

fn main() -> std::process::ExitCode {
    anastomesh::cli::main()
}
