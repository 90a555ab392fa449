//! Kinds of input that must be refused: surfaces that bound no volume, and numbers out of range.

use super::make::MakeCase;
use super::repeated::extreme_units;
use super::surfaces::spiky;
use crate::case::{Case, Expect, Input};
use crate::random::Random;
use crate::surface::{Surface, cuboid, sphere};
use crate::vector::along;

pub const KINDS: [(&str, MakeCase); 13] = [
    ("surface without a triangle", |r| refused(open(r))),
    ("surface with an inverted triangle", |r| refused(inverted(r))),
    ("duplicate triangle", |r| refused(duplicate(r))),
    ("fin on an edge", |r| refused(fin(r))),
    ("cubes that share an edge", |r| refused(shared_edge(r))),
    ("surfaces that intersect", |r| refused(intersecting(r))),
    ("vertex pushed through the opposite side", |r| refused(pushed(r))),
    ("cube that shares a side with its cavity", |_| refused(shared_side())),
    ("random triangles", |r| refused(random(r))),
    ("triangle without area", |r| refused(flat(r))),
    ("coordinate that is not finite", not_finite),
    ("index out of range", out_of_range),
    ("tree in units of 1e-150 or 1e150", |r| Case::new(Input::Network(extreme_units(r)), Expect::Refused)),
];

fn refused(surface: Surface) -> Case {
    Case::new(Input::Surface(surface), Expect::Refused)
}

fn closed(r: &mut Random) -> Surface {
    if r.chance(0.3) { cuboid([0.0; 3], [1.0; 3]) } else { spiky(r) }
}

/// Closed surface with a hole.
fn open(r: &mut Random) -> Surface {
    let mut out = closed(r);
    let lost = r.below(out.triangles.len());
    out.triangles.remove(lost);
    out
}

/// Closed surface with one triangle inside out.
fn inverted(r: &mut Random) -> Surface {
    let mut out = closed(r);
    let turned = r.below(out.triangles.len());
    out.triangles[turned].swap(0, 1);
    out
}

/// Closed surface with a triangle twice.
fn duplicate(r: &mut Random) -> Surface {
    let mut out = closed(r);
    let [a, b, c] = out.triangles[r.below(out.triangles.len())];
    out.triangles.push(r.pick(&[[a, b, c], [b, c, a], [b, a, c]]));
    out
}

/// Closed surface with a third triangle at an edge.
fn fin(r: &mut Random) -> Surface {
    let mut out = closed(r);
    let [a, b, _] = out.triangles[r.below(out.triangles.len())];
    out.points.push([3.0, 3.0, 3.0]);
    out.triangles.push([a, b, out.points.len() - 1]);
    out
}

/// Two cubes with a common edge, whose points are shared.
fn shared_edge(r: &mut Random) -> Surface {
    let mut out = cuboid([0.0; 3], [1.0; 3]);
    out.add(&cuboid([1.0, 1.0, 0.0], [2.0, 1.5 + r.unit(), 1.0]));
    let twin = |v: usize| out.points.iter().position(|p| *p == out.points[v]).unwrap_or(v);
    let triangles = out.triangles.iter().map(|t| t.map(twin)).collect();
    let out = Surface { triangles, ..out };
    out.with_triangles(&vec![true; out.triangles.len()])
}

/// Two closed surfaces that overlap in part.
fn intersecting(r: &mut Random) -> Surface {
    let mut out = sphere(3 + r.below(5));
    let shift = along([0.0; 3], r.direction(), r.between(0.3, 1.2));
    out.add(&sphere(3 + r.below(5)).map(|p| along(p, shift, 1.0)));
    out
}

/// Sphere with one vertex far beyond the opposite side.
fn pushed(r: &mut Random) -> Surface {
    let mut out = sphere(4 + r.below(6));
    let vertex = r.below(out.points.len());
    out.points[vertex] = out.points[vertex].map(|x| -3.0 * x + 0.01);
    out
}

/// Cube whose cavity touches one side exactly.
fn shared_side() -> Surface {
    let mut out = cuboid([0.0; 3], [1.0; 3]);
    out.add(&cuboid([0.0, 0.25, 0.25], [0.5, 0.75, 0.75]).inverted());
    out
}

/// Triangles between random points.
fn random(r: &mut Random) -> Surface {
    let points: Vec<_> = (0..4 + r.below(20)).map(|_| along([0.0; 3], r.direction(), r.unit())).collect();
    let mut out = Surface { points, ..Surface::default() };
    // An odd number of triangles is never closed.
    for _ in 0..5 + 2 * r.below(20) {
        let first = r.below(out.points.len());
        let [b, c] = [1, 2].map(|step| (first + step) % out.points.len());
        out.triangles.push([first, b, c]);
    }
    out
}

/// Closed surface with two triangles of area zero at a point on an edge.
fn flat(r: &mut Random) -> Surface {
    let mut out = cuboid([0.0; 3], [2.0; 3]);
    out.points.push([r.pick(&[0.5, 1.0, 1.5]), 0.0, 0.0]);
    out.triangles.extend([[0, 8, 1], [0, 1, 8]]);
    out
}

/// Closed surface with NaN or infinity, or a number outside the range of exact predicates.
fn not_finite(r: &mut Random) -> Case {
    let mut surface = closed(r);
    let vertex = r.below(surface.points.len());
    surface.points[vertex][r.below(3)] = r.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300]);
    refused(surface)
}

/// File whose triangle names a vertex that does not exist.
fn out_of_range(r: &mut Random) -> Case {
    let surface = closed(r);
    let text = surface.off();
    let (head, last) = text.trim_end().rsplit_once(' ').unwrap_or((&text, ""));
    let wrong = r.pick(&["4294967295", "-1", "99999", "18446744073709551616", "1.5", last.trim_start_matches('0')]);
    let wrong = if wrong == last { "77777" } else { wrong };
    Case::new(Input::Text(format!("{head} {wrong}\n")), Expect::Refused)
}
