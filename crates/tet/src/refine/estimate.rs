//! Estimate of the number of tetrahedra from a size field.

use super::grading::Grading;
use super::tree::{SizeTree, children};
use super::wall::Wall;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Tetrahedra per cube of a body-centred lattice.
const PER_CUBE: f64 = 12.0;

/// Tetrahedra per cube of an edge length, between points that are selected by their distance, for edge lengths that do not
/// grow. Regular ones would be 8.5. This and [`STEEPER`] are found for lines in tissue at growths of 1.3 and 2.
pub const PER_LENGTH: f64 = 5.6;

/// Exponent of the increase of that number with the slope of the edge lengths. Steep lengths are not reached.
const STEEPER: f64 = 1.2;

/// Tetrahedra per triangle of the surface, in addition to those of the cubes.
const PER_TRIANGLE: f64 = 2.0;

/// Cubes of each level that are tested.
const SAMPLES: usize = 1500;

/// Expected number of tetrahedra if cubes of a size field are filled. Counts the cubes of each level, and tests a sample
/// of them for lying inside.
pub fn estimate_tets(tree: &SizeTree, wall: &Wall) -> f64 {
    estimate_with(tree, wall, &|_, _| PER_CUBE)
}

/// As [`estimate_tets`], for points of the size field that are selected by a grading.
pub fn estimate_spaced(tree: &SizeTree, wall: &Wall, grading: &Grading) -> f64 {
    let per_length = PER_LENGTH * libm::exp(STEEPER * grading.slope());
    let per_cube = |center: &Point3, side: f64| (per_length * (side / grading.at(center)).powi(3)).min(PER_CUBE);
    estimate_with(tree, wall, &per_cube)
}

/// Expected number of tetrahedra, from that in a cube with a centre and a side.
fn estimate_with(tree: &SizeTree, wall: &Wall, per_cube: &dyn Fn(&Point3, f64) -> f64) -> f64 {
    let mut tets = coarsest_inside(tree, wall, per_cube);
    for level in 1..=tree.levels() {
        let all = 8 * tree.split_count(level - 1);
        let step = all.div_ceil(SAMPLES).max(1);
        let (mut tested, mut found) = (0, 0.0);
        for cube in tree.split_cubes(level - 1).flat_map(children).step_by(step) {
            tested += 1;
            let center = center(tree, level, cube);
            if !tree.is_split(level, cube) && wall.holds(&center) {
                found += per_cube(&center, tree.side(level));
            }
        }
        tets += all as f64 * found / f64::from(tested.max(1));
    }
    tets + PER_TRIANGLE * wall.surface.triangles.len() as f64
}

/// Expected number of tetrahedra of a uniform lattice with cubes of this side.
pub fn estimate_uniform(side: f64, wall: &Wall) -> f64 {
    let (low, size) = bounds(wall);
    let inside = places(low, size).filter(|p| wall.holds(p)).count();
    let volume = size.product() * share(inside, SAMPLES);
    PER_CUBE * volume / side.powi(3) + PER_TRIANGLE * wall.surface.triangles.len() as f64
}

/// Expected number of tetrahedra in the cubes of the coarsest level inside that are not split.
fn coarsest_inside(tree: &SizeTree, wall: &Wall, per_cube: &dyn Fn(&Point3, f64) -> f64) -> f64 {
    let (low, size) = bounds(wall);
    let whole = |p: &Point3| !tree.is_split(0, tree.cube_at(p, 0)) && wall.holds(p);
    let found: f64 = places(low, size).filter(whole).map(|p| per_cube(&p, tree.side(0))).sum();
    size.product() * found / SAMPLES as f64 / tree.side(0).powi(3)
}

fn center(tree: &SizeTree, level: usize, cube: [i32; 3]) -> Point3 {
    let middle = Vec3::from(cube.map(f64::from)).add_scalar(0.5);
    tree.origin + middle * tree.side(level)
}

/// Lowest corner and extents of the bounding box.
fn bounds(wall: &Wall) -> (Point3, Vec3) {
    let Some(first) = wall.surface.points.first() else { return (Point3::origin(), Vec3::zeros()) };
    let (low, high) = wall.surface.points.iter().fold((*first, *first), |(l, h), p| (l.inf(p), h.sup(p)));
    (low, high - low)
}

/// Evenly distributed points of a box. (Roberts, 'The unreasonable effectiveness of quasirandom sequences', 2018.)
fn places(low: Point3, size: Vec3) -> impl Iterator<Item = Point3> {
    let steps = Vec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3);
    (1..=SAMPLES).map(move |n| low + (steps * n as f64).map(f64::fract).component_mul(&size))
}

fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole.max(1) as f64
}
