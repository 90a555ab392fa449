//! Meshes with a split surface ([`Boundary::Split`]). Surface edges that are too long, and edges of triangles under
//! badly shaped tetrahedra, are halved until the goals are met or nothing is gained. The pieces are kept like any
//! input.
//!
//! Midpoints are rounded, so the pieces of a triangle are coplanar up to rounding. The certificate refers to the
//! pieces.

use super::builder::{Tetrahedralization, Tetrahedralizer};
use super::complex::face_key;
use super::error::TetError;
use super::options::{Boundary, Interior, Refinement, Sizing};
use super::outside::without;
use super::plc::LeftOut;
use super::plc::{Plc, PlcRef};
use super::sized;
use anastomesh_mesh::Bounds;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::geometry::Point3;
use rustc_hash::{FxHashMap, FxHashSet};
use std::sync::Arc;

/// Maximum rounds of splitting for shape.
const MAX_SURFACE_SPLITS: usize = 3;

/// Maximum triangles of the split surface.
const MAX_TRIANGLES: usize = 20_000_000;

/// A surface being split.
struct Pieces {
    plc: Plc,
    /// Input triangle of each piece.
    origin: Vec<u32>,
    /// Input segment of each piece.
    segment_origin: Vec<u32>,
    /// Triangles at each edge; may contain replaced ones.
    at_edge: FxHashMap<[u32; 2], Vec<u32>>,
    segments: FxHashMap<[u32; 2], u32>,
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn edges_of(t: [u32; 3]) -> [[u32; 2]; 3] {
    [edge(t[0], t[1]), edge(t[1], t[2]), edge(t[2], t[0])]
}

impl Pieces {
    fn new(plc: Plc) -> Self {
        let mut at_edge: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
        for (i, t) in plc.surface.triangles.iter().enumerate() {
            for e in edges_of(*t) {
                at_edge.entry(e).or_default().push(i as u32);
            }
        }
        let segments = plc.segments.iter().zip(0..).map(|(e, i)| (edge(e[0], e[1]), i)).collect();
        let origin = (0..plc.surface.triangles.len() as u32).collect();
        let segment_origin = (0..plc.segments.len() as u32).collect();
        Self { plc, origin, segment_origin, at_edge, segments }
    }

    fn length(&self, [a, b]: [u32; 2]) -> f64 {
        (self.plc.surface.points[a as usize] - self.plc.surface.points[b as usize]).norm()
    }

    fn middle(&self, [a, b]: [u32; 2]) -> Point3 {
        nalgebra::center(&self.plc.surface.points[a as usize], &self.plc.surface.points[b as usize])
    }

    /// Halves an edge and its triangles. An edge too short to have a midpoint stays.
    fn halve(&mut self, e: [u32; 2]) -> bool {
        let middle = self.middle(e);
        let ends = e.map(|v| self.plc.surface.points[v as usize]);
        let segment = self.segments.remove(&e);
        let triangles = self.at_edge.remove(&e).unwrap_or_default();
        let full = self.plc.surface.triangles.len() + triangles.len() > MAX_TRIANGLES;
        if ends.contains(&middle) || full || (triangles.is_empty() && segment.is_none()) {
            return false;
        }
        let m = self.plc.surface.points.len() as u32;
        self.plc.surface.points.push(middle);
        let [a, b] = e;
        if let Some(s) = segment {
            self.plc.segments[s as usize] = [a, m];
            self.segments.insert(edge(a, m), s);
            self.segments.insert(edge(m, b), self.plc.segments.len() as u32);
            self.plc.segments.push([m, b]);
            self.segment_origin.push(self.segment_origin[s as usize]);
        }
        for i in triangles {
            let t = self.plc.surface.triangles[i as usize];
            let new = self.plc.surface.triangles.len() as u32;
            let first = t.map(|v| if v == b { m } else { v });
            let second = t.map(|v| if v == a { m } else { v });
            self.plc.surface.triangles[i as usize] = first;
            self.plc.surface.triangles.push(second);
            self.origin.push(self.origin[i as usize]);
            if let Some(&marker) = self.plc.markers.get(i as usize) {
                self.plc.markers.push(marker);
            }
            for old in edges_of(t) {
                if let Some(list) = self.at_edge.get_mut(&old) {
                    list.retain(|&x| x != i);
                }
            }
            for (tri, id) in [(first, i), (second, new)] {
                for e in edges_of(tri) {
                    self.at_edge.entry(e).or_default().push(id);
                }
            }
        }
        true
    }

    /// Halves edges until none is much longer than `size` at its midpoint. The longest edge of a triangle goes first,
    /// so that angles do not shrink.
    fn split_to(&mut self, size: &dyn Fn(&Point3) -> f64) {
        let mut due: Vec<u32> = (0..self.plc.surface.triangles.len() as u32).collect();
        while !due.is_empty() {
            let mut next = Vec::new();
            for i in due {
                let longest = self.longest(i);
                let wanted = size(&self.middle(longest));
                if wanted > 0.0 && self.length(longest) > Boundary::LONGER * wanted {
                    let touched = self.at_edge.get(&longest).cloned().unwrap_or_default();
                    let first = self.plc.surface.triangles.len() as u32;
                    if self.halve(longest) {
                        next.extend(touched);
                        next.extend(first..self.plc.surface.triangles.len() as u32);
                    }
                }
            }
            next.sort_unstable();
            next.dedup();
            due = next;
        }
    }

    /// Renames pieces to the triangles and segments of the input.
    fn name_origins(&self, done: &mut Tetrahedralization) {
        let left_out = &mut done.summary.left_out;
        done.origins = without(&self.origin, &left_out.triangles);
        for (ids, origin) in [(&mut left_out.triangles, &self.origin), (&mut left_out.segments, &self.segment_origin)] {
            for id in ids.iter_mut() {
                *id = origin[*id as usize];
            }
            ids.sort_unstable();
            ids.dedup();
        }
    }

    fn longest(&self, triangle: u32) -> [u32; 2] {
        let mut edges = edges_of(self.plc.surface.triangles[triangle as usize]);
        edges.sort_unstable_by(|x, y| self.length(*y).total_cmp(&self.length(*x)).then(x.cmp(y)));
        edges[0]
    }
}

impl Tetrahedralizer {
    /// Meshes a checked complex with triangles that may be split. If some cannot be recovered, retries without those
    /// outside the filled volume, whose pieces are not needed.
    ///
    /// # Errors
    /// As [`Tetrahedralizer::run`].
    pub(super) fn run_split(&self, plc: PlcRef) -> Result<Tetrahedralization, TetError> {
        let error = match self.run_pieces(plc) {
            Err(error @ (TetError::Stuck { .. } | TetError::NotRecovered { .. })) => error,
            other => return other,
        };
        let bare =
            self.clone().boundary(Boundary::Keep).interior(Interior::None).refine(None::<Refinement>).optimize(false);
        match bare.sizing(Sizing::Surface).run(plc) {
            Ok(Tetrahedralization { summary, .. }) if !summary.left_out.is_empty() => {
                self.run_without(plc, summary.left_out)
            }
            Err(error) if error.is_stop() => Err(error),
            _ => Err(error),
        }
    }

    /// Meshes the complex without its outside parts.
    fn run_without(&self, plc: PlcRef, left_out: LeftOut) -> Result<Tetrahedralization, TetError> {
        let kept: Vec<u32> = without(&(0..plc.surface.triangles.len() as u32).collect::<Vec<_>>(), &left_out.triangles);
        let surface = left_out.kept_surface(plc.surface);
        let inner = PlcRef {
            surface: &surface,
            markers: &without(plc.markers, &left_out.triangles),
            segments: &without(plc.segments, &left_out.segments),
            ..plc
        };
        let mut done = self.run_pieces(inner)?;
        for id in &mut done.origins {
            *id = kept[*id as usize];
        }
        done.summary.left_out = left_out;
        Ok(done)
    }

    fn run_pieces(&self, plc: PlcRef) -> Result<Tetrahedralization, TetError> {
        let (refinement, sizing) = self.refinement_and_sizing();
        let volume = refinement.and_then(|r| r.bounds.max_volume);
        let size = Arc::new(sized::size_function(plc.surface, sizing, volume));
        let mut pieces = Pieces::new(plc.to_owned());
        if volume.is_some() || !matches!(sizing, Sizing::Surface) {
            pieces.split_to(&*size);
        }
        let keep = self.clone().boundary(Boundary::Keep);
        let keep = match sizing {
            // The size field of the input also applies to its pieces.
            Sizing::PerVertex(_) => {
                let size = Arc::clone(&size);
                keep.sizing(Sizing::Function(Arc::new(move |p: &Point3| size(p))))
            }
            _ => keep,
        };
        let goals = sized::goals(refinement);
        let shape = super::refine::Goals { bounds: Bounds { max_volume: None, ..goals.bounds }, ..goals };
        let mut round = 0;
        loop {
            let mut done = keep.run(&pieces.plc)?;
            let split = if round < MAX_SURFACE_SPLITS { to_split(&done.mesh, &pieces, &shape) } else { Vec::new() };
            let changed = split.into_iter().filter(|&e| pieces.halve(e)).count();
            if changed == 0 {
                pieces.name_origins(&mut done);
                return Ok(done);
            }
            round += 1;
        }
    }
}

/// Longest edges of triangles under tetrahedra that violate the goals, in ascending order, without edges that are short
/// relative to the tetrahedron.
fn to_split(mesh: &TetMesh, pieces: &Pieces, goals: &super::refine::Goals) -> Vec<[u32; 2]> {
    let mut triangle: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    for (i, t) in pieces.plc.surface.triangles.iter().enumerate() {
        triangle.insert(face_key(*t), i as u32);
    }
    let mut found: FxHashSet<[u32; 2]> = FxHashSet::default();
    for v in &mesh.tets {
        let corners = v.map(|x| &mesh.points[x as usize]);
        let on = (0..4).filter_map(|i| triangle.get(&face_key(super::complex::face_of(v, i))));
        let on: Vec<u32> = on.copied().collect();
        if on.is_empty() || goals.fault(corners, None).is_none() {
            continue;
        }
        let shortest = (0..4).flat_map(|i| (0..i).map(move |j| (i, j)));
        let shortest = shortest.map(|(i, j)| (corners[i] - corners[j]).norm()).fold(f64::INFINITY, f64::min);
        for t in on {
            let longest = pieces.longest(t);
            if pieces.length(longest) > 1.8 * shortest {
                found.insert(longest);
            }
        }
    }
    let mut list: Vec<[u32; 2]> = found.into_iter().collect();
    list.sort_unstable();
    list
}
