//! Tetrahedralization in the order of insertion, and its translation to the order of the input.

use crate::certify::CertifyError;
use crate::certify_hull::certify_hull;
use crate::complex::Complex;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::geometry::Point3;

/// Tetrahedralization with points and vertices in the order of insertion, in which neighbours are near each other in memory.
pub struct Ordered {
    pub(super) complex: Complex,
    /// Index in the input of each vertex.
    pub(super) order: Vec<u32>,
}

impl Ordered {
    /// Certifies that the tetrahedra fill the convex hull of the points (see [`certify_hull`]), and that each point of the input
    /// is one vertex. Returns the faces of the hull.
    ///
    /// # Errors
    /// The first condition that does not hold.
    pub fn certify(&self, points: &[Point3]) -> Result<Vec<[u32; 3]>, CertifyError> {
        self.check_order(points)?;
        let name = |v: u32| self.order.get(v as usize).copied().unwrap_or(v);
        let mut hull = certify_hull(&self.complex).map_err(|error| error.renamed(name))?;
        for v in hull.iter_mut().flatten() {
            *v = name(*v);
        }
        Ok(hull)
    }

    fn check_order(&self, points: &[Point3]) -> Result<(), CertifyError> {
        let mut missing = vec![true; points.len()];
        for (&point, at) in self.order.iter().zip(&self.complex.points) {
            if points.get(point as usize) != Some(at) {
                return Err(CertifyError::PointMoved { point });
            }
            missing[point as usize] = false;
        }
        match missing.iter().position(|&missing| missing) {
            Some(point) => Err(CertifyError::PointUnused { point: point as u32 }),
            None => Ok(()),
        }
    }

    /// Returns the mesh over the points in their original order.
    pub fn into_mesh(self, points: &[Point3]) -> TetMesh {
        let Self { complex, order } = self;
        let tets = complex.into_tets(|v| order[v as usize]);
        TetMesh { points: points.to_vec(), tets }
    }

    /// Returns the complex over the points in their original order.
    pub(super) fn into_complex(self, points: &[Point3]) -> Complex {
        self.complex.renumbered(&self.order, points.to_vec())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delaunay::delaunay_ordered;
    use crate::progress::Watch;

    fn points() -> Vec<Point3> {
        let coordinate = |i: u32, k: u32| f64::from((i * 7919 + k * 104_729) % 997) / 1000.0;
        (0..100).map(|i| Point3::new(coordinate(i, 1), coordinate(3 * i + 1, 2), coordinate(7 * i + 2, 3))).collect()
    }

    #[test]
    fn an_order_that_is_no_permutation_of_the_points_is_found() {
        let points = points();
        let mut made = delaunay_ordered(&points, &Watch::NOBODY).unwrap();
        assert!(made.certify(&points).is_ok());
        let order = made.order.clone();
        made.order.swap(3, 4);
        assert_eq!(made.certify(&points), Err(CertifyError::PointMoved { point: order[4] }));
        made.order.clone_from(&order);
        made.order[3] = 1_000_000;
        assert_eq!(made.certify(&points), Err(CertifyError::PointMoved { point: 1_000_000 }));
        made.order.clone_from(&order);
        let mut more = points.clone();
        more.push(Point3::new(0.5, 0.5, 0.5));
        assert_eq!(made.certify(&more), Err(CertifyError::PointUnused { point: 100 }));
    }

    #[test]
    fn meshes_have_the_points_of_the_input() {
        let points = points();
        let made = delaunay_ordered(&points, &Watch::NOBODY).unwrap();
        let count = made.complex.real_tets().count();
        let mesh = made.into_mesh(&points);
        assert_eq!((&mesh.points, mesh.tets.len()), (&points, count));
        assert!(mesh.tets.iter().all(|tet| {
            let [a, b, c, d] = tet.map(|v| &points[v as usize]);
            anastomesh_mesh::geometry::predicates::orient3d(a, b, c, d) > 0.0
        }));
    }

    /// A broken complex is reported with the numbers of the input.
    #[test]
    fn faults_are_reported_in_the_numbers_of_the_input() {
        let points = points();
        let mut made = delaunay_ordered(&points, &Watch::NOBODY).unwrap();
        let tet = made.complex.real_tets().next().unwrap();
        let vertices = made.complex.verts(tet).map(|v| made.order[v as usize]);
        let [a, b, ..] = made.complex.verts(tet);
        made.complex.points.swap(a as usize, b as usize);
        made.order.swap(a as usize, b as usize);
        let Err(CertifyError::NotPositive { tet: found, vertices: named }) = made.certify(&points) else { panic!() };
        assert_eq!((found, named), (tet, [vertices[1], vertices[0], vertices[2], vertices[3]]));
    }
}
