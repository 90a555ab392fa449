//! Selection of cut positions within the feasible parts of a branch.

use super::params::PartitionParams;
use super::parts::UncutReason;
use anastomesh_skeleton::course::{Course, Courses, Way};
use anastomesh_skeleton::cuttability::{BranchEnd, Cuttability, Uncuttable};
use anastomesh_skeleton::{Adjacency, BranchId};

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
}

/// Minimum piece length between two cuts of a branch, in radii.
const SHORTEST_PIECE: f64 = 4.0;

impl<'a> CutFinder<'a> {
    pub fn new(adjacency: &'a Adjacency, courses: Courses<'a>, params: &'a PartitionParams) -> Self {
        let cuttability = |rules| Cuttability::new(adjacency, courses, rules);
        let eager = (!params.eager.is_empty()).then(|| cuttability(params.eager_cuts));
        Self { courses, params, adjacency, usual: cuttability(params.cuts), eager }
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
        self.choose(course, branch, window.reach, &window.straight, out);
        out[start..].sort_by(|a, b| a.window[0].total_cmp(&b.window[0]));
        None
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
            let least = if piece_lo > 0.0 || piece_hi < course.length() { 2.0 } else { 1.0 };
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
                if to > from && piece[1] - piece[0] > self.params.long * course.radius(middle, Way::Onward) {
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
