//! Part of a cluster's mesh around one cut, renumbered: the working set of trimming.

use crate::block::Plane;
use anastomesh_mesh::geometry::{Point3, Section};

/// Neighbour entry for the boundary of the mesh.
pub(super) const WALL: u32 = u32::MAX;
/// Neighbour entry for a tetrahedron outside the region.
pub(super) const OUTSIDE: u32 = u32::MAX - 1;

/// Region of tetrahedra that are connected through faces to the vessel's tip, within a cylinder around the cut.
#[derive(Default)]
pub(super) struct Region {
    /// Global ids of the tetrahedra, in breadth-first order.
    pub tets: Vec<u32>,
    /// Global ids of the vertices.
    pub vertices: Vec<u32>,
    /// Tetrahedra with local vertices.
    pub corners: Vec<[u32; 4]>,
    /// Neighbour across face `i`: local tetrahedron, `WALL` or `OUTSIDE`.
    pub neighbours: Vec<[u32; 4]>,
    /// Signed distance of each vertex from the cut plane.
    pub height: Vec<f64>,
    /// Distance of each vertex from the axis.
    pub lateral: Vec<f64>,
    /// Position of each vertex in the cut plane, on an integer grid.
    pub flat: Vec<[i64; 2]>,
    /// Offset of each vertex in `star_tets`, plus the total.
    pub star_start: Vec<u32>,
    /// Tetrahedra at each vertex.
    pub star_tets: Vec<u32>,
}

/// Extent of a region.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    /// Distance from the axis.
    pub lateral: f64,
    /// Distance below the cut plane.
    pub depth: f64,
}

/// Data of the whole mesh for growing regions; the maps are reset after every use.
pub(super) struct Ground<'a> {
    pub points: &'a [Point3],
    pub tets: &'a [[u32; 4]],
    pub neighbours: &'a [[u32; 4]],
    pub alive: &'a [bool],
    pub local_tet: &'a mut [u32],
    pub local_vertex: &'a mut [u32],
}

impl Region {
    /// Collects the region around a cut, from a seed tetrahedron in the tip.
    pub(super) fn grow(ground: &mut Ground, seed: u32, section: &Section, reach: Reach) -> Self {
        let mut region = Self::default();
        region.tets.push(seed);
        ground.local_tet[seed as usize] = 0;
        let mut at = 0;
        while at < region.tets.len() {
            let t = region.tets[at] as usize;
            at += 1;
            for &handle in &ground.neighbours[t] {
                let n = neighbour(handle);
                if n == WALL || !ground.alive[n as usize] || ground.local_tet[n as usize] != WALL {
                    continue;
                }
                if inside(ground, n, section, reach) {
                    ground.local_tet[n as usize] = region.tets.len() as u32;
                    region.tets.push(n);
                }
            }
        }
        region.renumber(ground);
        region.project(ground.points, section, reach);
        region.build_stars();
        for &t in &region.tets {
            ground.local_tet[t as usize] = WALL;
        }
        for &v in &region.vertices {
            ground.local_vertex[v as usize] = WALL;
        }
        region
    }

    fn renumber(&mut self, ground: &mut Ground) {
        for &t in &self.tets {
            let corners = ground.tets[t as usize].map(|v| {
                let local = &mut ground.local_vertex[v as usize];
                if *local == WALL {
                    *local = self.vertices.len() as u32;
                    self.vertices.push(v);
                }
                *local
            });
            self.corners.push(corners);
            self.neighbours.push(ground.neighbours[t as usize].map(|handle| {
                let n = neighbour(handle);
                if n == WALL || !ground.alive[n as usize] {
                    WALL
                } else if ground.local_tet[n as usize] == WALL {
                    OUTSIDE
                } else {
                    ground.local_tet[n as usize]
                }
            }));
        }
    }

    fn project(&mut self, points: &[Point3], section: &Section, reach: Reach) {
        let plane = Plane::new(section, 2.0 * reach.lateral);
        for &v in &self.vertices {
            let p = &points[v as usize];
            let height = section.height(p);
            self.height.push(height);
            self.lateral.push((p - section.origin - section.axis * height).norm());
            self.flat.push(plane.snap(p));
        }
    }

    fn build_stars(&mut self) {
        let mut start = vec![0u32; self.vertices.len() + 1];
        for c in &self.corners {
            for &v in c {
                start[v as usize + 1] += 1;
            }
        }
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut fill = start.clone();
        self.star_tets = vec![0; 4 * self.corners.len()];
        for (t, c) in self.corners.iter().enumerate() {
            for &v in c {
                self.star_tets[fill[v as usize] as usize] = t as u32;
                fill[v as usize] += 1;
            }
        }
        self.star_start = start;
    }

    /// Tetrahedra at a vertex.
    pub(super) fn star(&self, v: u32) -> &[u32] {
        &self.star_tets[self.star_start[v as usize] as usize..self.star_start[v as usize + 1] as usize]
    }
}

/// Tetrahedron of a handle `4·tet + face`.
fn neighbour(handle: u32) -> u32 {
    if handle == u32::MAX { WALL } else { handle >> 2 }
}

fn inside(ground: &Ground, tet: u32, section: &Section, reach: Reach) -> bool {
    let sum = ground.tets[tet as usize]
        .iter()
        .map(|&v| ground.points[v as usize].coords)
        .sum::<anastomesh_mesh::geometry::Vec3>();
    let d = sum / 4.0 - section.origin.coords;
    let height = d.dot(&section.axis);
    height > -reach.depth && (d - section.axis * height).norm() < reach.lateral
}
