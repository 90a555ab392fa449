//! Smoothing of a lumen's wall where it is folded, so that a shell fits.
//!
//! At a folded vertex no direction leads away from all triangles of the wall, and prisms would invert. The vertex and those
//! up to two edges away move as far as necessary, and the tetrahedra of the lumen stay positive.

use super::surface::LumenSurface;
use anastomesh_mesh::adjacency::Incidence;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::source::MeshSource;
use anastomesh_tet::parts::{is_open, openness};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;
use std::io;

/// Openness below which a vertex is folded: the least cosine between its direction and the normals of its triangles.
const FOLDED: f64 = 0.1;
/// Passes over the folded vertices.
const PASSES: usize = 30;
/// Steps of a vertex, relative to its mean edge.
const STEPS: [f64; 5] = [0.4, 0.15, 0.05, 0.015, 0.005];

/// Moves folded vertices of the wall. Returns the vertices of the mesh that move, ascending, with their new positions.
///
/// # Errors
/// Errors of reading the mesh.
pub fn unfold(mesh: &dyn MeshSource, lumen: &mut LumenSurface) -> io::Result<Vec<(u32, Point3)>> {
    let mut wall = Wall::of(lumen);
    let all: Vec<u32> = (0..lumen.surface.points.len() as u32).filter(|v| !wall.of_caps.contains(v)).collect();
    let mut folded = wall.folded(&all);
    if folded.is_empty() {
        return Ok(Vec::new());
    }
    let near = wall.around(&wall.around(&folded));
    let mut stars = Stars::of(mesh, near.iter().map(|&v| lumen.points[v as usize]))?;
    let mut moved = BTreeMap::new();
    for _ in 0..PASSES {
        for v in wall.around(&wall.around(&folded)) {
            // Only vertices around those that were folded at first may move.
            let vertex = lumen.points[v as usize];
            if !stars.tets.contains_key(&vertex) {
                continue;
            }
            if let Some(place) = wall.better(v, |p| stars.stay_positive(vertex, p)) {
                wall.points[v as usize] = place;
                stars.points.insert(vertex, place);
                moved.insert(vertex, place);
            }
        }
        folded = wall.folded(&near);
        if folded.is_empty() {
            break;
        }
    }
    lumen.surface.points = wall.points;
    Ok(moved.into_iter().collect())
}

/// Tetrahedra at some vertices.
struct Stars {
    tets: FxHashMap<u32, Vec<[u32; 4]>>,
    points: FxHashMap<u32, Point3>,
}

impl Stars {
    fn of(mesh: &dyn MeshSource, vertices: impl Iterator<Item = u32>) -> io::Result<Self> {
        let mut tets: FxHashMap<u32, Vec<[u32; 4]>> = vertices.map(|v| (v, Vec::new())).collect();
        mesh.each_tets(|piece| {
            for tet in piece.tets.iter() {
                for v in tet {
                    if let Some(own) = tets.get_mut(v) {
                        own.push(*tet);
                    }
                }
            }
            Ok(())
        })?;
        let mut ids: Vec<u32> = tets.values().flatten().flatten().copied().collect();
        ids.sort_unstable();
        ids.dedup();
        let points = ids.iter().copied().zip(mesh.points_of(&ids)?).collect();
        Ok(Self { tets, points })
    }

    /// True if the tetrahedra at a vertex stay positive when it moves.
    fn stay_positive(&self, vertex: u32, place: &Point3) -> bool {
        self.tets[&vertex].iter().all(|tet| {
            let [a, b, c, d] = tet.map(|v| if v == vertex { place } else { &self.points[&v] });
            orient3d(a, b, c, d) > 0.0
        })
    }
}

/// Wall of a lumen with its triangles at each vertex.
struct Wall {
    points: Vec<Point3>,
    triangles: Vec<[u32; 3]>,
    at_vertex: Incidence,
    neighbours: Incidence,
    /// Vertices of caps, which do not move.
    of_caps: FxHashSet<u32>,
}

impl Wall {
    fn of(lumen: &LumenSurface) -> Self {
        let capped = lumen.surface.triangles.iter().zip(&lumen.caps);
        let triangles: Vec<[u32; 3]> = capped.clone().filter(|(_, cap)| cap.is_none()).map(|(t, _)| *t).collect();
        let points = lumen.surface.points.clone();
        Self {
            at_vertex: Incidence::of_cells(&triangles, points.len()),
            neighbours: Incidence::of_vertices(&triangles, points.len()),
            of_caps: capped.filter(|(_, cap)| cap.is_some()).flat_map(|(t, _)| *t).collect(),
            points,
            triangles,
        }
    }

    /// A vertex and those around it that may move.
    fn with_neighbours(&self, v: u32) -> Vec<u32> {
        let around = self.neighbours.get(v).iter().copied().chain([v]);
        around.filter(|v| !self.of_caps.contains(v)).collect()
    }

    /// Some vertices and those around them that may move.
    fn around(&self, vertices: &[u32]) -> Vec<u32> {
        let mut all: Vec<u32> = vertices.iter().flat_map(|&v| self.with_neighbours(v)).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn folded(&self, vertices: &[u32]) -> Vec<u32> {
        vertices.par_iter().copied().filter(|&v| !is_open(&self.normals(v), FOLDED)).collect()
    }

    fn openness(&self, v: u32) -> f64 {
        openness(&self.normals(v))
    }

    /// Normals of the triangles at a vertex, into the lumen.
    fn normals(&self, v: u32) -> Vec<Vec3> {
        let inward = |&t: &u32| {
            let [a, b, c] = self.triangles[t as usize].map(|v| self.points[v as usize]);
            -(b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
        };
        self.at_vertex.get(v).iter().map(inward).collect()
    }

    /// Openness that a vertex and those around it lack, in sum.
    fn lack(&self, v: u32) -> f64 {
        self.with_neighbours(v).into_iter().map(|v| (FOLDED - self.openness(v)).max(0.0)).sum()
    }

    /// Place of a vertex at which it and those around it are more open.
    fn better(&mut self, v: u32, fits: impl Fn(&Point3) -> bool) -> Option<Point3> {
        let own = self.points[v as usize];
        let ring = self.neighbours.get(v);
        let length = |w: &u32| (self.points[*w as usize] - own).norm();
        let mean = ring.iter().map(length).sum::<f64>() / ring.len().max(1) as f64;
        let mut best = (self.lack(v), own);
        let middle = ring.iter().map(|w| self.points[*w as usize].coords).sum::<Vec3>() / ring.len().max(1) as f64;
        let smoother = (middle - own.coords).try_normalize(0.0);
        for step in STEPS {
            for way in ways().chain(smoother) {
                let place = best.1 + way * (step * mean);
                if !fits(&place) {
                    continue;
                }
                self.points[v as usize] = place;
                let lack = self.lack(v);
                if lack < best.0 {
                    best = (lack, place);
                }
            }
        }
        self.points[v as usize] = own;
        (best.1 != own).then_some(best.1)
    }
}

/// Unit vectors to the faces, edges and corners of a cube.
fn ways() -> impl Iterator<Item = Vec3> {
    let axis = || [-1.0, 0.0, 1.0].into_iter();
    let all = axis().flat_map(move |x| axis().flat_map(move |y| axis().map(move |z| Vec3::new(x, y, z))));
    all.filter_map(|way| way.try_normalize(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::VolumeMesh;
    use anastomesh_mesh::check::check_tets;
    use anastomesh_mesh::shapes::sphere_surface;
    use anastomesh_tet::Tetrahedralizer;

    #[test]
    fn a_folded_vertex_is_opened() {
        let mut surface = sphere_surface(3);
        // Lifted, and moved beyond a neighbour: an overhang, whose lower triangles face the others.
        let beside = Incidence::of_vertices(&surface.triangles, surface.points.len()).get(40)[0];
        let edge = surface.points[beside as usize] - surface.points[40];
        surface.points[40] = surface.points[40] * 1.2 + edge * 6.0;
        let mut mesh = Tetrahedralizer::new().run(&surface).expect("filled").mesh;
        let caps = vec![None; surface.triangles.len()];
        let mut lumen =
            LumenSurface { points: (0..surface.points.len() as u32).collect(), surface, caps, patches: Vec::new() };
        let before = Wall::of(&lumen).openness(40);
        let moved = unfold(&VolumeMesh { mesh: mesh.clone(), ..VolumeMesh::default() }, &mut lumen).expect("in memory");
        for &(v, place) in &moved {
            mesh.points[v as usize] = place;
        }
        assert!(before < FOLDED && !moved.is_empty(), "{before}");
        assert!(Wall::of(&lumen).openness(40) >= FOLDED);
        assert_eq!(mesh.points[40], lumen.surface.points[40]);
        let faults: Vec<_> = check_tets(&mesh, None).failed().map(|line| line.line).collect();
        assert!(faults.is_empty(), "{faults:?}");
    }
}
