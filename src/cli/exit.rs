//! What the program says with its exit code.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use anastomesh_network::flow::NotConverged;

/// The exit codes, as in `docs/meshing.md`.
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
    /// Somebody asked it to stop.
    Stopped,
}

impl Exit {
    /// Its number.
    pub fn code(self) -> u8 {
        match self {
            Self::Fine => 0,
            Self::GateNotMet => 1,
            Self::Usage => 2,
            Self::BadInput => 3,
            Self::StageFailed => 4,
            Self::Bug => 70,
            // As shells have it for what Ctrl-C ended.
            Self::Stopped => 130,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        exit.code().into()
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

impl From<NotConverged> for Failure {
    fn from(error: NotConverged) -> Self {
        Self::stage(error.to_string())
    }
}

impl Failure {
    /// The input, or a path, is at fault.
    pub fn input(message: impl Into<String>) -> Self {
        Self { exit: Exit::BadInput, message: message.into() }
    }

    /// The output cannot be written.
    pub fn unwritable(path: &Path, why: &dyn fmt::Display) -> Self {
        let path = path.display();
        Self::input(format!(
            "{path}: cannot be written: {why}; name a file in a folder that exists and can be written to"
        ))
    }

    /// A file beside the input cannot be read.
    pub fn unreadable(path: &Path, why: &dyn fmt::Display) -> Self {
        Self::input(format!("{}: cannot be read: {why}; check the path and its permissions", path.display()))
    }

    /// A stage failed.
    pub fn stage(message: impl Into<String>) -> Self {
        Self { exit: Exit::StageFailed, message: message.into() }
    }

    /// Somebody asked to stop.
    pub fn stopped(message: impl Into<String>) -> Self {
        Self { exit: Exit::Stopped, message: message.into() }
    }

    /// The command line is wrong in a way that only the input shows.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { exit: Exit::Usage, message: message.into() }
    }
}
