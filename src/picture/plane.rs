//! Cutting plane.

use super::camera::Camera;
use super::outline::Outline;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Plane; everything on the side of its normal is removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub normal: Vec3,
    pub offset: f64,
}

impl Plane {
    /// Distance behind the plane; negative for removed points.
    #[inline]
    pub fn behind(&self, place: &Point3) -> f64 {
        self.offset - place.coords.dot(&self.normal)
    }
}

/// Requested plane: normal to an axis, or to the view direction if `axis` is `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneWish {
    pub axis: Option<Vec3>,
    pub place: Place,
}

/// Position of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At the centre of the picture.
    Middle,
    /// At a fraction of the object's extent, 0 to 1.
    Share(f64),
    /// At a coordinate.
    Coordinate(f64),
}

impl std::str::FromStr for PlaneWish {
    type Err = String;

    /// Parses `x`, `-y`, `z:12.5`, `x:40%`, `view`, `view:60%`.
    fn from_str(text: &str) -> Result<Self, String> {
        let help = "give x, y, z, -x, -y, -z or view, and where it is not to be in the middle a coordinate or a share: x:12.5, view:40%";
        let (axis, place) = text.split_once(':').map_or((text, None), |(axis, place)| (axis, Some(place)));
        let axis = match axis {
            "x" => Some(Vec3::x()),
            "y" => Some(Vec3::y()),
            "z" => Some(Vec3::z()),
            "-x" => Some(-Vec3::x()),
            "-y" => Some(-Vec3::y()),
            "-z" => Some(-Vec3::z()),
            "view" => None,
            _ => return Err(help.into()),
        };
        let number = |text: &str| text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or(help);
        let place = match place {
            None => Place::Middle,
            Some(place) => match place.strip_suffix('%') {
                Some(share) => Place::Share(number(share)? / 100.0),
                None => Place::Coordinate(number(place)?),
            },
        };
        Ok(Self { axis, place })
    }
}

impl PlaneWish {
    /// Resolves the plane for a camera and an object.
    pub fn plane(&self, camera: &Camera, outline: &Outline) -> Plane {
        // `x` removes the viewer's side, `-x` the other one.
        let facing = |axis: Vec3| if axis.abs().dot(&camera.towards) < 0.0 { -axis } else { axis };
        let normal = self.axis.map_or(camera.towards, facing);
        let offset = match self.place {
            Place::Middle => camera.centre.coords.dot(&normal),
            Place::Share(share) => {
                // The fraction is measured along the positive axis, whichever side is removed.
                let share = if normal.sum() < 0.0 && self.axis.is_some() { 1.0 - share } else { share };
                let [low, high] = outline.range(normal);
                low + share * (high - low)
            }
            // Coordinates of `-x` are those of x.
            Place::Coordinate(c) if self.axis.is_some() => c * normal.sum(),
            Place::Coordinate(c) => c,
        };
        Plane { normal, offset }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Direction;

    #[test]
    fn the_viewers_side_goes() {
        let mut outline = Outline::for_points(2);
        outline.add(&Point3::new(-1.0, -1.0, -1.0));
        outline.add(&Point3::new(1.0, 1.0, 1.0));
        for (azimuth, near) in [(0.0, -1.0), (180.0, 1.0)] {
            let camera = Camera::new(Direction::by_angles(azimuth, 0.0), &outline, [10, 10], 1.0, None);
            let behind = |text: &str| {
                text.parse::<PlaneWish>().unwrap().plane(&camera, &outline).behind(&Point3::new(0.0, near, 0.0))
            };
            assert!(behind("y") < 0.0 && behind("-y") > 0.0);
        }
    }

    #[test]
    fn planes_are_read_and_placed() {
        let mut outline = Outline::for_points(2);
        outline.add(&Point3::new(0.0, 0.0, 0.0));
        outline.add(&Point3::new(10.0, 2.0, 1.0));
        let camera = Camera::new(Direction::by_angles(0.0, 0.0), &outline, [10, 10], 1.0, None);
        let behind = |text: &str, x: f64| {
            text.parse::<PlaneWish>().unwrap().plane(&camera, &outline).behind(&Point3::new(x, 0.5, 0.5))
        };
        for (text, x) in [("x", 5.0), ("x:40%", 4.0), ("-x:40%", 4.0), ("x:7", 7.0), ("-x:7", 7.0)] {
            let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
            assert!(behind(text, x).abs() < 1e-12 && (behind(text, x - 1.0) - sign).abs() < 1e-12, "{text}");
        }
        assert!((behind("view", 0.0) + 0.5).abs() < 1e-12);
        for wrong in ["", "w", "x:", "x:%", "x:1e999", "x:nan", "view:a"] {
            assert!(wrong.parse::<PlaneWish>().is_err(), "{wrong}");
        }
    }
}
