//! Boundary of a lumen as a surface with its own points.

use anastomesh_mesh::geometry::{DisjointSets, Point3};
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::{TriMesh, WALL};
use rustc_hash::FxHashMap;
use std::io;

/// Boundary of a lumen.
pub struct LumenSurface {
    /// Surface, oriented outwards.
    pub surface: TriMesh,
    /// Point of the mesh of each point of the surface.
    pub points: Vec<u32>,
    /// Cap of each triangle; `None` for the wall.
    pub caps: Vec<Option<u32>>,
    /// Patch of each cap. Several caps may have one.
    pub patches: Vec<i32>,
}

impl LumenSurface {
    /// Boundary of a mesh.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    pub fn of(mesh: &dyn MeshSource) -> io::Result<Self> {
        let (mut triangles, mut of_faces) = (Vec::new(), Vec::new());
        mesh.each_faces(|piece| {
            triangles.extend_from_slice(&piece.faces);
            of_faces.extend_from_slice(&piece.patches);
            Ok(())
        })?;
        let mut number = vec![u32::MAX; mesh.counts().points];
        for &v in triangles.as_flattened() {
            number[v as usize] = 0;
        }
        let points: Vec<u32> = (0..).zip(&number).filter(|(_, n)| **n == 0).map(|(v, _)| v).collect();
        (0..).zip(&points).for_each(|(i, &v)| number[v as usize] = i);
        for v in triangles.as_flattened_mut() {
            *v = number[*v as usize];
        }
        let surface = TriMesh { points: mesh.points_of(&points)?, triangles };
        let (caps, patches) = caps(&surface, &of_faces);
        Ok(Self { surface, points, caps, patches })
    }

    /// Points of the mesh, and their positions.
    pub fn into_points(self) -> (Vec<u32>, Vec<Point3>) {
        (self.points, self.surface.points)
    }
}

/// Cap of each triangle, and the patch of each cap. A cap is a connected part off the wall.
fn caps(surface: &TriMesh, patches: &[i32]) -> (Vec<Option<u32>>, Vec<i32>) {
    let off_wall = || (0..surface.triangles.len()).filter(|&t| patches[t] != WALL);
    let mut joined = DisjointSets::new(surface.points.len());
    for [a, b, c] in off_wall().map(|t| surface.triangles[t]) {
        joined.join(a, b);
        joined.join(b, c);
    }
    let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
    let (mut caps, mut of_cap) = (vec![None; patches.len()], Vec::new());
    for t in off_wall() {
        let cap = *numbers.entry(joined.find(surface.triangles[t][0])).or_insert_with(|| {
            of_cap.push(patches[t]);
            of_cap.len() as u32 - 1
        });
        caps[t] = Some(cap);
    }
    (caps, of_cap)
}
