//! Exit codes and failures.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use anastomesh_io::OutputError;
use anastomesh_network::flow::NotConverged;

/// The exit codes, as in `docs/meshing.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Success.
    Fine,
    /// The result was written, but validation failed.
    GateNotMet,
    /// The command line is wrong.
    Usage,
    /// The input cannot be read or used, or the output cannot be written.
    BadInput,
    /// A stage failed.
    StageFailed,
    /// Internal error.
    Bug,
    /// Stopped by a signal.
    Stopped,
}

impl Exit {
    /// Returns the number of the exit code.
    pub fn code(self) -> u8 {
        match self {
            Self::Fine => 0,
            Self::GateNotMet => 1,
            Self::Usage => 2,
            Self::BadInput => 3,
            Self::StageFailed => 4,
            Self::Bug => 70,
            // Convention of shells: 128 + SIGINT.
            Self::Stopped => 130,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        exit.code().into()
    }
}

/// Error message and exit code.
#[derive(Debug)]
pub struct Failure {
    /// Exit code.
    pub exit: Exit,
    /// Place, problem and remedy.
    pub message: String,
}

impl From<NotConverged> for Failure {
    fn from(error: NotConverged) -> Self {
        Self::stage(error.to_string())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::input(error.to_string())
    }
}

impl Failure {
    /// Failure of the input or a path.
    pub fn input(message: impl Into<String>) -> Self {
        Self { exit: Exit::BadInput, message: message.into() }
    }

    /// Failure to write the output.
    pub fn unwritable(path: &Path, why: &dyn fmt::Display) -> Self {
        let path = path.display();
        Self::input(format!("{path}: cannot be written: {why}; name a file in an existing, writable folder"))
    }

    /// Failure to read an additional file.
    pub fn unreadable(path: &Path, why: &dyn fmt::Display) -> Self {
        Self::input(format!("{}: cannot be read: {why}; check the path and its permissions", path.display()))
    }

    /// Failure of a stage.
    pub fn stage(message: impl Into<String>) -> Self {
        Self { exit: Exit::StageFailed, message: message.into() }
    }

    /// Stop on request.
    pub fn stopped(message: impl Into<String>) -> Self {
        Self { exit: Exit::Stopped, message: message.into() }
    }

    /// Command-line error found after parsing.
    pub fn usage(message: impl Into<String>) -> Self {
        Self { exit: Exit::Usage, message: message.into() }
    }
}
