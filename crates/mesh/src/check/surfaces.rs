//! Boundary surfaces of a mesh: faces connected by vertices.

use crate::adjacency::NONE;
use crate::geometry::DisjointSets;

/// Boundary surfaces: faces connected by vertices.
pub(super) struct Surfaces {
    /// Surface of each vertex; `NONE` off the boundary.
    pub of: Vec<u32>,
    /// Surfaces, ascending by smallest vertex.
    pub all: Vec<Surface>,
}

/// A boundary surface.
pub(super) struct Surface {
    /// Smallest vertex.
    pub vertex: u32,
    pub vertices: i64,
    pub faces: i64,
}

impl Surface {
    /// Euler number of a closed surface, where 2 E = 3 F.
    pub(super) fn euler(&self) -> i64 {
        self.vertices - self.faces / 2
    }
}

pub(super) fn surfaces(points: usize, faces: &[[u32; 3]]) -> Surfaces {
    let mut sets = DisjointSets::new(points);
    let mut of = vec![NONE; points];
    for &[a, b, c] in faces {
        sets.join(a, b);
        sets.join(b, c);
        for v in [a, b, c] {
            of[v as usize] = v;
        }
    }
    let mut all: Vec<Surface> = Vec::new();
    for v in 0..points as u32 {
        if of[v as usize] == NONE {
            continue;
        }
        // The root is the smallest vertex, which comes first.
        let root = sets.root(v);
        if root == v {
            of[v as usize] = all.len() as u32;
            all.push(Surface { vertex: v, vertices: 0, faces: 0 });
        } else {
            of[v as usize] = of[root as usize];
        }
        all[of[v as usize] as usize].vertices += 1;
    }
    for face in faces {
        all[of[face[0] as usize] as usize].faces += 1;
    }
    Surfaces { of, all }
}
