//! Recovery: every edge and triangle of the surface becomes an edge and face of the complex.
//!
//! What the Delaunay tetrahedralization already has is frozen first. Missing edges are then recovered by flipping away
//! what crosses them, missing triangles by removing the edges that pierce them; where flips are stuck, a Steiner point
//! off the surface gives them room. A [`rule`] says which tetrahedra flips may make; where it forbids flat ones, those of
//! the Delaunay tetrahedralization are dissolved first ([`flat`]). Each tier has a work budget. What is left over goes to
//! the caller's next tier.

mod blocked;
mod cavity;
pub(super) mod exact;
mod flat;
mod march;
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
use anastomesh_mesh::TriMesh;
use cavity::Cavity;
use march::{Crossing, crossings, piercing_edges};
pub(super) use rule::{Rule, flat_height, flat_height_in_single};
pub(super) use turned::{lies_in_planes, lies_turned};

/// Depth to which a flip that is blocked may clear its way by others.
const DEPTH: u32 = 3;

/// Flips tried for one edge or triangle before it is given up for the round.
const BUDGET: u32 = 400;

/// Maximum passes that insert Steiner points next to missing edges and triangles.
const MAX_STEINER_PASSES: u32 = 8;

/// A round that leaves more than this part of what was lost before it is the last one: the next tier does it better.
const WORTHWHILE: f64 = 0.75;

/// Where flips alone leave more than this part of what is missing, and more than [`MANY`], Steiner points do not help.
const HOPELESS: f64 = 0.2;

/// See [`HOPELESS`].
const MANY: usize = 100;

/// So few lost edges and triangles are worth another round or two.
const FEW: usize = 8;

/// What recovery did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecoverySummary {
    /// Edges that the Delaunay tetrahedralization lacked.
    pub missing_edges: usize,
    /// Triangles that it lacked.
    pub missing_triangles: usize,
    /// Steiner points added, on either side of the surface.
    pub steiner_points: usize,
}

/// Recovers all of the surface in `c`, whose first vertices are the surface's points, by flips that make such tetrahedra
/// as `rule` allows; freezes its faces.
pub(super) fn recover(
    c: &mut Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    rule: Rule,
    watch: &Watch,
) -> Result<RecoverySummary, TetError> {
    let (mut lost_edges, mut lost_faces) = survey(c, surface, edges);
    let mut r = Recovery::new(c, surface, edges, rule);
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
        let in_vain = r.recover_edges(&mut lost_edges);
        if in_vain && r.met.is_none() {
            break;
        }
        watch.report(Stage::Recover, total - lost_edges.len() - lost_faces.len(), total)?;
        lost_faces.retain(|&f| r.met.is_some() || !r.recover_face(f));
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
    budget: u32,
    round: u32,
    /// Proof that the surface meets itself.
    met: Option<TetError>,
}

impl<'a> Recovery<'a> {
    fn new(c: &'a mut Complex, surface: &'a TriMesh, edges: &'a SurfaceEdges, rule: Rule) -> Self {
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
            round: 0,
            met: None,
        }
    }

    /// What makes the choices of this round.
    fn salt(round: u32) -> u64 {
        4 * u64::from(round)
    }

    /// Recovers edges; those that come loose are lost no longer. Whether the others were given up, since flips are in vain.
    fn recover_edges(&mut self, lost: &mut Vec<[u32; 2]>) -> bool {
        let missing = lost.clone();
        let (mut tried, mut failed, mut in_vain) = (0, 0, false);
        lost.retain(|&edge| {
            if in_vain || self.met.is_some() {
                return true;
            }
            tried += 1;
            let fails = !self.recover_edge(edge);
            failed += usize::from(fails);
            in_vain = self.round == 0 && fails && failed == MANY && 2 * failed > tried && self.is_turned(&missing);
            fails
        });
        in_vain
    }

    /// Whether most of some edges lie in planes but for rounding.
    fn is_turned(&self, edges: &[[u32; 2]]) -> bool {
        let points = &self.surface.points;
        let height = match self.rule {
            Rule::Positive => flat_height_in_single(points).unwrap_or(flat_height(points)),
            Rule::Thick(height) => height,
        };
        lies_turned(self.surface, edges, height) || lies_in_planes(self.surface, edges, height)
    }

    /// Flips away what crosses an edge: the first crossing that gives way, from one end and then from the other.
    fn recover_edge(&mut self, [a, b]: [u32; 2]) -> bool {
        self.budget = BUDGET;
        let mut way = std::mem::take(&mut self.way);
        let (mut from, mut to) = (a, b);
        let mut tried = 0;
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
            if self.budget == 0 || tried >= way.len() {
                break false;
            }
            self.budget -= 1;
            // What fails may have flipped something on its way: the crossings are listed anew in any case.
            if self.clear(way[tried]) {
                tried = 0;
                std::mem::swap(&mut from, &mut to);
            } else {
                tried += 1;
            }
        };
        self.way = way;
        done
    }

    /// Flips a crossing away; false when it is stuck.
    fn clear(&mut self, crossing: Crossing) -> bool {
        match crossing {
            Crossing::Face(half) => self.clear_face(half, DEPTH),
            Crossing::Edge(t, p, q) => self.clear_edge(t, p, q, DEPTH),
            Crossing::Exists | Crossing::Vertex(_) | Crossing::Nothing => false,
        }
    }

    /// The part of the surface that is crossed: then the surface meets itself, and no flip can help.
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
        if (0..3).any(|i| self.star.find_edge(self.c, tri[i], tri[(i + 1) % 3]).is_none()) {
            return false;
        }
        let mut piercers = std::mem::take(&mut self.piercers);
        let mut tried = 0;
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
            let Some(&(t, p, q)) = piercers.get(tried) else { break false };
            if self.budget == 0 {
                break false;
            }
            self.budget -= 1;
            tried = if self.clear_edge(t, p, q, DEPTH) { 0 } else { tried + 1 };
        };
        self.piercers = piercers;
        done
    }
}

/// Whether trying something else may help.
fn blocked(refusal: Refusal) -> bool {
    matches!(refusal, Refusal::NotValid | Refusal::RingTooLarge)
}
