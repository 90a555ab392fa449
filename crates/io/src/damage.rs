//! Random file damage, for tests of readers.

use proptest::prelude::*;
use proptest::sample::Index;

/// Replacements of bytes, and an optional truncation.
#[derive(Clone, Debug)]
pub(super) struct Damage {
    changes: Vec<(Index, Vec<u8>)>,
    cut: Option<Index>,
}

/// Random damage: replacements by a byte, some characters or a large number, at up to a few positions.
pub(super) fn damage() -> impl Strategy<Value = Damage> {
    let replacement = prop_oneof![
        any::<u8>().prop_map(|b| vec![b]),
        "[0-9a-z #/.\\-\n]{0,6}".prop_map(String::into_bytes),
        Just(b" 99999999999 ".to_vec()),
    ];
    let changes = prop::collection::vec((any::<Index>(), replacement), 0..4);
    (changes, prop::option::of(any::<Index>())).prop_map(|(changes, cut)| Damage { changes, cut })
}

impl Damage {
    /// Applies the damage to a file.
    pub(super) fn done_to(&self, bytes: &[u8]) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        for (at, replacement) in &self.changes {
            if bytes.is_empty() {
                break;
            }
            let at = at.index(bytes.len());
            bytes.splice(at..=at, replacement.iter().copied());
        }
        if let Some(cut) = self.cut {
            bytes.truncate(cut.index(bytes.len() + 1));
        }
        bytes
    }
}
