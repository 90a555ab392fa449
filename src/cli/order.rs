//! Option `--order`: second-order elements.

use super::exit::Failure;
use crate::pipeline::{Estimate, TooLarge};
use anastomesh_io::volume::{MeshFormat, MeshNotes};
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::check::{CheckReport, check_regions_watched};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::second_order::{Curving, SecondOrder};
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_skeleton::{Skeleton, Tubes};
use std::io;

/// Bytes of memory per tetrahedron.
const BYTES_PER_TET: f64 = 320.0;

#[derive(Clone, Copy, Debug, clap::Args)]
pub struct OrderArgs {
    /// Order of the elements: 1, or 2 for ten-node tetrahedra whose midpoints lie on smooth walls and interfaces (VTU, MSH,
    /// .npyd and .svmesh, in memory)
    #[arg(long, value_name = "ORDER", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=2))]
    order: u8,
}

/// Second-order mesh.
pub struct SecondOrderMesh {
    /// Mesh of the corners.
    pub corners: VolumeMesh,
    pub midpoints: SecondOrder,
    pub curving: Curving,
    pub check: CheckReport,
    /// True if vertices are on the curved surfaces of the given volume, false if they are those of the linear mesh.
    pub is_balanced: bool,
}

impl SecondOrderMesh {
    fn of(corners: VolumeMesh, notes: &MeshNotes, is_balanced: bool, progress: &dyn Progress) -> io::Result<Self> {
        let (midpoints, curving) = SecondOrder::curved_watched(&corners, progress)?;
        let check = check_regions_watched(&corners, &notes.regions, notes.expectation.as_ref(), progress)?;
        let check = check.with_second_order(&corners, &midpoints);
        Ok(Self { corners, midpoints, curving, check, is_balanced })
    }
}

impl OrderArgs {
    /// True for second-order elements.
    pub fn is_second(self) -> bool {
        self.order == 2
    }

    /// Refuses formats without second-order elements, and this other option if it is given.
    pub fn check(self, format: Option<MeshFormat>, others: &[(&str, bool)]) -> Result<(), Failure> {
        if !self.is_second() {
            return Ok(());
        }
        if !format.is_some_and(MeshFormat::has_second_order) {
            return Err(Failure::usage(
                "--order 2 is not supported by this format: use .vtu, .msh, .msh2, .npyd or .svmesh",
            ));
        }
        match others.iter().find(|(_, is_given)| *is_given) {
            Some((option, _)) => Err(Failure::usage(format!("--order 2 does not combine with {option}"))),
            None => Ok(()),
        }
    }

    /// Checks that a second-order mesh fits into the memory limit.
    pub fn fits(self, estimate: &Estimate, memory: u64) -> Result<(), TooLarge> {
        let bytes = (estimate.tets * BYTES_PER_TET) as u64;
        if self.is_second() && bytes > memory {
            let (estimate, why, instead) = (*estimate, "second-order elements", "--order 1");
            return Err(TooLarge::Whole { estimate, why, instead, bytes, memory });
        }
        Ok(())
    }

    /// Midpoints on surfaces through the vertices of a mesh; `None` for linear elements.
    pub fn midpoints(self, volume: &VolumeMesh, progress: &dyn Progress) -> io::Result<Option<(SecondOrder, Curving)>> {
        self.is_second().then(|| SecondOrder::curved_watched(volume, progress)).transpose()
    }

    /// Second-order mesh of a network whose wall lies on the vessels' radius; `None` for linear elements. If the mesh with moved vertices
    /// has more faults than the linear one, which `check` reports, vertices stay.
    pub fn balanced(
        self,
        mesh: &dyn MeshSource,
        network: &Skeleton,
        check: &CheckReport,
        notes: &MeshNotes,
        progress: &dyn Progress,
    ) -> io::Result<Option<SecondOrderMesh>> {
        if !self.is_second() {
            return Ok(None);
        }
        let given = mesh.whole().map_or_else(|| gather(mesh), |volume| Ok(volume.clone()))?;
        let mut moved = given.clone();
        let tubes = Tubes::of(network);
        moved.mesh.points = SecondOrder::balanced_points(&given, &|p| onto_radius(&tubes, p));
        let balanced = SecondOrderMesh::of(moved, notes, true, progress)?;
        let faults = |check: &CheckReport| check.failed().map(|failed| failed.count.max(1)).sum::<u64>();
        let is_sound = faults(&balanced.check) <= faults(check);
        Ok(Some(if is_sound { balanced } else { SecondOrderMesh::of(given, notes, false, progress)? }))
    }

    /// The option as command-line text, if it is not the default.
    pub fn typed(self) -> &'static str {
        if self.is_second() { " --order 2" } else { "" }
    }
}

/// Distances from the radius, relative to it, up to which vertices move there, and beyond which they stay. Rings at joints are 0.8 %
/// outside, which is an excess of the linear mesh. Forks and bends differ by more.
const NEAR_RADIUS: [f64; 2] = [0.02, 0.05];

/// Displacement from a position near the wall of a tube onto it.
fn onto_radius(tubes: &Tubes, place: &Point3) -> Vec3 {
    let Some(near) = tubes.nearest_wall(place) else { return Vec3::zeros() };
    let [whole, none] = NEAR_RADIUS;
    let share = ((none - (near.distance / near.radius - 1.0).abs()) / (none - whole)).clamp(0.0, 1.0);
    let tube = &tubes.list[near.edge.0 as usize];
    let axis = tube.a + (tube.b - tube.a) * near.t;
    (place - axis).try_normalize(0.0).map_or(Vec3::zeros(), |away| away * (share * (near.radius - near.distance)))
}
