//! Histogram of the dihedral angles of a mesh of any size.

use super::quality::dihedral_angles;
use super::source::MeshSource;
use crate::geometry::Point3;
use rayon::prelude::*;
use std::io;

/// Bins over 0 to 180 degrees.
const BINS: usize = 36;
/// Approximate number of tetrahedra sampled. More do not change the histogram visibly.
const SAMPLE_SIZE: usize = 2_000_000;

/// Histogram of dihedral angles. Large meshes are sampled in evenly spaced parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DihedralHistogram([u64; BINS]);

impl DihedralHistogram {
    /// Measures a mesh.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    pub fn of(mesh: &dyn MeshSource) -> io::Result<Self> {
        let stride = mesh.counts().tets.div_ceil(SAMPLE_SIZE).clamp(1, mesh.parts().max(1) as usize);
        let parts: Vec<u32> = (0..mesh.parts()).step_by(stride).collect();
        let counts = parts.par_iter().map(|&part| {
            let corners = mesh.corners_of(&mesh.tets(part)?.tets)?;
            Ok(corners.par_chunks(1024).map(count).reduce(|| [0; BINS], |a, b| add(a, &b)))
        });
        counts.try_reduce(|| [0; BINS], |a, b| Ok(add(a, &b))).map(Self)
    }

    /// Width of a bin in degrees.
    pub const WIDTH: f64 = 180.0 / BINS as f64;

    /// Number of angles in each bin.
    pub fn counts(&self) -> &[u64] {
        &self.0
    }
}

fn count(tets: &[[Point3; 4]]) -> [u64; BINS] {
    let mut bins = [0; BINS];
    for [a, b, c, d] in tets {
        for angle in dihedral_angles([a, b, c, d]) {
            bins[((angle.to_degrees() * BINS as f64 / 180.0) as usize).min(BINS - 1)] += 1;
        }
    }
    bins
}

fn add(mut a: [u64; BINS], b: &[u64; BINS]) -> [u64; BINS] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::VolumeMesh;
    use crate::shapes::cube_lattice;

    #[test]
    fn every_angle_is_counted() {
        let volume = VolumeMesh { mesh: cube_lattice(2), ..VolumeMesh::default() };
        let found = DihedralHistogram::of(&volume).unwrap();
        // Kuhn's tetrahedra have angles of 45, 60 and 90 degrees.
        assert_eq!(found.counts().iter().sum::<u64>(), 6 * volume.mesh.tets.len() as u64);
        let used: Vec<usize> = (0..BINS).filter(|&i| found.counts()[i] > 0).collect();
        assert!(used.iter().all(|i| [8, 9, 11, 12, 17, 18].contains(i)), "{used:?}");
    }
}
