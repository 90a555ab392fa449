//! Edge lengths requested at points in space, for example by an error estimate on an earlier mesh.

use super::course::{Course, Way};
use super::fine_place::{FinePlace, LEAST_SIZE};
use super::resolution::GROWTH;
use anastomesh_mesh::geometry::{Point3, Section};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::Arc;
use xxhash_rust::xxh3::Xxh3;

/// Mean edge length of a mesh with resolution ρ, in R / ρ for a vessel of radius R.
const USUAL: f64 = 1.93;
/// Maximum factor at which edges are made shorter. Smaller differences are within the scatter of edge lengths.
const SHORTER: f64 = 0.9;
/// Points that belong to a section, in its radii: distance from its plane, and from its axis.
const SLAB: f64 = 0.5;
const ACROSS: f64 = 1.25;
/// Distance of adjacent stations in radii.
const STEP: f64 = 1.0;
/// Maximum number of stations along a vessel.
const MOST_STATIONS: f64 = 1e5;

/// Edge lengths requested at points in space.
///
/// ```
/// use anastomesh_mesh::Point3;
/// use anastomesh_skeleton::SizeField;
///
/// let points = [Point3::new(0.0, 0.0, 0.0), Point3::new(0.0, 0.0, 1.0)];
/// let field = SizeField::new("size", &points, &[0.1, 0.2])?;
/// assert_eq!(field.len(), 2);
/// assert!(SizeField::new("size", &points, &[0.1, -0.2]).is_err());
/// # Ok::<(), anastomesh_skeleton::SizeFieldError>(())
/// ```
#[derive(Clone, Serialize)]
pub struct SizeField {
    /// Name of the array.
    array: String,
    #[serde(skip)]
    samples: Arc<Samples>,
    /// Hash of points and lengths.
    digest: String,
}

struct Samples {
    tree: ImmutableKdTree<f64, 3>,
    points: Vec<Point3>,
    lengths: Vec<f64>,
}

/// Reasons why points and lengths are no size field.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SizeFieldError {
    /// There are no points, or another number of lengths.
    #[error("{points} points with {lengths} edge lengths: give one length for each point")]
    Count {
        /// Number of points.
        points: usize,
        /// Number of lengths.
        lengths: usize,
    },
    /// A length is not usable.
    #[error("number {} has the edge length {value}: give finite lengths above zero", index + 1)]
    Length {
        /// Index of the length.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A coordinate is infinite or NaN.
    #[error("point {} has a coordinate that is not finite", index + 1)]
    Point {
        /// Index of the point.
        index: usize,
    },
}

impl SizeField {
    /// Creates a field from points and the edge lengths requested there, in the unit of the network.
    ///
    /// # Errors
    /// No points, another number of lengths, or a value that is not finite or a length that is not above zero.
    pub fn new(array: &str, points: &[Point3], lengths: &[f64]) -> Result<Self, SizeFieldError> {
        let counts = SizeFieldError::Count { points: points.len(), lengths: lengths.len() };
        if points.is_empty() || points.len() != lengths.len() {
            return Err(counts);
        }
        if let Some(index) = lengths.iter().position(|&value| !(value > 0.0 && value.is_finite())) {
            return Err(SizeFieldError::Length { index, value: lengths[index] });
        }
        if let Some(index) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(SizeFieldError::Point { index });
        }
        let mut hash = Xxh3::new();
        for value in points.iter().flat_map(|p| p.iter()).chain(lengths) {
            hash.update(&value.to_bits().to_le_bytes());
        }
        let places: Vec<[f64; 3]> = points.iter().map(|&p| p.into()).collect();
        let tree = ImmutableKdTree::new_from_slice(&places).map_err(|_| counts)?;
        let samples = Arc::new(Samples { tree, points: points.to_vec(), lengths: lengths.to_vec() });
        Ok(Self { array: array.to_owned(), samples, digest: format!("{:032x}", hash.digest128()) })
    }

    /// Name of the array.
    pub fn array(&self) -> &str {
        &self.array
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.samples.points.len()
    }

    /// True without points, which no field is.
    pub fn is_empty(&self) -> bool {
        self.samples.points.is_empty()
    }

    /// Edge length requested in a section of a vessel: the lower quartile over the points nearby. `None` without points.
    pub fn in_section(&self, section: &Section) -> Option<f64> {
        let Samples { tree, points, lengths } = &*self.samples;
        let reach = section.radius * libm::hypot(SLAB, ACROSS);
        let place = section.origin.into();
        let near = tree.query(&place).within::<SquaredEuclidean<f64>>(reach * reach).unsorted().execute();
        let is_inside = |index: &usize| {
            let (height, away) = (section.height(&points[*index]), points[*index] - section.origin);
            height.abs() <= SLAB * section.radius && (away - section.axis * height).norm() <= ACROSS * section.radius
        };
        let near = near.into_iter().map(|found| found.item as usize).filter(is_inside);
        let mut found: Vec<f64> = near.map(|index| lengths[index]).collect();
        let quarter = found.len() / 4;
        (!found.is_empty()).then(|| *found.select_nth_unstable_by(quarter, f64::total_cmp).1)
    }

    /// Edge length requested at the nearest point; the shortest one if several are as near.
    pub fn nearest(&self, p: &Point3) -> f64 {
        let Samples { tree, points, lengths } = &*self.samples;
        let place = (*p).into();
        let nearest = tree.query(&place).nearest_one::<SquaredEuclidean<f64>>().execute().item as usize;
        let as_near = (points[nearest] - p).norm_squared() * (1.0 + 1e-9);
        let near = tree.query(&place).within::<SquaredEuclidean<f64>>(as_near).unsorted().execute();
        near.into_iter().map(|found| lengths[found.item as usize]).fold(lengths[nearest], f64::min)
    }

    /// Places along a vessel where edges shorter than those of the resolution `rho` are requested.
    pub fn stations(&self, branch: u32, course: &Course, rho: f64) -> Vec<FineStation> {
        let (mut found, mut arc) = (Vec::new(), 0.0);
        let shortest_step = course.length() / MOST_STATIONS;
        loop {
            let section = course.section(arc, Way::Onward);
            let step = (STEP * section.radius).max(shortest_step);
            let usual = USUAL * section.radius / rho;
            let asked = self.in_section(&section).map_or(1.0, |length| length / usual);
            if asked < SHORTER {
                let within = libm::hypot(section.radius, 0.5 * step);
                let place = FinePlace { at: section.origin, within, factor: asked.max(LEAST_SIZE) };
                found.push(FineStation { branch, arc, usual, asked, place });
            }
            if arc >= course.length() {
                return found;
            }
            arc = (arc + step).min(course.length());
        }
    }
}

/// A place along a vessel with shorter edges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FineStation {
    /// Index of the branch.
    pub branch: u32,
    /// Arc length along the branch.
    pub arc: f64,
    /// Mean edge length of the resolution.
    pub usual: f64,
    /// Requested factor on it, before it is limited to [`LEAST_SIZE`].
    pub asked: f64,
    /// The place with its factor.
    pub place: FinePlace,
}

impl FineStation {
    /// Distance beyond which edges have the length of the resolution.
    pub fn reach(&self) -> f64 {
        self.place.within + (1.0 - self.place.factor) * self.usual / GROWTH
    }
}

impl fmt::Debug for SizeField {
    // Cache keys contain fields in this form, so the hash stands for the values.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "SizeField({}, {})", self.array, self.digest)
    }
}

impl PartialEq for SizeField {
    fn eq(&self, other: &Self) -> bool {
        self.array == other.array && self.digest == other.digest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::network;
    use anastomesh_mesh::geometry::Vec3;

    /// Points on the axis from 0 to 20, with short lengths between 8 and 12.
    fn field() -> SizeField {
        let points: Vec<Point3> = (0..=80).map(|i| Point3::new(0.0, 0.0, 0.25 * f64::from(i))).collect();
        let lengths: Vec<f64> = points.iter().map(|p| if (p.z - 10.0).abs() <= 2.0 { 0.3 } else { 0.9 }).collect();
        SizeField::new("size", &points, &lengths).expect("lengths")
    }

    #[test]
    fn a_section_takes_the_lower_quartile_of_the_points_nearby() {
        let section = |z| Section::new(Point3::new(0.0, 0.0, z), Vec3::z(), 1.0);
        assert_eq!([5.0, 10.0, 12.25].map(|z| field().in_section(&section(z))), [Some(0.9), Some(0.3), Some(0.3)]);
        assert_eq!(field().in_section(&section(-3.0)), None);
        assert_eq!(field().nearest(&Point3::new(5.0, 0.0, 11.0)), 0.3);
    }

    #[test]
    fn stations_lie_where_the_field_is_short() {
        let skeleton = network(&[[0.0, 0.0, 0.0], [0.0, 0.0, 20.0]], 1.0, &[(0, 1)]);
        let chains = skeleton.chains(&skeleton.adjacency());
        let course = Course::new(&skeleton, chains.branch(&skeleton, 0));
        let stations = |rho| field().stations(0, &course, rho);
        let arcs = |rho| stations(rho).iter().map(|s| s.arc).collect::<Vec<_>>();
        // With ρ = 3 edges have a length of 0.64, with ρ = 6 of 0.32.
        assert_eq!(arcs(3.0), [8.0, 9.0, 10.0, 11.0, 12.0]);
        assert_eq!(arcs(6.0), [0.0; 0]);
        let place = stations(3.0)[0].place;
        assert!((place.factor - 0.3 * 3.0 / USUAL).abs() < 1e-12 && place.within > 1.0);
    }

    #[test]
    fn bad_values_are_named() {
        let p = [Point3::origin(), Point3::new(1.0, 0.0, 0.0)];
        assert!(matches!(SizeField::new("s", &p, &[1.0]), Err(SizeFieldError::Count { points: 2, lengths: 1 })));
        assert!(matches!(SizeField::new("s", &[], &[]), Err(SizeFieldError::Count { points: 0, .. })));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(SizeField::new("s", &p, &[1.0, bad]), Err(SizeFieldError::Length { index: 1, .. })));
        }
        let far = [Point3::origin(), Point3::new(f64::NAN, 0.0, 0.0)];
        assert_eq!(SizeField::new("s", &far, &[1.0; 2]), Err(SizeFieldError::Point { index: 1 }));
    }
}
