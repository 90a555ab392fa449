//! Kinds of surfaces that are valid by construction.

use super::make::MakeCase;
use crate::case::{Case, Expect, Input};
use crate::random::{Random, decade};
use crate::surface::{SIDES, Surface, cuboid, sphere};
use crate::vector::{along, frame, norm};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

pub const KINDS: [(&str, MakeCase); 12] = [
    ("union of boxes on a grid, turned", |r| valid(boxes(r))),
    ("box with turned arms", |r| valid(arms(r))),
    ("extrusion with needles", |r| valid(extrusion(r))),
    ("slightly perturbed plane", |r| valid(plane(r))),
    ("sphere in an offset sphere", |r| valid(offset(r))),
    ("cube in a cube, 1 ulp from its sides", |r| valid(ulp_inside(r))),
    ("cubes side by side, 1 ulp apart", |r| valid(ulp_beside(r))),
    ("nested cubes", |r| valid(nested(r))),
    ("sphere with random radii", |r| valid(spiky(r))),
    ("spiral ribbon", |r| valid(spiral(r))),
    ("sphere in units of 1e-30 to 1e30", |r| valid(units(r))),
    ("flattened sphere", |r| valid(flattened(r))),
];

fn valid(surface: Surface) -> Case {
    Case::new(Input::Surface(surface), Expect::Valid)
}

/// Union of cells of an uneven grid: a Boolean union of boxes, without non-manifold edges or vertices.
pub fn boxes(r: &mut Random) -> Surface {
    let size = [(); 3].map(|()| 2 + r.below(3));
    let ticks = size.map(|n| uneven(r, n));
    let frame = frame(r.direction());
    for _ in 0..30 {
        let filled: Vec<bool> = (0..size.iter().product()).map(|_| r.chance(0.6)).collect();
        let surface = union(size, &ticks, &|i, j, k| filled[(i * size[1] + j) * size[2] + k]);
        if !surface.triangles.is_empty() && is_manifold(&surface) {
            return if r.chance(0.5) { surface.turn(&frame) } else { surface };
        }
    }
    union(size, &ticks, &|_, _, _| true)
}

/// Ends of `count` intervals of lengths 0.01 to 1.
pub fn uneven(r: &mut Random, count: usize) -> Vec<f64> {
    let mut ticks = vec![0.0];
    for i in 0..count {
        let length = if r.chance(0.2) { 0.01 } else { r.between(0.2, 1.0) };
        ticks.push(ticks[i] + length);
    }
    ticks
}

/// Boundary of the filled cells of a grid.
fn union(size: [usize; 3], ticks: &[Vec<f64>; 3], is_filled: &dyn Fn(usize, usize, usize) -> bool) -> Surface {
    let inside = |p: [usize; 3]| (0..3).all(|k| p[k] >= 1 && p[k] <= size[k]);
    let full = |p: [usize; 3]| inside(p) && is_filled(p[0] - 1, p[1] - 1, p[2] - 1);
    let (mut out, mut numbers) = (Surface::default(), BTreeMap::new());
    let cells = size.iter().product::<usize>();
    for cell in 0..cells {
        let at = [cell / size[2] / size[1], cell / size[2] % size[1], cell % size[2]];
        let shifted = at.map(|x| x + 1);
        if !full(shifted) {
            continue;
        }
        for (side, corners) in SIDES.iter().enumerate() {
            let (axis, up) = ([2, 1, 0][side / 2], side % 2 == 1);
            let mut beside = shifted;
            beside[axis] = if up { beside[axis] + 1 } else { beside[axis] - 1 };
            if full(beside) {
                continue;
            }
            let [a, b, c, d] = corners.map(|corner| {
                let node = [0, 1, 2].map(|k| at[k] + (corner >> k & 1));
                *numbers.entry(node).or_insert_with(|| {
                    out.points.push([0, 1, 2].map(|k| ticks[k][node[k]]));
                    out.points.len() - 1
                })
            });
            out.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    out
}

/// True if each edge has two triangles and each vertex one fan.
fn is_manifold(surface: &Surface) -> bool {
    let mut edges: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    let mut fans: Vec<BTreeMap<usize, usize>> = vec![BTreeMap::new(); surface.points.len()];
    for t in &surface.triangles {
        for k in 0..3 {
            let [a, b, c] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
            fans[a].insert(b, c);
        }
    }
    let is_one = |fan: &BTreeMap<usize, usize>| {
        let Some((&start, _)) = fan.first_key_value() else { return false };
        let (mut at, mut steps) = (start, 0);
        while let Some(&next) = fan.get(&at) {
            (at, steps) = (next, steps + 1);
            if at == start || steps > fan.len() {
                break;
            }
        }
        at == start && steps == fan.len()
    };
    edges.values().all(|count| *count == 2) && fans.iter().all(is_one)
}

/// Cube with an arm on each side: prisms of smaller squares, turned in the side and tilted.
fn arms(r: &mut Random) -> Surface {
    let mut out = cuboid([-1.0; 3], [1.0; 3]);
    out.triangles.clear();
    for side in SIDES {
        let ring = side.map(|v| out.points[v]);
        let middle = [0, 1, 2].map(|k| ring.iter().map(|p| p[k]).sum::<f64>() / 4.0);
        if r.chance(0.2) {
            let [a, b, c, d] = side;
            out.triangles.extend([[a, b, c], [a, c, d]]);
            continue;
        }
        let (size, turn, length) = (r.scale(-3, 0).min(0.5), r.between(-0.3, 0.3), r.scale(-2, 1));
        let axes = [1, 3].map(|i| [0, 1, 2].map(|k| (ring[i][k] - ring[0][k]) / 2.0));
        let tilt = axes.map(|axis| axis.map(|x| x * r.between(-0.3, 0.3)));
        let top = [0, 1, 2].map(|k| length * (middle[k] + tilt[0][k] + tilt[1][k]));
        let (sin, cos) = turn.sin_cos();
        let first = out.points.len();
        for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let (u, v) = (size * (cos * u - sin * v), size * (sin * u + cos * v));
            out.points.push([0, 1, 2].map(|k| middle[k] + u * axes[0][k] + v * axes[1][k]));
        }
        for i in 0..4 {
            out.points.push([0, 1, 2].map(|k| out.points[first + i][k] + top[k]));
        }
        let quad = |a: usize, b: usize, c: usize, d: usize| [[a, b, c], [a, c, d]];
        for i in 0..4 {
            let j = (i + 1) % 4;
            out.triangles.extend(quad(side[i], side[j], first + j, first + i));
            out.triangles.extend(quad(first + i, first + j, first + 4 + j, first + 4 + i));
        }
        out.triangles.extend(quad(first + 4, first + 5, first + 6, first + 7));
    }
    if r.chance(0.5) { out.turn(&frame(r.direction())) } else { out }
}

/// Prism of a star-shaped polygon with corners at angles that differ by as little as 1e-9.
fn extrusion(r: &mut Random) -> Surface {
    let mut angles: Vec<f64> = (0..6).map(|i| TAU * f64::from(i) / 6.0).collect();
    for _ in 0..r.below(20) {
        let near = angles[r.below(angles.len())];
        let angle = if r.chance(0.5) { near + r.scale(-9, -1) } else { r.angle() };
        if angles.iter().all(|a| (a - angle).abs() > 1e-10) && angle < TAU {
            angles.push(angle);
        }
    }
    angles.sort_by(f64::total_cmp);
    let (height, n) = (r.scale(-3, 3), angles.len());
    let radii: Vec<f64> = angles.iter().map(|_| r.between(0.2, 1.0)).collect();
    let mut out = Surface::default();
    for z in [0.0, height] {
        out.points.extend(angles.iter().zip(&radii).map(|(a, r)| [r * a.cos(), r * a.sin(), z]));
        out.points.push([0.0, 0.0, z]);
    }
    for i in 0..n {
        let (j, up) = ((i + 1) % n, n + 1);
        out.triangles.extend([[n, j, i], [n + up, i + up, j + up], [i, j, j + up], [i, j + up, i + up]]);
    }
    out
}

/// Box whose upper side is a grid with heights that differ by 1e-16 to 0.1.
fn plane(r: &mut Random) -> Surface {
    let (n, size) = (2 + r.below(10), r.scale(-16, -1).min(0.1));
    let mut out = Surface::default();
    for z in [0.0, r.scale(-2, 1)] {
        for i in 0..=n * (n + 2) {
            let rough = if z > 0.0 { size * r.unit() } else { 0.0 };
            out.points.push([(i % (n + 1)) as f64, (i / (n + 1)) as f64, z + rough]);
        }
    }
    let (row, up) = (n + 1, (n + 1) * (n + 1));
    let at = |i: usize, j: usize| i + row * j;
    for i in 0..n {
        for j in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            out.triangles.extend([[a, c, b], [a, d, c], [a + up, b + up, c + up], [a + up, c + up, d + up]]);
        }
        let sides =
            [[at(i, 0), at(i + 1, 0)], [at(i + 1, n), at(i, n)], [at(0, i + 1), at(0, i)], [at(n, i), at(n, i + 1)]];
        for [a, b] in sides {
            out.triangles.extend([[a, b, b + up], [a, b + up, a + up]]);
        }
    }
    out
}

/// Shell between a sphere and a smaller copy of it.
fn offset(r: &mut Random) -> Surface {
    let n = 3 + r.below(8);
    let inner = 1.0 - r.scale(-4, -1).min(0.5);
    let mut out = sphere(n);
    out.add(&sphere(n).map(|p| p.map(|x| x * inner)).inverted());
    out
}

/// Cube with a cubic cavity that comes within 1 ulp of some sides.
fn ulp_inside(r: &mut Random) -> Surface {
    let low = [(); 3].map(|()| if r.chance(0.5) { 1.0_f64.next_up() } else { 1.25 });
    let high = [(); 3].map(|()| if r.chance(0.3) { 2.0_f64.next_down() } else { 1.75 });
    let mut out = cuboid([1.0; 3], [2.0; 3]);
    out.add(&cuboid(low, high).inverted());
    out
}

/// Two cubes that are 1 ulp apart, shifted along their common side.
fn ulp_beside(r: &mut Random) -> Surface {
    let shift = r.pick(&[0.0, 0.5, 0.25, 1.0]);
    let mut out = cuboid([0.0; 3], [1.0; 3]);
    let start = 1.0_f64.next_up();
    out.add(&cuboid([start, shift, 0.0], [start + 1.0, 1.0 + shift, 1.0]));
    out
}

/// Cubes in each other, alternately solid and hollow.
fn nested(r: &mut Random) -> Surface {
    let (mut half, mut out) = (1.0, Surface::default());
    for i in 0..2 + r.below(10) {
        let cube = cuboid([-half; 3], [half; 3]);
        out.add(&if i % 2 == 0 { cube } else { cube.inverted() });
        half *= 1.0 - r.scale(-3, 0).min(0.6);
    }
    out.turn(&frame(r.direction()))
}

/// Star-shaped surface: each vertex of a sphere at a radius of its own.
pub fn spiky(r: &mut Random) -> Surface {
    let (n, deep) = (3 + r.below(8), r.between(0.1, 0.95));
    sphere(n).map(|p| p.map(|x| x / norm(p))).map({
        let mut random = r.clone();
        let factors: BTreeMap<[u64; 3], f64> = sphere(n)
            .map(|p| p.map(|x| x / norm(p)))
            .points
            .iter()
            .map(|p| (p.map(f64::to_bits), 1.0 - deep * random.unit()))
            .collect();
        move |p| p.map(|x| x * factors[&p.map(f64::to_bits)])
    })
}

/// Thin ribbon along a spiral, extruded.
fn spiral(r: &mut Random) -> Surface {
    let (n, thick, height) = (20 + r.below(80), r.scale(-5, -1).min(0.2), r.scale(-2, 1));
    let mut out = Surface::default();
    for z in [0.0, height] {
        for i in 0..=n {
            let angle = 0.2 * i as f64;
            for radius in [1.0 + 0.1 * angle, 1.0 + 0.1 * angle + thick] {
                out.points.push([radius * angle.cos(), radius * angle.sin(), z]);
            }
        }
    }
    let up = 2 * (n + 1);
    let mut quad = |a: usize, b: usize, c: usize, d: usize| out.triangles.extend([[a, b, c], [a, c, d]]);
    for i in 0..n {
        let [a, b, c, d] = [2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2];
        quad(a, d, c, b);
        quad(a + up, b + up, c + up, d + up);
        quad(b, c, c + up, b + up);
        quad(d, a, a + up, d + up);
    }
    quad(0, 1, 1 + up, up);
    let last = 2 * n;
    quad(last + 1, last, last + up, last + 1 + up);
    out
}

/// Sphere in any unit, with exact zeros: sines of π would leave the range of exact predicates.
fn units(r: &mut Random) -> Surface {
    let (n, unit) = (3 + r.below(5), decade(r.below(61) as i32 - 30));
    sphere(n).map(|p| p.map(|x| if x.abs() < 1e-9 { 0.0 } else { x * unit }))
}

/// Sphere compressed along one axis, and moved far from the origin.
fn flattened(r: &mut Random) -> Surface {
    let (n, flat) = (3 + r.below(8), r.scale(-6, 0));
    let frame = frame(r.direction());
    let away = along([0.0; 3], r.direction(), r.pick(&[0.0, 10.0, 1000.0]));
    sphere(n).map(|[x, y, z]| [x, y, z * flat]).turn(&frame).map(|p| along(p, away, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_are_manifold() {
        for (name, make) in KINDS {
            for seed in 0..30 {
                let case = make(&mut Random::of_case(name, seed));
                let Input::Surface(surface) = case.input else { panic!("{name}: no surface") };
                assert!(is_manifold(&surface), "{name}, seed {seed}");
                let volume: f64 = surface
                    .triangles
                    .iter()
                    .map(|t| {
                        let [a, b, c] = t.map(|v| surface.points[v]);
                        crate::vector::dot(a, crate::vector::cross(b, c))
                    })
                    .sum();
                assert!(volume > 0.0, "{name}, seed {seed}: {volume}");
            }
        }
    }
}
