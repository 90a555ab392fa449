//! Name of a shard: its number and the number of shards.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// One of several shares of the blocks: `3/8` is the third of eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    number: u32,
    of: u32,
}

/// Invalid shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoShard {
    /// The text is not two numbers.
    #[error("invalid shard '{0}': give number and count, such as 3/8")]
    Text(String),
    /// The shard number is 0, or above the number of shards.
    #[error("shard {0}/{1} is out of range: give 1/{1} to {1}/{1}")]
    Range(u32, u32),
    /// The number of shards is 0 or too large.
    #[error("invalid number of shards {0}: give 1 to {MOST}")]
    Count(u32),
}

/// Maximum number of shards; more than schedulers start.
pub(super) const MOST: u32 = 1_000_000;

impl Shard {
    /// Returns the shard with this number, counted from 1.
    ///
    /// # Errors
    /// The number is out of range.
    pub fn new(number: u32, of: u32) -> Result<Self, NoShard> {
        match () {
            () if !(1..=MOST).contains(&of) => Err(NoShard::Count(of)),
            () if !(1..=of).contains(&number) => Err(NoShard::Range(number, of)),
            () => Ok(Self { number, of }),
        }
    }

    /// Reads the number and the count of a shard, such as `3/8`, without checking their range: `Shard::new` does.
    ///
    /// # Errors
    /// If the text is not two numbers.
    pub fn two_numbers(text: &str) -> Result<(u32, u32), NoShard> {
        let number = |text: &str| u32::from_str(text).ok();
        let both = text.split_once('/').and_then(|(i, n)| number(i).zip(number(n)));
        both.ok_or_else(|| NoShard::Text(text.into()))
    }

    /// Its number, counted from 0.
    pub fn index(self) -> usize {
        self.number as usize - 1
    }

    /// Number of shards.
    pub fn of(self) -> usize {
        self.of as usize
    }

    pub(super) fn records(self) -> String {
        format!("anastomesh.shard_{}_of_{}.blocks", self.number, self.of)
    }

    pub(super) fn lock(self) -> String {
        format!("anastomesh.shard_{}_of_{}.lock", self.number, self.of)
    }

    pub(super) fn mark(self) -> String {
        format!("anastomesh.shard_{}_of_{}.done", self.number, self.of)
    }

    pub(super) fn all(of: u32) -> impl Iterator<Item = Self> {
        (1..=of).map(move |number| Self { number, of })
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!(Shard::two_numbers("3/8"), Ok((3, 8)));
        for text in ["", "3", "3/", "/8", "-1/8", "3/8/2", "a/b", "3 / 8", "99999999999/8"] {
            assert_eq!(Shard::two_numbers(text), Err(NoShard::Text(text.into())));
        }
        assert_eq!(Shard::new(1, 1).map(Shard::index), Ok(0));
        assert_eq!(Shard::new(8, 8).map(|s| (s.index(), s.of(), s.to_string())), Ok((7, 8, "8/8".into())));
        assert_eq!(Shard::new(0, 8), Err(NoShard::Range(0, 8)));
        assert_eq!(Shard::new(9, 8), Err(NoShard::Range(9, 8)));
        assert_eq!(Shard::new(1, 0), Err(NoShard::Count(0)));
        assert_eq!(Shard::new(1, u32::MAX), Err(NoShard::Count(u32::MAX)));
    }
}
