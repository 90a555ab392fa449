//! Selection of cut positions within the feasible parts of a branch.

use super::fine::of_branch;
use super::params::PartitionParams;
use super::parts::UncutReason;
use anastomesh_skeleton::course::{Course, Courses, Way};
use anastomesh_skeleton::cuttability::{BranchEnd, Cuttability, Uncuttable};
use anastomesh_skeleton::{Adjacency, BranchId, FineStation};

/// Candidate cut: the planes may lie anywhere in `window` that leaves space for the connector between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub branch: u32,
    /// Allowed plane positions, as arc lengths.
    pub window: [f64; 2],
    /// Current plane positions: side 0 and side 1.
    pub planes: [f64; 2],
    /// True if the cut is made.
    pub alive: bool,
}

/// Searches for cut positions, branch by branch.
pub(super) struct CutFinder<'a> {
    courses: Courses<'a>,
    params: &'a PartitionParams,
    adjacency: &'a Adjacency,
    usual: Cuttability<'a>,
    eager: Option<Cuttability<'a>>,
    /// Places with shorter edges.
    fine: &'a [FineStation],
}

/// Minimum piece length between two cuts of a branch, in radii.
const SHORTEST_PIECE: f64 = 4.0;
/// Length of a connector between such cuts, relative to the minimum length.
const REASONABLE: f64 = 4.0;
/// Minimum length of a piece beside a cut that is cut again, in radii. Else a bifurcation and a long vessel beyond a bend, say, would
/// be contoured together.
const LONG_PIECE: f64 = 12.0;

impl<'a> CutFinder<'a> {
    pub fn new(
        adjacency: &'a Adjacency,
        courses: Courses<'a>,
        params: &'a PartitionParams,
        fine: &'a [FineStation],
    ) -> Self {
        let cuttability = |rules| Cuttability::new(adjacency, courses, rules);
        let eager = (!params.eager.is_empty()).then(|| cuttability(params.eager_cuts));
        Self { courses, params, adjacency, usual: cuttability(params.cuts), eager, fine }
    }

    /// Appends the cut positions of `branch`, or returns the reason why the branch has none.
    pub fn slots(&self, branch: u32, out: &mut Vec<Slot>) -> Option<UncutReason> {
        let course = &self.courses.get(branch);
        if self.params.forbidden_cuts.contains(&BranchId(branch)) {
            return Some(UncutReason::Forbidden);
        }
        let ends = course.branch.ends().map(|n| BranchEnd::of(self.adjacency, n));
        if ends.contains(&BranchEnd::Terminal) && !self.params.cut_terminals && !self.terminal_wants_cut(course) {
            return Some(UncutReason::Terminal);
        }
        let eager = self.eager.as_ref().filter(|_| self.params.eager.contains(&BranchId(branch)));
        let window = match eager.unwrap_or(&self.usual).window(branch) {
            Ok(window) => window,
            Err(Uncuttable::Length) => return Some(UncutReason::Length),
            Err(Uncuttable::Angle) => return Some(UncutReason::Angle),
            Err(Uncuttable::Bend) => return Some(UncutReason::Bend),
        };
        let start = out.len();
        self.choose(course, branch, window.reach, &self.coarse(branch, window.straight), out);
        out[start..].sort_by(|a, b| a.window[0].total_cmp(&b.window[0]));
        None
    }

    /// The pieces of `parts` in which edges have the length of the resolution.
    fn coarse(&self, branch: u32, parts: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        let stations = of_branch(self.fine, branch);
        if stations.is_empty() {
            return parts;
        }
        let taken = |station: &FineStation| [station.arc - station.reach(), station.arc + station.reach()];
        let taken = merged(stations.iter().map(taken).collect());
        parts.into_iter().flat_map(|part| gaps(part, &taken)).collect()
    }

    fn terminal_wants_cut(&self, course: &Course) -> bool {
        let [small, large] = course.radius_range(0.0, course.length());
        course.length() > self.params.long * course.mean_radius() || large > self.params.taper * small
    }

    /// Selects the longest straight part of `[lo, hi]`, then repeats where a long piece remains beside it.
    fn choose(&self, course: &Course, branch: u32, [lo, hi]: [f64; 2], parts: &[[f64; 2]], out: &mut Vec<Slot>) {
        // Intervals to search, each with the vessel piece that remains uncut if the search fails.
        let mut pending = vec![(lo, hi, 0.0, course.length())];
        while let Some((lo, hi, piece_lo, piece_hi)) = pending.pop() {
            let clipped = parts.iter().map(|p| [p[0].max(lo), p[1].min(hi)]);
            // The first cut needs only the minimum space, further cuts a connector of reasonable length.
            let least = if piece_lo > 0.0 || piece_hi < course.length() { REASONABLE } else { 1.0 };
            let rules = self.params.rules(branch);
            let fits = |p: &[f64; 2]| rules.fits(course, *p, least);
            let best = clipped.filter(fits).reduce(|a, b| {
                // Ties within rounding go to the first part.
                if b[1] - b[0] > (a[1] - a[0]) * (1.0 + 1e-9) { b } else { a }
            });
            let Some(window) = best else { continue };
            self.divide(course, branch, window, out);
            let gap = |s: f64| SHORTEST_PIECE * course.radius(s, Way::Onward).max(course.radius(s, Way::Back));
            for (from, to, piece) in [
                (lo, window[0] - gap(window[0]), [piece_lo, window[0]]),
                (window[1] + gap(window[1]), hi, [window[1], piece_hi]),
            ] {
                let middle = 0.5 * (piece[0] + piece[1]);
                if to > from && piece[1] - piece[0] > LONG_PIECE * course.radius(middle, Way::Onward) {
                    pending.push((from, to, piece[0], piece[1]));
                }
            }
        }
    }

    /// Converts a window to one slot, or to several with short pieces between them if it exceeds the longest connector.
    fn divide(&self, course: &Course, branch: u32, window: [f64; 2], out: &mut Vec<Slot>) {
        let radius = course.radius_range(window[0], window[1])[1];
        let length = window[1] - window[0];
        let piece = 1.5 * SHORTEST_PIECE * radius;
        let count = (length / (self.params.longest_connector * radius)).ceil().clamp(1.0, 1e5);
        let connector = (length - (count - 1.0) * piece) / count;
        for i in 0..count as usize {
            let lo = window[0] + i as f64 * (connector + piece);
            let part = [lo, if i + 1 == count as usize { window[1] } else { lo + connector }];
            out.push(Slot { branch, window: part, planes: self.planes(course, branch, part), alive: true });
        }
    }

    /// Initial plane positions: the ends of the window, shifted on request of the caller.
    fn planes(&self, course: &Course, branch: u32, window: [f64; 2]) -> [f64; 2] {
        let shift = self.params.shifted_cuts.get(&BranchId(branch)).copied().unwrap_or(0.0).clamp(-1.0, 1.0);
        let largest = course.radius_range(window[0], window[1])[1];
        let slack = (window[1] - window[0] - self.params.rules(branch).room * largest).max(0.0);
        // NaN counts as no shift.
        if shift > 0.0 {
            [window[0] + shift * slack, window[1]]
        } else if shift < 0.0 {
            [window[0], window[1] + shift * slack]
        } else {
            window
        }
    }
}

/// Union of intervals, in ascending order.
fn merged(mut intervals: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
    intervals.dedup_by(|next, last| {
        let overlap = next[0] <= last[1];
        if overlap {
            last[1] = last[1].max(next[1]);
        }
        overlap
    });
    intervals
}

/// Parts of an interval outside of disjoint ones in ascending order.
fn gaps([lo, hi]: [f64; 2], taken: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let (mut free, mut from) = (Vec::new(), lo);
    let first = taken.partition_point(|t| t[1] <= lo);
    for &[start, end] in taken[first..].iter().take_while(|t| t[0] < hi) {
        free.push([from, start]);
        from = end;
    }
    free.push([from, hi]);
    free.retain(|[lo, hi]| lo < hi);
    free
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_taken_out_of_parts() {
        let taken = merged(vec![[5.0, 6.0], [1.0, 3.0], [2.0, 4.0], [2.0, 2.5], [9.0, 12.0]]);
        assert_eq!(taken, [[1.0, 4.0], [5.0, 6.0], [9.0, 12.0]]);
        assert_eq!(gaps([0.0, 10.0], &taken), [[0.0, 1.0], [4.0, 5.0], [6.0, 9.0]]);
        assert_eq!(gaps([2.0, 3.0], &taken), [[0.0; 2]; 0]);
        assert_eq!(gaps([6.0, 7.0], &taken), [[6.0, 7.0]]);
        assert_eq!(gaps([3.0, 5.5], &taken), [[4.0, 5.0]]);
    }
}
