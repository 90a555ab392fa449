//! Blocks on all threads: the costliest first, and no more at a time than memory allows.

use rustc_hash::FxHashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};

/// Expected cost of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Tetrahedra.
    pub tets: f64,
    /// Bytes of memory while it is made.
    pub bytes: u64,
    /// Operations, as counted by budgets: about 0.05 µs each.
    pub operations: f64,
    /// Triangles of the wall.
    pub wall: f64,
    /// Number of the block's template, equal for blocks that share one; 0 for others.
    pub template: u32,
}

/// Maximum number of blocks with one template that a thread makes in sequence.
const IN_SEQUENCE: usize = 16;

/// Blocks in the order of making, in runs that one thread makes in sequence. Costs decrease by factors of 2. Blocks that share a
/// template follow each other, the costliest first, so that few templates are in use.
fn runs(costs: &[Cost]) -> (Vec<u32>, Vec<Range<usize>>) {
    let mut order: Vec<u32> = (0..costs.len() as u32).collect();
    let cost = |i: u32| &costs[i as usize];
    let own_size = |i: u32| (cost(i).tets as u64).max(1).ilog2();
    let mut sizes: FxHashMap<u32, u32> = FxHashMap::default();
    for i in order.iter().copied().filter(|&i| cost(i).template != 0) {
        let size = sizes.entry(cost(i).template).or_default();
        *size = own_size(i).max(*size);
    }
    let size = |i: u32| sizes.get(&cost(i).template).copied().unwrap_or_else(|| own_size(i));
    order.sort_unstable_by(|&a, &b| {
        let of_size = size(b).cmp(&size(a)).then(cost(a).template.cmp(&cost(b).template));
        of_size.then(cost(b).tets.total_cmp(&cost(a).tets)).then(a.cmp(&b))
    });
    let shares = |a: &u32, b: &u32| cost(*a).template != 0 && cost(*a).template == cost(*b).template;
    let mut end = 0;
    let of_template = order.chunk_by(shares).flat_map(|list| list.chunks(IN_SEQUENCE));
    let runs = of_template.map(|run| {
        end += run.len();
        end - run.len()..end
    });
    let runs = runs.collect();
    (order, runs)
}

/// Lets blocks in as long as their memory fits; one alone always comes in.
struct Gate {
    limit: u64,
    used: Mutex<u64>,
    left: Condvar,
}

/// Admitted block. Dropping it releases its memory, even in a panic, so that no other block waits forever.
struct AdmittedBlock<'a> {
    gate: &'a Gate,
    bytes: u64,
}

impl Gate {
    fn enter(&self, bytes: u64) -> AdmittedBlock<'_> {
        let mut used = self.used.lock().unwrap_or_else(PoisonError::into_inner);
        while *used > 0 && *used + bytes > self.limit {
            used = self.left.wait(used).unwrap_or_else(PoisonError::into_inner);
        }
        *used += bytes;
        AdmittedBlock { gate: self, bytes }
    }
}

impl Drop for AdmittedBlock<'_> {
    fn drop(&mut self) {
        *self.gate.used.lock().unwrap_or_else(PoisonError::into_inner) -= self.bytes;
        self.gate.left.notify_all();
    }
}

/// Does `work` for every cost's index on all threads of the current pool; results in the order of the indices. The first
/// error ends it.
///
/// # Errors
/// The error of the smallest index that failed before the others stopped.
pub fn costliest_first<T: Send, E: Send>(
    costs: &[Cost],
    limit: u64,
    work: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let (order, runs) = runs(costs);
    let next = AtomicUsize::new(0);
    let gate = Gate { limit, used: Mutex::new(0), left: Condvar::new() };
    // Millions of them: each stands where it belongs from the beginning.
    let done: Mutex<Vec<Option<T>>> = Mutex::new(costs.iter().map(|_| None).collect());
    let failed: Mutex<Option<(usize, E)>> = Mutex::new(None);
    // One loop per thread rather than a parallel iterator: a thread that waits inside a block for others' help must not
    // begin another block, which would have to wait at the gate for the first.
    let one_thread = |_: rayon::BroadcastContext| {
        let next_run = || runs.get(next.fetch_add(1, Ordering::Relaxed));
        for i in std::iter::from_fn(next_run).flat_map(|run| &order[run.clone()]) {
            let i = *i as usize;
            let inside = gate.enter(costs[i].bytes);
            let result = work(i);
            drop(inside);
            match result {
                Ok(value) => done.lock().unwrap_or_else(PoisonError::into_inner)[i] = Some(value),
                Err(error) => {
                    next.store(runs.len(), Ordering::Relaxed);
                    let mut failed = failed.lock().unwrap_or_else(PoisonError::into_inner);
                    if failed.as_ref().is_none_or(|(first, _)| i < *first) {
                        *failed = Some((i, error));
                    }
                }
            }
        }
    };
    rayon::broadcast(one_thread);
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some((_, error)) => Err(error),
        // All results exist.
        None => Ok(done.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().map_while(|t| t).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn costs(bytes: &[u64]) -> Vec<Cost> {
        bytes.iter().map(|&bytes| Cost { tets: bytes as f64, bytes, ..Cost::default() }).collect()
    }

    #[test]
    fn results_stand_in_the_order_of_the_indices() {
        let done = costliest_first::<_, ()>(&costs(&[3, 1, 2]), 100, |i| Ok(10 * i)).expect("nothing fails");
        assert_eq!(done, [0, 10, 20]);
    }

    #[test]
    fn blocks_with_one_template_follow_each_other() {
        let block = |tets: f64, template| Cost { tets, template, ..Cost::default() };
        let (order, runs) = runs(&[block(5.0, 0), block(4.0, 2), block(6.0, 1), block(5.5, 2), block(90.0, 1)]);
        assert_eq!(order, [4, 2, 0, 3, 1]);
        assert_eq!(runs, [0..2, 2..3, 3..5]);
        assert_eq!(super::runs(&vec![block(1.0, 7); 40]).1, [0..16, 16..32, 32..40]);
    }

    #[test]
    fn memory_in_use_stays_within_its_limit() {
        let bytes: Vec<u64> = (0..200).map(|i| 1 + i * 37 % 50).collect();
        let (now, most) = (Mutex::new(0), Mutex::new(0));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().expect("threads");
        let work = |i: usize| {
            *now.lock().expect("no holder panicked") += bytes[i];
            let used = *now.lock().expect("likewise");
            let mut most = most.lock().expect("likewise");
            *most = used.max(*most);
            drop(most);
            std::thread::yield_now();
            *now.lock().expect("likewise") -= bytes[i];
            Ok::<_, ()>(())
        };
        pool.install(|| costliest_first(&costs(&bytes), 60, work)).expect("nothing fails");
        assert!(*most.lock().expect("likewise") <= 60);
        // A block that does not fit at all is made alone rather than never.
        pool.install(|| costliest_first(&costs(&[5, 1]), 2, |_| Ok::<_, ()>(()))).expect("nothing fails");
    }

    #[test]
    fn a_panic_is_passed_on_and_nobody_waits_for_its_block() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        let work = |i: usize| if i == 3 { panic!("planted") } else { Ok::<_, ()>(()) };
        // One block at a time: whoever waits at the gate is let in afterwards.
        let run = || pool.install(|| costliest_first(&costs(&[9; 50]), 9, work));
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).is_err());
    }

    #[test]
    fn an_error_ends_it() {
        let failed = costliest_first(&costs(&[9; 50]), 100, |i| if i >= 3 { Err(i) } else { Ok(()) });
        assert!(failed.is_err());
    }
}
