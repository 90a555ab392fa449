//! Numbers and names shared by writer and reader, and the custom section.

use crate::volume::content::MeshNotes;
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::{Cap, NamedRegion, Patch};
use rustc_hash::FxHashMap;

/// Gmsh element types.
pub(super) const MSH_TRIANGLE: i32 = 2;
pub(super) const MSH_QUAD: i32 = 3;
pub(super) const MSH_TETRA: i32 = 4;
pub(super) const MSH_PRISM: i32 = 6;
pub(super) const MSH_PYRAMID: i32 = 7;
pub(super) const MSH_LINE_3: i32 = 8;
pub(super) const MSH_TRIANGLE_6: i32 = 9;
pub(super) const MSH_TETRA_10: i32 = 11;

/// Places of Gmsh's nodes of a ten-node tetrahedron in VTK's order, and the reverse. Gmsh has the edges 01, 12, 02, 03, 23, 13; VTK swaps the
/// last two.
pub(super) const TETRA_10_ORDER: [usize; 10] = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8];

/// Name of the volume's physical group.
pub(super) const VOLUME_NAME: &str = "lumen";

/// Name of the custom section.
pub(super) const SECTION: &str = "Anastomesh";

/// Contents of the custom section, as JSON.
#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Extra {
    generator: String,
    options: String,
    loops: Option<Vec<u32>>,
    terminals: Option<Vec<u32>>,
    caps: Vec<ExtraCap>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    regions: Vec<NamedRegion>,
    /// Physical groups that are not the numbers of their regions.
    #[serde(default, skip_serializing_if = "RegionGroups::is_empty")]
    pub(super) groups: RegionGroups,
}

/// Physical groups of regions. A group is the number of its region if that is positive, as the format requires. Others get the
/// next numbers above all. Holds pairs of region and group for these.
#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct RegionGroups(Vec<[i32; 2]>);

impl RegionGroups {
    pub(super) fn of(regions: &[NamedRegion]) -> Self {
        let ids = || regions.iter().map(|region| region.id);
        let free = ids().max().unwrap_or(0).max(0).checked_add(1).map(|first| first..=i32::MAX);
        let others = ids().filter(|&id| id <= 0);
        Self(others.zip(free.into_iter().flatten()).map(Into::into).collect())
    }

    /// Group of a region; `None` for a number that is not positive and not in the list.
    pub(super) fn of_region(&self, id: i32) -> Option<i32> {
        let other = || self.0.iter().find(|pair| pair[0] == id).map(|pair| pair[1]);
        if id > 0 { Some(id) } else { other() }
    }

    /// Region of each group that is not its number.
    pub(super) fn regions(&self) -> FxHashMap<i32, i32> {
        self.0.iter().map(|&[region, group]| (group, region)).collect()
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Cap in the custom section.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
struct ExtraCap {
    patch: i32,
    node: u32,
    center: [f64; 3],
    normal: [f64; 3],
    radius: f64,
}

impl Extra {
    pub(super) fn of(patches: &[Patch], notes: &MeshNotes) -> Self {
        let cap = |id: i32, cap: &Cap| ExtraCap {
            patch: id,
            node: cap.node,
            center: cap.center.coords.into(),
            normal: cap.normal.into(),
            radius: cap.radius,
        };
        Self {
            generator: notes.generator.clone(),
            options: notes.options.clone(),
            loops: notes.expectation.as_ref().map(|expected| expected.loops.clone()),
            terminals: notes.expectation.as_ref().map(|expected| expected.terminals.clone()),
            caps: patches.iter().filter_map(|p| p.cap.as_ref().map(|c| cap(p.id, c))).collect(),
            regions: notes.regions.clone(),
            groups: RegionGroups::of(&notes.regions),
        }
    }

    /// Returns the notes, and the caps with their patches.
    pub(super) fn into_notes(self) -> (MeshNotes, Vec<(i32, Cap)>) {
        let terminals = self.terminals.unwrap_or_default();
        let expectation = self.loops.map(|loops| Expectation { loops, terminals });
        let Self { generator, options, regions, .. } = self;
        let notes = MeshNotes { expectation, generator, options, regions, flow: None };
        let cap = |c: ExtraCap| {
            let (center, normal) = (Point3::from(c.center), Vec3::from(c.normal));
            (c.patch, Cap { node: c.node, center, normal, radius: c.radius })
        };
        (notes, self.caps.into_iter().map(cap).collect())
    }
}

/// Type of a cell with these vertices.
pub(super) fn kind_of_cell(vertices: &[u32]) -> i32 {
    match vertices.len() {
        6 => MSH_PRISM,
        5 => MSH_PYRAMID,
        _ => MSH_TETRA,
    }
}

/// Type of a face with these vertices.
pub(super) fn kind_of_face(vertices: &[u32]) -> i32 {
    if vertices.len() == 4 { MSH_QUAD } else { MSH_TRIANGLE }
}
