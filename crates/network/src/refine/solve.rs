//! Main loop of the refinement: forces first, then projection until no condition is violated.

use super::bend::{add_bends, divide_near};
use super::contact::Contacts;
use super::figures::Figures;
use super::forces::{self, Rates};
use super::frame::Frame;
use super::history::{Displacement, HistorySample};
use super::leash::Leashes;
use super::overlapping::overlapping;
use super::params::{RefineError, RefineParams};
use super::push::Push;
use super::{cut_length, settle, shape, tighten};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_skeleton::{Barrier, Overlaps, Skeleton, paper_unit};

/// Exponent p of the combined correction of a node: the sum of n requests is divided by n^p.
const AVERAGE: f64 = 0.25;
/// Bounds of a node's step rate. The rate falls if the node reverses direction, else it rises.
const RATES: [f64; 2] = [0.1, 1.5];
const FALL: f64 = 0.7;
const RISE: f64 = 1.1;
/// Displacement of nodes whose contacts are searched again, in skins. Those beyond half a skin must be.
const FAR: f64 = 0.25;
/// Minimum number of nodes per node that has moved that far. If there are fewer, all contacts are searched.
const FEW: usize = 3;
/// Interval between bend insertions, as a fraction of the iterations.
const BENDS: f64 = 0.125;
/// Number of first iterations that are all sampled, if any are.
const EARLY: usize = 10;
/// Maximum bend intervals without improvement before the loop stops.
const PATIENCE: usize = 4;

/// Maximum number of pairs of close vessels that are pushed apart, over all iterations: a constant, and a number per edge. Shared
/// measured networks take at most 3 million in total. Only networks in which nearly everything overlaps exceed it. A random walk of
/// 34,000 nodes, with 43,000 overlapping pairs, takes 1.3 billion.
const PUSHES: [u64; 2] = [3_000_000, 20_000];
/// Pairs pushed apart in the time of testing one pair for overlap.
const COUNT: u64 = 30;

/// Result of the loop.
pub(super) struct Moved {
    /// Best state; `None` if every state was worse than the input in a protected metric.
    pub best: Option<State>,
    pub history: Vec<HistorySample>,
    pub unit: f64,
    /// True if the iterations ended early because too many vessels are close to each other.
    pub gave_up: bool,
}

pub(super) struct State {
    pub skeleton: Skeleton,
    pub origin: Vec<Point3>,
    pub bends: usize,
    /// Number of iterations.
    pub iteration: usize,
}

/// Moves the nodes of a split skeleton; `given` holds the figures of the input.
///
/// # Errors
/// [`RefineError::Cancelled`].
pub(super) fn solve(
    skeleton: Skeleton,
    given: &Figures,
    params: &RefineParams,
    leashes: Option<Leashes>,
    progress: &dyn Progress,
) -> Result<Moved, RefineError> {
    let mut solver = Solver::new(skeleton, params, leashes);
    solver.divide();
    let start = solver.sample(0, 0);
    let at = |iteration| progress.at(Stage::Move, iteration as u64, params.iterations as u64);
    at(0);
    let mut history = vec![start];
    let with_forces = if leashes.is_some() { 0.0 } else { params.forces * params.iterations as f64 }.round() as usize;
    let between = ((BENDS * params.iterations as f64).round() as usize).max(1);
    let mut best = Best { given: *given, score: None, improved: 0, state: None };
    let overlaps = best.offer(&solver, 0);
    if !solver.loosen(&overlaps) {
        at(params.iterations);
        return Ok(Moved { best: best.state, history, unit: solver.unit, gave_up: false });
    }
    for iteration in 1..=params.iterations {
        if progress.is_cancelled() {
            return Err(RefineError::Cancelled);
        }
        let asked = solver.step(iteration <= with_forces);
        let quiet = asked == 0 && iteration > with_forces;
        let mut last = iteration == params.iterations || solver.is_over_budget();
        if last || quiet || iteration % between == 0 {
            let was_perfect = best.is_perfect();
            let overlaps = best.offer(&solver, iteration);
            solver.spent += COUNT * solver.contacts.pairs.len() as u64;
            // One more interval after success, for the clearance.
            last |= was_perfect && best.is_perfect() || iteration >= best.improved + PATIENCE * between;
            last |= quiet && best.is_perfect();
            if !last && iteration + between / 2 <= params.iterations {
                let bends = solver.attend(&overlaps);
                last = quiet && bends == 0;
            }
        }
        // Most changes happen in the first iterations.
        if last || (params.every > 0 && (iteration % params.every == 0 || iteration < params.every.min(EARLY))) {
            history.push(solver.sample(iteration, asked));
        }
        at(if last { params.iterations } else { iteration });
        if last {
            break;
        }
    }
    let gave_up = solver.is_over_budget() && !best.is_perfect();
    let mut best = best.state;
    if let (Some(_), Some(state)) = (leashes, &mut best) {
        let mut back = state.skeleton.clone();
        tighten::tighten(&mut back, &state.origin, params.clearance);
        if !gave_up {
            settle::settle(&mut back, &state.origin, params.clearance, solver.unit, progress)?;
        }
        // Nodes may not return if a protected metric becomes worse than in the input.
        if back != state.skeleton && Figures::of(&back, true).worse_than(given, &params.hold).is_empty() {
            state.skeleton = back;
        }
    }
    Ok(Moved { best, history, unit: solver.unit, gave_up })
}

/// Best state so far.
struct Best {
    given: Figures,
    /// Lexicographic score: fewer are better.
    score: Option<[usize; 4]>,
    /// Iteration of the last improvement.
    improved: usize,
    state: Option<State>,
}

impl Best {
    /// Keeps the solver's state if it improves the score and no protected metric is worse than in the input.
    fn offer(&mut self, solver: &Solver, iteration: usize) -> Overlaps {
        let (figures, overlaps) = Figures::with_overlaps(&solver.frame.skeleton, solver.leashes.is_some());
        let score = if solver.leashes.is_some() { [figures.overlaps, 0, 0, 0] } else { figures.score() };
        let held = figures.worse_than(&self.given, &solver.params.hold).is_empty();
        if held && self.score.is_none_or(|best| score <= best) {
            if self.score != Some(score) {
                self.improved = iteration;
            }
            self.score = Some(score);
            self.state = Some(State {
                skeleton: solver.frame.skeleton.clone(),
                origin: solver.frame.origin.clone(),
                bends: solver.bends,
                iteration,
            });
        }
        overlaps
    }

    /// True if no overlaps or uncuttable branches remain. The plain count treats pieces of one polyline as far pairs,
    /// and short pieces fail equation 11. Both are ignored here.
    fn is_perfect(&self) -> bool {
        self.score.is_some_and(|s| s[0] == 0 && s[2] == 0)
    }
}

struct Solver<'a> {
    params: &'a RefineParams,
    /// Displacement limits, if only overlapping vessels move.
    leashes: Option<Leashes>,
    frame: Frame,
    unit: f64,
    contacts: Contacts,
    /// Maximum displacement of each node since the last search for its contacts.
    moved: Vec<f64>,
    last: Vec<Vec3>,
    rate: Vec<f64>,
    bends: usize,
    /// Pairs pushed apart so far.
    spent: u64,
}

impl<'a> Solver<'a> {
    fn new(skeleton: Skeleton, params: &'a RefineParams, leashes: Option<Leashes>) -> Self {
        let unit = paper_unit(&skeleton);
        let mut frame = Frame::new(skeleton, params.free_terminals, params.furthest * unit, unit);
        if leashes.is_some() {
            frame.hold();
        }
        let mut solver = Self {
            params,
            leashes,
            frame,
            unit,
            contacts: Contacts::default(),
            moved: Vec::new(),
            last: Vec::new(),
            rate: Vec::new(),
            bends: 0,
            spent: 0,
        };
        solver.restart();
        solver
    }

    /// Resets per-node state after nodes were added; contacts are searched again.
    fn restart(&mut self) {
        let n = self.frame.origin.len();
        self.moved.clear();
        self.moved.resize(n, f64::INFINITY);
        self.last.resize(n, Vec3::zeros());
        self.rate.resize(n, 1.0);
    }

    /// True if the budget is used up. It applies where only overlapping vessels move.
    fn is_over_budget(&self) -> bool {
        let [constant, per_edge] = PUSHES;
        self.leashes.is_some() && self.spent > constant + per_edge * self.frame.skeleton.edges.len() as u64
    }

    /// Performs one step and returns the number of requests.
    fn step(&mut self, with_forces: bool) -> usize {
        // Pairs further apart than the skin cannot touch before a node has moved by half of it.
        let skin = 2.0 * self.unit;
        if self.moved.iter().any(|&m| m > 0.5 * skin) {
            self.find_contacts(skin);
        }
        let mut sum = vec![Vec3::zeros(); self.moved.len()];
        let mut count = vec![0_u32; self.moved.len()];
        let mut add = |list: &[Push]| {
            for &(node, d) in list {
                sum[node.index()] += d;
                count[node.index()] += 1;
            }
        };
        if with_forces {
            let p = self.params;
            let rates = Rates { barrier: p.barrier_rate, repel: p.repel_rate, angle: p.angle_rate };
            let barrier = Barrier { support: p.clearance, unit: self.unit };
            add(&forces::pushes(&self.frame, &self.contacts, &barrier, rates));
        }
        self.spent += self.contacts.pairs.len() as u64;
        let contacts = self.contacts.pushes(&self.frame, self.params.clearance, &self.moved);
        // If only overlapping vessels move, none is lengthened or opened for a cut.
        let room =
            if self.leashes.is_some() { cut_length::lengths(&self.frame) } else { cut_length::pushes(&self.frame) };
        add(&contacts);
        add(&room);
        for (sum, &count) in sum.iter_mut().zip(&count) {
            *sum /= libm::pow(f64::from(count.max(1)), AVERAGE);
        }
        if self.leashes.is_some() {
            self.frame.clip(&mut sum);
        }
        shape::smooth_steps(&self.frame, &mut sum, &count);
        self.advance(&sum);
        contacts.len() + room.len()
    }

    /// Searches for contacts, if possible of nodes that have moved far alone.
    fn find_contacts(&mut self, skin: f64) {
        let skins = vec![0.5 * skin; self.frame.skeleton.edges.len()];
        let is_far: Vec<bool> = self.moved.iter().map(|&m| m > FAR * skin).collect();
        let far = is_far.iter().filter(|&&is_far| is_far).count();
        if self.leashes.is_some() || far > is_far.len() / FEW {
            // Frees the old contacts first, to save memory.
            self.contacts = Contacts::default();
            self.contacts = Contacts::find(&self.frame, self.params.clearance, &skins, self.leashes.is_some());
            self.moved.fill(0.0);
        } else {
            self.contacts.search_again(&self.frame, self.params.clearance, &skins, &is_far);
            self.moved.iter_mut().zip(is_far).filter(|(_, is_far)| *is_far).for_each(|(moved, _)| *moved = 0.0);
        }
    }

    /// Moves every node by its step times its rate, within its limit.
    fn advance(&mut self, steps: &[Vec3]) {
        for (i, step) in steps.iter().enumerate() {
            if step.norm_squared() <= 0.0 {
                continue;
            }
            let turned = step.dot(&self.last[i]) < 0.0;
            self.rate[i] =
                if turned { (self.rate[i] * FALL).max(RATES[0]) } else { (self.rate[i] * RISE).min(RATES[1]) };
            self.last[i] = *step;
            let (from, home) = (self.frame.skeleton.nodes[i].position, self.frame.origin[i]);
            let mut to = from + step * self.rate[i];
            let off = (to - home).norm();
            if off > self.frame.leash[i] {
                to = home + (to - home) * (self.frame.leash[i] / off);
            }
            self.frame.skeleton.nodes[i].position = to;
            self.moved[i] += (to - from).norm();
        }
    }

    /// Gives overlapping vessels priority until the next count and adds bends; returns the number of bends.
    fn attend(&mut self, overlaps: &Overlaps) -> usize {
        self.spent += COUNT * self.contacts.pairs.len() as u64;
        let before = std::mem::replace(&mut self.frame.urgent, vec![false; self.frame.origin.len()]);
        for node in overlaps.pairs.iter().flat_map(|o| o.nodes).flatten() {
            self.frame.urgent[node.index()] = true;
            // A vessel that overlaps for two counts may bend.
            self.frame.is_bend[node.index()] |= self.leashes.is_some() && before[node.index()];
        }
        let bends = match (self.params.bends, self.leashes) {
            (false, _) => 0,
            (true, None) => add_bends(&mut self.frame, overlaps),
            (true, Some(_)) => divide_near(&mut self.frame, overlaps),
        };
        self.bends += bends;
        self.frame.rejoin();
        if let Some(leashes) = self.leashes {
            let again = if bends > 0 { Some(self.overlaps()) } else { None };
            let close = Leashes::close(&self.frame, again.as_ref().unwrap_or(overlaps), self.params.near);
            leashes.loosen(&mut self.frame, &close);
        }
        self.restart();
        bends
    }

    /// Divides the vessels that overlap or almost touch, if all others are fixed.
    fn divide(&mut self) {
        if self.leashes.is_none() || !self.params.bends {
            return;
        }
        let overlaps = self.overlaps();
        let mut near = self.released(&overlaps).unwrap_or(overlaps);
        if !near.pairs.is_empty() {
            // Else a vessel that was moved apart would approach the other one along a long straight piece.
            near.pairs.extend(Leashes::at_tips(&self.frame));
        }
        self.bends += divide_near(&mut self.frame, &near);
        self.frame.rejoin();
        self.restart();
    }

    /// Releases overlapping vessels if all others are fixed, or vessels that almost touch if none overlap. Returns false if
    /// nothing may move.
    fn loosen(&mut self, overlaps: &Overlaps) -> bool {
        let Some(leashes) = self.leashes else { return true };
        let near = self.released(overlaps);
        let overlaps = near.as_ref().unwrap_or(overlaps);
        leashes.loosen(&mut self.frame, overlaps);
        !overlaps.pairs.is_empty()
    }

    /// Overlaps of the present state.
    fn overlaps(&self) -> Overlaps {
        overlapping(&self.frame.skeleton, &self.frame.adjacency, self.leashes.is_none(), 1.0)
    }

    /// Vessels to release at first, if those are not the overlapping ones.
    fn released(&self, overlaps: &Overlaps) -> Option<Overlaps> {
        let near = self.params.near;
        (near > 1.0 || overlaps.pairs.is_empty()).then(|| Leashes::near(&self.frame, near))
    }

    fn sample(&self, iteration: usize, asked: usize) -> HistorySample {
        let (skeleton, adjacency) = (&self.frame.skeleton, &self.frame.adjacency);
        let metrics = skeleton.metrics(adjacency);
        HistorySample { iteration, displacement: Displacement::of(skeleton, &self.frame.origin), metrics, asked }
    }
}
