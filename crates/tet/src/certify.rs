//! Certificate: exact conditions that make a mesh the tetrahedralization of a surface.

use super::complex::{face_key, face_of};
use super::plc::InputKind;
use super::plc::InputPart;
use super::plc::LeftOut;
use anastomesh_mesh::adjacency::{face_vertices, tet_adjacency};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::{TetMesh, TriMesh};
use rustc_hash::FxHashMap;

/// Volumes of mesh and surface may differ by this much of the sum of their terms' magnitudes: rounding.
const VOLUME_TOLERANCE: f64 = 1e-10;

/// And by this much of what three edges of each term span at most: rounding, where terms are those of flat corners.
const TERM_ROUNDOFF: f64 = 16.0 * f64::EPSILON;

/// Violated condition of a mesh that should fill a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CertifyError {
    /// The mesh's points do not begin with the surface's.
    #[error("point {point} of the surface has moved")]
    PointMoved {
        /// The point.
        point: u32,
    },
    /// A flat or inverted tetrahedron, or one with bad indices.
    #[error("tetrahedron {tet} with vertices {vertices:?} is not positive")]
    NotPositive {
        /// The tetrahedron.
        tet: u32,
        /// Its vertices.
        vertices: [u32; 4],
    },
    /// Two tetrahedra on the same side of a face, or three at one face.
    #[error("face {face:?} is shared by more than two tetrahedra, or by two on the same side")]
    NotConforming {
        /// Vertices of the face.
        face: [u32; 3],
    },
    /// A boundary face that the surface does not have, or has with the other orientation.
    #[error("boundary face {face:?} is not a triangle of the surface")]
    ForeignFace {
        /// Vertices of the face.
        face: [u32; 3],
    },
    /// A triangle of the surface that is not a boundary face.
    #[error("triangle {triangle} of the surface is not on the boundary")]
    TriangleLost {
        /// The triangle.
        triangle: u32,
    },
    /// A triangle of the complex that is no face of the mesh.
    #[error("triangle {triangle} of the input is not a face of the mesh")]
    FacetLost {
        /// The triangle.
        triangle: u32,
    },
    /// A segment of the complex that is no edge of the mesh.
    #[error("segment {segment} of the input is not an edge of the mesh")]
    SegmentLost {
        /// The segment.
        segment: u32,
    },
    /// An item that was left out as lying outside is a face or an edge of the mesh.
    #[error("{} {id} of the input was left out, but the mesh contains it", part.noun())]
    NotOutside {
        /// Triangle or segment.
        part: InputPart,
        /// Its id.
        id: u32,
    },
    /// Two regions that meet in a face which is no triangle of the complex.
    #[error("face {face:?} lies between two regions and is not a triangle of the input")]
    RegionsMix {
        /// Vertices of the face.
        face: [u32; 3],
    },
    /// A point that no tetrahedron has.
    #[error("point {point} has no tetrahedron")]
    PointUnused {
        /// The point.
        point: u32,
    },
    /// A face of a convex hull with a part of the mesh on its outer side.
    #[error("the hull is not convex at face {face:?}")]
    NotConvex {
        /// Vertices of the face.
        face: [u32; 3],
    },
    /// A ray from inside a tetrahedron does not cross the convex hull once.
    #[error("a ray from tetrahedron {tet} crosses the hull {crossed} times instead of once")]
    Winding {
        /// The tetrahedron.
        tet: u32,
        /// Number of hull faces that the ray crosses.
        crossed: usize,
    },
    /// The volumes of mesh and surface differ by more than rounding.
    #[error("the mesh has volume {mesh}, the surface encloses {surface}")]
    Volume {
        /// Sum over the tetrahedra.
        mesh: f64,
        /// Enclosed by the surface.
        surface: f64,
    },
}

impl CertifyError {
    /// Replaces the vertex numbers in the error of a tetrahedralization of points.
    pub(super) fn renamed(self, name: impl Fn(u32) -> u32) -> Self {
        match self {
            Self::NotPositive { tet, vertices } => Self::NotPositive { tet, vertices: vertices.map(name) },
            Self::NotConforming { face } => Self::NotConforming { face: face.map(name) },
            Self::NotConvex { face } => Self::NotConvex { face: face.map(name) },
            Self::PointUnused { point } => Self::PointUnused { point: name(point) },
            other => other,
        }
    }
}

/// Proves that `mesh` fills `surface`.
///
/// - The points of the mesh begin with those of the surface, bit for bit.
/// - Every tetrahedron is positive by the exact predicate.
/// - Two tetrahedra on opposite sides share each interior face.
/// - The boundary is the surface, triangle for triangle, with the same orientation.
/// - The volumes agree to rounding.
///
/// ```
/// use anastomesh_tet::{Tetrahedralizer, certify};
///
/// let surface = anastomesh_mesh::shapes::sphere_surface(2);
/// let mut made = Tetrahedralizer::new().run(&surface)?;
/// assert!(certify(&made.mesh, &surface).is_ok());
/// made.mesh.tets.pop();
/// assert!(certify(&made.mesh, &surface).is_err());
/// # Ok::<(), anastomesh_tet::TetError>(())
/// ```
///
/// # Errors
/// The first of these that does not hold.
pub fn certify(mesh: &TetMesh, surface: &TriMesh) -> Result<(), CertifyError> {
    let places = certify_facets(mesh, surface, InputKind::Closed, &[])?;
    match places.iter().position(|&p| p != Place::Boundary) {
        Some(i) => Err(CertifyError::ForeignFace { face: swapped(surface.triangles[i]) }),
        None => Ok(()),
    }
}

/// Position of an input triangle in the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// It is a boundary face, oriented outwards.
    Boundary,
    /// It is a boundary face, oriented inwards.
    Reversed,
    /// It is a face between two tetrahedra.
    Inside,
}

/// Proves that `mesh` contains the triangles of `facets`, and returns their positions.
///
/// - The points of the mesh begin with those of `facets`, bit for bit.
/// - Every tetrahedron is positive by the exact predicate.
/// - Two tetrahedra on opposite sides share each interior face.
/// - Every boundary face is a triangle of `facets`, in either orientation.
/// - Every triangle is a face of the mesh, and a boundary face for [`InputKind::Closed`].
/// - Faces between tetrahedra of different `regions` (one for each tetrahedron, or none) are triangles of `facets`.
/// - The volume of the mesh and the volume enclosed by its boundary agree to rounding.
///
/// # Errors
/// The first of these that does not hold.
pub fn certify_facets(
    mesh: &TetMesh,
    facets: &TriMesh,
    kind: InputKind,
    regions: &[i32],
) -> Result<Vec<Place>, CertifyError> {
    same_points(mesh, facets)?;
    all_positive(mesh)?;
    let places = same_faces(mesh, facets, kind, regions)?;
    same_volume(mesh, facets, &places)?;
    Ok(places)
}

/// Proves that the segments are edges of the mesh.
///
/// # Errors
/// The first that is not.
pub fn certify_segments(mesh: &TetMesh, segments: &[[u32; 2]]) -> Result<(), CertifyError> {
    if segments.is_empty() {
        return Ok(());
    }
    let mut found: FxHashMap<[u32; 2], bool> = FxHashMap::default();
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    for &[a, b] in segments {
        found.insert(key(a, b), false);
    }
    for t in &mesh.tets {
        for i in 0..4 {
            for j in 0..i {
                if let Some(f) = found.get_mut(&key(t[i], t[j])) {
                    *f = true;
                }
            }
        }
    }
    match segments.iter().position(|&[a, b]| found.get(&key(a, b)) != Some(&true)) {
        Some(i) => Err(CertifyError::SegmentLost { segment: i as u32 }),
        None => Ok(()),
    }
}

/// Proves that no triangle that is left out is a face of the mesh, and no segment an edge of it.
///
/// # Errors
/// The first that is.
pub fn certify_left_out(
    mesh: &TetMesh,
    facets: &TriMesh,
    segments: &[[u32; 2]],
    left_out: &LeftOut,
) -> Result<(), CertifyError> {
    if left_out.is_empty() {
        return Ok(());
    }
    let edge = |a: u32, b: u32| [a.min(b), a.max(b)];
    let triangles: FxHashMap<[u32; 3], u32> =
        left_out.triangles.iter().map(|&i| (face_key(facets.triangles[i as usize]), i)).collect();
    let edges: FxHashMap<[u32; 2], u32> =
        left_out.segments.iter().map(|&i| (edge(segments[i as usize][0], segments[i as usize][1]), i)).collect();
    for t in &mesh.tets {
        if let Some(&id) = (0..4).find_map(|i| triangles.get(&face_key(face_of(t, i)))) {
            return Err(CertifyError::NotOutside { part: InputPart::Triangles, id });
        }
        let pairs = (0..4).flat_map(|i| (0..i).map(move |j| (i, j)));
        if let Some(&id) = pairs.into_iter().find_map(|(i, j)| edges.get(&edge(t[i], t[j]))) {
            return Err(CertifyError::NotOutside { part: InputPart::Segments, id });
        }
    }
    Ok(())
}

/// Checks that two half-faces run through their common vertices in opposite directions.
fn opposed(mesh: &TetMesh, half: u32, mate: u32) -> Result<(), CertifyError> {
    let face = face_vertices(&mesh.tets, half);
    if rotated(swapped(face)) == rotated(face_vertices(&mesh.tets, mate)) {
        Ok(())
    } else {
        Err(CertifyError::NotConforming { face })
    }
}

/// Face with opposite orientation.
fn swapped([a, b, c]: [u32; 3]) -> [u32; 3] {
    [a, c, b]
}

fn same_points(mesh: &TetMesh, surface: &TriMesh) -> Result<(), CertifyError> {
    let bits = |p: &Point3| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()];
    for (i, p) in surface.points.iter().enumerate() {
        if mesh.points.get(i).is_none_or(|q| bits(p) != bits(q)) {
            return Err(CertifyError::PointMoved { point: i as u32 });
        }
    }
    Ok(())
}

fn all_positive(mesh: &TetMesh) -> Result<(), CertifyError> {
    for (t, &vertices) in mesh.tets.iter().enumerate() {
        let known = vertices.iter().all(|&v| (v as usize) < mesh.points.len());
        let positive = known && {
            let [a, b, c, d] = vertices.map(|v| &mesh.points[v as usize]);
            orient3d(a, b, c, d) > 0.0
        };
        if !positive {
            return Err(CertifyError::NotPositive { tet: t as u32, vertices });
        }
    }
    Ok(())
}

/// The rotation of a face that begins with its smallest vertex: equal for faces of equal orientation only.
fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a <= b && a <= c {
        [a, b, c]
    } else if b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

fn same_faces(mesh: &TetMesh, facets: &TriMesh, kind: InputKind, regions: &[i32]) -> Result<Vec<Place>, CertifyError> {
    let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
    if let Some(&half) = adjacency.crowded.first() {
        return Err(CertifyError::NotConforming { face: face_vertices(&mesh.tets, half) });
    }
    let mut wanted: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    wanted.reserve(facets.triangles.len());
    for (i, &t) in facets.triangles.iter().enumerate() {
        wanted.insert(rotated(t), i as u32);
    }
    let find = |face: [u32; 3]| {
        let same = wanted.get(&rotated(face)).map(|&i| (i, Place::Boundary));
        same.or_else(|| wanted.get(&rotated(swapped(face))).map(|&i| (i, Place::Reversed)))
    };
    let region = |half: u32| regions.get((half >> 2) as usize);
    let mut places = vec![None; facets.triangles.len()];
    for (half, &mate) in (0_u32..).zip(adjacency.neighbors.as_flattened()) {
        let face = face_vertices(&mesh.tets, half);
        if mate == u32::MAX {
            let Some((i, place)) = find(face) else { return Err(CertifyError::ForeignFace { face }) };
            places[i as usize] = Some(place);
        } else if mate > half {
            opposed(mesh, half, mate)?;
            if kind == InputKind::Plc {
                match find(face) {
                    Some((i, _)) => places[i as usize] = Some(Place::Inside),
                    None if region(half) != region(mate) => return Err(CertifyError::RegionsMix { face }),
                    None => {}
                }
            } else if region(half) != region(mate) {
                return Err(CertifyError::RegionsMix { face });
            }
        }
    }
    match places.iter().position(Option::is_none) {
        Some(i) if kind == InputKind::Closed => Err(CertifyError::TriangleLost { triangle: i as u32 }),
        Some(i) => Err(CertifyError::FacetLost { triangle: i as u32 }),
        None => Ok(places.into_iter().flatten().collect()),
    }
}

fn same_volume(mesh: &TetMesh, facets: &TriMesh, places: &[Place]) -> Result<(), CertifyError> {
    let (mut filled, mut span) = (0.0, 0.0);
    for v in &mesh.tets {
        let [a, b, c, d] = v.map(|i| mesh.points[i as usize]);
        let [b, c, d] = [b - a, c - a, d - a];
        filled += b.cross(&c).dot(&d) / 6.0;
        span += b.norm() * c.norm() * d.norm();
    }
    span += spanned(facets);
    let (enclosed, magnitude) = signed_volume(facets, |i| match places.get(i) {
        Some(Place::Boundary) => 1.0,
        Some(Place::Reversed) => -1.0,
        _ => 0.0,
    });
    if (filled - enclosed).abs() <= VOLUME_TOLERANCE * magnitude + TERM_ROUNDOFF * span {
        Ok(())
    } else {
        Err(CertifyError::Volume { mesh: filled, surface: enclosed })
    }
}

/// The volume that a closed surface encloses, and the sum of the magnitudes of its terms.
pub fn enclosed_volume(surface: &TriMesh) -> (f64, f64) {
    signed_volume(surface, |_| 1.0)
}

/// Sum over triangles of the product of the distances of their vertices from the first point. It bounds the volume
/// terms.
fn spanned(surface: &TriMesh) -> f64 {
    let Some(&origin) = surface.points.first() else { return 0.0 };
    let term = |t: &[u32; 3]| t.iter().map(|&i| (surface.points[i as usize] - origin).norm()).product::<f64>();
    surface.triangles.iter().map(term).sum()
}

fn signed_volume(surface: &TriMesh, sign: impl Fn(usize) -> f64) -> (f64, f64) {
    let Some(&origin) = surface.points.first() else { return (0.0, 0.0) };
    let mut volume = 0.0;
    let mut magnitude = 0.0;
    for (i, t) in surface.triangles.iter().enumerate() {
        let [a, b, c] = t.map(|i| surface.points[i as usize] - origin);
        let term = sign(i) * a.cross(&b).dot(&c) / 6.0;
        volume += term;
        magnitude += term.abs();
    }
    (volume, magnitude)
}

#[cfg(test)]
#[path = "certify_tests.rs"]
mod tests;
