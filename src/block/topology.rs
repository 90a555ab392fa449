//! Adjacency and faces of a block's tetrahedra. They depend on the vertex numbers alone, so images of a template share them.

use super::error::NotOnBoundary;
use anastomesh_mesh::adjacency::{TetAdjacency, face_vertices, tet_adjacency};
use anastomesh_mesh::check::parts::{Certificate, PartView, certify_image, certify_with};
use anastomesh_mesh::{TetMesh, face_key};
use rustc_hash::FxHashMap;
use std::sync::{Arc, OnceLock};

/// Disc between two blocks, as seen by one of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FinishedJoint {
    /// Vertices in ascending order; the other block has them in equal order.
    pub vertices: Vec<u32>,
    /// Boundary faces of the disc.
    pub faces: Vec<u32>,
}

/// Adjacency of tetrahedra, and the faces of their boundary: handles `4 · tet + i` in ascending order.
#[derive(Debug, Default)]
pub struct Topology {
    /// Face neighbours; `None` for a tube of several templates.
    pub adjacency: Option<Arc<TetAdjacency>>,
    /// Discs at the ends of the block, in their order.
    pub discs: Vec<FinishedJoint>,
    /// Other faces of the boundary.
    pub wall: Vec<u32>,
    /// Certificate of the first image, or of the joined templates.
    pub certificate: OnceLock<Certificate>,
    /// Topologies with other orders of two or three discs, at their [`place`].
    others: [OnceLock<Arc<Topology>>; 6],
}

/// Place of an order of two or three discs in a list of all orders.
fn place(order: &[usize]) -> Option<usize> {
    match *order {
        [first, _] => Some(first),
        [first, second, third] => Some(2 * first + usize::from(second > third)),
        _ => None,
    }
}

impl Topology {
    /// Topology of a mesh with these discs.
    ///
    /// # Errors
    /// A triangle is not on the boundary.
    pub fn of<'a>(mesh: &TetMesh, discs: impl IntoIterator<Item = &'a [[u32; 3]]>) -> Result<Self, NotOnBoundary> {
        let adjacency = Arc::new(tet_adjacency(&mesh.tets, mesh.points.len()));
        let mut faces = Faces::new(adjacency.boundary().map(|face| (face, face_vertices(&mesh.tets, face))));
        let discs = discs.into_iter().map(|disc| faces.joint(disc)).collect::<Result<_, _>>()?;
        Ok(Self { adjacency: Some(adjacency), discs, wall: faces.rest(), ..Self::default() })
    }

    /// Topology of a closed surface with these discs. Faces are indices of triangles, and there is no adjacency.
    ///
    /// # Errors
    /// A triangle is not part of the surface.
    pub fn of_hull<'a>(
        hull: &[[u32; 3]],
        discs: impl IntoIterator<Item = &'a [[u32; 3]]>,
    ) -> Result<Self, NotOnBoundary> {
        let mut faces = Faces::new((0..).zip(hull.iter().copied()));
        let discs = discs.into_iter().map(|disc| faces.joint(disc)).collect::<Result<_, _>>()?;
        Ok(Self { discs, wall: faces.rest(), ..Self::default() })
    }

    /// Topology with its discs in another order.
    pub fn ordered(self: &Arc<Self>, order: &[usize]) -> Arc<Self> {
        if order.is_sorted() {
            return Arc::clone(self);
        }
        let make = || {
            let discs = order.iter().map(|&disc| self.discs[disc].clone()).collect();
            let adjacency = self.adjacency.clone();
            Arc::new(Self { adjacency, discs, wall: self.wall.clone(), ..Self::default() })
        };
        let kept = place(order).and_then(|place| self.others.get(place));
        kept.map_or_else(make, |kept| Arc::clone(kept.get_or_init(make)))
    }

    /// Certificate of a block with this topology. Images of a template after the first one have part of it in common.
    pub fn certify(&self, part: &PartView) -> Certificate {
        let faces = self.wall.iter().map(|&face| face_vertices(&part.mesh.tets, face));
        let image = self.certificate.get().and_then(|like| certify_image(part, &faces.collect::<Vec<_>>(), like));
        image.unwrap_or_else(|| {
            let made = || Arc::new(tet_adjacency(&part.mesh.tets, part.mesh.points.len()));
            let certificate = certify_with(part, || self.adjacency.clone().unwrap_or_else(made));
            self.certificate.get_or_init(|| certificate.clone());
            certificate
        })
    }
}

/// Compares the topology itself, without what is kept for other images.
impl PartialEq for Topology {
    fn eq(&self, other: &Self) -> bool {
        self.adjacency == other.adjacency && self.discs == other.discs && self.wall == other.wall
    }
}

/// Boundary faces that are not yet assigned.
struct Faces(FxHashMap<[u32; 3], u32>);

impl Faces {
    fn new(faces: impl Iterator<Item = (u32, [u32; 3])>) -> Self {
        Self(faces.map(|(face, triangle)| (face_key(triangle), face)).collect())
    }

    fn joint(&mut self, triangles: &[[u32; 3]]) -> Result<FinishedJoint, NotOnBoundary> {
        let mut vertices: Vec<u32> = triangles.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let take = |&face: &[u32; 3]| self.0.remove(&face_key(face)).ok_or(NotOnBoundary { face });
        let mut faces = triangles.iter().map(take).collect::<Result<Vec<u32>, _>>()?;
        faces.sort_unstable();
        Ok(FinishedJoint { vertices, faces })
    }

    fn rest(self) -> Vec<u32> {
        let mut rest: Vec<u32> = self.0.into_values().collect();
        rest.sort_unstable();
        rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Topology with this number of discs, whose vertices are their numbers.
    fn of_discs(count: u32) -> Arc<Topology> {
        let discs = (0..count).map(|i| FinishedJoint { vertices: vec![i], faces: Vec::new() }).collect();
        Arc::new(Topology { discs, ..Topology::default() })
    }

    #[test]
    fn each_order_of_discs_is_kept() {
        let orders: [&[usize]; 7] = [&[0, 1], &[1, 0], &[0, 2, 1], &[1, 0, 2], &[1, 2, 0], &[2, 0, 1], &[2, 1, 0]];
        let [two, three, four] = [2, 3, 4].map(of_discs);
        for order in orders {
            let topology = if order.len() == 2 { &two } else { &three };
            let ordered = topology.ordered(order);
            let found: Vec<usize> = ordered.discs.iter().map(|disc| disc.vertices[0] as usize).collect();
            assert_eq!(found, order);
            assert!(Arc::ptr_eq(&ordered, &topology.ordered(order)), "{order:?}");
        }
        // Orders of more discs are not kept.
        assert!(!Arc::ptr_eq(&four.ordered(&[1, 0, 2, 3]), &four.ordered(&[1, 0, 2, 3])));
    }

    #[test]
    fn topologies_differ_in_discs_and_walls() {
        let [two, other] = [of_discs(2), of_discs(2)];
        assert_eq!(two, other);
        assert_ne!(*two, Topology { wall: vec![1], discs: two.discs.clone(), ..Topology::default() });
        assert_ne!(two, of_discs(3));
        let adjacency = Some(Arc::default());
        assert_ne!(*two, Topology { adjacency, discs: two.discs.clone(), ..Topology::default() });
    }
}
