//! The certificate: what has to hold before a mesh may be called the tetrahedralization of a surface.

use crate::geometry::Point3;
use crate::geometry::predicates::orient3d;
use crate::mesh::adjacency::{face_vertices, tet_adjacency};
use crate::mesh::{TetMesh, TriMesh};
use rustc_hash::FxHashMap;

/// Volumes of mesh and surface may differ by this much of the sum of their terms' magnitudes: rounding.
const VOLUME_TOLERANCE: f64 = 1e-10;

/// What does not hold of a mesh that should fill a surface.
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
    #[error("face {face:?} is not shared properly")]
    NotConforming {
        /// Vertices of the face.
        face: [u32; 3],
    },
    /// A boundary face that the surface does not have, or has with the other orientation.
    #[error("boundary face {face:?} is no triangle of the surface")]
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
    /// The volumes of mesh and surface differ by more than rounding.
    #[error("the mesh has volume {mesh}, the surface encloses {surface}")]
    Volume {
        /// Sum over the tetrahedra.
        mesh: f64,
        /// Enclosed by the surface.
        surface: f64,
    },
}

/// Proves that `mesh` fills `surface`: its points begin with the surface's, bit for bit; every tetrahedron is positive
/// by the exact predicate; interior faces are shared by two tetrahedra on opposite sides; the boundary is the surface,
/// triangle for triangle, with the same orientation; the volumes agree to rounding.
///
/// # Errors
/// The first of these that does not hold.
pub fn certify(mesh: &TetMesh, surface: &TriMesh) -> Result<(), CertifyError> {
    same_points(mesh, surface)?;
    all_positive(mesh)?;
    same_boundary(mesh, surface)?;
    same_volume(mesh, surface)
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

fn same_boundary(mesh: &TetMesh, surface: &TriMesh) -> Result<(), CertifyError> {
    let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
    if let Some(&half) = adjacency.crowded.first() {
        return Err(CertifyError::NotConforming { face: face_vertices(&mesh.tets, half) });
    }
    let mut wanted: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    wanted.reserve(surface.triangles.len());
    for (i, &t) in surface.triangles.iter().enumerate() {
        wanted.insert(rotated(t), i as u32);
    }
    let mut found = vec![false; surface.triangles.len()];
    let slots = adjacency.neighbors.iter().flatten();
    for (half, &mate) in slots.enumerate() {
        let half = half as u32;
        let face = face_vertices(&mesh.tets, half);
        if mate != u32::MAX {
            let [a, b, c] = rotated(face);
            if mate > half && [a, c, b] != rotated(face_vertices(&mesh.tets, mate)) {
                return Err(CertifyError::NotConforming { face });
            }
            continue;
        }
        match wanted.get(&rotated(face)) {
            Some(&i) => found[i as usize] = true,
            None => return Err(CertifyError::ForeignFace { face }),
        }
    }
    match found.iter().position(|&f| !f) {
        Some(i) => Err(CertifyError::TriangleLost { triangle: i as u32 }),
        None => Ok(()),
    }
}

fn same_volume(mesh: &TetMesh, surface: &TriMesh) -> Result<(), CertifyError> {
    let mut filled = 0.0;
    for v in &mesh.tets {
        let [a, b, c, d] = v.map(|i| mesh.points[i as usize]);
        filled += (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0;
    }
    let (enclosed, magnitude) = enclosed_volume(surface);
    if (filled - enclosed).abs() <= VOLUME_TOLERANCE * magnitude {
        Ok(())
    } else {
        Err(CertifyError::Volume { mesh: filled, surface: enclosed })
    }
}

/// The volume that a closed surface encloses, and the sum of the magnitudes of its terms.
pub fn enclosed_volume(surface: &TriMesh) -> (f64, f64) {
    let Some(&origin) = surface.points.first() else { return (0.0, 0.0) };
    let mut volume = 0.0;
    let mut magnitude = 0.0;
    for t in &surface.triangles {
        let [a, b, c] = t.map(|i| surface.points[i as usize] - origin);
        let term = a.cross(&b).dot(&c) / 6.0;
        volume += term;
        magnitude += term.abs();
    }
    (volume, magnitude)
}
