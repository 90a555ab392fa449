//! Values of a network's vessels, at each point of its mesh.

use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_skeleton::Skeleton;
use anastomesh_skeleton::Tubes;
use rayon::prelude::*;

/// Values at both ends of each edge. A point has the value of the vessel whose wall is nearest, linear along the vessel.
pub struct EdgeValues {
    tubes: Tubes,
    values: Vec<[f64; 2]>,
}

impl EdgeValues {
    const COLUMNS: [Column; 1] = [Column { name: "value", at_points: true, is_integer: false }];

    /// Values of the edges of a network.
    pub fn new(network: &Skeleton, values: Vec<[f64; 2]>) -> Self {
        Self { tubes: Tubes::of(network), values }
    }

    fn at(&self, place: &Point3) -> f64 {
        let Some(near) = self.tubes.nearest_wall(place) else { return f64::NAN };
        let [a, b] = self.values[near.edge.index()];
        a + near.t * (b - a)
    }

    fn in_cells<const N: usize>(&self, cells: &[[Point3; N]]) -> Vec<f64> {
        let middle = |cell: &[Point3; N]| Point3::from(cell.iter().map(|p| p.coords).sum::<Vec3>() / N as f64);
        cells.par_iter().map(|cell| self.at(&middle(cell))).collect()
    }
}

impl Beside for EdgeValues {
    fn columns(&self) -> &[Column] {
        &Self::COLUMNS
    }

    fn at_points(&self, _: usize, points: &[Point3]) -> Vec<f64> {
        points.par_iter().map(|p| self.at(p)).collect()
    }

    fn in_tets(&self, _: usize, tets: &[[Point3; 4]]) -> Vec<f64> {
        self.in_cells(tets)
    }

    fn in_faces(&self, _: usize, faces: &[[Point3; 3]]) -> Vec<f64> {
        self.in_cells(faces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::network;

    #[test]
    fn values_follow_the_nearest_vessel() {
        let points = [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [9.0, 0.0, 10.0]];
        let values = EdgeValues::new(&network(&points, 1.0, &[(0, 1), (1, 2)]), vec![[0.0, 5.0], [8.0, 8.0]]);
        let found = values.at_points(0, &[Point3::new(0.9, 0.0, 4.0), Point3::new(8.0, 0.0, 11.0)]);
        assert!((found[0] - 2.0).abs() < 1e-12 && found[1] == 8.0, "{found:?}");
        assert_eq!(values.in_faces(0, &[[Point3::new(0.0, 0.5, 2.0); 3]]), [1.0]);
    }
}
