//! Networks for tests.

use super::{Edge, Node, NodeId, Skeleton};
use anastomesh_mesh::geometry::Vec3;

/// A network with one radius for all vessels.
pub fn network(points: &[[f64; 3]], radius: f64, edges: &[(u32, u32)]) -> Skeleton {
    let node = |(i, &p): (usize, &[f64; 3])| Node { position: p.into(), radius, original: i as u32 };
    Skeleton {
        nodes: points.iter().enumerate().map(node).collect(),
        edges: edges.iter().map(|&(a, b)| Edge { nodes: [NodeId(a), NodeId(b)], radii: [radius; 2] }).collect(),
    }
}

/// A binary tree grown by a simple rule, with overlapping vessels.
pub fn tangle(depth: u32, seed: u32) -> Skeleton {
    let mut state = seed.wrapping_mul(2_654_435_761).max(1);
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        f64::from(state) / f64::from(u32::MAX) - 0.5
    };
    let mut points = vec![[0.0; 3], [0.0, 0.0, 12.0]];
    let mut edges = vec![(0, 1)];
    let mut tips = vec![(1_u32, Vec3::z())];
    for level in 0..depth {
        let mut next = Vec::new();
        for (tip, way) in tips {
            for _ in 0..2 {
                let turn = Vec3::new(random(), random(), random()) * 1.6;
                let way = (way + turn).normalize();
                let from = points[tip as usize];
                let length = 14.0 - f64::from(level);
                let to = [0, 1, 2].map(|k| from[k] + way[k] * length);
                edges.push((tip, points.len() as u32));
                next.push((points.len() as u32, way));
                points.push(to);
            }
        }
        tips = next;
    }
    network(&points, 1.0, &edges)
}
