//! Floor 2: what concerns one mesh, wherever it came from: arrays, adjacency, quality, smoothing, validity.

pub mod adjacency;
pub(crate) mod beside;
pub(crate) mod bits;
pub(crate) mod boundary;
mod bounds;
pub mod check;
#[cfg(feature = "cli")]
pub(crate) mod dihedral;
pub mod faces;
pub mod facets;
mod keep;
mod keys;
pub mod quality;
pub mod relabel;
pub mod repair;
#[cfg(test)]
pub(crate) mod shapes;
pub mod smooth;
pub mod source;

pub use bounds::Bounds;
#[cfg(any(test, feature = "cli"))]
pub use bounds::REGULAR_DIHEDRAL;
pub(crate) use keep::Kept;
pub(crate) use keys::{face_key, tet_key};

use crate::geometry::Point3;

/// A triangle surface. A closed surface is oriented outwards: seen from outside, vertices run counter-clockwise.
///
/// ```
/// use anastomesh::{Point3, TriMesh};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let surface = TriMesh { points, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] };
/// assert!(anastomesh::tet::repair(&surface).report.turned_triangles == 0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions.
    pub points: Vec<Point3>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// Mean edge length, each edge counted with each of its triangles; 0 without any.
    pub(crate) fn mean_edge(&self) -> f64 {
        let mut sum = 0.0;
        for t in &self.triangles {
            let [a, b, c] = t.map(|v| self.points[v as usize]);
            sum += (b - a).norm() + (c - b).norm() + (a - c).norm();
        }
        sum / (3 * self.triangles.len()).max(1) as f64
    }
}

/// A tetrahedral mesh. Tetrahedra `[a, b, c, d]` are positive: `orient3d(a, b, c, d) > 0`, that is
/// `det(b − a, c − a, d − a) > 0`.
///
/// ```
/// use anastomesh::{Point3, TetMesh, check::check_tets};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let mut mesh = TetMesh { points, tets: vec![[0, 1, 2, 3]] };
/// assert_eq!(check_tets(&mesh, None).failed().count(), 0);
/// mesh.tets[0].swap(0, 1);
/// assert_ne!(check_tets(&mesh, None).failed().count(), 0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetMesh {
    /// Vertex positions.
    pub points: Vec<Point3>,
    /// Vertex indices of each tetrahedron.
    pub tets: Vec<[u32; 4]>,
}

/// The faces of a positive tetrahedron: face `i` lies opposite vertex `i` and, seen from outside, runs
/// counter-clockwise.
pub const TET_FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// A tetrahedral mesh whose boundary is labelled: what the pipeline makes and the writers write.
///
/// ```
/// let file = anastomesh::testing::read_mesh_from(MESH.as_bytes(), anastomesh::testing::MeshFormat::Medit)?;
/// assert_eq!((file.volume.mesh.tets.len(), file.volume.boundary_patch.len()), (1, 4));
/// assert_eq!(file.volume.patches[0].name, "wall");
/// # const MESH: &str = "MeshVersionFormatted 2\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n\
/// #     Tetrahedra 1\n1 2 3 4 1\nTriangles 4\n1 3 2 1\n1 2 4 1\n2 3 4 1\n3 1 4 1\nEnd\n";
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VolumeMesh {
    /// Points and tetrahedra.
    pub mesh: TetMesh,
    /// Block of each tetrahedron (clusters first, then connectors).
    pub tet_block: Vec<i32>,
    /// Every boundary face exactly once, oriented outwards.
    pub boundary: Vec<[u32; 3]>,
    /// Block of the tetrahedron under each boundary face.
    pub boundary_block: Vec<i32>,
    /// Patch of each boundary face: `WALL`, or another patch of `patches`.
    pub boundary_patch: Vec<i32>,
    /// The patches, in ascending order of their id.
    pub patches: Vec<Patch>,
}

/// Patch id of the vessel wall. The first inlet has id 2, the others follow: further inlets, then outlets.
pub const WALL: i32 = 1;

/// A named part of the boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Id, as in `VolumeMesh::boundary_patch`.
    pub id: i32,
    /// `wall`, `inlet`, `inlet_1`, …, `outlet_0`, `outlet_1`, …
    pub name: String,
    /// What a cap closes; none for the wall.
    pub cap: Option<Cap>,
}

impl Patch {
    /// Whether it is called an inlet.
    pub(crate) fn is_inlet(&self) -> bool {
        self.id != WALL && self.name.starts_with("inlet")
    }

    /// Whether it is called an outlet, or holds several.
    pub(crate) fn is_outlet(&self) -> bool {
        self.id != WALL && self.name.starts_with("outlet")
    }
}

/// A flat disc that closes a vessel: an inlet or outlet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Index of the terminal node in the network as it was read.
    pub node: u32,
    /// Centre of the disc.
    pub center: Point3,
    /// Unit normal, out of the mesh.
    pub normal: crate::geometry::Vec3,
    /// Radius of the vessel there.
    pub radius: f64,
}
