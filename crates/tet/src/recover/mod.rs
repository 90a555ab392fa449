//! Boundary recovery: every edge and triangle of the surface becomes an edge or face of the complex.
//!
//! Parts present in the Delaunay tetrahedralization are frozen first. Missing edges are recovered by flipping away
//! their crossings, missing triangles by removing the edges that pierce them. If flips are stuck, Steiner points off
//! the surface enable more. A [`rule`] defines the tetrahedra that flips may make. If it forbids flat ones, those of
//! the Delaunay tetrahedralization are dissolved first ([`flat`]). Each tier has a work budget; the next tier gets the
//! rest.

mod aim;
mod blocked;
mod cavity;
pub(super) mod exact;
mod flat;
mod journal;
mod march;
mod priority;
mod removal;
mod rule;
mod steiner;
mod turned;

use super::complex::Complex;
use super::error::{Obstacle, TetError};
use super::flips::{Flipper, Refusal};
use super::input::SurfaceEdges;
use super::progress::{Stage, Watch};
use super::star::{EdgeRing, Star};
use super::survey::survey;
use aim::Aim;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::budget::Stop;
use cavity::Cavity;
use journal::Journal;
use march::{Crossing, crossings, piercing_edges};
pub(super) use priority::Priority;
pub(super) use removal::remove_steiner_points;
pub(super) use rule::{Rule, coarse_height, flat_height, flat_height_in_single};
use rustc_hash::FxHashMap;
pub(super) use turned::{lies_in_planes, lies_turned};

/// Maximum passes over the missing edges before the first Steiner points. Nested flips are one deeper in each pass.
pub(super) const MAX_FLIP_PASSES: u32 = 10;

/// A further pass is made if the last one recovered at least this fraction of the edges.
const GAIN: f64 = 0.04;

/// Passes made whatever their gain. The third is the first in which nested flips reach beyond the neighbours.
const FIRST_PASSES: u32 = 3;

/// Maximum nested removals of edges, for one edge or triangle per pass. With 400, 4 % fewer edges stay missing on the
/// shared surfaces, at four times the cost.
const BUDGET: u32 = 50;

/// Maximum rounds of Steiner points.
const MAX_STEINER_PASSES: u32 = 8;

/// Recovery stops after a round that leaves more than this fraction of the previous losses. The next tier does better.
const WORTHWHILE: f64 = 0.75;

/// Maximum lost edges and triangles for which slow progress is accepted in early rounds.
const FEW: usize = 8;

/// Steiner points do not help if flips leave more than this fraction of the missing parts, and more than [`MANY`].
const HOPELESS: f64 = 0.2;

/// See [`HOPELESS`].
const MANY: usize = 100;

/// Operations per flip that is tried, as counted by budgets.
const OPERATIONS: usize = 20;

/// Counts of boundary recovery.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecoverySummary {
    /// Edges missing in the Delaunay tetrahedralization.
    pub missing_edges: usize,
    /// Triangles missing in the Delaunay tetrahedralization.
    pub missing_triangles: usize,
    /// Steiner points in the mesh. Those outside, and those that could be removed, are not counted.
    pub steiner_points: usize,
}

impl RecoverySummary {
    /// Adds the counts of another part.
    pub(super) fn add(&mut self, other: &Self) {
        self.missing_edges += other.missing_edges;
        self.missing_triangles += other.missing_triangles;
        self.steiner_points += other.steiner_points;
    }
}

/// Recovers the whole surface in `c`, whose first vertices are the surface's points, and freezes its faces. Flips make
/// only tetrahedra that `rule` allows.
pub(super) fn recover(
    c: &mut Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    rule: Rule,
    watch: &Watch,
) -> Result<RecoverySummary, TetError> {
    recover_with(c, surface, edges, (rule, MAX_FLIP_PASSES, &Priority::default()), watch)
}

/// As [`recover`], with at most `passes` over the missing edges, those with priority first. A single pass is followed by
/// no Steiner points.
pub(super) fn recover_with(
    c: &mut Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    (rule, passes, priority): (Rule, u32, &Priority),
    watch: &Watch,
) -> Result<RecoverySummary, TetError> {
    let (mut lost_edges, mut lost_faces) = survey(c, surface, edges);
    priority.sort(&mut lost_edges, &mut lost_faces);
    let mut r = Recovery::new(c, surface, (edges, rule), watch);
    r.passes = passes;
    let mut summary = RecoverySummary {
        missing_edges: lost_edges.len(),
        missing_triangles: lost_faces.len(),
        ..RecoverySummary::default()
    };
    let mut before = usize::MAX;
    for round in 0..=MAX_STEINER_PASSES {
        r.round = round;
        r.dissolve();
        let total = summary.missing_edges + summary.missing_triangles;
        watch.report(Stage::Recover, total - lost_edges.len() - lost_faces.len(), total)?;
        let abandoned = r.recover_edges(&mut lost_edges);
        r.stopped.map_or(Ok(()), Err)?;
        if (abandoned || passes == 1) && !lost_edges.is_empty() && r.met.is_none() {
            break;
        }
        watch.report(Stage::Recover, total - lost_edges.len() - lost_faces.len(), total)?;
        lost_faces.retain(|&f| r.met.is_some() || r.stopped.is_some() || !r.recover_face(f));
        r.stopped.map_or(Ok(()), Err)?;
        if let Some(error) = r.met {
            return Err(error);
        }
        let lost = lost_edges.len() + lost_faces.len();
        if lost == 0 {
            return Ok(summary);
        }
        let worthwhile = (lost as f64) < WORTHWHILE * before as f64 || (lost <= FEW && round < MAX_STEINER_PASSES / 2);
        before = lost;
        let hopeless = round == 0 && lost > MANY && lost as f64 > HOPELESS * total as f64;
        if hopeless || !worthwhile {
            break;
        }
        if round < MAX_STEINER_PASSES {
            summary.steiner_points += r.add_steiner_points(&lost_edges, &lost_faces, round);
        }
    }
    Err(TetError::NotRecovered { edges: lost_edges, triangles: lost_faces })
}

struct Recovery<'a> {
    c: &'a mut Complex,
    surface: &'a TriMesh,
    edges: &'a SurfaceEdges,
    rule: Rule,
    star: Star,
    flipper: Flipper,
    ring: EdgeRing,
    cavity: Cavity,
    way: Vec<Crossing>,
    piercers: Vec<(u32, u32, u32)>,
    /// Nested removals of edges that are left for the present edge or triangle.
    budget: u32,
    /// Maximum depth of nested flips.
    depth: u32,
    aim: Aim,
    journal: Journal,
    /// Ends of the edges whose removal is in progress. Nested flips make no edges there.
    ends: Vec<u32>,
    /// Edges that could not be removed since the last success, with the depth of the search.
    failed: FxHashMap<[u32; 2], u32>,
    /// Flips tried and not yet counted.
    tried: usize,
    round: u32,
    /// Maximum passes over the missing edges before Steiner points.
    passes: u32,
    /// Proof that the surface intersects itself.
    met: Option<TetError>,
    watch: &'a Watch<'a>,
    /// Reason to end early.
    stopped: Option<Stop>,
}

impl<'a> Recovery<'a> {
    fn new(
        c: &'a mut Complex,
        surface: &'a TriMesh,
        (edges, rule): (&'a SurfaceEdges, Rule),
        watch: &'a Watch<'a>,
    ) -> Self {
        Self {
            c,
            surface,
            edges,
            rule,
            star: Star::default(),
            flipper: Flipper::default(),
            ring: EdgeRing::default(),
            cavity: Cavity::default(),
            way: Vec::new(),
            piercers: Vec::new(),
            budget: 0,
            depth: MAX_FLIP_PASSES,
            aim: Aim::Any,
            journal: Journal::default(),
            ends: Vec::new(),
            failed: FxHashMap::default(),
            tried: 0,
            round: 0,
            passes: MAX_FLIP_PASSES,
            met: None,
            watch,
            stopped: None,
        }
    }

    /// Counts the flips of one edge or triangle.
    fn count(&mut self) {
        let tried = std::mem::take(&mut self.tried);
        self.stopped = self.stopped.or(self.watch.spend(OPERATIONS * (1 + tried)).err());
    }

    /// Seed for the random choices of a round.
    fn salt(round: u32) -> u64 {
        4 * u64::from(round)
    }

    /// Recovers edges and removes them from `lost`, in passes with deeper and deeper flips. After Steiner points one pass
    /// with the largest depth follows. Returns true if it gave up because flips are hopeless.
    fn recover_edges(&mut self, lost: &mut Vec<[u32; 2]>) -> bool {
        let round = self.round;
        let first = if round == 0 { 0 } else { MAX_FLIP_PASSES - 1 };
        let missing = if round == 0 { lost.clone() } else { Vec::new() };
        for pass in first..MAX_FLIP_PASSES.min(first + self.passes) {
            let before = lost.len();
            (self.round, self.depth) = (round + pass, 1 + pass);
            let (mut tried, mut failed, mut abandoned) = (0, 0, false);
            lost.retain(|&edge| {
                if abandoned || self.met.is_some() || self.stopped.is_some() {
                    return true;
                }
                tried += 1;
                let fails = !self.recover_edge(edge);
                failed += usize::from(fails);
                abandoned = round == 0 && fails && failed == MANY && 2 * failed > tried && self.is_turned(&missing);
                fails
            });
            if abandoned {
                (self.round, self.depth) = (round, MAX_FLIP_PASSES);
                return true;
            }
            let few = ((before - lost.len()) as f64) < GAIN * before as f64;
            if lost.is_empty() || self.met.is_some() || self.stopped.is_some() || (few && pass >= FIRST_PASSES) {
                break;
            }
        }
        (self.round, self.depth) = (round, MAX_FLIP_PASSES);
        false
    }

    /// True if most of the edges lie in planes up to rounding.
    fn is_turned(&self, edges: &[[u32; 2]]) -> bool {
        let points = &self.surface.points;
        let height = match self.rule {
            Rule::Positive => flat_height_in_single(points).unwrap_or(flat_height(points)),
            Rule::Thick(height) => height,
        };
        lies_turned(self.surface, edges, height) || lies_in_planes(self.surface, edges, height)
    }

    /// Recovers an edge by flipping away its crossings, from alternate ends.
    fn recover_edge(&mut self, [a, b]: [u32; 2]) -> bool {
        self.budget = BUDGET;
        self.aim = Aim::Edge([a, b]);
        let mut way = std::mem::take(&mut self.way);
        let (mut from, mut to) = (a, b);
        let mut at = 0;
        let done = loop {
            crossings(self.c, &mut self.star, &mut self.ring, from, to, &mut way);
            if way.first() == Some(&Crossing::Exists) {
                break true;
            }
            if let Some(obstacle) = way.iter().find_map(|&x| self.obstacle(x)) {
                let obstacle = obstacle.as_given(&self.surface.triangles);
                self.met = Some(TetError::EdgeMeets { edge: [a, b], obstacle });
                break false;
            }
            self.journal.clear();
            self.failed.clear();
            // Plain flips first, in turns: where one is impossible, another may make it possible.
            let n = way.len();
            let turns = |k: usize| (at + k) % n;
            let plain = (0..n).map(turns).find(|&k| self.clear(way[k], 0));
            if let Some(k) = plain {
                at = k.saturating_sub(1);
                continue;
            }
            at = 0;
            if !way.iter().any(|&crossing| self.clear(crossing, self.depth)) {
                break false;
            }
            std::mem::swap(&mut from, &mut to);
        };
        self.aim = Aim::Any;
        self.way = way;
        self.count();
        done
    }

    /// Flips a crossing away. Returns false if stuck.
    fn clear(&mut self, crossing: Crossing, depth: u32) -> bool {
        match crossing {
            Crossing::Face(half) => self.clear_face(half, depth),
            Crossing::Edge(t, p, q) => self.clear_edge(t, p, q, depth),
            Crossing::Exists | Crossing::Vertex(_) | Crossing::Nothing => false,
        }
    }

    /// Crossed part of the surface, if any. The surface then intersects itself, and no flip can help.
    fn obstacle(&self, crossing: Crossing) -> Option<Obstacle> {
        match crossing {
            Crossing::Face(half) if self.c.is_frozen(half) => Some(Obstacle::Triangle(self.c.face(half))),
            Crossing::Edge(_, p, q) if self.edges.contains(p, q) => Some(Obstacle::Edge([p, q])),
            Crossing::Vertex(v) if (v as usize) < self.surface.points.len() => Some(Obstacle::Point(v)),
            _ => None,
        }
    }

    /// Removes the edges that pierce a triangle whose edges exist; freezes the triangle.
    fn recover_face(&mut self, triangle: u32) -> bool {
        let tri = self.surface.triangles[triangle as usize];
        self.budget = BUDGET;
        self.aim = Aim::Triangle(tri);
        if (0..3).any(|i| self.star.find_edge(self.c, tri[i], tri[(i + 1) % 3]).is_none()) {
            return false;
        }
        let mut piercers = std::mem::take(&mut self.piercers);
        let done = loop {
            if let Some(half) = self.star.find_face(self.c, tri) {
                self.c.freeze(half);
                break true;
            }
            piercing_edges(self.c, &mut self.star, &mut self.ring, tri, &mut piercers);
            if let Some(&(_, p, q)) = piercers.iter().find(|&&(_, p, q)| self.edges.contains(p, q)) {
                self.met = Some(TetError::EdgeMeets { edge: [p, q], obstacle: Obstacle::Triangle(tri) });
                break false;
            }
            self.journal.clear();
            self.failed.clear();
            let found = piercers.iter().any(|&(t, p, q)| self.clear_edge(t, p, q, 0))
                || piercers.iter().any(|&(t, p, q)| self.clear_edge(t, p, q, self.depth));
            if !found {
                break false;
            }
        };
        self.piercers = piercers;
        self.aim = Aim::Any;
        self.count();
        done
    }
}

/// True if another attempt may help.
fn blocked(refusal: Refusal) -> bool {
    matches!(refusal, Refusal::NotValid | Refusal::RingTooLarge)
}

#[cfg(test)]
mod recorded;
#[cfg(test)]
mod tests;
