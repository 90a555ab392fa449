//! Space for cuts: every vessel must be long enough for its angles with its neighbours.

use super::frame::{Chain, Frame, LEAST};
use super::push::{Push, project};
use anastomesh_mesh::geometry::Vec3;
use anastomesh_skeleton::{ANGLE_MARGIN, CONNECTOR_ROOM, CUT_DISTANCE, EdgeId, NARROW, NodeId, separation};
use rayon::prelude::*;

/// Safety factor on the required length.
const MARGIN: f64 = 1.02;

/// Corrections of vessels that cannot be cut, are too short for equation 11, or leave their node at a narrow angle.
pub(super) fn pushes(frame: &Frame) -> Vec<Push> {
    let chains = frame.chains.par_iter().with_min_len(512).fold(Vec::new, |mut out, chain| {
        push_chain(frame, &chain, &mut out);
        if chain.edges.len() > 1 {
            chain.edges.iter().for_each(|&e| keep_length(frame, e, &mut out));
        }
        out
    });
    let nodes = (0..frame.origin.len() as u32).into_par_iter().with_min_len(512).fold(Vec::new, |mut out, node| {
        push_angles(frame, NodeId(node), &mut out);
        out
    });
    let mut all = chains.collect::<Vec<_>>().concat();
    all.extend(nodes.collect::<Vec<_>>().concat());
    all
}

/// Corrections of polyline pieces that became shorter.
pub(super) fn lengths(frame: &Frame) -> Vec<Push> {
    let mut out = Vec::new();
    for &edge in frame.chains.iter().filter(|chain| chain.edges.len() > 1).flat_map(|chain| chain.edges) {
        keep_length(frame, edge, &mut out);
    }
    out
}

/// Required length of a vessel: distance from its neighbours at junctions plus space for a cut or a cap. At least the
/// length of equation 11. `None` for a loop at one node.
pub(super) fn need(frame: &Frame, chain: &Chain) -> Option<f64> {
    needed(frame, chain, &mut Vec::new())
}

/// Required length of a vessel; appends its negative derivatives to `gradient`.
fn needed(frame: &Frame, chain: &Chain, gradient: &mut Vec<(NodeId, Vec3)>) -> Option<f64> {
    let ends = chain.ends();
    if ends[0] == ends[1] {
        return None;
    }
    let own = [chain.edges[0], chain.edges[chain.edges.len() - 1]];
    let radii = [0, 1].map(|i| frame.radius_at(own[i], ends[i]));
    if ends.iter().any(|n| frame.urgent[n.index()]) {
        return Some(LEAST * radii[0].max(radii[1]));
    }
    let by_11 = CUT_DISTANCE * (radii[0] + radii[1]);
    let inner = ends.map(|n| frame.adjacency.valence(n) > 2);
    // Twice the room of a connector, as its planes may have to move. At a terminal, half of that is a piece with its cap.
    let mut cut = 0.0;
    for i in [0, 1] {
        cut += CONNECTOR_ROOM * radii[i];
        if inner[i] {
            cut += distance(frame, ends[i], own[i], gradient);
        }
    }
    Some(cut.max(by_11))
}

fn push_chain(frame: &Frame, chain: &Chain, out: &mut Vec<Push>) {
    let length: f64 = chain.edges.iter().map(|&e| frame.skeleton.length(e)).sum();
    let ends = chain.ends();
    let own = [chain.edges[0], chain.edges[chain.edges.len() - 1]];
    let mut gradient: Vec<(NodeId, Vec3)> = Vec::with_capacity(8);
    for (node, edge) in ends.into_iter().zip(own) {
        let away = frame.at(node) - frame.at(frame.lever(node, edge));
        gradient.push((node, away.try_normalize(0.0).unwrap_or_else(Vec3::x)));
    }
    let Some(need) = needed(frame, chain, &mut gradient) else { return };
    let deficit = MARGIN * need - length;
    if deficit > 0.0 {
        let radii = frame.radius_at(own[0], ends[0]) + frame.radius_at(own[1], ends[1]);
        project(frame, &gradient, deficit, 0.5 * radii, out);
    }
}

/// Keeps polyline pieces at their old length, as far as equation 11 requires it.
fn keep_length(frame: &Frame, edge: EdgeId, out: &mut Vec<Push>) {
    let deficit = 1.001 * frame.kept[edge.index()] - frame.skeleton.length(edge);
    if deficit > 0.0 {
        let [a, b] = frame.skeleton.edge(edge).nodes;
        let way = (frame.at(b) - frame.at(a)).try_normalize(0.0).unwrap_or_else(Vec3::x);
        project(frame, &[(a, -way), (b, way)], deficit, 0.5 * frame.kept[edge.index()], out);
    }
}

/// Minimum distance of a cut from a node; appends its negative derivatives to `gradient`.
fn distance(frame: &Frame, node: NodeId, own: EdgeId, gradient: &mut Vec<(NodeId, Vec3)>) -> f64 {
    let lever = frame.lever(node, own);
    let u = frame.at(lever) - frame.at(node);
    let r = frame.radius_at(own, node);
    let mut worst: Option<(f64, NodeId, f64)> = None;
    for &other in frame.adjacency.edges(node).iter().filter(|&&e| e != own) {
        let (end, r2) = (frame.lever(node, other), frame.radius_at(other, node));
        let apart = separation(&u, &(frame.at(end) - frame.at(node)), [r, r2]);
        if worst.is_none_or(|(w, ..)| apart > w) {
            worst = Some((apart, end, r2));
        }
    }
    let Some((apart, end, r2)) = worst else { return CUT_DISTANCE * r };
    if ANGLE_MARGIN * apart <= CUT_DISTANCE * r || frame.is_as_close_as_may_be(node, [lever, end]) {
        return CUT_DISTANCE * r;
    }
    let v = frame.at(end) - frame.at(node);
    let (lu, lv) = (u.norm(), v.norm());
    let cos = u.dot(&v) / (lu * lv);
    // Angles below about two degrees give no useful derivative.
    let sin = (u.cross(&v).norm() / (lu * lv)).max(0.04);
    let slope = ANGLE_MARGIN * (r + r2 * cos) / (sin * sin);
    let [by_u, by_v] = opening(&u, &v);
    gradient.push((lever, by_u * slope));
    gradient.push((end, by_v * slope));
    gradient.push((node, (by_u + by_v) * -slope));
    // At most the length that both vessels together can provide.
    ANGLE_MARGIN * (r2 + r * cos) / sin
}

/// Derivatives of the angle between `u` and `v` with respect to both.
fn opening(u: &Vec3, v: &Vec3) -> [Vec3; 2] {
    let (lu, lv) = (u.norm(), v.norm());
    let (u, v) = (u / lu, v / lv);
    let cos = u.dot(&v);
    let out = |from: Vec3, x: Vec3| {
        let across = from * cos - x;
        across.try_normalize(1e-9)
    };
    if let (Some(a), Some(b)) = (out(u, v), out(v, u)) {
        return [a / lu, b / lv];
    }
    let mut axis = Vec3::zeros();
    axis[u.iamin()] = 1.0;
    let side = u.cross(&axis).normalize();
    [side / lu, -side / lv]
}

fn push_angles(frame: &Frame, node: NodeId, out: &mut Vec<Push>) {
    let edges = frame.adjacency.edges(node);
    if edges.len() < 3 && !frame.is_fold[node.index()] {
        return;
    }
    for (i, &e) in edges.iter().enumerate() {
        for &f in &edges[..i] {
            let levers = [e, f].map(|e| frame.lever(node, e));
            let [u, v] = levers.map(|n| frame.at(n) - frame.at(node));
            let wanted = 1.1 * NARROW;
            if frame.is_as_close_as_may_be(node, levers) {
                continue;
            }
            if u.dot(&v) <= libm::cos(wanted) * u.norm() * v.norm() {
                continue;
            }
            let angle = libm::atan2(u.cross(&v).norm(), u.dot(&v));
            let [by_u, by_v] = opening(&u, &v);
            let gradient = [(levers[0], by_u), (levers[1], by_v), (node, -by_u - by_v)];
            project(frame, &gradient, wanted - angle, 0.5 * frame.skeleton.node(node).radius, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::frame::Frame;
    use super::*;
    use anastomesh_mesh::geometry::Point3;
    use anastomesh_skeleton::{Edge, Node, Skeleton};
    use proptest::prelude::*;

    /// A vessel between two junctions: 0-1 with 2, 3 at 0 and 4, 5 at 1.
    fn tree(points: &[[f64; 3]; 6], radii: &[f64; 5]) -> Skeleton {
        let node = |(i, &p): (usize, &[f64; 3])| Node { position: p.into(), radius: 1.0, original: i as u32 };
        let ends = [(0, 1), (0, 2), (0, 3), (1, 4), (1, 5)];
        let edge = |(&(a, b), &r): (&(u32, u32), &f64)| Edge { nodes: [NodeId(a), NodeId(b)], radii: [r; 2] };
        Skeleton {
            nodes: points.iter().enumerate().map(node).collect(),
            edges: ends.iter().zip(radii).map(edge).collect(),
        }
    }

    /// Length minus required length of the first chain, with its gradient.
    fn slack(skeleton: &Skeleton) -> (f64, Vec<(NodeId, Vec3)>) {
        let frame = Frame::new(skeleton.clone(), 1e9, 1e9, 1.0);
        let chain = frame.chains.iter().find(|c| c.edges == [EdgeId(0)]).expect("edge 0 is a chain");
        let mut gradient = Vec::new();
        for (node, other) in [(0, 1), (1, 0)].map(|(a, b)| (NodeId(a), NodeId(b))) {
            if chain.ends()[0] == node || chain.ends()[1] == node {
                gradient.push((node, (frame.at(node) - frame.at(other)).normalize()));
            }
        }
        let need = needed(&frame, &chain, &mut gradient).expect("two ends");
        (frame.skeleton.length(EdgeId(0)) - need, gradient)
    }

    proptest! {
        #[test]
        fn gradient_is_that_of_the_room(
            shift in prop::array::uniform6(prop::array::uniform3(-1.0..1.0_f64)),
            radii in prop::array::uniform5(0.5..1.5_f64),
        ) {
            let base = [[0.0; 3], [12.0, 0.0, 0.0], [9.0, 7.0, 2.0], [-9.0, 3.0, 1.0], [20.0, -5.0, 3.0], [4.0, -5.0, 4.0]];
            let mut points = base;
            for (p, d) in points.iter_mut().zip(&shift) {
                for k in 0..3 {
                    p[k] += d[k];
                }
            }
            let skeleton = tree(&points, &radii);
            let (value, gradient) = slack(&skeleton);
            let mut total = [Vec3::zeros(); 6];
            for (node, g) in gradient {
                total[node.index()] += g;
            }
            let h = 1e-6;
            for i in 0..6 {
                for k in 0..3 {
                    let moved = |d: f64| {
                        let mut s = skeleton.clone();
                        s.nodes[i].position[k] += d;
                        slack(&s).0
                    };
                    let (up, down) = (moved(h), moved(-h));
                    // Not where the decisive neighbour or the active bound changes.
                    if (up - 2.0 * value + down).abs() > 1e-9 {
                        continue;
                    }
                    let slope = (up - down) / (2.0 * h);
                    prop_assert!((slope - total[i][k]).abs() < 1e-3 * (1.0 + slope.abs()), "{i} {k}: {slope} {}", total[i][k]);
                }
            }
        }
    }

    #[test]
    fn a_vessel_that_is_too_short_is_lengthened_by_both_ends() {
        let points =
            [[0.0; 3], [4.0, 0.0, 0.0], [-5.0, 9.0, 0.0], [-5.0, -9.0, 0.0], [9.0, 9.0, 0.0], [9.0, -9.0, 0.0]];
        let frame = Frame::new(tree(&points, &[1.0; 5]), 0.0, 1e9, 1.0);
        let moves = pushes(&frame);
        let of = |n: u32| moves.iter().filter(|m| m.0 == NodeId(n)).map(|m| m.1.x).sum::<f64>();
        assert!(of(0) < 0.0 && of(1) > 0.0);
        assert!(moves.iter().all(|m| m.0.0 < 2), "terminals are held");
        let end: Point3 = frame.at(NodeId(1));
        assert!((end.x - 4.0).abs() < 1e-12);
    }
}
