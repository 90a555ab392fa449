//! Vectors and boxes in space.

use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};
use std::array::from_fn;

/// Position, or difference of positions.
pub type Point = [f64; 3];
/// Axis-aligned bounding box.
pub type Bounds = rstar::AABB<Point>;
/// Tree of numbered boxes.
pub type Boxes = RTree<GeomWithData<Rectangle<Point>, u32>>;

/// Tree of boxes, numbered from 0.
pub fn boxes(bounds: impl Iterator<Item = Bounds>) -> Boxes {
    RTree::bulk_load(bounds.map(Rectangle::from).zip(0..).map(|(own, i)| GeomWithData::new(own, i)).collect())
}

pub fn minus(a: Point, b: Point) -> Point {
    from_fn(|k| a[k] - b[k])
}

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes with numbers below 1, from a linear congruential generator of Knuth.
    fn random_bounds(count: usize, width: f64) -> Vec<Bounds> {
        let mut state = 5_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        let mut corners = || {
            let low = [0; 3].map(|_| random());
            Bounds::from_corners(low, low.map(|x| x + width * random()))
        };
        (0..count).map(|_| corners()).collect()
    }

    #[test]
    fn pairs_and_points_are_those_of_all_boxes() {
        for (count, width) in [(0, 1.0), (1, 1.0), (6, 0.6), (7, 0.6), (40, 0.3), (300, 0.1), (300, 0.0)] {
            let all = random_bounds(count, width);
            let corners: Vec<[Point; 2]> = all.iter().map(|own| [own.lower(), own.upper()]).collect();
            let tree = boxes(all.iter().copied());
            let meets = |&(i, j): &(usize, usize)| {
                (0..3).all(|k| corners[i][0][k].max(corners[j][0][k]) <= corners[i][1][k].min(corners[j][1][k]))
            };
            let expected: Vec<_> = (0..count).flat_map(|i| (0..count).map(move |j| (i, j))).filter(meets).collect();
            let found = tree.intersection_candidates_with_other_tree(&tree);
            let mut found: Vec<_> = found.map(|(a, b)| (a.data as usize, b.data as usize)).collect();
            found.sort_unstable();
            assert_eq!(found, expected, "{count}");
            for corner in all.iter().map(Bounds::upper) {
                let contains =
                    |&i: &usize| (0..3).all(|k| corners[i][0][k] <= corner[k] && corner[k] <= corners[i][1][k]);
                let found = tree.locate_in_envelope_intersecting(Bounds::from_point(corner));
                let mut found: Vec<usize> = found.map(|own| own.data as usize).collect();
                found.sort_unstable();
                assert_eq!(found, (0..count).filter(contains).collect::<Vec<_>>(), "{count}");
            }
        }
    }

    #[test]
    fn products_of_vectors() {
        let (a, b) = ([1., 2., 3.], [5., -7., 11.]);
        assert_eq!((dot(a, b), minus(a, b)), (24., [-4., 9., -8.]));
        assert_eq!((cross(a, b), cross(b, a)), ([43., 4., -17.], [-43., -4., 17.]));
    }
}
