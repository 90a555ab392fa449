//! Canonical forks in use, for all threads.

use super::canonical::Canonical;
use crate::block::params::BlockParams;
use crate::partition::ForkCell;
use rustc_hash::FxHashMap;
use std::sync::{Arc, LazyLock, Mutex, OnceLock, PoisonError};

/// Number of recently used forks that are kept, at about 40 kB each for ρ = 3. Up to twice as many are in memory.
const RECENT: usize = 64;

/// Cell, and the bits of ρ and of the core factor.
type Key = (ForkCell, [u64; 2]);
/// `None`: the cell has no canonical fork.
type Entry = Arc<OnceLock<Option<Arc<Canonical>>>>;

/// Forks used recently, and those used before. When there are too many recent ones, they replace the others.
#[derive(Default)]
struct Kept {
    recent: FxHashMap<Key, Entry>,
    before: FxHashMap<Key, Entry>,
}

static KEPT: LazyLock<Mutex<Kept>> = LazyLock::new(Mutex::default);

impl Kept {
    fn entry(&mut self, key: Key) -> Entry {
        if let Some(entry) = self.recent.get(&key) {
            return Arc::clone(entry);
        }
        let entry = self.before.remove(&key).unwrap_or_default();
        if self.recent.len() == RECENT {
            self.before = std::mem::take(&mut self.recent);
        }
        self.recent.insert(key, Arc::clone(&entry));
        entry
    }
}

/// Returns the canonical fork of a cell; `None` if it cannot be made.
pub fn canonical(cell: ForkCell, params: &BlockParams) -> Option<Arc<Canonical>> {
    let key = (cell, [params.rho, params.core].map(f64::to_bits));
    // A panicked thread leaves only complete entries.
    let entry = KEPT.lock().unwrap_or_else(PoisonError::into_inner).entry(key);
    entry.get_or_init(|| Canonical::of(&cell, params).map(Arc::new)).clone()
}
