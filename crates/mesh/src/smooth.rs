//! Taubin smoothing of surfaces.

use super::adjacency::Incidence;
use crate::geometry::{Point3, Vec3};

/// Taubin λ|μ smoothing: a Laplacian step forwards and a slightly longer one backwards, which preserves sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taubin {
    /// Factor of the smoothing step, in (0, 1).
    pub lambda: f64,
    /// Factor of the inflating step, below −`lambda`.
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
    /// Smooths the points listed in `movable` towards the mean of their neighbours. All move at once, so the order of
    /// the list does not matter.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TriMesh;
    use crate::shapes::{perturb, sphere_surface};

    fn smooth(mesh: &mut TriMesh, movable: &[bool]) {
        let neighbors = Incidence::of_vertices(&mesh.triangles, mesh.points.len());
        let vertices: Vec<u32> = (0..mesh.points.len() as u32).filter(|&v| movable[v as usize]).collect();
        Taubin::default().smooth_points(&mut mesh.points, &neighbors, &vertices);
    }

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
        smooth(&mut mesh, &everywhere);
        assert!(roughness(&mesh) < 0.3 * before);
        assert!((volume(&mesh) / size - 1.0).abs() < 0.01);
    }

    #[test]
    fn taubin_moves_only_what_it_may() {
        let mut mesh = sphere_surface(3);
        let movable: Vec<bool> = mesh.points.iter().map(|p| p.z > 0.0).collect();
        perturb(&mut mesh.points, &vec![true; movable.len()], 0.02, 3);
        let before = mesh.points.clone();
        smooth(&mut mesh, &movable);
        for (i, &may) in movable.iter().enumerate() {
            assert_eq!(mesh.points[i] != before[i], may);
        }
    }
}
