//! Errors of the block store.

use std::fmt;
use std::io;
use std::path::PathBuf;

use super::shard::Shard;

/// Reasons why blocks cannot be stored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StoreError {
    /// The folder cannot be used.
    #[error("{}: cannot be used as work directory: {source}; name a writable folder", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Another run uses the folder.
    #[error(
        "{}: another run uses this work directory; wait for it to end, or name another directory",
        path.display()
    )]
    Locked {
        /// The folder.
        path: PathBuf,
    },
    /// Another run makes the same shard.
    #[error("{}: another run makes shard {shard}; wait for it to end, or stop it", path.display())]
    ShardLocked {
        /// The folder.
        path: PathBuf,
        /// The shard.
        shard: Shard,
    },
    /// The file system has no file locks.
    #[error(
        "{}: the file system of this work directory has no file locks ({why}), so runs could overwrite each other; name a \
         folder on another file system, or mount this one with locks",
        path.display()
    )]
    NoLocks {
        /// The folder.
        path: PathBuf,
        /// Error of the operating system.
        why: String,
    },
    /// The folder has another number of shards.
    #[error(
        "{}: this work directory has {was} shards, but {shard} was requested; give every run the same number of shards, or \
         name another folder",
        path.display()
    )]
    OtherShards {
        /// The folder.
        path: PathBuf,
        /// Number of shards of the folder.
        was: u32,
        /// Requested shard.
        shard: Shard,
    },
    /// Some shards are not finished.
    #[error(
        "{}: {} not finished; run {}",
        path.display(), listed(shards), if shards.len() == 1 { "it" } else { "them" }
    )]
    Missing {
        /// The folder.
        path: PathBuf,
        /// Unfinished shards.
        shards: Vec<Shard>,
    },
    /// The file of a finished shard is truncated.
    #[error(
        "{}: only the first {end} of {bytes} bytes are complete records; run shard {shard} again to complete them",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Shard of the file.
        shard: Shard,
        /// End of the last complete record, in bytes.
        end: u64,
        /// Expected length, in bytes.
        bytes: u64,
    },
    /// The folder holds the blocks of another version of the program, another network or other options.
    #[error(
        "{}: this work directory belongs to {difference}; name another one",
        path.display()
    )]
    Other {
        /// The folder.
        path: PathBuf,
        /// The first difference.
        difference: Difference,
    },
    /// A block cannot be written.
    #[error("a finished block cannot be written to {place}: {source}; {}", advice(source))]
    Write {
        /// Location of the blocks.
        place: String,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A block cannot be read back.
    #[error("a finished block cannot be read back: {0}; check the disk")]
    Read(#[from] io::Error),
}

/// Difference between a run and the run that created the work directory.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Difference {
    /// Another version of the program, or an unreadable manifest.
    Version(String),
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

/// Maximum number of listed shards.
const LISTED: usize = 10;

fn listed(shards: &[Shard]) -> String {
    let mut names: Vec<String> = shards.iter().take(LISTED).map(Shard::to_string).collect();
    if shards.len() > LISTED {
        names.push(format!("{} more", shards.len() - LISTED));
    }
    match &names[..] {
        [one] => format!("shard {one} is"),
        _ => format!("shards {} are", names.join(", ")),
    }
}

fn advice(source: &io::Error) -> &'static str {
    match source.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free some space, or name a work directory on a larger disk; finished blocks in a work directory are kept for the next run"
        }
        _ => "check the disk; finished blocks in a work directory are kept for the next run",
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Version(program) => write!(f, "another version of the program ({program})"),
            Self::Network => f.write_str("another network"),
            Self::Option { name, was, is } => write!(f, "other options ({name} was {was}, now {is})"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_has_advice_of_its_own() {
        let failed = |kind| StoreError::Write { place: "w".into(), source: io::Error::from(kind) }.to_string();
        for kind in [io::ErrorKind::StorageFull, io::ErrorKind::QuotaExceeded] {
            assert!(failed(kind).contains("free some space"), "{}", failed(kind));
        }
        assert!(failed(io::ErrorKind::Other).contains("check the disk"));
    }

    #[test]
    fn differences_name_what_has_changed() {
        let [name, was, is] = ["mesh.rho", "3.0", "4.0"].map(str::to_owned);
        assert_eq!(Difference::Option { name, was, is }.to_string(), "other options (mesh.rho was 3.0, now 4.0)");
        assert_eq!(Difference::Network.to_string(), "another network");
        assert_eq!(Difference::Version("0.9".into()).to_string(), "another version of the program (0.9)");
    }

    #[test]
    fn ten_missing_shards_are_listed() {
        let shards: Vec<Shard> = Shard::all(12).collect();
        assert_eq!(listed(&shards[..1]), "shard 1/12 is");
        assert_eq!(listed(&shards[..2]), "shards 1/12, 2/12 are");
        assert!(listed(&shards[..10]).ends_with("9/12, 10/12 are"));
        assert!(listed(&shards).ends_with("10/12, 2 more are"));
    }
}
