//! Validation of the input, in exact arithmetic, with linear time and memory except for sorting. Spatial defects
//! (intersecting parts) are checked in [`super::contacts`].

use super::certify::enclosed_volume;
use super::error::{EdgeFaults, InputArray, NAMED, TetError};
use super::plc::{InputKind, PlcRef};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::place_key;
use anastomesh_mesh::geometry::predicates::{MAX_MAGNITUDE, collinear, in_exact_range};

/// Maximum coordinate. The box around the input is three times as large and must be in the range of the predicates.
const LARGEST: f64 = MAX_MAGNITUDE / 4.0;

/// Edges of a surface, and additional segments.
#[derive(Clone, Debug, Default)]
pub(super) struct SurfaceEdges {
    /// Distinct edges, smaller vertex first, in ascending order.
    pub edges: Vec<[u32; 2]>,
    /// `edges[offset[v]..offset[v + 1]]` have `v` as their smaller vertex.
    offset: Vec<u32>,
}

impl SurfaceEdges {
    /// Creates the table from distinct edges in ascending order.
    fn new(edges: Vec<[u32; 2]>, points: usize) -> Self {
        let mut offset = vec![0u32; points + 1];
        for e in &edges {
            offset[e[0] as usize + 1] += 1;
        }
        for v in 0..points {
            offset[v + 1] += offset[v];
        }
        Self { edges, offset }
    }

    /// Range in `edges` of those with the smaller vertex `v`.
    pub fn range(&self, v: u32) -> Option<std::ops::Range<usize>> {
        let end = *self.offset.get((v as usize).saturating_add(1))?;
        Some(self.offset[v as usize] as usize..end as usize)
    }

    /// True if the surface has edge `a, b`.
    pub fn contains(&self, a: u32, b: u32) -> bool {
        self.position(a, b).is_some()
    }

    /// Index in `edges` of edge `a, b`.
    pub fn position(&self, a: u32, b: u32) -> Option<usize> {
        let (a, b) = (a.min(b), a.max(b));
        let range = self.range(a)?;
        let start = range.start;
        self.edges[range].binary_search_by_key(&b, |e| e[1]).ok().map(|i| start + i)
    }
}

/// The first few offenders and their total number.
#[derive(Debug, Default)]
pub(super) struct Offenders<T = u32> {
    pub named: Vec<T>,
    pub count: usize,
}

impl<T> Offenders<T> {
    pub fn add(&mut self, id: T) {
        if self.named.len() < NAMED {
            self.named.push(id);
        }
        self.count += 1;
    }
}

impl<T> FromIterator<T> for Offenders<T> {
    fn from_iter<I: IntoIterator<Item = T>>(ids: I) -> Self {
        let mut all = Self { named: Vec::new(), count: 0 };
        ids.into_iter().for_each(|id| all.add(id));
        all
    }
}

/// Checks the arrays of a surface and lists its edges, including `segments`. Self-intersections and coincident points
/// are not checked. A general complex may have no triangle twice; a closed surface may have two back to back.
pub(super) fn validate(surface: &TriMesh, segments: &[[u32; 2]], kind: InputKind) -> Result<SurfaceEdges, TetError> {
    check_arrays(surface)?;
    check_segments(segments, surface.points.len())?;
    match kind {
        InputKind::Closed => list_closed_edges(surface, segments),
        InputKind::Plc => {
            no_duplicate_triangles(&surface.triangles)?;
            Ok(list_edges(surface, segments))
        }
    }
}

/// Checks that a surface encloses a positive volume, as the short form requires.
pub(super) fn outward(surface: &TriMesh) -> Result<(), TetError> {
    let (volume, _) = enclosed_volume(surface);
    if volume < 0.0 { Err(TetError::InsideOut { volume }) } else { Ok(()) }
}

/// Checks the lengths of optional arrays.
pub(super) fn check_lengths(plc: PlcRef) -> Result<(), TetError> {
    let (found, expected) = (plc.markers.len(), plc.surface.triangles.len());
    if found != 0 && found != expected {
        return Err(TetError::WrongLength { array: InputArray::Markers, found, expected });
    }
    Ok(())
}

fn check_arrays(surface: &TriMesh) -> Result<(), TetError> {
    let (points, triangles) = (surface.points.len(), surface.triangles.len());
    if points == 0 || triangles == 0 {
        return Err(TetError::Empty { points, triangles });
    }
    if points.max(triangles) > (u32::MAX / 64) as usize {
        return Err(TetError::TooLarge { points: points.max(triangles) });
    }
    check_coordinates(&surface.points)?;
    check_indices(surface)?;
    check_areas(surface)
}

fn check_coordinates(points: &[Point3]) -> Result<(), TetError> {
    let wrong = |p: &Point3| !p.iter().all(|&x| in_exact_range(x) && x.abs() <= LARGEST);
    let found: Offenders = points.iter().zip(0..).filter(|(p, _)| wrong(p)).map(|(_, i)| i).collect();
    match found.named.first() {
        Some(&first) => {
            let position = points[first as usize];
            Err(TetError::OutOfRange { points: found.named, count: found.count, position })
        }
        None => Ok(()),
    }
}

fn check_indices(surface: &TriMesh) -> Result<(), TetError> {
    let points = surface.points.len();
    let wrong = |t: &[u32; 3]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || t.iter().any(|&v| v as usize >= points);
    let found: Offenders = surface.triangles.iter().zip(0..).filter(|(t, _)| wrong(t)).map(|(_, i)| i).collect();
    match found.named.first() {
        Some(&first) => {
            let vertices = surface.triangles[first as usize];
            Err(TetError::BadTriangle { triangles: found.named, count: found.count, vertices })
        }
        None => Ok(()),
    }
}

fn check_areas(surface: &TriMesh) -> Result<(), TetError> {
    let flat = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|v| &surface.points[v as usize]);
        collinear(p, q, r)
    };
    let found: Offenders = surface.triangles.iter().zip(0..).filter(|(t, _)| flat(t)).map(|(_, i)| i).collect();
    match found.named.first() {
        Some(&first) => {
            let vertices = surface.triangles[first as usize];
            Err(TetError::FlatTriangle { triangles: found.named, count: found.count, vertices })
        }
        None => Ok(()),
    }
}

fn check_segments(segments: &[[u32; 2]], points: usize) -> Result<(), TetError> {
    let wrong = |e: &[u32; 2]| e[0] == e[1] || e.iter().any(|&v| v as usize >= points);
    let found: Offenders = segments.iter().zip(0..).filter(|(e, _)| wrong(e)).map(|(_, i)| i).collect();
    if found.count == 0 { Ok(()) } else { Err(TetError::BadSegment { segments: found.named, count: found.count }) }
}

/// Edge from a vertex of a triangle to the next, smaller vertex first, and true if that is its direction.
fn edge_of(t: &[u32; 3], i: usize) -> ([u32; 2], bool) {
    let (a, b) = (t[i], t[(i + 1) % 3]);
    ([a.min(b), a.max(b)], a < b)
}

/// Sides of all triangles in ascending order, by a counting sort on the smaller vertex.
fn sorted_sides(surface: &TriMesh) -> Vec<([u32; 2], bool)> {
    let sides = || surface.triangles.iter().flat_map(|t| (0..3).map(|i| edge_of(t, i)));
    let mut end = vec![0u32; surface.points.len() + 1];
    for (e, _) in sides() {
        end[e[0] as usize + 1] += 1;
    }
    for v in 0..surface.points.len() {
        end[v + 1] += end[v];
    }
    let mut sorted = vec![([0; 2], false); 3 * surface.triangles.len()];
    for side in sides() {
        let slot = &mut end[side.0[0] as usize];
        sorted[*slot as usize] = side;
        *slot += 1;
    }
    // Filling moved each start to its end.
    let mut start = 0;
    for &end in &end[..surface.points.len()] {
        sorted[start..end as usize].sort_unstable();
        start = end as usize;
    }
    sorted
}

/// All distinct edges and segments.
fn list_edges(surface: &TriMesh, segments: &[[u32; 2]]) -> SurfaceEdges {
    let mut edges: Vec<[u32; 2]> = segments.iter().map(|e| [e[0].min(e[1]), e[0].max(e[1])]).collect();
    edges.extend(surface.triangles.iter().flat_map(|t| (0..3).map(|i| edge_of(t, i).0)));
    edges.sort_unstable();
    edges.dedup();
    SurfaceEdges::new(edges, surface.points.len())
}

/// Pairs the edges; each must occur once in each direction.
fn list_closed_edges(surface: &TriMesh, segments: &[[u32; 2]]) -> Result<SurfaceEdges, TetError> {
    let sides = sorted_sides(surface);
    let mut edges = Vec::with_capacity(sides.len() / 2 + segments.len());
    let (mut open, mut crowded, mut twisted) = (Vec::new(), Vec::new(), Vec::new());
    for run in sides.chunk_by(|x, y| x.0 == y.0) {
        match *run {
            [(e, x), (_, y)] if x != y => edges.push(e),
            [(e, _), (_, _)] => twisted.push(e),
            [(e, _)] => open.push(e),
            _ => crowded.push(run[0].0),
        }
    }
    drop(sides);
    if !(open.is_empty() && crowded.is_empty() && twisted.is_empty()) {
        no_duplicate_triangles(&surface.triangles)?;
    }
    let faults = |edges: &[[u32; 2]]| {
        let edge = *edges.first()?;
        let Offenders { named: triangles, count } = triangles_at(surface, edges);
        Some(EdgeFaults { triangles, count, edge, edges: edges.len() })
    };
    if let Some(found) = faults(&crowded) {
        return Err(TetError::NotManifold(found));
    }
    if let Some(found) = faults(&twins(&surface.points, &open)) {
        return Err(TetError::NotShared(found));
    }
    if let Some(found) = faults(&open) {
        return Err(TetError::Open(found));
    }
    if let Some(found) = faults(&twisted) {
        return Err(TetError::NotOriented(found));
    }
    if !segments.is_empty() {
        edges.extend(segments.iter().map(|e| [e[0].min(e[1]), e[0].max(e[1])]));
        edges.sort_unstable();
        edges.dedup();
    }
    Ok(SurfaceEdges::new(edges, surface.points.len()))
}

/// Edges that coincide with another of the given edges, in ascending order.
fn twins(points: &[Point3], edges: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let placed = |&edge: &[u32; 2]| {
        let mut ends = edge.map(|v| place_key(&points[v as usize]));
        ends.sort_unstable();
        (ends, edge)
    };
    let mut placed: Vec<_> = edges.iter().map(placed).collect();
    placed.sort_unstable();
    let runs = placed.chunk_by(|x, y| x.0 == y.0).filter(|run| run.len() > 1);
    let mut found: Vec<[u32; 2]> = runs.flatten().map(|&(_, edge)| edge).collect();
    found.sort_unstable();
    found
}

/// Triangles with one of the given edges, which are in ascending order.
fn triangles_at(surface: &TriMesh, edges: &[[u32; 2]]) -> Offenders {
    let has = |t: &[u32; 3]| (0..3).any(|i| edges.binary_search(&edge_of(t, i).0).is_ok());
    surface.triangles.iter().zip(0..).filter(|(t, _)| has(t)).map(|(_, i)| i).collect()
}

/// Checks that no two points have the same coordinates, regardless of the sign of zero.
pub(super) fn no_duplicate_points(points: &[Point3]) -> Result<(), TetError> {
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (place_key(&points[i as usize]), i));
    let mut twins: Vec<[u32; 2]> = Vec::new();
    for run in order.chunk_by(|&i, &j| points[i as usize] == points[j as usize]) {
        twins.extend(run.iter().skip(1).map(|&i| [run[0], i]));
    }
    twins.sort_unstable_by_key(|pair| pair[1]);
    let Some(first) = twins.first() else { return Ok(()) };
    let position = points[first[0] as usize];
    let count = twins.len();
    twins.truncate(NAMED);
    Err(TetError::DuplicatePoints { pairs: twins, count, position })
}

/// Checks that no two triangles have the same three vertices.
pub(super) fn no_duplicate_triangles(triangles: &[[u32; 3]]) -> Result<(), TetError> {
    let mut order: Vec<([u32; 3], u32)> = triangles.iter().map(|&t| anastomesh_mesh::face_key(t)).zip(0..).collect();
    order.sort_unstable();
    let mut twice: Vec<[u32; 2]> = Vec::new();
    for run in order.chunk_by(|x, y| x.0 == y.0) {
        twice.extend(run.iter().skip(1).map(|&(_, again)| [run[0].1, again]));
    }
    twice.sort_unstable();
    let found: Offenders<[u32; 2]> = twice.into_iter().collect();
    match found.count {
        0 => Ok(()),
        count => Err(TetError::DuplicateTriangles { pairs: found.named, count }),
    }
}
