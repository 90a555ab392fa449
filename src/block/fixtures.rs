//! Synthetic blocks for tests, and invariants of block meshes.

use super::connector_surface::{ConnectorEnd, ConnectorSurface};
use crate::partition::{Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind};
use anastomesh_mesh::geometry::{Point3, Section, Tube, Vec3};
use anastomesh_mesh::quality::tet_ratio;
use anastomesh_mesh::quality::triangle_min_angle;
use anastomesh_mesh::{TET_FACES, TetMesh, TriMesh};
use anastomesh_skeleton::{BranchId, NodeId};
use rustc_hash::FxHashMap;

/// Jitter in [−0.5, 0.5] that depends only on the ids.
pub(crate) fn jitter(seed: u64, id: u64) -> f64 {
    let mut x = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ id.wrapping_mul(0xD1B5_4A32_D192_ED03);
    for _ in 0..3 {
        x ^= x >> 31;
        x = x.wrapping_mul(0x94D0_49BB_1331_11EB);
    }
    (x >> 11) as f64 / (1u64 << 53) as f64 - 0.5
}

/// Face neighbours as handles, by a map: slow and simple.
pub(crate) fn neighbours(mesh: &TetMesh) -> Vec<[u32; 4]> {
    let mut open: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    let mut out = vec![[u32::MAX; 4]; mesh.tets.len()];
    for (t, c) in mesh.tets.iter().enumerate() {
        for (i, f) in TET_FACES.iter().enumerate() {
            let mut key = f.map(|k| c[k]);
            key.sort_unstable();
            let handle = 4 * t as u32 + i as u32;
            if let Some(other) = open.remove(&key) {
                out[t][i] = other;
                out[(other / 4) as usize][(other % 4) as usize] = handle;
            } else {
                open.insert(key, handle);
            }
        }
    }
    out
}

/// Direction that depends only on a seed.
pub(crate) fn direction(seed: u64) -> Vec3 {
    Vec3::new(jitter(seed, 11), jitter(seed, 12), jitter(seed, 13) + 1e-6).normalize()
}

pub(crate) fn section(origin: Point3, axis: Vec3, radius: f64) -> Section {
    Section::new(origin, axis, radius)
}

/// Asserts positive tetrahedra, face connectivity, and a closed manifold boundary with single fans.
pub(crate) fn assert_mesh(mesh: &TetMesh, euler: i64) {
    for t in &mesh.tets {
        assert!(tet_ratio(&t.map(|v| mesh.points[v as usize])) > 0.0, "inverted");
    }
    let nb = neighbours(mesh);
    let mut seen = vec![false; mesh.tets.len()];
    let mut stack = vec![0u32];
    while let Some(t) = stack.pop() {
        if !std::mem::replace(&mut seen[t as usize], true) {
            stack.extend(nb[t as usize].iter().filter(|&&n| n != u32::MAX).map(|n| n / 4));
        }
    }
    assert!(seen.iter().all(|&s| s), "not connected");
    assert_eq!(closed_euler(&boundary(mesh)), Some(euler));
}

pub(crate) fn boundary(mesh: &TetMesh) -> Vec<[u32; 3]> {
    let nb = neighbours(mesh);
    (0..mesh.tets.len())
        .flat_map(|t| (0..4).map(move |i| (t, i)))
        .filter(|&(t, i)| nb[t][i] == u32::MAX)
        .map(|(t, i)| TET_FACES[i].map(|k| mesh.tets[t][k]))
        .collect()
}

/// Euler number of a closed oriented 2-manifold; `None` if the triangles are not one.
pub(crate) fn closed_euler(triangles: &[[u32; 3]]) -> Option<i64> {
    let mut links: FxHashMap<(u32, u32), u32> = FxHashMap::default();
    let mut valence: FxHashMap<u32, u32> = FxHashMap::default();
    for t in triangles {
        for k in 0..3 {
            if links.insert((t[k], t[(k + 1) % 3]), t[(k + 2) % 3]).is_some() {
                return None;
            }
            *valence.entry(t[k]).or_default() += 1;
        }
    }
    for t in triangles {
        for k in 0..3 {
            let (v, start) = (t[k], t[(k + 1) % 3]);
            let (mut at, mut count) = (*links.get(&(v, start))?, 1);
            while at != start {
                at = *links.get(&(v, at))?;
                count += 1;
            }
            if count != valence[&v] {
                return None;
            }
        }
    }
    Some(valence.len() as i64 - links.len() as i64 / 2 + triangles.len() as i64)
}

/// Star of vessels from a node, one per direction, ending in a cut or a terminal after 4 units.
pub(crate) fn star(center: Point3, arms: &[(Vec3, f64, EndKind)]) -> Cluster {
    let mut cluster = Cluster { nodes: vec![NodeId(0)], ..Cluster::default() };
    for &(axis, radius, kind) in arms {
        let origin = center + axis * 4.0;
        cluster.tubes.push(Tube { a: center, b: origin, ra: radius, rb: radius });
        cluster.tubes.push(Tube { a: origin, b: origin + axis * (1.7 * radius), ra: radius, rb: radius });
        let overrun = cluster.tubes.len() as u32 - 1;
        cluster.ends.push(ClusterEnd { section: Section::new(origin, axis, radius), kind, overrun });
    }
    cluster
}

pub(crate) fn cut(cut: u32, side: u8) -> EndKind {
    EndKind::Cut { cut: CutId(cut), side }
}

/// Bifurcation rotated by `seed`; end 0 is side 0 of cut 0.
pub(crate) fn bifurcation(seed: u64) -> Cluster {
    let turn = nalgebra::Rotation3::new(direction(seed) * 2.0);
    let arm = |x: f64, z: f64| turn * Vec3::new(x, 0.1, z).normalize();
    star(
        Point3::origin(),
        &[
            (arm(0.0, 1.0), 1.0, cut(0, 0)),
            (arm(0.8, -0.7), 0.8, EndKind::Terminal(NodeId(1))),
            (arm(-0.8, -0.6), 0.7, cut(1, 0)),
        ],
    )
}

pub(crate) fn worst_ratio(mesh: &TetMesh) -> f64 {
    mesh.tets.iter().map(|t| tet_ratio(&t.map(|v| mesh.points[v as usize]))).fold(1.0, f64::min)
}

/// Second cluster opposite to a cluster's end 0, three radii away, and the cut between them.
pub(crate) fn facing(cluster: &Cluster) -> (Cluster, Cut) {
    let first = cluster.ends[0].section;
    let center = first.origin + first.axis * 7.0;
    let facing = star(center, &[(-first.axis, 1.0, cut(0, 1)), (first.axis, 1.0, EndKind::Terminal(NodeId(3)))]);
    let path = vec![first, Section { origin: facing.ends[0].section.origin, ..first }];
    (facing, Cut { branch: BranchId(0), sides: [(ClusterId(0), 0), (ClusterId(1), 0)], path, size: None })
}

/// Asserts that end triangles and vertices are adopted bit for bit.
pub(crate) fn assert_taken_over(out: &ConnectorSurface, ends: [ConnectorEnd; 2]) {
    for (p, v) in out.surface.points.iter().zip(&out.shared) {
        assert_eq!(*p, ends[v.side as usize].points[v.vertex as usize]);
    }
    let mut k = 0;
    for (side, end) in ends.iter().enumerate() {
        for t in &end.surface.triangles {
            let copy = out.surface.triangles[k].map(|v| out.shared[v as usize]);
            assert!(copy.iter().all(|v| usize::from(v.side) == side));
            assert_eq!(copy.map(|v| v.vertex), [t[0], t[2], t[1]]);
            k += 1;
        }
    }
    assert_eq!(k, out.end_triangles as usize);
    assert_eq!(closed_euler(&out.surface.triangles), Some(2));
    assert!(volume(&out.surface) > 0.0);
}

pub(crate) fn volume(s: &TriMesh) -> f64 {
    let p = |v: u32| s.points[v as usize].coords;
    s.triangles.iter().map(|t| p(t[0]).dot(&p(t[1]).cross(&p(t[2]))) / 6.0).sum()
}

/// Smallest angle of the wall's triangles, in degrees.
pub(crate) fn wall_angle(c: &ConnectorSurface) -> f64 {
    let p = |v: u32| &c.surface.points[v as usize];
    let wall = &c.surface.triangles[c.end_triangles as usize..];
    wall.iter().map(|t| triangle_min_angle(p(t[0]), p(t[1]), p(t[2])).to_degrees()).fold(180.0, f64::min)
}

pub(crate) fn straight(seed: u64, length: f64, r: [f64; 2]) -> Vec<Section> {
    let axis = direction(seed);
    let o = Point3::new(jitter(seed, 1), jitter(seed, 2), jitter(seed, 3));
    vec![section(o, axis, r[0]), section(o + axis * length, axis, r[1])]
}

/// Section seen from the other side.
pub(crate) fn flipped(s: &Section) -> Section {
    Section { axis: -s.axis, ..*s }
}
