//! Smoothing of measured centrelines within a bound.
//!
//! Segmentation moves centreline points by a fraction of a voxel. At point spacings below half a radius such noise has
//! no meaning. Each point moves to the mean of the line over one radius, applied twice. Bends are kept by a correction
//! with the mean of the residual (Tukey's twicing, 'Exploratory Data Analysis', 1977). Displacements are bounded by a
//! fraction of the radius.

use anastomesh_mesh::geometry::Point3;
use nalgebra::Vector4;

/// Half width of the averaging window, in radii.
const REACH: f64 = 0.5;

/// Position and radius along a line.
type Values = Vec<Vector4<f64>>;

/// Smooths a line with fixed ends: positions by at most `bounds[0]` radii, radii by at most `bounds[1]` of their value.
pub(super) fn smoothed(points: &[Point3], radii: &[f64], bounds: [f64; 2]) -> (Vec<Point3>, Vec<f64>) {
    let arc = arc_lengths(points);
    let half = half_widths(&arc, radii);
    // Coordinates relative to the start avoid loss of precision far from the origin.
    let given: Values = points.iter().zip(radii).map(|(p, r)| (p - points[0]).push(*r)).collect();
    let mean = |values: &Values| means(&means(values, &arc, &half), &arc, &half);
    let once = mean(&given);
    let rest: Values = given.iter().zip(&once).map(|(g, m)| g - m).collect();
    let corrections = mean(&rest);
    let moved = (0..points.len()).map(|i| {
        if half[i] == 0.0 {
            return (points[i], radii[i]);
        }
        let change = once[i] + corrections[i] - given[i];
        let (shift, widen) = (change.xyz(), change.w);
        let (most, widest) = (bounds[0] * radii[i], bounds[1] * radii[i]);
        let share = (most / shift.norm()).min(1.0);
        (points[i] + shift * share, radii[i] + widen.clamp(-widest, widest))
    });
    moved.unzip()
}

fn arc_lengths(points: &[Point3]) -> Vec<f64> {
    let mut arc = vec![0.0];
    arc.extend(points.windows(2).scan(0.0, |sum, p| {
        *sum += (p[1] - p[0]).norm();
        Some(*sum)
    }));
    arc
}

/// Half width of the averaging window of each point; zero if its neighbours are further away.
fn half_widths(arc: &[f64], radii: &[f64]) -> Vec<f64> {
    let last = arc.len() - 1;
    let half = |i: usize| {
        if i == 0 || i == last {
            return 0.0;
        }
        let half = (REACH * radii[i]).min(arc[i]).min(arc[last] - arc[i]);
        let wide = (arc[i + 1] - arc[i]).max(arc[i] - arc[i - 1]);
        if wide < half { half } else { 0.0 }
    };
    (0..=last).map(half).collect()
}

/// Mean of the piecewise linear values over each point's window.
fn means(values: &Values, arc: &[f64], half: &[f64]) -> Values {
    let mut sums = vec![Vector4::zeros()];
    for i in 1..values.len() {
        sums.push(sums[i - 1] + (values[i - 1] + values[i]) * (0.5 * (arc[i] - arc[i - 1])));
    }
    let integral = |s: f64| {
        let i = arc.partition_point(|&a| a <= s).clamp(1, arc.len() - 1);
        let (from, length) = (s - arc[i - 1], arc[i] - arc[i - 1]);
        let share = if length > 0.0 { from / length } else { 0.0 };
        sums[i - 1] + (values[i - 1] + (values[i] - values[i - 1]) * (0.5 * share)) * from
    };
    let mean = |i: usize| match half[i] {
        0.0 => values[i],
        h => (integral(arc[i] + h) - integral(arc[i] - h)) / (2.0 * h),
    };
    (0..values.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers between -1 and 1.
    fn noise(i: usize) -> f64 {
        libm::sin(i as f64 * 12.9898) * 43758.5453 % 1.0
    }

    /// A noisy bend of three radii: points and radii.
    fn bend(amplitude: f64) -> (Vec<Point3>, Vec<f64>) {
        let at = |i: usize| {
            let (angle, off) = (i as f64 * 0.02, 3.0 + amplitude * noise(i));
            Point3::new(off * libm::cos(angle), off * libm::sin(angle), amplitude * noise(i + 1000))
        };
        ((0..=100).map(at).collect(), (0..=100).map(|i| 1.0 + amplitude * noise(i + 2000)).collect())
    }

    fn off_circle(points: &[Point3]) -> f64 {
        let off = |p: &Point3| libm::hypot(libm::hypot(p.x, p.y) - 3.0, p.z);
        points.iter().map(off).sum::<f64>() / points.len() as f64
    }

    #[test]
    fn noise_goes_and_bends_stay() {
        let (points, radii) = bend(0.02);
        let (smooth, even) = smoothed(&points, &radii, [0.025, 0.03]);
        assert!(off_circle(&smooth) < 0.4 * off_circle(&points), "{} {}", off_circle(&smooth), off_circle(&points));
        let uneven = |r: &[f64]| r.iter().map(|r| (r - 1.0).abs()).sum::<f64>();
        assert!(uneven(&even) < 0.4 * uneven(&radii));
        let (points, radii) = bend(0.0);
        let bent = off_circle(&smoothed(&points, &radii, [0.025, 0.01]).0);
        assert!(bent < 2e-3, "{bent}");
    }

    #[test]
    fn nothing_moves_further_than_its_bound_and_ends_stay() {
        let (points, radii) = bend(0.3);
        let (smooth, even) = smoothed(&points, &radii, [0.025, 0.01]);
        for i in 0..points.len() {
            assert!((smooth[i] - points[i]).norm() <= 0.025 * radii[i] * (1.0 + 1e-12));
            assert!((even[i] - radii[i]).abs() <= 0.01 * radii[i] * (1.0 + 1e-12));
        }
        assert_eq!((smooth[0], smooth[100]), (points[0], points[100]));
    }

    #[test]
    fn lines_of_few_points_stay() {
        let points: Vec<Point3> = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]].map(Point3::from).to_vec();
        assert_eq!(smoothed(&points, &[1.0; 3], [0.025, 0.01]), (points, vec![1.0; 3]));
    }
}
