//! Violations of conditions, collected from parts in the numbering of the whole.

use super::{Fault, Parts};
use crate::check::result::{KEPT_OFFENDERS, Line, LineResult, Offender, OffenderKind, Outcome, Tally};
use std::collections::BTreeMap;

/// Maximum offenders held at a time.
const MAX_HELD: usize = 4096;

/// Offenders of conditions, in the numbering of the whole.
#[derive(Debug, Default)]
pub(super) struct Tallies(BTreeMap<Line, (u64, Vec<Offender>)>);

impl Tallies {
    pub(super) fn add(&mut self, line: Line, offender: Offender) {
        self.add_some(line, 1, [offender]);
    }

    pub(super) fn add_some(&mut self, line: Line, count: u64, offenders: impl IntoIterator<Item = Offender>) {
        let (all, held) = self.0.entry(line).or_default();
        *all += count;
        held.extend(offenders);
        if held.len() > MAX_HELD {
            *all -= tidy(held);
            held.truncate(KEPT_OFFENDERS);
        }
    }

    /// Adds a fault of a part.
    pub(super) fn add_fault(&mut self, parts: &dyn Parts, part: u32, fault: &Fault) {
        let id = |kind: OffenderKind, id: i64| match (kind, u32::try_from(id)) {
            (OffenderKind::Patch | OffenderKind::Node, _) | (_, Err(_)) => id,
            (OffenderKind::Tet | OffenderKind::TetPair, Ok(tet)) => parts.tet(part, tet) as i64,
            (_, Ok(vertex)) => i64::from(parts.vertex(part, vertex)),
        };
        let whole = |offender: &Offender| Offender {
            ids: offender.ids.iter().map(|&i| id(offender.kind, i)).collect(),
            ..offender.clone()
        };
        self.add_some(fault.line, fault.count, fault.offenders.iter().map(whole));
    }

    pub(super) fn fails(&self, line: Line) -> bool {
        self.0.contains_key(&line)
    }

    pub(super) fn first_of(&self, lines: &[Line]) -> Option<Line> {
        lines.iter().copied().find(|&line| self.fails(line))
    }

    pub(super) fn take(&mut self, line: Line) -> LineResult {
        let Some((mut count, mut offenders)) = self.0.remove(&line) else { return Tally::new(line).done() };
        count -= tidy(&mut offenders);
        offenders.truncate(KEPT_OFFENDERS);
        LineResult { outcome: Outcome::Fail, count, offenders, ..Tally::new(line).done() }
    }
}

/// Sorts offenders and removes duplicates, since both parts of a joint report its faces. Returns the number removed.
fn tidy(offenders: &mut Vec<Offender>) -> u64 {
    let before = offenders.len();
    offenders.sort_by(|a, b| a.ids.cmp(&b.ids));
    offenders.dedup_by(|a, b| a.ids == b.ids);
    (before - offenders.len()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: Line = Line::FacesSharedByTwo;

    fn point(id: u32) -> Offender {
        Offender::new(OffenderKind::Point, &[id], None)
    }

    #[test]
    fn offenders_are_held_up_to_a_limit() {
        let mut tallies = Tallies::default();
        let held = |tallies: &Tallies| tallies.0[&LINE].1.len();
        for id in (0..4096).rev() {
            tallies.add(LINE, point(id));
        }
        assert_eq!(held(&tallies), 4096);
        tallies.add(LINE, point(5000));
        assert_eq!(held(&tallies), KEPT_OFFENDERS);
        let result = tallies.take(LINE);
        assert_eq!((result.outcome, result.count, result.offenders.len()), (Outcome::Fail, 4097, KEPT_OFFENDERS));
        assert!(
            result.offenders.iter().map(|offender| &offender.ids).eq(&(0..1000).map(|id| vec![id]).collect::<Vec<_>>())
        );
        assert!(!tallies.fails(LINE));
    }

    #[test]
    fn offenders_reported_by_two_parts_count_once() {
        for count in [3, 2500_u32] {
            let mut tallies = Tallies::default();
            let twice = (0..count).chain(0..count).map(point);
            tallies.add_some(LINE, 2 * u64::from(count), twice);
            assert_eq!(tallies.take(LINE).count, u64::from(count));
        }
    }
}
