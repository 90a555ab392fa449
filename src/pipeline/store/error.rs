//! Why finished blocks cannot be kept.

use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why blocks cannot be kept.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The folder cannot be used.
    #[error("{}: cannot be used as work directory: {source}; name a folder that can be written to", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Another run uses the folder.
    #[error("{}: another run is using this work directory; wait for it, or name another one", path.display())]
    Locked {
        /// The folder.
        path: PathBuf,
    },
    /// The folder holds the blocks of another version of the program, another network or other options.
    #[error(
        "{}: this work directory was begun with {difference}; name another one, or give --restart to throw its blocks away",
        path.display()
    )]
    Other {
        /// The folder.
        path: PathBuf,
        /// What is not as it was.
        difference: Difference,
    },
    /// A block cannot be written.
    #[error("a finished block cannot be written to {place}: {source}; {}", advice(source))]
    Write {
        /// Where blocks are kept.
        place: String,
        /// Why.
        source: io::Error,
    },
    /// A block cannot be read back.
    #[error("a finished block cannot be read back: {0}")]
    Read(#[from] io::Error),
}

/// What is not as it was when a work directory was begun.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Difference {
    /// Another version of the program, or what is there is no manifest.
    Version(String),
    /// Another network.
    Network,
    /// Another option.
    Option { name: String, was: String, is: String },
}

fn advice(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "make room or name a --work-dir on a larger disk; blocks in a --work-dir are kept, so the next run goes on there"
        }
        _ => "check the disk; blocks in a --work-dir are kept, so the next run goes on there",
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Version(program) => write!(f, "another version ({program})"),
            Self::Network => f.write_str("another network"),
            Self::Option { name, was, is } => write!(f, "another option: {name} was {was} and is now {is}"),
        }
    }
}
