//! The tree from the inlet to the terminals: each set of terminals is split in two, down to single ones.
//!
//! Nodes are in the order of a walk from the inlet (node 0): each fork is followed by all of its first branch, then by all
//! of its second. A vessel with n terminals has 2n − 1 nodes, so every branch knows its place beforehand and branches
//! grow in parallel.

use super::random::Random;
use super::split::lesser;
use anastomesh_mesh::geometry::{Point3, Vec3};
use nalgebra::Matrix3;

/// Sets larger than this are grown in parallel.
const PARALLEL: usize = 2048;

/// Along the vessel, distances count so much less when the direction is chosen in which terminals are split: vessels fork
/// to the sides rather than into near and far.
const ALONG: f64 = 0.5;

/// A tree with one fork or terminal per node; every node but the inlet has the vessel that leads to it.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// Where each node is.
    pub positions: Vec<Point3>,
    /// The node before; the inlet's own is 0.
    pub parents: Vec<u32>,
    /// Terminals behind each node, itself included.
    pub sizes: Vec<u32>,
}

impl Tree {
    /// The two nodes after a fork.
    pub fn branches(&self, fork: usize) -> [usize; 2] {
        [fork + 1, fork + 2 * self.sizes[fork + 1] as usize]
    }

    /// Whether a node has two branches: all but the inlet and the terminals.
    pub fn is_fork(&self, node: usize) -> bool {
        node > 0 && self.sizes[node] > 1
    }
}

/// The part of a tree behind one vessel.
struct Subtree<'a> {
    points: &'a mut [Point3],
    positions: &'a mut [Point3],
    parents: &'a mut [u32],
    sizes: &'a mut [u32],
    /// Index of its first node, and of the node before.
    first: u32,
    parent: u32,
    /// Where the vessel comes from.
    from: Point3,
}

/// Grows a tree from `inlet` to the points, which are reordered. `exponent` is Murray's.
pub fn grow(inlet: Point3, points: &mut [Point3], exponent: f64, random: Random) -> Tree {
    let nodes = 2 * points.len();
    let mut tree =
        Tree { positions: vec![inlet; nodes], parents: vec![0; nodes], sizes: vec![points.len() as u32; nodes] };
    branch(
        Subtree {
            points,
            positions: &mut tree.positions[1..],
            parents: &mut tree.parents[1..],
            sizes: &mut tree.sizes[1..],
            first: 1,
            parent: 0,
            from: inlet,
        },
        2.0 / exponent,
        random,
    );
    tree
}

/// Recursion goes as deep as the tree: some tens of forks.
fn branch(part: Subtree, weight: f64, random: Random) {
    let Subtree { points, positions, parents, sizes, first, parent, from } = part;
    let n = points.len();
    parents[0] = parent;
    sizes[0] = n as u32;
    if n == 1 {
        positions[0] = points[0];
        return;
    }
    let near = lesser(n as u32, random, u64::from(first)) as usize;
    part_points(points, near, &from);
    let (near_points, far_points) = points.split_at_mut(near);
    let targets = [from, centroid(far_points), centroid(near_points)];
    let fork = fermat(&targets, [n, n - near, near].map(|count| (count as f64).powf(weight)));
    positions[0] = fork;
    let cut = 2 * (n - near) - 1;
    let (positions, parents, sizes) = (&mut positions[1..], &mut parents[1..], &mut sizes[1..]);
    let (far_positions, near_positions) = positions.split_at_mut(cut);
    let (far_parents, near_parents) = parents.split_at_mut(cut);
    let (far_sizes, near_sizes) = sizes.split_at_mut(cut);
    let child = |own, points, positions, parents, sizes| Subtree {
        points,
        positions,
        parents,
        sizes,
        first: own,
        parent: first,
        from: fork,
    };
    let far = child(first + 1, far_points, far_positions, far_parents, far_sizes);
    let near = child(first + 1 + cut as u32, near_points, near_positions, near_parents, near_sizes);
    if n > PARALLEL {
        rayon::join(|| branch(far, weight, random), || branch(near, weight, random));
    } else {
        branch(far, weight, random);
        branch(near, weight, random);
    }
}

fn centroid(points: &[Point3]) -> Point3 {
    let sum: Vec3 = points.iter().map(|p| p.coords).sum();
    Point3::from(sum / points.len() as f64)
}

/// Brings `near` of the points to the front: those on one side of a plane across their longest extent, the side of
/// `from`. Compact parts matter most: splitting where the next vessels have the least volume makes networks in which four
/// times as many vessels overlap.
fn part_points(points: &mut [Point3], near: usize, from: &Point3) {
    let centre = centroid(points);
    let along = (centre - from).try_normalize(0.0).unwrap_or_else(Vec3::zeros);
    let shrink = Matrix3::identity() - along * along.transpose() * (1.0 - ALONG);
    let mut spread = Matrix3::zeros();
    for p in points.iter() {
        let x = shrink * (p - centre);
        spread += x * x.transpose();
    }
    let eigen = spread.symmetric_eigen();
    let mut axis = shrink * eigen.eigenvectors.column(eigen.eigenvalues.imax());
    if axis.dot(&along) < 0.0 {
        axis = -axis;
    }
    points.select_nth_unstable_by(near, |p, q| axis.dot(&p.coords).total_cmp(&axis.dot(&q.coords)));
}

/// About the point with the least sum of weighted distances from three (Weiszfeld 1937): vessels from there to the three
/// have the least volume when the weights are the squares of their radii (Murray 1926).
fn fermat(targets: &[Point3; 3], weights: [f64; 3]) -> Point3 {
    let total: f64 = weights.iter().sum();
    let sum: Vec3 = targets.iter().zip(weights).map(|(q, w)| q.coords * w).sum();
    let mut x = Point3::from(sum / total);
    for _ in 0..12 {
        x = weiszfeld(&x, targets, weights);
    }
    x
}

/// One step towards it.
pub fn weiszfeld(x: &Point3, targets: &[Point3; 3], weights: [f64; 3]) -> Point3 {
    let mut sum = Vec3::zeros();
    let mut total = 0.0;
    for (q, w) in targets.iter().zip(weights) {
        let pull = w / (q - x).norm();
        if !pull.is_finite() {
            return *x;
        }
        sum += q.coords * pull;
        total += pull;
    }
    Point3::from(sum / total)
}
