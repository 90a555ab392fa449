//! The way of a connector from plane to plane.

use anastomesh_mesh::geometry::{Section, Vec3};
use anastomesh_skeleton::course::{Course, Way};

/// Distance of sections on a vessel that turns, in radii.
const SPACING: f64 = 0.75;
/// What a section may add to its neighbours to be left out: a share of the radius, an angle in radians.
const TOLERANCE: f64 = 0.01;
/// Sections that one step of the simplification looks over at most.
const LOOK_AHEAD: usize = 64;
/// Sections of a path at most, before simplification.
const SECTIONS: f64 = 4096.0;

/// Sections from the plane at `planes[0]` to that at `planes[1]`, axes along the branch.
pub(super) fn path(course: &Course, planes: [f64; 2]) -> Vec<Section> {
    let first = course.section(planes[0], Way::Onward);
    let mut last = course.section(planes[1], Way::Back);
    last.axis = -last.axis;
    let mut sections = Vec::with_capacity(2);
    sections.push(first);
    if course.has_node_between(planes[0], planes[1]) {
        sections.extend(stations(course, planes).into_iter().map(|s| Section {
            origin: course.point(s),
            axis: course.tangent(s),
            radius: 0.5 * (course.radius(s, Way::Onward) + course.radius(s, Way::Back)),
        }));
        sections.push(last);
        return simplified(&sections);
    }
    sections.push(last);
    sections
}

/// Evenly spread arc lengths strictly between the planes.
fn stations(course: &Course, [lo, hi]: [f64; 2]) -> Vec<f64> {
    let mut list = Vec::new();
    let mut s = lo;
    while s < hi {
        s += (SPACING * course.radius(s, Way::Back)).max((hi - lo) / SECTIONS);
        list.push(s);
    }
    // Stretched or shrunk so that the last one is the second plane, which is nearer by: that many less or not.
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

/// Leaves out sections that lie where interpolation between their neighbours puts them.
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

/// Whether all but the first and last section may be left out.
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
