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

#[cfg(test)]
mod tests {
    use super::super::tests::polyline;
    use super::*;
    use anastomesh_mesh::geometry::Point3;
    use anastomesh_skeleton::course::Courses;

    /// Section at `x` whose radius and axis are between those of two others.
    fn section(x: f64, aside: f64, radius: f64, turn: f64) -> Section {
        Section::new(Point3::new(x, aside, 0.0), Vec3::new(1.0, turn, 0.0), radius)
    }

    #[test]
    fn sections_are_redundant_within_a_hundredth() {
        // Halfway: radius 3, and an axis turned by 0.1.
        let (a, b) = (section(0.0, 0.0, 2.0, 0.0), section(8.0, 0.0, 4.0, 0.2));
        let is = |middle: Section| redundant(&[a, middle, b]);
        assert!(is(section(4.0, 0.0, 3.0, 0.1)));
        assert!(is(section(2.0, 0.0, 2.5, 0.05)));
        assert!(is(section(4.0, 0.029, 3.0, 0.1)) && !is(section(4.0, 0.031, 3.0, 0.1)));
        assert!(is(section(4.0, 0.0, 3.029, 0.1)) && !is(section(4.0, 0.0, 3.031, 0.1)));
        assert!(is(section(4.0, 0.0, 2.971, 0.1)) && !is(section(4.0, 0.0, 2.969, 0.1)));
        assert!(is(section(4.0, 0.0, 3.0, 0.109)) && !is(section(4.0, 0.0, 3.0, 0.111)));
        // Before the first section, at it, and beyond the last one.
        assert!(!is(section(-0.5, 0.0, 1.875, -0.0125)));
        assert!(!is(section(0.0, 0.0, 2.0, 0.0)));
        assert!(!is(section(8.5, 0.0, 4.125, 0.2125)));
        // All inner sections count.
        assert!(!redundant(&[a, section(2.0, 0.5, 2.5, 0.05), section(4.0, 0.0, 3.0, 0.1), b]));
        assert!(!redundant(&[a, section(2.0, 0.0, 2.5, 0.05), section(4.0, 0.5, 3.0, 0.1), b]));
    }

    #[test]
    fn a_step_omits_63_sections_at_most() {
        let xs = |kept: Vec<Section>| kept.iter().map(|s| s.origin.x).collect::<Vec<f64>>();
        let straight: Vec<Section> = (0..200).map(|i| section(f64::from(i), 0.0, 1.0, 0.0)).collect();
        assert_eq!(xs(simplified(&straight)), [0.0, 64.0, 128.0, 192.0, 199.0]);
        // A corner stays.
        let bent: Vec<Section> =
            (0..=20).map(|i| section(f64::from(i), (f64::from(i) - 10.0).max(0.0), 1.0, 0.0)).collect();
        assert_eq!(xs(simplified(&bent)), [0.0, 10.0, 20.0]);
        assert_eq!(xs(simplified(&straight[..2])), [0.0, 1.0]);
    }

    #[test]
    fn stations_are_evenly_spaced_between_the_planes() {
        let mut skeleton = polyline([[0.0; 3], [10.0, 0.0, 0.0]]);
        skeleton.edges[0].radii = [0.5; 2];
        let chains = skeleton.chains(&skeleton.adjacency());
        let course = Courses { skeleton: &skeleton, chains: &chains }.get(0);
        // Three quarters of the radius: 0.375. The last interval is rounded to the nearest number of them.
        for (hi, intervals) in [(6.0, 11), (5.85, 10), (5.95, 11), (2.3, 1), (2.1, 1)] {
            let expected = (1..intervals).map(|i| 2.0 + (hi - 2.0) * f64::from(i) / f64::from(intervals));
            let found = stations(&course, [2.0, hi]);
            assert_eq!(found.len() + 1, intervals as usize, "{hi}");
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{hi}: {found:?}");
        }
    }

    #[test]
    fn a_path_has_4096_intervals_at_most() {
        let mut skeleton = polyline([[0.0; 3], [8192.0, 0.0, 0.0]]);
        skeleton.edges[0].radii = [0.5; 2];
        let chains = skeleton.chains(&skeleton.adjacency());
        let course = Courses { skeleton: &skeleton, chains: &chains }.get(0);
        // Intervals of a radius instead of three quarters.
        let found = stations(&course, [6144.0, 8192.0]);
        assert!(found.iter().zip(1..4096).all(|(s, i)| *s == 6144.0 + 0.5 * f64::from(i)) && found.len() == 4095);
    }
}
