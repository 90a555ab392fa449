//! Path of a connector from plane to plane.

use anastomesh_mesh::geometry::{Section, Vec3};
use anastomesh_skeleton::course::{Course, Way};

/// Section spacing on a curved vessel, in radii.
const SPACING: f64 = 0.75;
/// Tolerance for omitting a section: a fraction of the radius, and an angle in radians.
const TOLERANCE: f64 = 0.01;
/// Maximum number of sections that one simplification step examines.
const LOOK_AHEAD: usize = 64;
/// Maximum number of sections in a path before simplification.
const SECTIONS: f64 = 4096.0;

/// Returns sections from the plane at `planes[0]` to that at `planes[1]`, with axes along the branch.
pub(super) fn path(course: &Course, planes: [f64; 2]) -> Vec<Section> {
    let first = course.section(planes[0], Way::Onward);
    let mut last = course.section(planes[1], Way::Back);
    last.axis = -last.axis;
    let mut sections = Vec::with_capacity(2);
    sections.push(first);
    if course.has_node_between(planes[0], planes[1]) {
        sections.extend(stations(course, planes).into_iter().map(|s| {
            let radius = 0.5 * (course.radius(s, Way::Onward) + course.radius(s, Way::Back));
            Section::new(course.point(s), course.tangent(s), radius)
        }));
        sections.push(last);
        return simplified(&sections);
    }
    sections.push(last);
    sections
}

/// Returns evenly spaced arc lengths strictly between the planes.
fn stations(course: &Course, [lo, hi]: [f64; 2]) -> Vec<f64> {
    let mut list = Vec::new();
    let mut s = lo;
    while s < hi {
        s += (SPACING * course.radius(s, Way::Back)).max((hi - lo) / SECTIONS);
        list.push(s);
    }
    // The spacing is scaled so that the last station coincides with the second plane, then that station is dropped.
    if list.len() > 1 && s - hi > 0.5 * SPACING * course.radius(hi, Way::Onward) {
        list.pop();
        s = list[list.len() - 1];
    }
    list.pop();
    let scale = (hi - lo) / (s - lo);
    for x in &mut list {
        *x = lo + (*x - lo) * scale;
    }
    list
}

/// Omits sections that interpolation between their neighbours reproduces.
fn simplified(sections: &[Section]) -> Vec<Section> {
    let mut kept = vec![sections[0]];
    let mut i = 0;
    while i + 1 < sections.len() {
        let mut next = i + 1;
        while next + 1 < sections.len() && next - i < LOOK_AHEAD && redundant(&sections[i..=next + 1]) {
            next += 1;
        }
        kept.push(sections[next]);
        i = next;
    }
    kept.shrink_to_fit();
    kept
}

/// True if all sections but the first and last are redundant.
fn redundant(sections: &[Section]) -> bool {
    let (a, b) = (&sections[0], &sections[sections.len() - 1]);
    let span = b.origin - a.origin;
    let square = span.norm_squared();
    sections[1..sections.len() - 1].iter().all(|s| {
        let t = (s.origin - a.origin).dot(&span) / square;
        let axis: Vec3 = a.axis + (b.axis - a.axis) * t;
        let radius = a.radius + (b.radius - a.radius) * t;
        let tolerance = TOLERANCE * s.radius;
        t > 0.0
            && t < 1.0
            && (s.origin - (a.origin + span * t)).norm() <= tolerance
            && (s.radius - radius).abs() <= tolerance
            && s.axis.cross(&axis).norm() <= TOLERANCE
    })
}
