//! Boundary of a lumen as a surface with its own points.

use anastomesh_mesh::geometry::{DisjointSets, Point3};
use anastomesh_mesh::{TriMesh, VolumeMesh, WALL};
use rustc_hash::FxHashMap;

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
    pub fn of(volume: &VolumeMesh) -> Self {
        let mut points: Vec<u32> = volume.boundary.as_flattened().to_vec();
        points.sort_unstable();
        points.dedup();
        let mut number = vec![u32::MAX; volume.mesh.points.len()];
        (0..).zip(&points).for_each(|(i, &v)| number[v as usize] = i);
        let triangles = volume.boundary.iter().map(|face| face.map(|v| number[v as usize])).collect();
        let places: Vec<Point3> = points.iter().map(|&v| volume.mesh.points[v as usize]).collect();
        let surface = TriMesh { points: places, triangles };
        let (caps, patches) = caps(&surface, &volume.boundary_patch);
        Self { surface, points, caps, patches }
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
