//! Extracts the tetrahedra of one joint from the whole mesh and writes them back.

use anastomesh_mesh::tet_key;
use rustc_hash::FxHashMap;

use anastomesh_mesh::TetMesh;
use anastomesh_mesh::adjacency::{face_vertices, tet_adjacency};
use anastomesh_mesh::quality::radius_ratio;

/// Optimizes the inside of a mesh. The given number of leading points and all boundary faces are fixed. Points keep
/// their index; new ones may be appended. Returns false if the mesh is unchanged because it could not be optimized.
///
/// The tetrahedralizer's optimizer is such a function; as a parameter it keeps this module independent of it.
pub type Improve<'a> = dyn Fn(&mut TetMesh, usize) -> bool + Sync + 'a;

/// Part of a mesh with its own numbering: points that the optimization must not move, then inner points.
pub(super) struct Region {
    pub mesh: TetMesh,
    /// Number of leading points that are not inner points.
    pub fixed: usize,
    /// Points on the wall that are free to move along it.
    pub on_wall: Vec<bool>,
    /// Boundary faces of the region; around a point of `on_wall` these are faces of the wall.
    pub faces: Vec<[u32; 3]>,
    blocks: Vec<i32>,
    /// Index of each point in the whole mesh.
    global: Vec<u32>,
    /// Indices of the tetrahedra in the whole mesh, ascending.
    slots: Vec<u32>,
}

impl Region {
    /// Extracts the tetrahedra `tets`. `degree` counts the tetrahedra around each vertex of the whole mesh: vertices
    /// with tetrahedra outside the region are shared and fixed.
    pub fn new(whole: &TetMesh, tet_block: &[i32], tets: &[u32], degree: &[u32], frozen: &[bool]) -> Self {
        let corners: Vec<[u32; 4]> = tets.iter().map(|&t| whole.tets[t as usize]).collect();
        let mut vertices: Vec<u32> = corners.iter().flatten().copied().collect();
        vertices.sort_unstable();
        let counted: Vec<(u32, u32)> = vertices.chunk_by(|a, b| a == b).map(|run| (run[0], run.len() as u32)).collect();
        let (_, first_faces) = boundary(&corners, |v| counted.partition_point(|c| c.0 < v) as u32, counted.len());
        let mut on_boundary = vec![false; counted.len()];
        for &v in first_faces.iter().flatten() {
            on_boundary[v as usize] = true;
        }
        // Boundary points first; otherwise the order is stable.
        let mut order: Vec<usize> = (0..counted.len()).collect();
        order.sort_by_key(|&i| !on_boundary[i] && !frozen[counted[i].0 as usize]);
        let mut place = vec![0_u32; order.len()];
        for (new, &old) in order.iter().enumerate() {
            place[old] = new as u32;
        }
        let free = |i: usize| counted[i].1 == degree[counted[i].0 as usize] && !frozen[counted[i].0 as usize];
        let global: Vec<u32> = order.iter().map(|&i| counted[i].0).collect();
        let local = |v: u32| place[counted.partition_point(|c| c.0 < v)];
        Self {
            mesh: TetMesh {
                points: global.iter().map(|&v| whole.points[v as usize]).collect(),
                tets: corners.iter().map(|t| t.map(local)).collect(),
            },
            fixed: order.iter().filter(|&&i| on_boundary[i] || frozen[counted[i].0 as usize]).count(),
            on_wall: order.iter().map(|&i| on_boundary[i] && free(i)).collect(),
            faces: first_faces.iter().map(|f| f.map(|i| place[i as usize])).collect(),
            blocks: tets.iter().map(|&t| tet_block[t as usize]).collect(),
            global,
            slots: tets.to_vec(),
        }
    }

    /// Smallest radius ratio.
    pub fn worst(&self) -> f64 {
        let ratio = |t: &[u32; 4]| {
            let [a, b, c, d] = t.map(|v| &self.mesh.points[v as usize]);
            radius_ratio(a, b, c, d)
        };
        self.mesh.tets.iter().map(ratio).fold(f64::INFINITY, f64::min)
    }

    /// Optimizes the inside and updates the blocks.
    pub fn improve(&mut self, improve: &Improve) -> bool {
        let before = self.mesh.tets.clone();
        if !improve(&mut self.mesh, self.fixed) {
            return false;
        }
        self.on_wall.resize(self.mesh.points.len(), false);
        self.blocks = blocks_after(&before, &self.blocks, &self.mesh);
        true
    }

    /// Writes the region back to its original slots, then to the end; unused slots are added to `gaps`.
    pub fn write_back(self, whole: &mut TetMesh, tet_block: &mut Vec<i32>, gaps: &mut Vec<u32>) {
        let mut global = self.global;
        for (i, p) in self.mesh.points.iter().enumerate() {
            if let Some(&v) = global.get(i) {
                whole.points[v as usize] = *p;
            } else {
                global.push(whole.points.len() as u32);
                whole.points.push(*p);
            }
        }
        for (i, (t, &block)) in self.mesh.tets.iter().zip(&self.blocks).enumerate() {
            let t = t.map(|v| global[v as usize]);
            if let Some(&slot) = self.slots.get(i) {
                whole.tets[slot as usize] = t;
                tet_block[slot as usize] = block;
            } else {
                whole.tets.push(t);
                tet_block.push(block);
            }
        }
        gaps.extend(self.slots.iter().skip(self.mesh.tets.len()));
    }
}

/// Tetrahedra renumbered by `local`, with their boundary faces.
fn boundary(corners: &[[u32; 4]], local: impl Fn(u32) -> u32, points: usize) -> (Vec<[u32; 4]>, Vec<[u32; 3]>) {
    let tets: Vec<[u32; 4]> = corners.iter().map(|t| t.map(&local)).collect();
    let faces = tet_adjacency(&tets, points).boundary().map(|handle| face_vertices(&tets, handle)).collect();
    (tets, faces)
}

/// Blocks of the tetrahedra `after`, derived from those of `before`.
fn blocks_after(before: &[[u32; 4]], blocks: &[i32], after: &TetMesh) -> Vec<i32> {
    let mut names = blocks.to_vec();
    names.sort_unstable();
    names.dedup();
    if let [one] = names[..] {
        return vec![one; after.tets.len()];
    }
    let mut votes = vec![0_u32; names.len() * after.points.len()];
    let mut known: FxHashMap<[u32; 4], i32> = FxHashMap::default();
    for (t, &block) in before.iter().zip(blocks) {
        let name = names.partition_point(|&n| n < block);
        for &v in t {
            votes[v as usize * names.len() + name] += 1;
        }
        known.insert(tet_key(*t), block);
    }
    let elect = |t: &[u32; 4]| {
        let sum = |name: usize| t.iter().map(|&v| votes[v as usize * names.len() + name]).sum::<u32>();
        // The last of equal maxima in reverse order is the smallest name.
        (0..names.len()).rev().max_by_key(|&name| sum(name)).map_or(0, |name| names[name])
    };
    after.tets.iter().map(|t| known.get(&tet_key(*t)).copied().unwrap_or_else(|| elect(t))).collect()
}
