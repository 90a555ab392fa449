//! Orthographic camera: lengths can be measured in the picture.

use super::outline::Outline;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// View direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Direction {
    /// Across the two longest axes of the object, which shows most of it.
    #[default]
    Broadside,
    /// From the direction `towards` of the object, with `up` upwards.
    From { towards: Vec3, up: Vec3 },
}

impl Direction {
    /// Direction from angles in degrees: around the z axis from −y, and above the xy plane.
    pub fn by_angles(azimuth: f64, elevation: f64) -> Self {
        let (a, e) = (azimuth.to_radians(), elevation.to_radians());
        let towards = Vec3::new(libm::cos(e) * libm::sin(a), -libm::cos(e) * libm::cos(a), libm::sin(e));
        // Derivative by the elevation, defined also for a view from above.
        let up = Vec3::new(-libm::sin(e) * libm::sin(a), libm::sin(e) * libm::cos(a), libm::cos(e));
        Self::From { towards, up }
    }
}

/// Camera with a picture size in samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    right: Vec3,
    up: Vec3,
    /// Direction from the object to the viewer.
    pub towards: Vec3,
    /// Point at the centre of the picture.
    pub centre: Point3,
    /// Samples per unit of length.
    pub scale: f64,
    /// Picture size in samples.
    pub size: [usize; 2],
}

/// Fraction of the picture that the object fills.
const FILLED: f64 = 0.94;

impl Camera {
    /// Creates a camera that shows the whole object, magnified by `zoom` and centred on `at` if given.
    pub fn new(direction: Direction, outline: &Outline, size: [usize; 2], zoom: f64, at: Option<Point3>) -> Self {
        let (towards, up) = match direction {
            Direction::Broadside => outline.broadside(),
            Direction::From { towards, up } => (towards.normalize(), up),
        };
        let right = up.cross(&towards).normalize();
        let up = towards.cross(&right);
        let [across, upwards, deep] = [right, up, towards].map(|axis| outline.range(axis));
        let middle = |[low, high]: [f64; 2]| f64::midpoint(low, high);
        let centre = Point3::from(right * middle(across) + up * middle(upwards) + towards * middle(deep));
        let fits =
            |[low, high]: [f64; 2], samples: usize| FILLED * samples as f64 / (high - low).max(f64::MIN_POSITIVE);
        let scale = fits(across, size[0]).min(fits(upwards, size[1]));
        // An object without extent is shown like one of unit size.
        let scale = if scale.is_finite() && scale < 1e300 { scale } else { FILLED * size[0].min(size[1]) as f64 };
        Self { right, up, towards, centre: at.unwrap_or(centre), scale: zoom * scale, size }
    }

    /// Projects a point: samples from the left, from the top, and towards the viewer.
    #[inline]
    pub fn project(&self, place: &Point3) -> [f64; 3] {
        let v = place - self.centre;
        let [width, height] = self.size.map(|n| 0.5 * n as f64);
        [
            width + self.scale * v.dot(&self.right),
            height - self.scale * v.dot(&self.up),
            self.scale * v.dot(&self.towards),
        ]
    }

    /// Direction in view coordinates: right, up, towards the viewer.
    #[inline]
    pub fn turned(&self, v: &Vec3) -> [f64; 3] {
        [v.dot(&self.right), v.dot(&self.up), v.dot(&self.towards)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_axis_lies_across_and_all_is_in_the_picture() {
        let mut outline = Outline::for_points(8);
        for (i, z) in [0.0, 9.0, 20.0, 29.0].into_iter().enumerate() {
            outline.add(&Point3::new(0.3, 4.0 * (i % 2) as f64, z));
            outline.add(&Point3::new(-0.3, 2.0, z));
        }
        let camera = Camera::new(Direction::Broadside, &outline, [300, 200], 1.0, None);
        assert!(camera.towards.x.abs() > 0.9);
        for p in outline.points() {
            let [x, y, _] = camera.project(p);
            assert!((0.0..=300.0).contains(&x) && (0.0..=200.0).contains(&y));
        }
        let ends = [0.0, 29.0].map(|z| camera.project(&Point3::new(0.3, 0.0, z))[0]);
        assert!((ends[0] - ends[1]).abs() > 250.0);
    }

    #[test]
    fn angles_are_measured_from_the_front() {
        let Direction::From { towards, up } = Direction::by_angles(0.0, 0.0) else { panic!("angles") };
        assert!((towards - Vec3::new(0.0, -1.0, 0.0)).norm() < 1e-12 && (up - Vec3::z()).norm() < 1e-12);
        let Direction::From { towards, up } = Direction::by_angles(0.0, 90.0) else { panic!("angles") };
        assert!((towards - Vec3::z()).norm() < 1e-12 && (up - Vec3::y()).norm() < 1e-12);
    }
}
