//! Floor 3: whether a mesh is that of the network it was made for.
//!
//! A mesh may be sound and yet not this network's: an axis bent out of shape, a lumen that swelled, a wall that is
//! nowhere near the radius. So the network as it was given is held against the network that was meshed (its axis, its
//! volume) and against the wall.

mod along;
mod axis;
mod lumen;
mod spread;
mod text;
mod tubes;
mod wall;

use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::Skeleton;
use serde::Serialize;
use spread::Spread;
use std::io;

pub use along::Along;
pub use axis::{Displaced, Displacements};
pub use tubes::Tubes;

/// What a mesh keeps of its network.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Fidelity {
    /// From the given axis to the axis that was meshed, in radii of the given vessel.
    pub axis: Displacements,
    /// Distance of the wall from the given tubes, as a share of the radius: |d − r| / r at points of the wall.
    pub wall: Spread,
    /// Volume of the given lumen: the union of its tubes, by sampling.
    pub lumen: f64,
    /// Volume of the mesh.
    pub volume: f64,
}

/// Volume of the lumen of a network: of the union of its tubes, by sampling.
pub fn lumen_of(network: &Skeleton) -> f64 {
    lumen::volume(network, &Tubes::of(network))
}

/// The networks that are compared.
#[derive(Clone, Copy, Debug)]
pub struct Compared<'a> {
    /// As it was read, with usable radii.
    pub given: &'a Skeleton,
    /// The same with as many points as its shape needs.
    pub outline: &'a Skeleton,
    /// What was meshed.
    pub meshed: &'a Skeleton,
}

/// An axis that is further from the given one than so many radii in the median was moved.
const MOVED: f64 = 0.1;

impl Fidelity {
    /// Holds a mesh of so much volume against its network.
    ///
    /// # Errors
    /// When the mesh cannot be read.
    pub fn of(networks: Compared, mesh: &dyn MeshSource, volume: f64) -> io::Result<Self> {
        let Compared { given, outline, meshed } = networks;
        let outlined = Tubes::of(outline);
        let wall = wall::spread(&outlined, mesh)?;
        let lumen = lumen::volume(outline, &outlined);
        let tubes = if std::ptr::eq(outline, meshed) {
            outlined
        } else {
            drop(outlined);
            Tubes::of(meshed)
        };
        Ok(Self { axis: Displacements::of(given, meshed, &tubes), wall, lumen, volume })
    }

    /// Whether vessels were moved (as a refinement does): the wall's distance from the given tubes is then no error of the wall.
    pub fn is_moved(&self) -> bool {
        self.axis.spread.median > MOVED
    }

    /// Volume of the mesh over that of the given lumen, less 1.
    pub fn swelling(&self) -> f64 {
        if self.lumen > 0.0 { self.volume / self.lumen - 1.0 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Vec3;
    use anastomesh_skeleton::fixtures::network;
    use std::f64::consts::PI;

    /// The lumen of some tubes of radius 1.
    fn lumen(points: &[[f64; 3]], edges: &[(u32, u32)]) -> f64 {
        lumen_of(&network(points, 1.0, edges))
    }

    fn displacements(given: &Skeleton, meshed: &Skeleton) -> Displacements {
        Displacements::of(given, meshed, &Tubes::of(meshed))
    }

    #[test]
    fn what_tubes_have_in_common_counts_once() {
        let tube = lumen(&[[0.0; 3], [10.0, 0.0, 0.0]], &[(0, 1)]);
        assert!((tube / (10.0 * PI) - 1.0).abs() < 1e-9, "{tube}");
        // Two cylinders that cross at a right angle have 16/3 in common.
        let crossed = lumen(&[[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, -9.0, 0.0], [0.0, 9.0, 0.0]], &[(0, 1), (2, 3)]);
        assert!((crossed / (36.0 * PI - 16.0 / 3.0) - 1.0).abs() < 0.01, "{crossed}");
        // The same vessel in many pieces.
        let points: Vec<[f64; 3]> = (0..=40).map(|i| [0.25 * f64::from(i), 0.0, 0.0]).collect();
        let edges: Vec<(u32, u32)> = (0..40).map(|i| (i, i + 1)).collect();
        let pieces = lumen(&points, &edges);
        assert!((pieces / (10.0 * PI) - 1.0).abs() < 0.01, "{pieces}");
    }

    #[test]
    fn an_axis_that_was_moved_is_found_with_its_place() {
        let points = [[0.0; 3], [10.0, 0.0, 0.0], [20.0, 0.0, 0.0]];
        let given = network(&points, 1.0, &[(0, 1), (1, 2)]);
        let mut moved = given.clone();
        assert!(displacements(&given, &moved).spread.worst <= 0.0);
        moved.nodes[1].position += Vec3::new(0.0, 3.0, 0.0);
        let found = displacements(&given, &moved);
        let first = found.furthest[0];
        // The nearest place of the bent axis is on the side.
        assert!((first.radii - 3.0 * 10.0 / 109.0_f64.sqrt()).abs() < 1e-9 && first.given.contains(&1), "{first:?}");
        // Within a thicker vessel it is in its lumen.
        let thick = network(&points, 3.5, &[(0, 1), (1, 2)]);
        let mut beside = given;
        beside.nodes.iter_mut().for_each(|n| n.position.y = 3.0);
        assert!(displacements(&beside, &thick).spread.worst < 1.0);
    }
}
