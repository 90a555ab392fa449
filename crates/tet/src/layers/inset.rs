//! The surface further in: places of its vertices that let every prism be positive and the surface be filled.

use super::stack::{Numbers, Stack, toward};
use crate::contacts::contacts;
use crate::error::{Obstacle, Stuck, TetError};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{TetMesh, TriMesh};

/// What a vertex keeps of its way in when it is in the way,
const DRAWN_BACK: f64 = 0.6;
/// and what of it is so little that there is no layer at the vertex.
const LEAST: f64 = 2e-3;
/// Ways in of neighbours differ by this much of their distance at most, where one has been drawn back.
const GRADE: f64 = 0.5;
/// The same where the surface does not meet itself and yet is not kept, which takes long to find out: one time after the other, then
/// nothing.
const STUCK: [f64; 3] = [0.5, 0.2, 0.2];
/// Passes after which vertices in the way are moved back onto the wall at once.
const PATIENT: usize = 40;
/// Maximum passes that shorten layers before the surface is refused.
const MAX_INSET_PASSES: usize = 100;

/// A surface and where its vertices would best be further in.
pub struct Places<'a> {
    pub surface: &'a TriMesh,
    /// Its triangles that have layers.
    pub wall: &'a [[u32; 3]],
    /// Vertices that also have triangles without.
    pub is_rim: Vec<bool>,
    /// Where each vertex is wanted; vertices off the wall, too.
    pub wanted: Vec<Point3>,
    /// Vertices that may be nowhere else.
    pub is_held: Vec<bool>,
    /// Whether the surface further in is likely to meet itself: that is asked first then, as filling it takes longer.
    pub is_narrow: bool,
}

/// A mesh with layers.
pub struct Inset {
    /// The mesh; its points begin with the surface's, those off the wall being at their place further in.
    pub mesh: TetMesh,
    /// How many of its tetrahedra, the first ones, are those of layers.
    pub of_layers: usize,
    /// Which number each copy of a vertex has.
    pub numbers: Numbers,
    /// How much of its way in each vertex has.
    pub shares: Vec<f64>,
}

/// Finds the places, fills what is inside, and puts the layers round it. Layers reach to these `depths`, as shares of the way
/// in. The mesh that `fill` makes has to keep the surface, its points beginning with the surface's.
///
/// # Errors
/// That of `fill`; [`TetError::Stuck`] with a triangle of the wall whose prism is turned over, and whose vertices may be nowhere
/// else.
pub fn inset(
    places: &Places,
    depths: &[f64],
    mut fill: impl FnMut(&TriMesh) -> Result<TetMesh, TetError>,
) -> Result<Inset, TetError> {
    let outer = &places.surface.points;
    let mut ways = Ways::new(places);
    let mut round = 0;
    let mut failures = STUCK.into_iter();
    loop {
        round += 1;
        ways.drawn_back = if round < PATIENT { DRAWN_BACK } else { 0.0 };
        let inner = ways.inner();
        let stack = Stack::new(outer, places.wall, places.is_rim.clone(), &inner, depths);
        let turned = stack.turned();
        if let Some(&first) = turned.first() {
            if round > MAX_INSET_PASSES || !ways.draw_back(turned.as_flattened()) {
                return Err(TetError::Stuck { part: Obstacle::Triangle(first), reason: Stuck::Layer });
            }
            continue;
        }
        let inside = TriMesh { points: inner, triangles: places.surface.triangles.clone() };
        let meeting =
            || -> Vec<u32> { contacts(&inside).iter().flatten().flat_map(|&t| inside.triangles[t as usize]).collect() };
        if places.is_narrow && ways.draw_back(&meeting()) {
            continue;
        }
        match fill(&inside) {
            Ok(core) => {
                let numbers = stack.numbers.clone();
                let (mesh, of_layers) = stack.around(&core);
                return Ok(Inset { mesh, of_layers, numbers, shares: ways.shares });
            }
            Err(TetError::Cancelled) => return Err(TetError::Cancelled),
            Err(error) => {
                let meeting = if places.is_narrow { Vec::new() } else { meeting() };
                ways.drawn_back = if meeting.is_empty() { failures.next().unwrap_or(0.0) } else { DRAWN_BACK };
                let in_the_way = if meeting.is_empty() { stuck(&error, &inside) } else { meeting };
                let all = || (0..outer.len() as u32).collect::<Vec<u32>>();
                if round > MAX_INSET_PASSES || !(ways.draw_back(&in_the_way) || ways.draw_back(&all())) {
                    return Err(error);
                }
            }
        }
    }
}

/// The vertices of what could not be kept of a surface.
fn stuck(error: &TetError, surface: &TriMesh) -> Vec<u32> {
    let of = |part: &Obstacle| match *part {
        Obstacle::Point(v) => vec![v],
        Obstacle::Edge(edge) => edge.to_vec(),
        Obstacle::Triangle(triangle) => triangle.to_vec(),
    };
    let vertices = match error {
        TetError::Stuck { part, .. } => of(part),
        TetError::EdgeMeets { edge, obstacle } => [edge.to_vec(), of(obstacle)].concat(),
        TetError::NotRecovered { edges, triangles } => {
            let corners = triangles.iter().flat_map(|&t| surface.triangles[t as usize]);
            edges.iter().flatten().copied().chain(corners).collect()
        }
        _ => Vec::new(),
    };
    vertices.into_iter().filter(|&v| (v as usize) < surface.points.len()).collect()
}

/// How far in each vertex is.
struct Ways<'a> {
    places: &'a Places<'a>,
    shares: Vec<f64>,
    /// What a vertex keeps of its way in when it is in the way.
    drawn_back: f64,
}

impl<'a> Ways<'a> {
    fn new(places: &'a Places<'a>) -> Self {
        Self { places, shares: vec![1.0; places.wanted.len()], drawn_back: DRAWN_BACK }
    }

    fn inner(&self) -> Vec<Point3> {
        let Places { surface, wanted, .. } = self.places;
        let all = surface.points.iter().zip(wanted).zip(&self.shares);
        all.map(|((outer, wanted), &share)| toward(outer, wanted, share)).collect()
    }

    /// Draws vertices back towards the wall, and those round them as far as neighbours may differ; whether there was any that
    /// could be.
    fn draw_back(&mut self, vertices: &[u32]) -> bool {
        let mut vertices = vertices.to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let mut any = false;
        for v in vertices.into_iter().map(|v| v as usize) {
            if self.places.is_held[v] || self.shares[v] == 0.0 || self.length(v) == 0.0 {
                continue;
            }
            let share = self.shares[v] * self.drawn_back;
            self.shares[v] = if share < LEAST { 0.0 } else { share };
            any = true;
        }
        if any {
            self.grade();
        }
        any
    }

    /// How far in a vertex is wanted.
    fn length(&self, v: usize) -> f64 {
        (self.places.wanted[v] - self.places.surface.points[v]).norm()
    }

    fn grade(&mut self) {
        let points = &self.places.surface.points;
        let lengths: Vec<f64> = (0..points.len()).map(|v| self.length(v)).collect();
        let mut heights: Vec<f64> = lengths.iter().zip(&self.shares).map(|(length, share)| length * share).collect();
        let before = heights.clone();
        lower(&mut heights, points, self.places.wall, GRADE);
        for v in 0..heights.len() {
            if heights[v] < before[v] && !self.places.is_held[v] {
                self.shares[v] = heights[v] / lengths[v];
            }
        }
    }
}

/// Lowers heights until those of neighbours differ by no more than this share of their distance.
pub(super) fn lower(heights: &mut [f64], points: &[Point3], triangles: &[[u32; 3]], grade: f64) {
    let mut changed = true;
    while changed {
        changed = false;
        for &[a, b, c] in triangles {
            for [x, y] in [[a, b], [b, c], [c, a]].map(|side| side.map(|v| v as usize)) {
                let step = grade * (points[x] - points[y]).norm();
                for [low, high] in [[x, y], [y, x]] {
                    let most = heights[low] + step;
                    // Rounding must not go on for ever.
                    if heights[high] > most * (1.0 + 1e-9) {
                        heights[high] = most;
                        changed = true;
                    }
                }
            }
        }
    }
}
