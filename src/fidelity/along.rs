//! Wall error along the vessels, as a function of the position between their ends.

use super::wall::wall_points;
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::Skeleton;
use anastomesh_skeleton::Tubes;
use rayon::prelude::*;
use std::io;

/// Number of bins along a vessel.
const BINS: usize = 25;

/// Bin over a fraction of all vessels' lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Middle of the bin, from 0 at one end of the vessel to 1 at the other.
    pub share: f64,
    /// Percentiles 5, 50 and 95 of (d − r) / r in the bin; `None` if it is empty.
    pub quantiles: Option<[f64; 3]>,
}

/// Deviation of the wall from the given radius along branches between bifurcations.
#[derive(Clone, Debug, PartialEq)]
pub struct Along {
    /// Parts of the length, in order.
    pub bins: Vec<Bin>,
}

impl Along {
    /// Compares a mesh with its network.
    ///
    /// # Errors
    /// The mesh cannot be read.
    pub fn of(network: &Skeleton, mesh: &dyn MeshSource) -> io::Result<Self> {
        let tubes = Tubes::of(network);
        let shares = shares(network);
        let error = |point: &_| {
            let near = tubes.nearest_wall(point)?;
            let [a, b] = shares[near.edge.index()];
            Some((a + near.t * (b - a), (near.distance - near.radius) / near.radius))
        };
        let found: Vec<(f64, f64)> = wall_points(mesh)?.par_iter().filter_map(error).collect();
        let mut bins = vec![Vec::new(); BINS];
        for (share, error) in found {
            bins[((share * BINS as f64) as usize).min(BINS - 1)].push(error);
        }
        let bin = |(i, mut errors): (usize, Vec<f64>)| {
            errors.sort_unstable_by(f64::total_cmp);
            let at = |q: f64| errors.get((q * errors.len().saturating_sub(1) as f64).round() as usize).copied();
            let quantiles = || Some([at(0.05)?, at(0.5)?, at(0.95)?]);
            Bin { share: (i as f64 + 0.5) / BINS as f64, quantiles: quantiles() }
        };
        Ok(Self { bins: bins.into_iter().enumerate().map(bin).collect() })
    }
}

/// Relative position of each edge's ends on its branch.
fn shares(network: &Skeleton) -> Vec<[f64; 2]> {
    let mut shares = vec![[0.0, 1.0]; network.edges.len()];
    for branch in &network.branches(&network.adjacency()).list {
        let length = branch.length().max(f64::MIN_POSITIVE);
        for (i, &edge) in branch.edges.iter().enumerate() {
            let mut ends = [branch.arc[i] / length, branch.arc[i + 1] / length];
            if network.edge(edge).nodes[0] != branch.nodes[i] {
                ends.reverse();
            }
            shares[edge.index()] = ends;
        }
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::tube_lattice;
    use anastomesh_mesh::{VolumeMesh, WALL, adjacency::boundary_faces};
    use anastomesh_skeleton::fixtures::network;

    #[test]
    fn a_wall_beside_its_radius_is_so_everywhere() {
        let mesh = tube_lattice(3, 40, 0.3);
        let boundary = boundary_faces(&mesh);
        let patches = vec![WALL; boundary.len()];
        let top = mesh.points.iter().map(|p| p.z).fold(0.0, f64::max);
        let volume = VolumeMesh { mesh, boundary, boundary_patch: patches, ..VolumeMesh::default() };
        let thin = network(&[[0.0, 0.0, -top], [0.0, 0.0, 0.5 * top], [0.0, 0.0, 2.0 * top]], 1e-3, &[(0, 1), (2, 1)]);
        let found = Along::of(&thin, &volume).unwrap();
        assert_eq!(found.bins.len(), BINS);
        // The tube lies in the middle third of the vessel, far off its axis.
        let seen: Vec<usize> = (0..BINS).filter(|&i| found.bins[i].quantiles.is_some()).collect();
        assert!(seen.iter().all(|i| (8..=17).contains(i)) && seen.len() > 5, "{seen:?}");
        assert!(seen.iter().all(|&i| found.bins[i].quantiles.is_some_and(|q| q[1] > 10.0)));
    }
}
