//! Tree from the inlet to the terminals, by recursive bisection of the set of terminals.
//!
//! Nodes are in depth-first order from the inlet (node 0): each bifurcation is followed by its first branch, then its
//! second. A vessel with n terminals has 2n − 1 nodes, so the position of every branch is known beforehand and branches
//! grow in parallel.

use super::random::Random;
use super::split::lesser;
use anastomesh_mesh::geometry::{Point3, Vec3};
use nalgebra::Matrix3;

/// Minimum size of sets that grow in parallel.
const PARALLEL: usize = 2048;

/// Weight of distances along the vessel for the choice of the split direction. Vessels thus branch sideways rather than
/// into near and far parts.
const ALONG: f64 = 0.5;

/// Tree with one bifurcation or terminal per node. Every node except the inlet stands for its incoming vessel.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// Node positions.
    pub positions: Vec<Point3>,
    /// Parent of each node; 0 for the inlet.
    pub parents: Vec<u32>,
    /// Number of terminals in each node's subtree, itself included.
    pub sizes: Vec<u32>,
}

impl Tree {
    /// The two child nodes of a bifurcation.
    pub fn branches(&self, fork: usize) -> [usize; 2] {
        [fork + 1, fork + 2 * self.sizes[fork + 1] as usize]
    }

    /// True if a node has two branches, as all except the inlet and the terminals.
    pub fn is_fork(&self, node: usize) -> bool {
        node > 0 && self.sizes[node] > 1
    }
}

/// Part of a tree behind one vessel.
struct Subtree<'a> {
    points: &'a mut [Point3],
    positions: &'a mut [Point3],
    parents: &'a mut [u32],
    sizes: &'a mut [u32],
    /// Index of its first node, and of that node's parent.
    first: u32,
    parent: u32,
    /// Start of the vessel.
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

/// Recursion depth is that of the tree: some tens of bifurcations.
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
    let fork = fermat(&targets, [n, n - near, near].map(|count| libm::pow(count as f64, weight)));
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

/// Moves `near` of the points to the front: those on the side of `from` of a plane normal to their longest extent.
/// Compact parts matter most. Splitting by minimum volume of the next vessels gives four times as many overlapping
/// vessels.
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

/// Approximates the point of least weighted distance sum from three points (Weiszfeld 1937). With squared radii as
/// weights, the three vessels have minimum volume (Murray 1926).
fn fermat(targets: &[Point3; 3], weights: [f64; 3]) -> Point3 {
    let total: f64 = weights.iter().sum();
    let sum: Vec3 = targets.iter().zip(weights).map(|(q, w)| q.coords * w).sum();
    let mut x = Point3::from(sum / total);
    for _ in 0..12 {
        x = weiszfeld(&x, targets, weights);
    }
    x
}

/// One Weiszfeld step towards the weighted Fermat point.
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
