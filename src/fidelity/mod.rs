//! Fidelity of a mesh to its network.
//!
//! A valid mesh may still misrepresent the network: a displaced axis, an enlarged lumen, or a wall off the radius. The
//! given network is therefore compared with the meshed network (axis and volume) and with the wall.

mod along;
mod axis;
mod changes;
mod lumen;
#[cfg(feature = "cli")]
mod networks;
mod radius;
mod spread;
mod text;
mod wall;

use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::{Skeleton, Tubes};
use serde::Serialize;
use std::io;

pub use along::{Along, Bin};
pub use axis::{Displaced, Displacements};
pub use changes::{Change, Changes, Repairs};
pub use radius::{RadiusReference, SectionErrors};
pub use spread::Spread;
#[cfg(feature = "cli")]
pub(crate) use text::share;

/// Fidelity figures of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Fidelity {
    /// Displacement of the meshed axis from the given one, in radii of the given vessel.
    pub axis: Displacements,
    /// Relative distance of the wall from the given tubes: |d − r| / r at points of the wall.
    pub wall: Spread,
    /// Radius error of the sections.
    pub radius: SectionErrors,
    /// Volume of the given lumen: the union of its tubes, by sampling.
    pub lumen: f64,
    /// Volume of the mesh.
    pub volume: f64,
}

/// Volume of the lumen of a network: the union of its tubes, by sampling.
pub fn lumen_of(network: &Skeleton) -> f64 {
    lumen::volume(network, &Tubes::of(network))
}

/// Networks to compare.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compared<'a> {
    /// Input network with usable radii.
    pub given: &'a Skeleton,
    /// Resampled input network.
    pub outline: &'a Skeleton,
    /// Meshed network.
    pub meshed: &'a Skeleton,
}

/// Median displacement of the axis, in radii, above which the network counts as moved.
const MOVED: f64 = 0.1;

impl Fidelity {
    /// Compares a mesh of this volume with its network.
    ///
    /// # Errors
    /// The mesh cannot be read.
    pub(crate) fn of(networks: Compared, mesh: &dyn MeshSource, volume: f64) -> io::Result<Self> {
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
        let axis = Displacements::of(given, meshed, &tubes);
        let mut found = Self { axis, wall, lumen, volume, ..Self::default() };
        found.radius = if found.axis.spread.p99 > MOVED {
            SectionErrors { spread: wall::spread(&tubes, mesh)?, of: RadiusReference::Moved }
        } else {
            SectionErrors { spread: found.wall, of: RadiusReference::Given }
        };
        Ok(found)
    }

    /// True if vessels were moved (by a refinement): the wall's distance from the given tubes is then no error.
    pub fn is_moved(&self) -> bool {
        self.axis.spread.median > MOVED
    }

    /// Relative excess of the mesh volume over the given lumen; 0 if the given network has no volume.
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

    /// Lumen of tubes of radius 1.
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
        // Two cylinders that cross at a right angle share 16/3.
        let crossed = lumen(&[[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, -9.0, 0.0], [0.0, 9.0, 0.0]], &[(0, 1), (2, 3)]);
        assert!((crossed / (36.0 * PI - 16.0 / 3.0) - 1.0).abs() < 0.01, "{crossed}");
        // A vessel in many pieces.
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
        // The nearest place of the bent axis is to the side.
        assert!((first.radii - 3.0 * 10.0 / 109.0_f64.sqrt()).abs() < 1e-9 && first.given.contains(&1), "{first:?}");
        // A place within a thicker vessel lies in its lumen.
        let thick = network(&points, 3.5, &[(0, 1), (1, 2)]);
        let mut beside = given;
        beside.nodes.iter_mut().for_each(|n| n.position.y = 3.0);
        assert!(displacements(&beside, &thick).spread.worst < 1.0);
    }
}
