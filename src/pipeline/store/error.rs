//! Why finished blocks cannot be kept.

use std::fmt;
use std::io;
use std::path::PathBuf;

use super::shard::Shard;

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
    #[error(
        "{}: another run is using this work directory, alone or as a shard; wait for it, or name another one",
        path.display()
    )]
    Locked {
        /// The folder.
        path: PathBuf,
    },
    /// Another run makes the same shard.
    #[error("{}: shard {shard} is being made by another run; wait for it, or end it", path.display())]
    ShardLocked {
        /// The folder.
        path: PathBuf,
        /// Which one.
        shard: Shard,
    },
    /// Nothing keeps two runs from writing to one file.
    #[error(
        "{}: the file system of this work directory has no locks ({why}), so two runs could write to one file; name a \
         folder on another one, or have it mounted with locks that hold on all machines",
        path.display()
    )]
    NoLocks {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        why: String,
    },
    /// The folder has another number of shards.
    #[error(
        "{}: this work directory was begun with {was} shards, and {shard} is none of them; give each run of a folder the \
         same number, or name another folder",
        path.display()
    )]
    OtherShards {
        /// The folder.
        path: PathBuf,
        /// How many there are.
        was: u32,
        /// The one that is none of them.
        shard: Shard,
    },
    /// Shards have not been made to their end.
    #[error(
        "{}: {} not been made to the end; run {}",
        path.display(), listed(shards), if shards.len() == 1 { "it" } else { "them" }
    )]
    Missing {
        /// The folder.
        path: PathBuf,
        /// Which ones.
        shards: Vec<Shard>,
    },
    /// A shard's file is not what it was when the shard ended.
    #[error(
        "{}: of {bytes} bytes only the first {end} are whole records; run shard {shard} again, which makes the others",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Whose it is.
        shard: Shard,
        /// Where its whole records end.
        end: u64,
        /// Where they should.
        bytes: u64,
    },
    /// The folder holds the blocks of another version of the program, another network or other options.
    #[error(
        "{}: this work directory was begun with {difference}; name another one",
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
    #[error("a finished block cannot be read back: {0}; check the disk")]
    Read(#[from] io::Error),
}

/// What is not as it was when a work directory was begun.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Difference {
    /// Another version of the program, or what is there is no manifest.
    Version(String),
    /// Another processor or C library, whose functions give other last bits.
    Arithmetic,
    /// Another network.
    Network,
    /// Another option.
    Option {
        /// Name of the option.
        name: String,
        /// Value of the earlier run.
        was: String,
        /// Value of this run.
        is: String,
    },
}

/// So many shards are listed.
const LISTED: usize = 10;

fn listed(shards: &[Shard]) -> String {
    let mut names: Vec<String> = shards.iter().take(LISTED).map(Shard::to_string).collect();
    if shards.len() > LISTED {
        names.push(format!("{} more", shards.len() - LISTED));
    }
    match &names[..] {
        [one] => format!("shard {one} has"),
        _ => format!("shards {} have", names.join(", ")),
    }
}

fn advice(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "make room or name a work directory on a larger disk; blocks in a work directory are kept, so the next run goes on there"
        }
        _ => "check the disk; blocks in a work directory are kept, so the next run goes on there",
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Version(program) => write!(f, "another version ({program})"),
            Self::Arithmetic => f.write_str(
                "other last bits of numbers, on a machine with another processor or C library, whose blocks do not fit these",
            ),
            Self::Network => f.write_str("another network"),
            Self::Option { name, was, is } => write!(f, "another option: {name} was {was} and is now {is}"),
        }
    }
}
