//! Greedy flattening (section 3.2.2 of the paper, Fig. 5): removes tetrahedra until an end surface is projection flat.
//!
//! Let positive triangles form one disc with a simple polygon as projected rim. They cover each point of the plane at
//! most once (degree 1). Pairwise overlap tests are not needed.

use super::region::{OUTSIDE, Region, WALL};
use crate::block::{FlattenFailure, cross, crossing, disc_rim};
use anastomesh_mesh::TET_FACES;
use anastomesh_mesh::geometry::Point3;

/// Parameters of one attempt at an end surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlattenAttempt {
    /// Height of the initial cut.
    pub offset: f64,
    /// Minimum cosine of triangles against the plane; 0 requires a positive projection only.
    pub min_cosine: f64,
    /// Maximum depth: tetrahedra with a deeper vertex are not removed.
    pub depth: f64,
}

/// End surface with local numbers.
pub(super) struct Flat {
    /// Removed tetrahedra of the region.
    pub removed: Vec<bool>,
    /// Triangles, oriented out of the remaining part.
    pub triangles: Vec<[u32; 3]>,
    /// Boundary loop.
    pub rim: Vec<u32>,
}

/// Maximum rounds of topology repair.
const MAX_TOPOLOGY_REPAIRS: usize = 60;

struct Flattener<'a> {
    region: &'a Region,
    points: &'a [Point3],
    attempt: FlattenAttempt,
    removed: Vec<bool>,
    /// Exposed faces `4·tet + face`; stale if their owner was removed.
    exposed: Vec<u32>,
    /// Number of leading entries of `exposed` already examined.
    checked: usize,
}

/// Creates a flat end surface.
pub(super) fn flatten(
    region: &Region,
    points: &[Point3],
    seed: u32,
    attempt: FlattenAttempt,
) -> Result<Flat, FlattenFailure> {
    let mut f =
        Flattener { region, points, attempt, removed: vec![false; region.tets.len()], exposed: Vec::new(), checked: 0 };
    f.cut(seed)?;
    for _ in 0..MAX_TOPOLOGY_REPAIRS {
        f.remove_folds()?;
        f.drop_islands();
        let faces = f.live_faces();
        if faces.is_empty() {
            return Err(FlattenFailure::NotADisc);
        }
        let triangles: Vec<[u32; 3]> = faces.iter().map(|&x| f.triangle(x)).collect();
        let culprits = match f.fault(&faces, &triangles) {
            Ok(rim) => return Ok(Flat { removed: f.removed, triangles, rim }),
            Err(c) => c,
        };
        if culprits.is_empty() {
            return Err(FlattenFailure::NotADisc);
        }
        for t in culprits {
            f.remove(t)?;
        }
    }
    Err(FlattenFailure::Budget)
}

impl Flattener<'_> {
    /// Removes the tetrahedra that lie wholly beyond the plane and are connected to the seed.
    fn cut(&mut self, seed: u32) -> Result<(), FlattenFailure> {
        let region = self.region;
        let offset = self.attempt.offset;
        let beyond = |t: u32| region.corners[t as usize].iter().all(|&v| region.height[v as usize] > offset);
        if !beyond(seed) {
            return Err(FlattenFailure::NothingBeyond);
        }
        let mut order = vec![seed];
        self.removed[seed as usize] = true;
        let mut at = 0;
        while at < order.len() {
            let t = order[at];
            at += 1;
            for &n in &region.neighbours[t as usize] {
                if n == OUTSIDE {
                    return Err(FlattenFailure::LeavesVessel);
                }
                if n != WALL && !self.removed[n as usize] && beyond(n) {
                    self.removed[n as usize] = true;
                    order.push(n);
                }
            }
        }
        for &t in &order {
            self.expose_neighbours(t);
        }
        Ok(())
    }

    fn expose_neighbours(&mut self, t: u32) {
        for &n in &self.region.neighbours[t as usize] {
            if n >= OUTSIDE || self.removed[n as usize] {
                continue;
            }
            if let Some(face) = self.region.neighbours[n as usize].iter().position(|&x| x == t) {
                self.exposed.push(4 * n + face as u32);
            }
        }
    }

    fn remove(&mut self, t: u32) -> Result<(), FlattenFailure> {
        if self.removed[t as usize] {
            return Ok(());
        }
        let region = self.region;
        if region.neighbours[t as usize].contains(&OUTSIDE) {
            return Err(FlattenFailure::LeavesVessel);
        }
        if region.corners[t as usize].iter().any(|&v| region.height[v as usize] < -self.attempt.depth) {
            return Err(FlattenFailure::TooDeep);
        }
        self.removed[t as usize] = true;
        self.expose_neighbours(t);
        Ok(())
    }

    /// Exposed face in local vertices, oriented out of the remaining part.
    fn triangle(&self, face: u32) -> [u32; 3] {
        let corners = self.region.corners[(face / 4) as usize];
        TET_FACES[(face % 4) as usize].map(|k| corners[k])
    }

    fn folded(&self, t: [u32; 3]) -> bool {
        let [a, b, c] = t.map(|v| self.region.flat[v as usize]);
        if cross(a, b, c) <= 0 {
            return true;
        }
        if self.attempt.min_cosine <= 0.0 {
            return false;
        }
        let [a, b, c] = t.map(|v| self.points[self.region.vertices[v as usize] as usize]);
        let [ha, hb, hc] = t.map(|v| self.region.height[v as usize]);
        // The squared gradient of the height over the triangle is tan² of its slope.
        let (e, f) = (b - a, c - a);
        let n2 = e.cross(&f).norm_squared();
        let (p, q) = (hb - ha, hc - ha);
        let g2 = (f * p - e * q).norm_squared();
        let sine2 = g2 / n2;
        1.0 - sine2 < self.attempt.min_cosine * self.attempt.min_cosine
    }

    fn remove_folds(&mut self) -> Result<(), FlattenFailure> {
        while self.checked < self.exposed.len() {
            let face = self.exposed[self.checked];
            self.checked += 1;
            if !self.removed[(face / 4) as usize] && self.folded(self.triangle(face)) {
                self.remove(face / 4)?;
            }
        }
        Ok(())
    }

    fn live_faces(&mut self) -> Vec<u32> {
        let removed = &self.removed;
        self.exposed.retain(|f| !removed[(f / 4) as usize]);
        self.exposed.sort_unstable();
        self.checked = self.exposed.len();
        self.exposed.clone()
    }

    /// Removes tetrahedra that are no longer connected to the cluster.
    fn drop_islands(&mut self) {
        let region = self.region;
        let mut kept = vec![false; region.tets.len()];
        let mut stack: Vec<u32> = (0..region.tets.len() as u32)
            .filter(|&t| !self.removed[t as usize] && region.neighbours[t as usize].contains(&OUTSIDE))
            .collect();
        if stack.is_empty() {
            // The region contains the whole cluster: its deepest tetrahedron represents the main part.
            let height = |t: u32| region.corners[t as usize].iter().map(|&v| region.height[v as usize]).sum::<f64>();
            let deepest = (0..region.tets.len() as u32)
                .filter(|&t| !self.removed[t as usize])
                .min_by(|&a, &b| height(a).total_cmp(&height(b)));
            stack.extend(deepest);
        }
        for &t in &stack {
            kept[t as usize] = true;
        }
        while let Some(t) = stack.pop() {
            for &n in &region.neighbours[t as usize] {
                if n < OUTSIDE && !self.removed[n as usize] && !kept[n as usize] {
                    kept[n as usize] = true;
                    stack.push(n);
                }
            }
        }
        for (removed, kept) in self.removed.iter_mut().zip(&kept) {
            *removed |= !kept;
        }
    }

    /// Returns the rim, or the tetrahedra to remove next.
    fn fault(&self, faces: &[u32], triangles: &[[u32; 3]]) -> Result<Vec<u32>, Vec<u32>> {
        let pinched = self.pinched(triangles);
        if !pinched.is_empty() {
            return Err(owners_at(faces, triangles, &pinched));
        }
        let Some(rim) = disc_rim(triangles) else {
            return Err(self.off_main_loop(faces, triangles));
        };
        let polygon: Vec<[i64; 2]> = rim.iter().map(|&v| self.region.flat[v as usize]).collect();
        if let Some((i, j)) = crossing(&polygon) {
            // The higher of the two edges is the overhanging one.
            let n = rim.len();
            let edge = |i: u32| [rim[i as usize], rim[(i as usize + 1) % n]];
            let height = |e: [u32; 2]| self.region.height[e[0] as usize] + self.region.height[e[1] as usize];
            let (e, f) = (edge(i), edge(j));
            let top = if height(e) >= height(f) { e } else { f };
            return Err(owners_of_edge(faces, triangles, top));
        }
        Ok(rim)
    }

    /// Vertices of the end surface at which the remaining boundary is not a single fan.
    fn pinched(&self, triangles: &[[u32; 3]]) -> Vec<u32> {
        let mut vertices: Vec<u32> = triangles.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let mut links: Vec<(u32, u32)> = Vec::new();
        vertices.retain(|&v| {
            links.clear();
            for &t in self.region.star(v) {
                if !self.removed[t as usize] {
                    self.boundary_links(t, v, &mut links);
                }
            }
            !single_fan(&mut links)
        });
        vertices
    }

    /// Appends the edge opposite `v` for every boundary face of tetrahedron `t` at vertex `v`.
    fn boundary_links(&self, t: u32, v: u32, links: &mut Vec<(u32, u32)>) {
        let corners = self.region.corners[t as usize];
        for (i, &n) in self.region.neighbours[t as usize].iter().enumerate() {
            if corners[i] == v || !(n == WALL || (n < OUTSIDE && self.removed[n as usize])) {
                continue;
            }
            let f = TET_FACES[i].map(|k| corners[k]);
            if let Some(k) = f.iter().position(|&x| x == v) {
                links.push((f[(k + 1) % 3], f[(k + 2) % 3]));
            }
        }
    }

    /// Owners of triangles at boundary loops other than the widest one, which are rims of pockets.
    fn off_main_loop(&self, faces: &[u32], triangles: &[[u32; 3]]) -> Vec<u32> {
        let loops = boundary_loops(triangles);
        let area = |l: &Vec<u32>| -> i64 {
            let p = |i: usize| self.region.flat[l[i % l.len()] as usize];
            (1..l.len()).map(|i| cross(p(0), p(i), p(i + 1)) / 2).sum()
        };
        let main = loops.iter().enumerate().max_by_key(|(_, l)| area(l)).map(|(i, _)| i);
        let mut vertices: Vec<u32> =
            loops.iter().enumerate().filter(|&(i, _)| Some(i) != main).flat_map(|(_, l)| l.iter().copied()).collect();
        vertices.sort_unstable();
        vertices.dedup();
        owners_at(faces, triangles, &vertices)
    }
}

/// True if the directed edges around a vertex form one cycle.
fn single_fan(links: &mut [(u32, u32)]) -> bool {
    links.sort_unstable();
    if links.is_empty() || links.windows(2).any(|w| w[0].0 == w[1].0) {
        return false;
    }
    let start = links[0].0;
    let mut at = links[0].1;
    for step in 1..=links.len() {
        if at == start {
            return step == links.len();
        }
        let Ok(k) = links.binary_search_by_key(&at, |l| l.0) else { return false };
        at = links[k].1;
    }
    false
}

/// Boundary loops of an oriented triangle set without pinched vertices.
fn boundary_loops(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    let mut edges: Vec<(u32, u32)> =
        triangles.iter().flat_map(|t| (0..3).map(move |k| (t[k], t[(k + 1) % 3]))).collect();
    edges.sort_unstable();
    let boundary: Vec<(u32, u32)> =
        edges.iter().copied().filter(|&(a, b)| edges.binary_search(&(b, a)).is_err()).collect();
    let mut used = vec![false; boundary.len()];
    let mut loops = Vec::new();
    for start in 0..boundary.len() {
        let mut k = start;
        let mut vertices = Vec::new();
        while !used[k] {
            used[k] = true;
            vertices.push(boundary[k].0);
            match boundary.binary_search_by_key(&boundary[k].1, |e| e.0) {
                Ok(next) => k = next,
                Err(_) => break,
            }
        }
        if !vertices.is_empty() {
            loops.push(vertices);
        }
    }
    loops
}

fn owners_at(faces: &[u32], triangles: &[[u32; 3]], vertices: &[u32]) -> Vec<u32> {
    faces
        .iter()
        .zip(triangles)
        .filter(|(_, t)| t.iter().any(|v| vertices.binary_search(v).is_ok()))
        .map(|(f, _)| f / 4)
        .collect()
}

fn owners_of_edge(faces: &[u32], triangles: &[[u32; 3]], edge: [u32; 2]) -> Vec<u32> {
    let has = |t: &[u32; 3]| t.contains(&edge[0]) && t.contains(&edge[1]);
    faces.iter().zip(triangles).filter(|(_, t)| has(t)).map(|(f, _)| f / 4).collect()
}
