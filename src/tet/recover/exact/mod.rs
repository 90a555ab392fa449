//! The exact tier, which does not fail in exact arithmetic: what is missing is cut into the complex with implicit vertices
//! on it, which are then moved off the surface (George, Borouchaki, Saltel, 'Ultimate robustness in meshing an arbitrary
//! polyhedron', 2003). Only what is crossed changes.
//!
//! What lies in planes of faces but for rounding is recovered before, by turning edges there ([`level`], [`plane`]). Then:
//!
//! 1. [`segments`]: missing edges become chains of edges, with a vertex at each face or edge that they cross.
//! 2. [`facets`]: missing triangles become unions of faces, with a vertex at each edge that pierces them.
//! 3. [`push`]: each of these vertices gives way to copies inside the sectors between the facets around it ([`sectors`],
//!    [`room`]); where a sector is too narrow, what lies beside it is taken as well ([`wider`]).

mod course;
mod dig;
mod facets;
mod helpers;
mod level;
mod looks;
mod parts;
mod plane;
mod polygon;
mod push;
mod room;
mod sectors;
mod segments;
mod space;
mod wider;

use crate::mesh::TriMesh;
use crate::tet::complex::Complex;
use crate::tet::delaunay::hash;
use crate::tet::error::{Obstacle, Stuck, TetError};
use crate::tet::input::SurfaceEdges;
use crate::tet::progress::Watch;
use crate::tet::recover::rule::flat_height;
use helpers::add_helpers;
use level::Level;
use parts::{Part, parts, sides};
use push::Push;
use rustc_hash::FxHashMap;
use segments::Segments;
use space::Space;

/// Times that it is tried in another order, where a vertex has found no room.
const ATTEMPTS: u64 = 4;

/// The same for a large part alone, in each of the ways.
const ATTEMPTS_ALONE: u64 = 2;

/// Edges of a part that is worth a copy of all, to be tried again alone.
const LARGE: usize = 100;

/// Least distances of a new vertex from the planes around, over the size of its room, that are asked for one after the
/// other.
const LEVELS: [f64; 6] = [1e-2, 1e-3, 1e-5, 1e-8, 1e-11, 0.0];

/// Implicit vertices allowed: for each missing edge, and in any case.
const VERTICES: (usize, usize) = (256, 1_000_000);

/// The same where cavities are deep, which takes longer for each.
const VERTICES_DEEP: (usize, usize) = (64, 100_000);

/// What the surface has and the complex lacks.
#[derive(Clone, Copy)]
pub(in crate::tet) struct Missing<'a> {
    pub edges: &'a [[u32; 2]],
    pub triangles: &'a [u32],
}

/// What the exact tier did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::tet) struct ExactSummary {
    /// Vertices that were put on edges.
    pub on_segments: usize,
    /// Vertices that were put inside of triangles.
    pub on_facets: usize,
    /// Vertices off the surface that remain.
    pub steiner_points: usize,
}

/// Recovers what is missing in a complex that has all the rest of the surface, its triangles frozen. The surface may not
/// meet itself; its triangles may share whole edges and vertices in any way, well inside the complex.
///
/// # Errors
/// [`TetError::EdgeMeets`]; [`TetError::Stuck`] where no floating-point position was found off the surface, or too many
/// vertices were needed; [`TetError::Cancelled`].
pub(in crate::tet) fn recover_exact(
    c: &Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    missing: Missing,
    turned: bool,
    watch: &Watch,
) -> Result<(Complex, ExactSummary), TetError> {
    let ways = Way::all(turned);
    let mut salt = 0;
    loop {
        match recover_parts(c.clone(), surface, edges, missing, (salt, ways[salt as usize]), watch) {
            Ok(recovered) => return Ok(recovered),
            Err(Failed { error, again }) if !again || salt + 1 == ATTEMPTS => return Err(error),
            Err(_) => salt += 1,
        }
    }
}

/// Why parts could not be recovered, and whether all may be tried again.
struct Failed {
    error: TetError,
    again: bool,
}

impl From<TetError> for Failed {
    fn from(error: TetError) -> Self {
        Self { error, again: false }
    }
}

fn recover_parts(
    c: Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    missing: Missing,
    (salt, way): (u64, Way),
    watch: &Watch,
) -> Result<(Complex, ExactSummary), Failed> {
    let (each, all) = if way.deep { VERTICES_DEEP } else { VERTICES };
    let budget = each * missing.edges.len() + all;
    let segments = Segments::new(edges, surface.points.len());
    let mut push = Push::new(Space::new(c, flat_height(&surface.points)), segments, surface.triangles.clone());
    let mut summary = ExactSummary::default();
    let left = if way.level { Some(level_out(&mut push, edges, missing, watch)?) } else { None };
    let missing = left.as_ref().map_or(missing, |(edges, triangles)| Missing { edges, triangles });
    push.segments.deep = way.deep;
    for part in parts(&surface.triangles, missing) {
        // Large parts take most of the time, and are tried again alone; a copy for each of the others would take longer.
        let saved = (part.edges.len() >= LARGE).then(|| (push.clone(), summary));
        let mut tried = 0;
        while let Err(error) = recover_part(&mut push, &part, salt + tried, &mut summary, budget, watch) {
            tried += 1;
            let error = about_input(error, surface, &part);
            // The surface does not meet itself, so whatever was in the way may not be there another way.
            let again = matches!(error, TetError::Stuck { .. });
            let Some(saved) = saved.as_ref().filter(|_| again && tried < ATTEMPTS_ALONE) else {
                return Err(Failed { error, again });
            };
            (push, summary) = saved.clone();
        }
    }
    Ok((push.s.c, summary))
}

/// How it is tried: what fails in one way comes loose in another.
#[derive(Clone, Copy)]
struct Way {
    /// Whether edges in planes of faces are turned first.
    level: bool,
    /// Whether cavities are to be deep, not only seen.
    deep: bool,
}

impl Way {
    /// The ways for parts that are flat but for rounding, and for others, one for each attempt.
    fn all(turned: bool) -> [Self; ATTEMPTS as usize] {
        let way = |level, deep| Self { level, deep };
        let seen = way(false, false);
        if turned {
            [way(true, true), way(false, true), way(true, false), seen]
        } else {
            [seen, seen, way(true, true), way(false, true)]
        }
    }
}

/// Recovers what lies in planes of faces but for rounding. Returns what is still missing.
fn level_out(
    push: &mut Push,
    edges: &SurfaceEdges,
    missing: Missing,
    watch: &Watch,
) -> Result<(Vec<[u32; 2]>, Vec<u32>), TetError> {
    let mut facets: FxHashMap<[u32; 2], Vec<[u32; 3]>> = FxHashMap::default();
    for &t in missing.triangles {
        let triangle = push.triangles[t as usize];
        for side in sides(triangle) {
            facets.entry(side).or_default().push(triangle);
        }
    }
    let mut level = Level { s: &mut push.s, keep: edges, facets, spare: 0, made: Vec::new(), inside: Vec::new() };
    for &edge in missing.edges {
        watch.ask()?;
        level.insert(edge);
    }
    level.leave();
    let made = level.made;
    push.adopt(made);
    let lost_edges = missing.edges.iter().copied().filter(|&[a, b]| !push.s.has_edge(a, b)).collect();
    let mut lost_triangles = Vec::new();
    for &t in missing.triangles {
        match push.s.find_face(push.triangles[t as usize]) {
            Some(half) => push.s.c.freeze(half),
            None => lost_triangles.push(t),
        }
    }
    Ok((lost_edges, lost_triangles))
}

/// What happens to helpers is told of the edge that they were to help.
fn about_input(error: TetError, surface: &TriMesh, part: &Part) -> TetError {
    let known = |v: &u32| (*v as usize) < surface.points.len();
    let of_input = |part: &Obstacle| match part {
        Obstacle::Triangle(v) => v.iter().all(known),
        Obstacle::Edge(v) => v.iter().all(known),
        Obstacle::Point(v) => known(v),
    };
    let told = match &error {
        TetError::EdgeMeets { edge, obstacle } => edge.iter().all(known) && of_input(obstacle),
        TetError::Stuck { part, .. } => of_input(part),
        _ => true,
    };
    let dangling = part.edges.first().filter(|_| !told);
    dangling.map_or(error, |&edge| TetError::Stuck { part: Obstacle::Edge(edge), reason: Stuck::Dangling })
}

fn recover_part(
    push: &mut Push,
    part: &Part,
    salt: u64,
    summary: &mut ExactSummary,
    budget: usize,
    watch: &Watch,
) -> Result<(), TetError> {
    let spend = |push: &Push, on: Obstacle| {
        watch.ask()?;
        let over = push.s.implicit_vertices() > budget;
        if over { Err(TetError::Stuck { part: on, reason: Stuck::Budget }) } else { Ok(()) }
    };
    let helpers = add_helpers(push, part, salt);
    // At random: fans of long thin triangles come in halves of halves then, where one after the other each next chain
    // would have to fit between the one before and what lies beyond.
    let mut edges = part.edges.clone();
    edges.sort_by_key(|&[a, b]| (hash(salt ^ (u64::from(a) << 32 | u64::from(b))), a, b));
    for &ends in &edges {
        spend(push, Obstacle::Edge(ends))?;
        let id = push.segments.cut(&mut push.s, ends)?;
        summary.on_segments += push.add_segment(id);
    }
    let beside = push.segments.list.len() as u32;
    for &ends in &helpers.edges {
        spend(push, Obstacle::Edge(ends))?;
        push.segments.cut(&mut push.s, ends)?;
    }
    #[cfg(test)]
    push.s.check();
    for &t in &part.triangles {
        spend(push, Obstacle::Triangle(push.triangles[t as usize]))?;
        let cover = facets::cover(&mut push.s, &push.segments, push.triangles[t as usize])?;
        summary.on_facets += push.add_facet(t, cover);
    }
    let mut inner = Vec::new();
    for &t in &helpers.triangles {
        let cover = facets::cover(&mut push.s, &push.segments, push.triangles[t as usize])?;
        inner.extend(push.add_helper(t, cover));
    }
    #[cfg(test)]
    push.s.check();
    push.settle()?;
    if !helpers.triangles.is_empty() {
        push.drop_helpers(&helpers.triangles, beside..push.segments.list.len() as u32, inner);
        push.settle()?;
    }
    summary.steiner_points += push.finish();
    Ok(())
}

#[cfg(test)]
mod tests;
