//! Uniqueness of ids: no id stands for two points except at connected joints.
//!
//! A vertex is in at most one joint, so joints give pairs of vertices. The whole has as many points as the parts minus
//! the vertices of the joints. If the ids are those numbers and all of them occur, no others are shared.

use super::Parts;
use super::glue::{Held, invalid};
use super::joints::Joined;
use super::tallies::Tallies;
use crate::check::result::{Line, Offender, OffenderKind};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::io;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of points of the whole.
pub(super) fn count(parts: &dyn Parts, held: &Held, joined: &Joined) -> u64 {
    let numbers = joined.pairs(parts).filter_map(|pair| held.joint_number(pair[0]));
    let shared: u64 = numbers.map(|number| u64::from(held.joint(number).vertices)).sum();
    held.points.saturating_sub(shared)
}

/// Checks all ids; joints must be valid.
pub(super) fn check(parts: &dyn Parts, held: &Held, joined: &Joined, tallies: &mut Tallies) -> io::Result<()> {
    let count = count(parts, held, joined);
    let size = usize::try_from(count.div_ceil(64)).map_err(|_| invalid("too many points"))?;
    let met: Vec<AtomicU64> = (0..size).map(|_| AtomicU64::new(0)).collect();
    let mark = |part: u32| -> io::Result<bool> {
        let ids = vertices(parts, held, part)?;
        for &id in ids.iter().filter(|&&id| u64::from(id) < count) {
            met[id as usize / 64].fetch_or(1 << (id % 64), Ordering::Relaxed);
        }
        Ok(ids.iter().all(|&id| u64::from(id) < count))
    };
    let in_range = (0..held.count()).into_par_iter().map(mark).collect::<io::Result<Vec<bool>>>()?;
    let distinct: u64 = met.par_iter().map(|word| u64::from(word.load(Ordering::Relaxed).count_ones())).sum();
    if distinct == count && in_range.iter().all(|&all| all) {
        return Ok(());
    }
    drop(met);
    name_faults(parts, held, joined, count, tallies)
}

fn vertices(parts: &dyn Parts, held: &Held, part: u32) -> io::Result<Vec<u32>> {
    let ids = parts.vertices(part, held.points_of(part))?;
    if ids.len() == held.points_of(part) as usize {
        Ok(ids)
    } else {
        Err(invalid(format!("part {part} has {} points but {} ids", held.points_of(part), ids.len())))
    }
}

/// Reports ids that are too large, and those used by more points than joints allow.
fn name_faults(parts: &dyn Parts, held: &Held, joined: &Joined, count: u64, tallies: &mut Tallies) -> io::Result<()> {
    let size = usize::try_from(count).map_err(|_| invalid("too many points"))?;
    let mut uses = vec![0_u8; size];
    let offender = |id: u32| Offender::new(OffenderKind::Point, &[id], None);
    for part in 0..held.count() {
        for id in vertices(parts, held, part)? {
            match uses.get_mut(id as usize) {
                Some(uses) => *uses = uses.saturating_add(1),
                None => tallies.add(Line::IndicesInRange, offender(id)),
            }
        }
    }
    let mut allowed: BTreeMap<u32, u8> = BTreeMap::new();
    for [(part, joint), _] in joined.pairs(parts) {
        for id in parts.joint(*part, *joint)?.vertices {
            *allowed.entry(id).or_insert(1) += 1;
        }
    }
    for (id, &uses) in (0..).zip(&uses).filter(|(_, uses)| **uses != 1) {
        if uses > allowed.get(&id).copied().unwrap_or(1) {
            tallies.add(Line::BoundaryFans, offender(id));
        } else if uses == 0 {
            tallies.add(Line::NoUnusedPoints, offender(id));
        }
    }
    Ok(())
}
