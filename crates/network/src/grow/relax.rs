//! Relaxation of a grown tree. Bifurcations move to the minimum volume of their three vessels, subject to minimum
//! vessel lengths. Nodes move out of thick vessels of other branches.

use super::tree::{Tree, weiszfeld};
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, Vec3, point_tube};
use rayon::prelude::*;

/// Passes of relaxation, each a number of sweeps and a clearing of thick vessels.
const RELAXATION_PASSES: usize = 6;

/// Sweeps over all bifurcations per round, and final sweeps over squeezed ones.
const SWEEPS: usize = 10;

/// Cosine and sine of the angle below which vessels at a bifurcation are spread.
const NARROW: (f64, f64) = (0.6, 0.8);

/// Minimum radius of vessels that are kept clear of nodes, relative to the thinnest.
const THICK: f64 = 1.2;

/// Minimum radius of vessels that stay fixed after the last clearing, relative to the thinnest.
const THIN: f64 = 4.0;

/// Clear distance of a node from the wall of a thick vessel, in radii of the node and of the vessel.
const CLEAR: [f64; 2] = [4.0, 0.3];

/// Minimum distance of terminals, in their radii.
const APART: f64 = 8.0;

/// Relaxes a tree whose vessels have the given radii, by node. Moves bifurcations, and terminals inside thick vessels.
pub fn relax(tree: &mut Tree, radii: &[f64]) {
    let parity = levels(tree);
    for _ in 0..RELAXATION_PASSES {
        for _ in 0..SWEEPS {
            sweep(tree, &parity, |tree, fork| better(tree, radii, fork));
        }
        clear(tree, radii);
        part_terminals(tree, radii);
    }
    // Nodes moved last may be close to their neighbours; cleared thick vessels stay fixed.
    let thin = THIN * radii.iter().copied().fold(f64::INFINITY, f64::min);
    for _ in 0..SWEEPS {
        sweep(tree, &parity, |tree, fork| {
            if radii[fork] < thin && squeezed(tree, radii, fork) {
                better(tree, radii, fork)
            } else {
                tree.positions[fork]
            }
        });
    }
}

/// True for nodes at an odd number of vessels from the inlet.
fn levels(tree: &Tree) -> Vec<bool> {
    let mut odd = vec![false; tree.parents.len()];
    for i in 1..odd.len() {
        odd[i] = !odd[tree.parents[i] as usize];
    }
    odd
}

/// Moves bifurcations of one parity, then of the other, so that no neighbours move at the same time.
fn sweep(tree: &mut Tree, parity: &[bool], place: impl Fn(&Tree, usize) -> Point3 + Sync) {
    for odd in [false, true] {
        let moved = (0..tree.positions.len())
            .into_par_iter()
            .map(|i| if parity[i] == odd && tree.is_fork(i) { place(tree, i) } else { tree.positions[i] })
            .collect();
        tree.positions = moved;
    }
}

/// True if a vessel at a bifurcation has less than half its minimum length.
fn squeezed(tree: &Tree, radii: &[f64], fork: usize) -> bool {
    let [a, b] = tree.branches(fork);
    [fork, a, b].into_iter().any(|node| {
        let length = (tree.positions[node] - tree.positions[tree.parents[node] as usize]).norm();
        length < 0.5 * least_length(tree, radii, node)
    })
}

/// Minimum length of the vessel to `node`: a cut at either end and separation from its parent vessel.
fn least_length(tree: &Tree, radii: &[f64], node: usize) -> f64 {
    let parent = tree.parents[node] as usize;
    let from = if parent == 0 { 0.0 } else { 2.0 * radii[parent] };
    let to = if tree.is_fork(node) { 2.0 * radii[node] } else { 0.0 };
    from + to + 4.0 * radii[node]
}

/// Improved position of a bifurcation: a step towards minimum volume, then corrections of lengths and angles.
fn better(tree: &Tree, radii: &[f64], fork: usize) -> Point3 {
    let [a, b] = tree.branches(fork);
    let ends = [tree.parents[fork] as usize, a, b];
    let vessels = [fork, a, b];
    let targets = ends.map(|end| tree.positions[end]);
    let mut x = weiszfeld(&tree.positions[fork], &targets, vessels.map(|v| radii[v] * radii[v]));
    for _ in 0..2 {
        for ((q, end), vessel) in targets.iter().zip(ends).zip(vessels) {
            let least = least_length(tree, radii, vessel);
            let away = x - q;
            let length = away.norm();
            if length < least {
                // A movable other end contributes its half.
                let half = if tree.is_fork(end) { 0.6 } else { 1.0 };
                let direction = away.try_normalize(0.0).unwrap_or_else(|| any_direction(fork));
                x += direction * (half * (least - length));
            }
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            x += opening(&x, &targets[i], &targets[j]);
        }
    }
    x
}

/// Shift of a bifurcation that rotates the nearer of two narrow vessels, to `p` and `q`, around its end.
fn opening(x: &Point3, p: &Point3, q: &Point3) -> Vec3 {
    let (u, v) = (p - x, q - x);
    let (near, far) = if u.norm_squared() <= v.norm_squared() { (u, v) } else { (v, u) };
    let (Some(n), Some(f)) = (near.try_normalize(0.0), far.try_normalize(0.0)) else { return Vec3::zeros() };
    let cosine = n.dot(&f);
    if cosine <= NARROW.0 {
        return Vec3::zeros();
    }
    let Some(aside) = (n - f * cosine).try_normalize(1e-9) else { return Vec3::zeros() };
    let wide = f * NARROW.0 + aside * NARROW.1;
    (near - wide * near.norm()) * 0.5
}

/// Direction that depends only on the node, for coinciding nodes.
fn any_direction(node: usize) -> Vec3 {
    let turn = node as f64 * 2.399_963_229_728_653;
    Vec3::new(libm::cos(turn), libm::sin(turn), 0.5).normalize()
}

/// Moves nodes out of thick vessels.
fn clear(tree: &mut Tree, radii: &[f64]) {
    let thin = radii.iter().skip(1).copied().fold(f64::INFINITY, f64::min);
    let thick: Vec<u32> = (1..radii.len() as u32).filter(|&i| radii[i as usize] > THICK * thin).collect();
    let tube = |i: u32| {
        let i = i as usize;
        Tube { a: tree.positions[tree.parents[i] as usize], b: tree.positions[i], ra: radii[i], rb: radii[i] }
    };
    let boxes: Vec<Aabb> = thick
        .iter()
        .map(|&i| {
            let t = tube(i);
            Aabb::of_points([&t.a, &t.b]).grown(radii[i as usize] * (1.0 + CLEAR[1]))
        })
        .collect();
    let search = Bvh::new(&boxes);
    let moved: Vec<Point3> = (0..tree.positions.len())
        .into_par_iter()
        .map(|node| {
            let mut p = tree.positions[node];
            if node == 0 {
                return p;
            }
            let reach = CLEAR[0] * radii[node];
            let mut away = Vec3::zeros();
            search.query(&Aabb::of_points([&p]).grown(reach), |found| {
                let vessel = thick[found as usize];
                let r = radii[vessel as usize];
                if radii[node] < r && !joined(tree, node, vessel as usize) {
                    away += push(&p, &tube(vessel), reach + CLEAR[1] * r);
                }
            });
            p += away;
            p
        })
        .collect();
    tree.positions = moved;
}

/// Separates terminals that became close by leaving thick vessels.
fn part_terminals(tree: &mut Tree, radii: &[f64]) {
    let ends: Vec<usize> = (1..radii.len()).filter(|&i| !tree.is_fork(i)).collect();
    let boxes: Vec<Aabb> =
        ends.iter().map(|&i| Aabb::of_points([&tree.positions[i]]).grown(0.5 * APART * radii[i])).collect();
    let mut close = Vec::new();
    Bvh::new(&boxes).self_pairs(|i, j| close.push([ends[i as usize], ends[j as usize]]));
    close.sort_unstable();
    for [i, j] in close {
        let least = 0.5 * APART * (radii[i] + radii[j]);
        let off = tree.positions[j] - tree.positions[i];
        let distance = off.norm();
        if distance < least {
            let direction = off.try_normalize(0.0).unwrap_or_else(|| any_direction(i));
            let half = direction * (0.5 * (least - distance));
            tree.positions[i] -= half;
            tree.positions[j] += half;
        }
    }
}

/// True if a vessel ends at a node or at one of its neighbours.
fn joined(tree: &Tree, node: usize, vessel: usize) -> bool {
    let parent = |n: usize| tree.parents[n] as usize;
    let ends = [vessel, parent(vessel)];
    let near = |n: usize| n == node || parent(n) == node || n == parent(node);
    ends.into_iter().any(near)
}

/// Shift of a point to a distance of `gap` from the wall of a tube.
fn push(p: &Point3, tube: &Tube, gap: f64) -> Vec3 {
    let (t, _) = point_tube(p, tube);
    let axis = tube.point(t);
    let want = tube.radius(t) + gap;
    let off = p - axis;
    let distance = off.norm();
    match off.try_normalize(1e-9 * want) {
        Some(direction) if distance < want => direction * (want - distance),
        _ => Vec3::zeros(),
    }
}
