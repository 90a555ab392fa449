//! What the program says with its exit code.

use std::process::ExitCode;

/// The exit codes, as in the README.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// All well.
    Fine,
    /// Work done, but a gate is not met: the mesh is not valid.
    GateNotMet,
    /// The command line is wrong.
    Usage,
    /// The input cannot be read or used, or the output cannot be written.
    BadInput,
    /// A stage failed.
    StageFailed,
    /// A fault of the program.
    Bug,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(match exit {
            Exit::Fine => 0,
            Exit::GateNotMet => 1,
            Exit::Usage => 2,
            Exit::BadInput => 3,
            Exit::StageFailed => 4,
            Exit::Bug => 70,
        })
    }
}

/// An error on its way to the person at the terminal: one message and the code to leave with.
#[derive(Debug)]
pub struct Failure {
    /// How the program ends.
    pub exit: Exit,
    /// What is wrong, where, and what to do.
    pub message: String,
}

impl Failure {
    /// The input, or a path, is at fault.
    pub fn input(message: impl Into<String>) -> Self {
        Self { exit: Exit::BadInput, message: message.into() }
    }

    /// A stage failed.
    pub fn stage(message: impl Into<String>) -> Self {
        Self { exit: Exit::StageFailed, message: message.into() }
    }

    /// The command line is wrong in a way that only the input shows.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { exit: Exit::Usage, message: message.into() }
    }
}
