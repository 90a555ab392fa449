//! Inner surface: vertex positions for which every prism is positive and the surface can be filled.

use super::stack::{Numbers, Stack, toward};
use crate::contacts::contacts;
use crate::error::{Obstacle, Stuck, TetError};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{TetMesh, TriMesh};

/// Factor of the offset of an obstructing vertex.
const OFFSET_FACTOR: f64 = 0.6;
/// Fraction of the offset below which a vertex gets no layer.
const LEAST: f64 = 2e-3;
/// Maximum difference of neighbouring offsets, relative to their distance, after a reduction.
const GRADE: f64 = 0.5;
/// Successive factors of the offset if filling fails without self-intersection, a slow test. Zero after these.
const STUCK: [f64; 3] = [0.5, 0.2, 0.2];
/// Round from which obstructing vertices return to the wall at once, and maximum rounds.
const PATIENT: usize = 40;
/// Maximum passes that shorten layers before the surface is refused.
const MAX_INSET_PASSES: usize = 100;

/// A surface and the wanted inner positions of its vertices.
pub struct Places<'a> {
    /// The surface.
    pub surface: &'a TriMesh,
    /// Triangles with layers.
    pub wall: &'a [[u32; 3]],
    /// True for vertices that also have triangles without layers.
    pub is_rim: Vec<bool>,
    /// Wanted position of each vertex, including those off the wall.
    pub wanted: Vec<Point3>,
    /// True for vertices that must be at their wanted position.
    pub is_held: Vec<bool>,
    /// True if the inner surface probably intersects itself. This is tested first then, since filling takes longer.
    pub is_narrow: bool,
}

/// A mesh with layers.
pub struct Inset {
    /// The mesh. Its points begin with the surface's; those off the wall are at their inner position.
    pub mesh: TetMesh,
    /// Number of layer tetrahedra, which come first.
    pub of_layers: usize,
    /// Indices of the copies of each vertex.
    pub numbers: Numbers,
    /// Fraction of its offset that each vertex has.
    pub shares: Vec<f64>,
}

/// Finds inner positions, fills the inner surface, and adds the layers around it. `depths` are fractions of the offset.
/// The mesh made by `fill` must keep the surface, and its points must begin with the surface's.
///
/// # Errors
/// Errors of `fill`; [`TetError::Stuck`] with a wall triangle whose prism is inverted and whose vertices cannot move.
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
        ways.drawn_back = if round < PATIENT { OFFSET_FACTOR } else { 0.0 };
        let inner = ways.inner();
        let stack = Stack::new(outer, places.wall, places.is_rim.clone(), &inner, depths);
        let turned = stack.turned();
        if let Some(&first) = turned.first() {
            if round > MAX_INSET_PASSES || !ways.reduce_offsets(turned.as_flattened()) {
                return Err(TetError::Stuck { part: Obstacle::Triangle(first), reason: Stuck::Layer });
            }
            continue;
        }
        let inside = TriMesh { points: inner, triangles: places.surface.triangles.clone() };
        let meeting =
            || -> Vec<u32> { contacts(&inside).iter().flatten().flat_map(|&t| inside.triangles[t as usize]).collect() };
        if places.is_narrow && ways.reduce_offsets(&meeting()) {
            continue;
        }
        match fill(&inside) {
            Ok(core) => {
                let numbers = stack.numbers.clone();
                let (mesh, of_layers) = stack.around(&core);
                return Ok(Inset { mesh, of_layers, numbers, shares: ways.shares });
            }
            Err(error) if error.is_stop() => return Err(error),
            Err(error) => {
                let meeting = if places.is_narrow { Vec::new() } else { meeting() };
                ways.drawn_back = if meeting.is_empty() { failures.next().unwrap_or(0.0) } else { OFFSET_FACTOR };
                let in_the_way = if meeting.is_empty() { stuck(&error, &inside) } else { meeting };
                let all = || (0..outer.len() as u32).collect::<Vec<u32>>();
                if round > MAX_INSET_PASSES || !(ways.reduce_offsets(&in_the_way) || ways.reduce_offsets(&all())) {
                    return Err(error);
                }
            }
        }
    }
}

/// Vertices of the parts of a surface that could not be recovered.
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

/// Current offset of each vertex.
pub struct Ways<'a> {
    places: &'a Places<'a>,
    /// Fraction of its wanted offset that each vertex has.
    pub shares: Vec<f64>,
    /// Factor of the offset of an obstructing vertex.
    pub drawn_back: f64,
}

impl<'a> Ways<'a> {
    pub fn new(places: &'a Places<'a>) -> Self {
        Self { places, shares: vec![1.0; places.wanted.len()], drawn_back: OFFSET_FACTOR }
    }

    /// Current positions.
    pub fn inner(&self) -> Vec<Point3> {
        let Places { surface, wanted, .. } = self.places;
        let all = surface.points.iter().zip(wanted).zip(&self.shares);
        all.map(|((outer, wanted), &share)| toward(outer, wanted, share)).collect()
    }

    /// Reduces the offsets of vertices, and grades those around them. Returns false if none could be reduced.
    pub fn reduce_offsets(&mut self, vertices: &[u32]) -> bool {
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

    /// Wanted offset of a vertex.
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

/// Lowers heights until neighbours differ by at most `grade` times their distance.
pub fn lower(heights: &mut [f64], points: &[Point3], triangles: &[[u32; 3]], grade: f64) {
    let mut changed = true;
    while changed {
        changed = false;
        for &[a, b, c] in triangles {
            for [x, y] in [[a, b], [b, c], [c, a]].map(|side| side.map(|v| v as usize)) {
                let step = grade * (points[x] - points[y]).norm();
                for [low, high] in [[x, y], [y, x]] {
                    let most = heights[low] + step;
                    // Tolerance for rounding, to ensure termination.
                    if heights[high] > most * (1.0 + 1e-9) {
                        heights[high] = most;
                        changed = true;
                    }
                }
            }
        }
    }
}
