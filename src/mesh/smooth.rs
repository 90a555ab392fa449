//! Smoothing: Taubin's for surfaces, guarded Laplacian for the inside of a tetrahedral mesh.

use super::adjacency::Incidence;
use super::quality::radius_ratio;
use super::{TetMesh, TriMesh};
use crate::geometry::{Point3, Vec3, predicates};

/// Taubin's λ|μ smoothing: a Laplacian step forwards and a slightly longer one backwards, which keeps sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taubin {
    /// Factor of the step that smooths, in (0, 1).
    pub lambda: f64,
    /// Factor of the step that swells back, below −`lambda`.
    pub mu: f64,
    /// Number of pairs of steps.
    pub iterations: usize,
}

impl Default for Taubin {
    fn default() -> Self {
        Self { lambda: 0.5, mu: -0.53, iterations: 10 }
    }
}

impl Taubin {
    /// Smooths the vertices of a surface for which `movable` is true; the others stay, to the bit.
    pub fn smooth(&self, mesh: &mut TriMesh, movable: &[bool]) {
        let neighbors = Incidence::of_vertices(&mesh.triangles, mesh.points.len());
        let vertices: Vec<u32> = (0..mesh.points.len() as u32).filter(|&v| movable[v as usize]).collect();
        self.smooth_points(&mut mesh.points, &neighbors, &vertices);
    }

    /// Smooths the points listed in `movable` towards the mean of their neighbours. All move at once: the order of the
    /// list does not matter.
    pub fn smooth_points(&self, points: &mut [Point3], neighbors: &Incidence, movable: &[u32]) {
        let mut moved = Vec::with_capacity(movable.len());
        for _ in 0..self.iterations {
            for factor in [self.lambda, self.mu] {
                moved.clear();
                moved.extend(movable.iter().map(|&v| {
                    let p = points[v as usize];
                    mean_of(points, neighbors.get(v)).map_or(p, |mean| p + (mean - p) * factor)
                }));
                for (&v, &p) in movable.iter().zip(&moved) {
                    points[v as usize] = p;
                }
            }
        }
    }
}

fn mean_of(points: &[Point3], vertices: &[u32]) -> Option<Point3> {
    let sum: Vec3 = vertices.iter().map(|&v| points[v as usize].coords).sum();
    (!vertices.is_empty()).then(|| Point3::from(sum / vertices.len() as f64))
}

/// Moves the vertices for which `movable` is true towards the mean of their neighbours, one after the other in
/// ascending order, `iterations` times round. A step is taken in full, by half or by a quarter, and only if every
/// tetrahedron around stays positive by the exact predicate and the worst radius ratio around does not fall.
/// Returns the number of steps taken.
pub fn smooth_laplacian(mesh: &mut TetMesh, movable: &[bool], iterations: usize) -> usize {
    let around = Incidence::of_cells(&mesh.tets, mesh.points.len());
    let neighbors = Incidence::of_vertices(&mesh.tets, mesh.points.len());
    let mut steps = 0;
    for _ in 0..iterations {
        for v in (0..mesh.points.len() as u32).filter(|&v| movable[v as usize]) {
            let Some(target) = mean_of(&mesh.points, neighbors.get(v)) else { continue };
            let start = mesh.points[v as usize];
            let before = worst_around(mesh, around.get(v));
            let taken = [1.0, 0.5, 0.25].into_iter().any(|share| {
                mesh.points[v as usize] = start + (target - start) * share;
                worst_around(mesh, around.get(v)) >= before && all_positive(mesh, around.get(v))
            });
            if taken {
                steps += 1;
            } else {
                mesh.points[v as usize] = start;
            }
        }
    }
    steps
}

fn worst_around(mesh: &TetMesh, tets: &[u32]) -> f64 {
    let ratio = |&t: &u32| {
        let [a, b, c, d] = mesh.tets[t as usize].map(|v| &mesh.points[v as usize]);
        radius_ratio(a, b, c, d)
    };
    tets.iter().map(ratio).fold(f64::INFINITY, f64::min)
}

fn all_positive(mesh: &TetMesh, tets: &[u32]) -> bool {
    tets.iter().all(|&t| {
        let [a, b, c, d] = mesh.tets[t as usize].map(|v| &mesh.points[v as usize]);
        predicates::orient3d(a, b, c, d) > 0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::adjacency::{boundary_faces, vertices_of};
    use crate::mesh::quality::TetQuality;
    use crate::mesh::shapes::{cube_lattice, perturb, sphere_surface};
    use proptest::prelude::*;

    fn volume(mesh: &TriMesh) -> f64 {
        let corners = mesh.triangles.iter().map(|t| t.map(|v| mesh.points[v as usize].coords));
        corners.map(|[a, b, c]| a.cross(&b).dot(&c) / 6.0).sum()
    }

    #[test]
    fn taubin_smooths_noise_and_keeps_the_size() {
        let mut mesh = sphere_surface(4);
        let everywhere = vec![true; mesh.points.len()];
        let roughness = |mesh: &TriMesh| {
            let radii = mesh.points.iter().map(|p| p.coords.norm());
            let mean = radii.clone().sum::<f64>() / mesh.points.len() as f64;
            radii.map(|r| (r - mean).powi(2)).sum::<f64>()
        };
        perturb(&mut mesh.points, &everywhere, 0.01, 7);
        let (before, size) = (roughness(&mesh), volume(&mesh));
        Taubin::default().smooth(&mut mesh, &everywhere);
        assert!(roughness(&mesh) < 0.3 * before);
        assert!((volume(&mesh) / size - 1.0).abs() < 0.01);
    }

    #[test]
    fn taubin_moves_only_what_it_may() {
        let mut mesh = sphere_surface(3);
        let movable: Vec<bool> = mesh.points.iter().map(|p| p.z > 0.0).collect();
        perturb(&mut mesh.points, &vec![true; movable.len()], 0.02, 3);
        let before = mesh.points.clone();
        Taubin::default().smooth(&mut mesh, &movable);
        for (i, &may) in movable.iter().enumerate() {
            assert_eq!(mesh.points[i] != before[i], may);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn laplacian_never_inverts_and_never_makes_the_worst_worse(seed in any::<u64>(), size in 0.0..0.12_f64) {
            let mut mesh = cube_lattice(4);
            let on = vertices_of(&boundary_faces(&mesh), mesh.points.len());
            let inner: Vec<bool> = on.iter().map(|on| !on).collect();
            perturb(&mut mesh.points, &inner, size, seed);
            let all: Vec<u32> = (0..mesh.tets.len() as u32).collect();
            prop_assume!(all_positive(&mesh, &all));
            let (before, points) = (TetQuality::of(&mesh), mesh.points.clone());
            smooth_laplacian(&mut mesh, &inner, 3);
            prop_assert!(all_positive(&mesh, &all));
            prop_assert!(TetQuality::of(&mesh).min >= before.min);
            prop_assert!(points.iter().zip(&mesh.points).zip(&on).all(|((p, q), &on)| !on || p == q));
        }
    }
}
