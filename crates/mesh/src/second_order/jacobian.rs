//! Sign of the Jacobian determinant of a quadratic tetrahedron, proved with Bernstein coefficients.
//!
//! A. Johnen, J.-F. Remacle, C. Geuzaine: Geometrical validity of curvilinear finite elements. Journal of Computational
//! Physics 233, 2013. The determinant is a cubic polynomial of the barycentric coordinates. Its values lie between the least and the
//! greatest of its 20 Bernstein coefficients. Coefficients at corners are values. The coefficients of the two halves of the
//! tetrahedron enclose the values more tightly, so that repeated bisection decides the sign.

use super::edges::TET_EDGES;
use crate::geometry::{Point3, Vec3};

/// Result of comparing the Jacobian determinant of an element with a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sign {
    /// The determinant exceeds the bound everywhere in the element.
    Above {
        /// Lower bound of the determinant, in cubed units of length.
        least: f64,
    },
    /// The determinant is less than the bound at some point.
    Below,
    /// Rounding errors or the limit on bisections prevent a decision.
    Undecided,
}

impl Sign {
    /// True if the determinant is proved to exceed the bound everywhere.
    pub fn is_above(self) -> bool {
        matches!(self, Self::Above { .. })
    }
}

/// Maximum number of bisections of an element on the way to a part. Twelve divide each direction by 16.
const MAX_DEPTH: u32 = 12;

/// Bernstein coefficients of a cubic polynomial, in the order of [`TRIPLES`].
pub(super) type Cubic = [f64; 20];

/// Corners of each coefficient, ascending: the coefficient of `[0, 0, 1]` belongs to λ₀² λ₁.
const TRIPLES: [[usize; 3]; 20] = triples();

/// Position in [`TRIPLES`] of three corners in any order.
const INDEX: [[[usize; 4]; 4]; 4] = index();

const fn triples() -> [[usize; 3]; 20] {
    let mut out = [[0; 3]; 20];
    let (mut n, mut i) = (0, 0);
    while i < 4 {
        let mut j = i;
        while j < 4 {
            let mut k = j;
            while k < 4 {
                out[n] = [i, j, k];
                n += 1;
                k += 1;
            }
            j += 1;
        }
        i += 1;
    }
    out
}

const fn index() -> [[[usize; 4]; 4]; 4] {
    let mut out = [[[0; 4]; 4]; 4];
    let mut n = 0;
    while n < 20 {
        let [i, j, k] = TRIPLES[n];
        out[i][j][k] = n;
        out[i][k][j] = n;
        out[j][i][k] = n;
        out[j][k][i] = n;
        out[k][i][j] = n;
        out[k][j][i] = n;
        n += 1;
    }
    out
}

/// Bernstein coefficients of the Jacobian determinant with respect to λ₁, λ₂, λ₃, and a bound of their rounding errors.
///
/// The nodes are four corners and six midpoints ([`TET_EDGES`]). N(i, j) is the node between the corners i and j, and
/// N(i, i) the corner i. With E(k, j) = `4 (N(k, j) − N(0, j)) − (N(k, k) − N(0, 0))`, the derivative by λₖ is Σ λⱼ E(k, j). The coefficient
/// of three corners is the mean of det(E(1, i), E(2, j), E(3, k)) over their orders (i, j, k). It is 6 volumes in a straight element.
pub(super) fn coefficients(nodes: &[Point3; 10]) -> (Cubic, f64) {
    let mut node = [[nodes[0]; 4]; 4];
    for (i, row) in node.iter_mut().enumerate() {
        row[i] = nodes[i];
    }
    for (&[i, j], &middle) in TET_EDGES.iter().zip(&nodes[4..]) {
        node[i][j] = middle;
        node[j][i] = middle;
    }
    let mut size = 0.0_f64;
    let mut derivative = |k: usize, j: usize| {
        let (curved, chord) = ((node[k][j] - node[0][j]) * 4.0, node[k][k] - node[0][0]);
        size = size.max((curved.abs() + chord.abs()).max());
        curved - chord
    };
    let [a, b, c]: [[Vec3; 4]; 3] = [1, 2, 3].map(|k| [0, 1, 2, 3].map(|j| derivative(k, j)));
    let (mut sums, mut counts) = ([0.0; 20], [0.0; 20]);
    for j in 0..4 {
        for k in 0..4 {
            let cross = b[j].cross(&c[k]);
            for i in 0..4 {
                sums[INDEX[i][j][k]] += a[i].dot(&cross);
                counts[INDEX[i][j][k]] += 1.0;
            }
        }
    }
    for (sum, count) in sums.iter_mut().zip(counts) {
        *sum /= count;
    }
    (sums, ERROR * size * size * size + f64::MIN_POSITIVE)
}

/// Rounding error of a coefficient, as a multiple of the cubed greatest |4 (N(k, j) − N(0, j))| + |N(k, k) − N(0, 0)| of any coordinate.
///
/// With u = 2⁻⁵³ and that length s, a coordinate of E has an error of at most 2us. Each of the 6 products of a determinant then has an
/// error of 6us³, and 5us³ from its own operations. The mean of at most 6 determinants adds 36us³, which is 102us³ in all. A bisection
/// takes means of at most 8 coefficients below 6s³ and adds 42us³, which is 504us³ for 12 bisections. 1024u leaves space for terms of
/// higher order.
const ERROR: f64 = 512.0 * f64::EPSILON;

/// Coefficients on the half of an element in which the middle of the corners `i` and `j` replaces `j`.
fn half(cubic: &Cubic, i: usize, j: usize) -> Cubic {
    let mut out = [0.0; 20];
    for (value, triple) in out.iter_mut().zip(TRIPLES) {
        // The symmetric trilinear form of the polynomial, with (i + j) / 2 in each place of j.
        let places = triple.map(|corner| if corner == j { [i, j] } else { [corner; 2] });
        let mut sum = 0.0;
        for a in places[0] {
            for b in places[1] {
                for c in places[2] {
                    sum += cubic[INDEX[a][b][c]];
                }
            }
        }
        *value = sum / 8.0;
    }
    out
}

/// Part of an element: coefficients, barycentric coordinates of the corners, and number of bisections.
struct Part {
    cubic: Cubic,
    corners: [[f64; 4]; 4],
    depth: u32,
}

impl Part {
    /// Both halves at the longest edge.
    fn halves(&self) -> [Self; 2] {
        let length =
            |[i, j]: [usize; 2]| -> f64 { (0..4).map(|x| (self.corners[i][x] - self.corners[j][x]).powi(2)).sum() };
        let longest = |best: [usize; 2], edge: [usize; 2]| if length(edge) > length(best) { edge } else { best };
        let [i, j] = TET_EDGES.into_iter().fold([0, 1], longest);
        [[i, j], [j, i]].map(|[kept, replaced]| {
            let mut corners = self.corners;
            for x in 0..4 {
                corners[replaced][x] = f64::midpoint(self.corners[i][x], self.corners[j][x]);
            }
            Self { cubic: half(&self.cubic, kept, replaced), corners, depth: self.depth + 1 }
        })
    }
}

/// Compares the Jacobian determinant of an element with a bound. The nodes are four corners and six midpoints, in the order of
/// [`TET_EDGES`]. The result is rigorous: rounding errors are bounded. Coordinates that are not finite give `Undecided`.
///
/// ```
/// use anastomesh_mesh::Point3;
/// use anastomesh_mesh::second_order::{TET_EDGES, jacobian_above};
///
/// let [o, x, y, z] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Point3::from);
/// let corners = [o, x, y, z];
/// let middles = TET_EDGES.map(|[i, j]| nalgebra::center(&corners[i], &corners[j]));
/// let mut nodes = [o; 10];
/// nodes[..4].copy_from_slice(&corners);
/// nodes[4..].copy_from_slice(&middles);
/// assert!(jacobian_above(&nodes, 0.9).is_above());
/// // The first edge bulges through the opposite one.
/// nodes[4] = Point3::new(0.5, 0.6, 0.6);
/// assert!(!jacobian_above(&nodes, 0.0).is_above());
/// # use anastomesh_mesh::nalgebra;
/// ```
pub fn jacobian_above(nodes: &[Point3; 10], bound: f64) -> Sign {
    let (cubic, error) = coefficients(nodes);
    let mut corners = [[0.0; 4]; 4];
    for (i, corner) in corners.iter_mut().enumerate() {
        corner[i] = 1.0;
    }
    let (mut least, mut is_decided) = (f64::INFINITY, true);
    let mut parts = vec![Part { cubic, corners, depth: 0 }];
    while let Some(part) = parts.pop() {
        if part.cubic.iter().all(|&c| c > bound + error) {
            least = part.cubic.iter().fold(least, |least, &c| least.min(c - error));
            continue;
        }
        let at_corners = [0, 1, 2, 3].map(|i| part.cubic[INDEX[i][i][i]]);
        if at_corners.iter().any(|&value| value < bound - error) {
            return Sign::Below;
        }
        // A value at the bound stays there in all smaller parts.
        let are_above = at_corners.iter().all(|&value| value > bound + error);
        if part.depth == MAX_DEPTH || !are_above {
            is_decided = false;
            continue;
        }
        parts.extend(part.halves());
    }
    if is_decided { Sign::Above { least } } else { Sign::Undecided }
}

/// Volume of a ten-node element, in cubed units of length. It is a sixth of the mean of the coefficients, since all Bernstein
/// polynomials have the same integral.
pub(crate) fn volume_of(nodes: &[Point3; 10]) -> f64 {
    coefficients(nodes).0.iter().sum::<f64>() / 120.0
}

/// Jacobian determinant of an element at a point with these barycentric coordinates; in floating point.
#[cfg(test)]
pub(super) fn jacobian_at(nodes: &[Point3; 10], at: [f64; 4]) -> f64 {
    let mut by = [Vec3::zeros(); 4];
    for i in 0..4 {
        by[i] += nodes[i].coords * (4.0 * at[i] - 1.0);
    }
    for (&[i, j], middle) in TET_EDGES.iter().zip(&nodes[4..]) {
        by[i] += middle.coords * (4.0 * at[j]);
        by[j] += middle.coords * (4.0 * at[i]);
    }
    (by[1] - by[0]).cross(&(by[2] - by[0])).dot(&(by[3] - by[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn element(offsets: [[f64; 3]; 6]) -> [Point3; 10] {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 1.0, 0.1], [0.0, 0.3, 0.9]].map(Point3::from);
        let mut nodes = [corners[0]; 10];
        nodes[..4].copy_from_slice(&corners);
        for (i, offset) in offsets.into_iter().enumerate() {
            let [a, b] = TET_EDGES[i];
            nodes[4 + i] = nalgebra::center(&corners[a], &corners[b]) + Vec3::from(offset);
        }
        nodes
    }

    /// Barycentric coordinates on a lattice.
    fn lattice(n: u32) -> impl Iterator<Item = [f64; 4]> {
        let all =
            move || (0..=n).flat_map(move |i| (0..=n - i).flat_map(move |j| (0..=n - i - j).map(move |k| [i, j, k])));
        all().map(move |[i, j, k]| [i, j, k, n - i - j - k].map(|x| f64::from(x) / f64::from(n)))
    }

    fn bernstein(cubic: &Cubic, at: [f64; 4]) -> f64 {
        let mut sum = 0.0;
        for a in 0..4 {
            for b in 0..4 {
                for c in 0..4 {
                    sum += cubic[INDEX[a][b][c]] * at[a] * at[b] * at[c];
                }
            }
        }
        sum
    }

    fn offsets(size: f64) -> impl Strategy<Value = [[f64; 3]; 6]> {
        prop::array::uniform6(prop::array::uniform3(-size..size))
    }

    proptest! {
        #[test]
        fn coefficients_and_halves_give_the_determinant(offsets in offsets(0.3)) {
            let nodes = element(offsets);
            let (cubic, error) = coefficients(&nodes);
            let part = half(&cubic, 2, 0);
            for at in lattice(4) {
                let direct = jacobian_at(&nodes, at);
                prop_assert!((bernstein(&cubic, at) - direct).abs() < 1e-12 + error);
                let whole = [at[0] / 2.0, at[1], at[2] + at[0] / 2.0, at[3]];
                prop_assert!((bernstein(&part, at) - jacobian_at(&nodes, whole)).abs() < 1e-12 + error);
            }
        }

        #[test]
        fn signs_agree_with_dense_samples(offsets in offsets(0.12)) {
            let nodes = element(offsets);
            let sampled = lattice(12).map(|at| jacobian_at(&nodes, at)).fold(f64::INFINITY, f64::min);
            match jacobian_above(&nodes, 0.0) {
                Sign::Above { least } => prop_assert!(0.0 < least && least <= sampled + 1e-12),
                Sign::Below => prop_assert!(sampled < 0.05),
                Sign::Undecided => prop_assert!(sampled.abs() < 0.05),
            }
        }
    }

    #[test]
    fn volumes_are_those_of_a_quadrature() {
        let nodes = element([[0.1, 0.0, 0.05], [0.0; 3], [0.02, 0.1, 0.0], [0.0; 3], [0.0, 0.0, 0.08], [0.03; 3]]);
        // Exact for cubic polynomials (Keast 1986): the centre, and four points.
        let points = (0..4).map(|i| std::array::from_fn(|j| if i == j { 0.5 } else { 1.0 / 6.0 }));
        let sum: f64 = points.map(|at| 0.45 * jacobian_at(&nodes, at)).sum();
        let volume = (sum - 0.8 * jacobian_at(&nodes, [0.25; 4])) / 6.0;
        assert!((volume_of(&nodes) - volume).abs() < 1e-14, "{volume}");
    }

    #[test]
    fn straight_elements_have_a_constant_determinant() {
        let nodes = element([[0.0; 3]; 6]);
        let (cubic, error) = coefficients(&nodes);
        let volume6 = jacobian_at(&nodes, [0.25; 4]);
        assert!(cubic.iter().all(|c| (c - volume6).abs() <= error && error < 1e-10));
        assert!(jacobian_above(&nodes, 0.99 * volume6).is_above());
        assert_eq!(jacobian_above(&nodes, 1.01 * volume6), Sign::Below);
    }

    #[test]
    fn a_determinant_that_is_negative_inside_alone_is_found() {
        // Opposite edges pushed towards each other: all corner values stay positive.
        let mut nodes = element([[0.0; 3]; 6]);
        let centre = |i: usize, j: usize, nodes: &[Point3; 10]| nalgebra::center(&nodes[i], &nodes[j]);
        let (p, q) = (centre(0, 1, &nodes), centre(2, 3, &nodes));
        nodes[4] += (q - p) * 0.75;
        nodes[9] += (p - q) * 0.75;
        assert_eq!(jacobian_above(&nodes, 0.0), Sign::Below);
        assert!(lattice(12).any(|at| jacobian_at(&nodes, at) < 0.0));
    }

    #[test]
    fn degenerate_and_infinite_elements_are_undecided() {
        let mut nodes = element([[0.0; 3]; 6]);
        nodes[5].x = f64::NAN;
        assert_eq!(jacobian_above(&nodes, 0.0), Sign::Undecided);
        assert_eq!(jacobian_above(&[Point3::origin(); 10], 0.0), Sign::Undecided);
    }
}
