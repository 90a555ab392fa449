//! Pieces that keep tetrahedra from being refined: circumcentres of badly shaped tetrahedra lie in their smallest spheres.
//! These are the encroached subfacets of Shewchuk, 'Tetrahedral mesh generation by Delaunay refinement', 1998.

use super::pieces::Pieces;
use crate::progress::{Counter, Watch};
use crate::refine::{Fault, Goals, circumcenter, smallest_sphere};
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3};
use anastomesh_mesh::{Bounds, TetMesh};

/// Operations per tetrahedron, as counted by budgets.
const OPERATIONS: usize = 20;

/// Encroached pieces of a mesh.
pub(super) struct Encroached {
    /// Share of the tetrahedra above the ratio.
    pub share: f64,
    /// For each piece the smallest of the shortest edges of tetrahedra that encroach it.
    rooms: Vec<Option<f64>>,
}

impl Pieces {
    /// Divides encroached pieces. Returns false if there is no room for any.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub(super) fn divide_encroached(
        &mut self,
        encroached: &Encroached,
        ratio: f64,
        most: usize,
        watch: &Watch,
    ) -> Result<bool, Stop> {
        self.changed.clear();
        let before = self.plc.surface.triangles.clone();
        for (t, room) in (0..).zip(&encroached.rooms).filter_map(|(t, room)| Some((t, (*room)?))) {
            let is_same = self.plc.surface.triangles[t as usize] == before[t as usize];
            if is_same && self.plc.surface.triangles.len() < most {
                let divided = self.edge_to_divide(t);
                if self.clearance(divided) >= room {
                    self.divide(divided);
                }
            }
        }
        let due = std::mem::take(&mut self.changed);
        let any = !due.is_empty();
        self.refine_all(due, ratio, most, watch)?;
        Ok(any)
    }

    /// Finds the encroached pieces of a mesh.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub(super) fn encroached(&self, mesh: &TetMesh, ratio: f64, watch: &Watch) -> Result<Encroached, Stop> {
        // A piece without area has no sphere.
        let sphere = |&t: &[u32; 3]| smallest_sphere(self.corners(t).each_ref()).unwrap_or((self.corners(t)[0], 0.0));
        let spheres: Vec<(Point3, f64)> = self.plc.surface.triangles.iter().map(sphere).collect();
        let grown = |(centre, square): &(Point3, f64)| Aabb { min: *centre, max: *centre }.grown(square.sqrt());
        let tree = Bvh::of(spheres.iter().map(grown).collect());
        let bounds = Bounds { max_radius_edge: Some(ratio), ..Bounds::default() };
        let goals = Goals { bounds, ..Goals::default() };
        let mut rooms: Vec<Option<f64>> = vec![None; spheres.len()];
        let mut above = 0;
        let mut counter = Counter::new(watch);
        for tet in &mesh.tets {
            counter.add(OPERATIONS)?;
            let corners = tet.map(|v| &mesh.points[v as usize]);
            let Some(Fault { spacing: shortest, .. }) = goals.fault(corners, None) else { continue };
            above += 1;
            let Some(centre) = circumcenter(corners) else { continue };
            tree.query(&Aabb { min: centre, max: centre }, |t| {
                let (middle, square) = spheres[t as usize];
                if (centre - middle).norm_squared() < square {
                    let room = &mut rooms[t as usize];
                    *room = Some(room.map_or(shortest, |room| room.min(shortest)));
                }
            });
        }
        counter.end()?;
        Ok(Encroached { share: f64::from(above) / mesh.tets.len().max(1) as f64, rooms })
    }
}
