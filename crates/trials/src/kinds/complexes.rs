//! Kinds of facet complexes with regions.

use super::make::MakeCase;
use super::surfaces::uneven;
use crate::case::{Case, Expect, Input};
use crate::random::Random;
use crate::surface::{SIDES, Surface, cuboid, sphere};
use crate::vector::{Vector, along, frame};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

pub const KINDS: [(&str, MakeCase); 9] = [
    ("boxes of a grid that share sides", |r| written(grid(r), Expect::Valid, r)),
    ("nested spheres", |r| written(spheres(r), Expect::Valid, r)),
    ("sphere halved by a disc", |r| written(halved(r), Expect::Valid, r)),
    ("region with a negative number", |r| written(negative(r), Expect::Valid, r)),
    ("regions that touch themselves at edges", |r| written(touching(r), Expect::Valid, r)),
    ("wedges around one edge", |r| written(wedges(r), Expect::Valid, r)),
    ("boxes in a box, some of them holes", |r| written(boxes(r), Expect::Valid, r)),
    ("box with dangling triangles", |r| written(dangling(r), Expect::Any, r)),
    ("sheets close to each other", |r| written(sheets(r), Expect::Valid, r)),
];

fn written(complex: Surface, expect: Expect, r: &mut Random) -> Case {
    let output = r.pick(&["out.vtu", "out.vtu", "out.msh", "out.ele"]);
    Case { output, ..Case::new(Input::Complex(complex), expect) }
}

fn middle(corners: &[Vector]) -> Vector {
    [0, 1, 2].map(|k| corners.iter().map(|p| p[k]).sum::<f64>() / corners.len() as f64)
}

/// Grid of boxes, each a region.
pub fn grid(r: &mut Random) -> Surface {
    grid_with(r, |i, _| i as i32 + 1)
}

/// Grid of boxes with few region numbers, so that regions touch themselves at edges and vertices.
fn touching(r: &mut Random) -> Surface {
    grid_with(r, |_, r| 1 + r.below(4) as i32)
}

/// Grid of boxes with region numbers; equal neighbours have no facet between them.
fn grid_with(r: &mut Random, id: impl Fn(usize, &mut Random) -> i32) -> Surface {
    let size = [(); 3].map(|()| 1 + r.below(3));
    let ticks = size.map(|n| uneven(r, n));
    let count = size.iter().product::<usize>();
    let ids: Vec<i32> = (0..count).map(|i| id(i, r)).collect();
    let cell = |p: [usize; 3]| (p[0] * size[1] + p[1]) * size[2] + p[2];
    let (mut out, mut numbers) = (Surface::default(), BTreeMap::new());
    for i in 0..count {
        let at = [i / size[2] / size[1], i / size[2] % size[1], i % size[2]];
        let node = |corner: usize| [0, 1, 2].map(|k| at[k] + (corner >> k & 1));
        let place = |node: [usize; 3]| [0, 1, 2].map(|k| ticks[k][node[k]]);
        out.regions.push((middle(&[place(node(0)), place(node(7))]), ids[i]));
        for (side, corners) in SIDES.iter().enumerate() {
            let (axis, up) = ([2, 1, 0][side / 2], side % 2 == 1);
            let outer = if up { at[axis] + 1 == size[axis] } else { at[axis] == 0 };
            let mut beside = at;
            // The lower cell of two writes their common side.
            if !outer {
                beside[axis] = if up { at[axis] + 1 } else { at[axis] - 1 };
            }
            if !outer && (!up || ids[cell(beside)] == ids[i]) {
                continue;
            }
            let [a, b, c, d] = corners.map(|corner| {
                *numbers.entry(node(corner)).or_insert_with(|| {
                    out.points.push(place(node(corner)));
                    out.points.len() - 1
                })
            });
            out.triangles.extend([[a, b, c], [a, c, d]]);
            out.markers.extend([1 + side as i32; 2]);
        }
    }
    if r.chance(0.4) { out.turn(&frame(r.direction())) } else { out }
}

/// Spheres in each other, each with a region.
fn spheres(r: &mut Random) -> Surface {
    let (mut radius, mut out) = (1.0, Surface::default());
    for i in 0..2 + r.below(4) {
        out.add(&sphere(4 + r.below(5)).map(|p| p.map(|x| x * radius)).marked(i as i32 + 1));
        out.regions.push(([0.9 * radius, 0.0, 0.0], i as i32 + 1));
        // Chords of four bands are at 0.85 of the radius: the inner sphere stays inside.
        radius *= 0.8 * r.between(0.5, 1.0);
    }
    out
}

/// Sphere with a disc at its equator and a region on both sides.
fn halved(r: &mut Random) -> Surface {
    let n = 2 * (2 + r.below(4));
    let mut out = sphere(n).marked(1);
    let ring = 2 * n;
    let first = 1 + (n / 2 - 1) * ring;
    out.points.push([0.0; 3]);
    let centre = out.points.len() - 1;
    for j in 0..ring {
        out.triangles.push([centre, first + j, first + (j + 1) % ring]);
        out.markers.push(2);
    }
    out.regions = vec![([0.1, 0.1, 0.4], 7), ([0.1, 0.1, -0.4], 9)];
    let flat = if r.chance(0.3) { r.scale(-3, 0) } else { 1.0 };
    out.map(|[x, y, z]| [x, y, z * flat])
}

/// Halved sphere in which one region has a negative number.
fn negative(r: &mut Random) -> Surface {
    let mut out = halved(r);
    out.regions[1].1 = -9;
    out
}

/// Prism cut into wedges that share its axis; angles as small as 1e-3.
fn wedges(r: &mut Random) -> Surface {
    let mut angles: Vec<f64> = (0..4).map(|i| TAU * f64::from(i) / 4.0).collect();
    for _ in 0..r.below(30) {
        let angle = if r.chance(0.3) { angles[r.below(angles.len())] + r.scale(-3, -1) } else { r.angle() };
        if angle < TAU - 5e-4 && angles.iter().all(|a| (a - angle).abs() > 5e-4) {
            angles.push(angle);
        }
    }
    angles.sort_by(f64::total_cmp);
    let (n, height) = (angles.len(), r.scale(-1, 1));
    let mut out = Surface::default();
    for z in [0.0, height] {
        out.points.extend(angles.iter().map(|a| [a.cos(), a.sin(), z]));
        out.points.push([0.0, 0.0, z]);
    }
    let up = n + 1;
    for i in 0..n {
        let j = (i + 1) % n;
        let tops = [[n, j, i], [n + up, i + up, j + up]];
        let sides = [[i, j, j + up], [i, j + up, i + up]];
        let page = [[n, i, i + up], [n, i + up, n + up]];
        out.triangles.extend(tops.into_iter().chain(sides).chain(page));
        out.markers.extend([1, 1, 2, 2, 3, 3]);
        let corners = [n, i, j, n + up, i + up, j + up].map(|v| out.points[v]);
        out.regions.push((middle(&corners), i as i32 + 1));
    }
    out
}

/// Boxes inside a box: regions or holes, 1e-6 to 0.1 from each other.
fn boxes(r: &mut Random) -> Surface {
    let mut out = cuboid([0.0; 3], [4.0, 1.0, 1.0]).marked(1);
    out.regions.push(([1e-7; 3], 1));
    let gap = r.scale(-6, -1);
    for i in 0..4 {
        let low = [f64::from(i) + gap, gap, gap];
        let inner = cuboid(low, [f64::from(i + 1) - gap, 1.0 - gap, 1.0 - gap]).marked(i + 2);
        if r.chance(0.3) {
            out.holes.push(along(low, [0.5; 3], 0.5));
        } else {
            out.regions.push((along(low, [0.5; 3], 0.5), i + 2));
        }
        out.add(&inner);
    }
    out
}

/// Box with triangles inside that hang free.
fn dangling(r: &mut Random) -> Surface {
    let mut out = cuboid([-1.0; 3], [1.0; 3]).marked(1);
    for i in 0..=r.below(8) {
        let first = out.points.len();
        let place = [-0.8 + 0.2 * i as f64, r.between(-0.7, 0.7), r.between(-0.7, 0.7)];
        for _ in 0..3 {
            out.points.push(along(place, r.direction(), r.between(0.01, 0.09)));
        }
        out.triangles.push([first, first + 1, first + 2]);
        out.markers.push(5);
    }
    out
}

/// Box cut by parallel sheets, 1e-9 to 0.1 from each other.
fn sheets(r: &mut Random) -> Surface {
    let mut heights = vec![0.0];
    for i in 0..=r.below(5) {
        heights.push(heights[i] + r.scale(-9, 0).min(0.3));
    }
    heights.push(heights.last().copied().unwrap_or(0.0) + 1.0);
    let mut out = Surface::default();
    for (i, &z) in heights.iter().enumerate() {
        let a = 4 * i;
        out.points.extend([[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]);
        out.triangles.extend([[a, a + 1, a + 2], [a, a + 2, a + 3]]);
        out.markers.extend([2, 2]);
        if i + 1 == heights.len() {
            continue;
        }
        out.regions.push(([0.4, 0.3, z.midpoint(heights[i + 1])], i as i32 + 1));
        for k in 0..4 {
            let (b, c) = (a + k, a + (k + 1) % 4);
            out.triangles.extend([[b, c, c + 4], [b, c + 4, b + 4]]);
            out.markers.extend([1, 1]);
        }
    }
    out
}
