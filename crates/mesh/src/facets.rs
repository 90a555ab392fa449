//! Triangulation of a flat facet with holes, segments and points inside, by constrained Delaunay triangulation of its
//! projection. No points are added.
//!
//! A facet is projected along the axis nearest to its normal. That drops a coordinate and rounds nothing, so predicates
//! on the projection are exact. A facet with corners off one plane is triangulated all the same.

use crate::geometry::predicates::in_exact_range;
use crate::geometry::{Point3, Vec3};
use spade::handles::{FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, Point2, PositionInTriangulation, Triangulation};

type Cdt = ConstrainedDelaunayTriangulation<Vertex>;

/// Length of normals, relative to the facet's squared extent, below which they do not define its plane.
const NO_NORMAL: f64 = 1e-9;

/// Triangulation of a facet.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FacetTriangles {
    /// Triangles with the orientation of the facet's first polygon.
    pub triangles: Vec<[u32; 3]>,
    /// Segments of the facet that no triangle has, smaller point first, ascending: they stick out of it.
    pub segments: Vec<[u32; 2]>,
}

/// Reason why a facet has no triangulation. Ids are those of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FacetError {
    /// Two of its segments cross between their ends.
    #[error(
        "its segments {} {} and {} {} cross: add their intersection point, or correct the polygons",
        first[0], first[1], second[0], second[1]
    )]
    Crossing {
        /// Ends of a segment.
        first: [u32; 2],
        /// Ends of (a part of) the other.
        second: [u32; 2],
    },
    /// Two of its points coincide, seen along the axis nearest to its normal.
    #[error("its points {} and {} coincide, or coincide in projection: keep one of them", points[0], points[1])]
    Coincident {
        /// The two points.
        points: [u32; 2],
    },
    /// It encloses nothing.
    #[error("it encloses no area: its corners lie on one line, or its polygons do not close")]
    NoArea,
    /// A coordinate is not finite, or out of range for exact arithmetic.
    #[error("the coordinates of its point {point} are not finite or out of the range of exact arithmetic")]
    OutOfRange {
        /// The point.
        point: u32,
    },
    /// A polygon refers to a missing point.
    #[error("it refers to the missing point {point}")]
    NoSuchPoint {
        /// Its index.
        point: u32,
    },
}

impl FacetError {
    /// Renames the points of the error.
    #[must_use]
    pub fn renamed(self, name: impl Fn(u32) -> u32) -> Self {
        match self {
            Self::Crossing { first, second } => Self::Crossing { first: first.map(&name), second: second.map(&name) },
            Self::Coincident { points } => Self::Coincident { points: points.map(&name) },
            Self::NoArea => Self::NoArea,
            Self::OutOfRange { point } => Self::OutOfRange { point: name(point) },
            Self::NoSuchPoint { point } => Self::NoSuchPoint { point: name(point) },
        }
    }
}

/// A point of the facet in projection.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    position: Point2<f64>,
    id: u32,
}

impl spade::HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// Triangulates the area enclosed by `polygons`: the part not reachable from outside or from one of `holes` without
/// crossing a segment. A polygon with two corners is a segment, one with one corner a required point. Corners are
/// joined in a ring; a segment with further points of the facet on it is split there.
///
/// # Errors
/// `FacetError`: segments cross, points coincide, or there is nothing inside.
pub fn triangulate(points: &[Point3], polygons: &[Vec<u32>], holes: &[Point3]) -> Result<FacetTriangles, FacetError> {
    let corners = polygons.iter().flatten();
    if let Some(&point) = corners.clone().find(|&&v| v as usize >= points.len()) {
        return Err(FacetError::NoSuchPoint { point });
    }
    if let Some(&point) = corners.clone().find(|&&v| !points[v as usize].iter().all(|&x| in_exact_range(x))) {
        return Err(FacetError::OutOfRange { point });
    }
    if let ([ring], []) = (polygons, holes)
        && let &[a, b, c] = ring.as_slice()
    {
        return Ok(FacetTriangles { triangles: vec![[a, b, c]], segments: Vec::new() });
    }
    let plane = Projection::of(points, polygons);
    let mut cdt = Cdt::new();
    let handles = insert_points(&mut cdt, points, corners.copied(), plane)?;
    let handle = |v: u32| handles.binary_search_by_key(&v, |entry| entry.0).ok().map(|at| handles[at].1);
    for ring in polygons {
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            if let (Some(from), Some(to)) = (handle(a), handle(b))
                && a != b
            {
                insert_segment(&mut cdt, from, to)?;
            }
        }
    }
    let outside = outside(&cdt, &holes.iter().map(|&hole| plane.project(hole)).collect::<Vec<_>>());
    let result = collect(&cdt, &outside, plane.turned);
    if result.triangles.is_empty() && polygons.iter().any(|ring| ring.len() > 2) && holes.is_empty() {
        return Err(FacetError::NoArea);
    }
    Ok(result)
}

/// Projection along an axis.
#[derive(Clone, Copy, Debug)]
struct Projection {
    axis: usize,
    /// True if the facet's normal points against the axis.
    turned: bool,
}

impl Projection {
    fn of(points: &[Point3], polygons: &[Vec<u32>]) -> Self {
        let corners = || polygons.iter().flatten().map(|&v| points[v as usize]);
        let first = corners().next().unwrap_or_else(Point3::origin);
        let extent = corners().map(|p| (p - first).norm()).fold(0.0, f64::max);
        let longest = |a: Vec3, b: Vec3| if b.norm() > a.norm() { b } else { a };
        let normals = polygons.iter().map(|ring| newell(points, ring));
        let mut normal = normals.clone().fold(Vec3::zeros(), longest);
        // A polygon whose parts cancel, or segments that enclose an area only together.
        if normal.norm() <= NO_NORMAL * extent * extent {
            let far = corners().map(|p| p - first).fold(Vec3::zeros(), longest);
            normal = corners().map(|p| far.cross(&(p - first))).fold(Vec3::zeros(), longest);
        }
        let axis = normal.iamax();
        let own = normals.map(|n| n[axis]).find(|&n| n != 0.0).unwrap_or(normal[axis]);
        Self { axis, turned: own < 0.0 }
    }

    /// Right-handed: orientation is that seen from the end of the axis.
    fn project(self, p: Point3) -> Point2<f64> {
        Point2::new(p[(self.axis + 1) % 3], p[(self.axis + 2) % 3])
    }
}

/// Twice the vector area of a polygon (Newell), relative to its first corner to limit cancellation.
fn newell(points: &[Point3], ring: &[u32]) -> Vec3 {
    let Some((&first, rest)) = ring.split_first() else { return Vec3::zeros() };
    let from = |v: u32| points[v as usize] - points[first as usize];
    rest.windows(2).map(|pair| from(pair[0]).cross(&from(pair[1]))).fold(Vec3::zeros(), |sum, n| sum + n)
}

/// Inserts each point once. Returns them with their handles, ascending.
fn insert_points(
    cdt: &mut Cdt,
    points: &[Point3],
    corners: impl Iterator<Item = u32>,
    plane: Projection,
) -> Result<Vec<(u32, FixedVertexHandle)>, FacetError> {
    let mut ids: Vec<u32> = corners.collect();
    ids.sort_unstable();
    ids.dedup();
    let mut handles = Vec::with_capacity(ids.len());
    for id in ids {
        let before = cdt.num_vertices();
        let position = plane.project(points[id as usize]);
        // −0 and 0 are equal.
        let position = Point2::new(position.x + 0.0, position.y + 0.0);
        if let Some(there) = vertex_at(cdt, position) {
            return Err(FacetError::Coincident { points: [there, id] });
        }
        let handle = cdt.insert(Vertex { position, id }).map_err(|_| FacetError::OutOfRange { point: id })?;
        if cdt.num_vertices() == before {
            return Err(FacetError::OutOfRange { point: id });
        }
        handles.push((id, handle));
    }
    Ok(handles)
}

/// Existing point at a position.
fn vertex_at(cdt: &Cdt, position: Point2<f64>) -> Option<u32> {
    match cdt.locate(position) {
        PositionInTriangulation::OnVertex(v) => Some(cdt.vertex(v).data().id),
        _ => None,
    }
}

fn insert_segment(cdt: &mut Cdt, from: FixedVertexHandle, to: FixedVertexHandle) -> Result<(), FacetError> {
    if cdt.can_add_constraint(from, to) {
        cdt.add_constraint(from, to);
        return Ok(());
    }
    let id = |v: FixedVertexHandle| cdt.vertex(v).data().id;
    let met = cdt.get_conflicting_edges_between_vertices(from, to).next();
    let second = met.map_or([id(from), id(to)], |edge| edge.vertices().map(|v| v.data().id));
    Err(FacetError::Crossing { first: [id(from), id(to)], second })
}

/// Marks the faces reachable from outside or from a hole without crossing a segment.
fn outside(cdt: &Cdt, holes: &[Point2<f64>]) -> Vec<bool> {
    let mut outside = vec![false; cdt.num_all_faces()];
    let mut front: Vec<FixedFaceHandle<InnerTag>> = Vec::new();
    for edge in cdt.convex_hull() {
        for side in [edge, edge.rev()] {
            if let Some(face) = side.face().as_inner()
                && !edge.is_constraint_edge()
            {
                front.push(face.fix());
            }
        }
    }
    for &hole in holes {
        if !(hole.x.is_finite() && hole.y.is_finite()) {
            continue;
        }
        match cdt.locate(hole) {
            PositionInTriangulation::OnFace(face) => front.push(face),
            PositionInTriangulation::OnEdge(edge) => {
                let edge = cdt.directed_edge(edge);
                if !edge.is_constraint_edge() {
                    for face in [edge.face(), edge.rev().face()] {
                        front.extend(face.as_inner().map(|face| face.fix()));
                    }
                }
            }
            _ => {}
        }
    }
    while let Some(face) = front.pop() {
        if std::mem::replace(&mut outside[face.index()], true) {
            continue;
        }
        for edge in cdt.face(face).adjacent_edges() {
            if let Some(other) = edge.rev().face().as_inner()
                && !edge.is_constraint_edge()
            {
                front.push(other.fix());
            }
        }
    }
    outside
}

fn collect(cdt: &Cdt, outside: &[bool], turned: bool) -> FacetTriangles {
    let mut result = FacetTriangles::default();
    for face in cdt.inner_faces().filter(|face| !outside[face.fix().index()]) {
        let [a, b, c] = face.vertices().map(|v| v.data().id);
        result.triangles.push(if turned { [a, c, b] } else { [a, b, c] });
    }
    for edge in cdt.undirected_edges().filter(|edge| edge.is_constraint_edge()) {
        let edge = edge.as_directed();
        let kept = |side: spade::handles::DirectedEdgeHandle<_, _, _, _>| {
            side.face().as_inner().is_some_and(|face| !outside[face.fix().index()])
        };
        if !kept(edge) && !kept(edge.rev()) {
            let [a, b] = edge.vertices().map(|v| v.data().id);
            result.segments.push([a.min(b), a.max(b)]);
        }
    }
    result.segments.sort_unstable();
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::triangle_area_vector;

    /// Points in the plane z = x / 2, which is not along an axis.
    fn tilted(plane: &[[f64; 2]]) -> Vec<Point3> {
        plane.iter().map(|&[x, y]| Point3::new(x, y, x / 2.0)).collect()
    }

    /// Area in projection along z, positive if all triangles face upwards.
    fn area(points: &[Point3], facet: &FacetTriangles) -> f64 {
        let areas = facet.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|v| points[v as usize]);
            triangle_area_vector(&a, &b, &c).z
        });
        assert!(areas.clone().all(|a| a > 0.0) || areas.clone().all(|a| a < 0.0));
        areas.sum()
    }

    fn square(low: f64, high: f64) -> [[f64; 2]; 4] {
        [[low, low], [high, low], [high, high], [low, high]]
    }

    #[test]
    fn rings_with_holes_segments_and_points() {
        let mut plane = square(0.0, 4.0).to_vec();
        plane.extend(square(1.0, 2.0));
        plane.push([3.0, 3.0]);
        let points = tilted(&plane);
        let rings = vec![vec![0, 1, 2, 3], vec![4, 5, 6, 7], vec![2, 6], vec![8]];
        let whole = triangulate(&points, &rings, &[]).unwrap();
        assert_eq!((whole.triangles.len(), area(&points, &whole)), (2 * 9 - 2 - 4, 16.0));
        let has =
            |facet: &FacetTriangles, a: u32, b: u32| facet.triangles.iter().any(|t| t.contains(&a) && t.contains(&b));
        // The point 8 lies on the segment 2 6 and splits it.
        assert!(has(&whole, 2, 8) && has(&whole, 8, 6) && !has(&whole, 2, 6));
        let hole = Point3::new(1.5, 1.25, 0.75);
        let holed = triangulate(&points, &rings, &[hole]).unwrap();
        assert_eq!(area(&points, &holed), 15.0);
        assert!(holed.segments.is_empty());
        // Reversed, and given as single segments.
        let turned = triangulate(&points, &[vec![3, 2, 1, 0]], &[]).unwrap();
        assert_eq!(area(&points, &turned), -16.0);
        let pieces = [vec![0, 1], vec![1, 2], vec![2, 3], vec![3, 0]];
        assert_eq!(area(&points, &triangulate(&points, &pieces, &[]).unwrap()).abs(), 16.0);
    }

    #[test]
    fn only_what_is_enclosed_is_filled() {
        // An L, and a segment that sticks out of it.
        let points = tilted(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0], [3.0, 3.0]]);
        let l = triangulate(&points, &[vec![0, 1, 2, 3, 4, 5], vec![6, 3]], &[]).unwrap();
        assert_eq!((area(&points, &l), l.segments), (3.0, vec![[3, 6]]));
        // A corner repeated in a row, and the first one repeated at the end.
        let same = triangulate(&points, &[vec![0, 1, 1, 2, 3, 4, 5, 0]], &[]).unwrap();
        assert_eq!(same.triangles, triangulate(&points, &[vec![0, 1, 2, 3, 4, 5]], &[]).unwrap().triangles);
        let segments = triangulate(&points, &[vec![0, 6], vec![3]], &[]).unwrap();
        assert_eq!(segments, FacetTriangles { triangles: vec![], segments: vec![[0, 3], [3, 6]] });
    }

    #[test]
    fn corners_need_not_lie_in_one_plane() {
        let points = [[0., 0., 0.], [0., 1., 0.1], [0., 1., 1.], [0.3, 0., 1.]].map(Point3::from);
        let quad = triangulate(&points, &[vec![0, 1, 2, 3]], &[]).unwrap();
        assert_eq!(quad.triangles.len(), 2);
        let normal: Vec3 = quad
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| points[v as usize]);
                triangle_area_vector(&a, &b, &c)
            })
            .sum();
        assert!(normal.x > 0.0);
    }

    #[test]
    fn faults_are_named() {
        let points = tilted(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [2.0, 2.0], [4.0, 4.0]]);
        let fault = |rings: &[Vec<u32>]| triangulate(&points, rings, &[]).unwrap_err();
        let crossing = fault(&[vec![0, 1, 2, 3], vec![0, 2], vec![1, 3]]);
        assert_eq!(crossing, FacetError::Crossing { first: [1, 3], second: [0, 2] });
        assert!(matches!(fault(&[vec![0, 2, 1, 3]]), FacetError::Crossing { .. }));
        assert_eq!(fault(&[vec![0, 1, 2, 4, 3]]), FacetError::Coincident { points: [2, 4] });
        assert_eq!(fault(&[vec![0, 2, 5, 2]]), FacetError::NoArea);
        assert_eq!(fault(&[vec![0, 1, 2, 9]]), FacetError::NoSuchPoint { point: 9 });
        let infinite = [Point3::origin(), Point3::new(f64::NAN, 0.0, 0.0), Point3::new(1.0, 1.0, 0.0)];
        let fault = triangulate(&infinite, &[vec![0, 1, 2, 0]], &[]).unwrap_err();
        assert_eq!(fault, FacetError::OutOfRange { point: 1 });
    }
}
