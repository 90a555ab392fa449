//! Data besides arrays: patch names, caps, and expectations for checks.

use crate::volume::content::MeshNotes;
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::{Cap, NamedRegion, Patch};
use serde::{Deserialize, Serialize};

/// Contents of `mesh.json`.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Notes {
    generator: String,
    options: String,
    regions: Regions,
    expected: Option<Expected>,
    patches: Vec<NamedPatch>,
}

/// Regions of the mesh.
#[derive(Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum Regions {
    /// Ids of blocks with their names; none if blocks are no regions.
    Named(Vec<NamedRegion>),
    /// True if blocks are regions without names (version 0.1).
    Unnamed(bool),
}

impl Default for Regions {
    fn default() -> Self {
        Self::Named(Vec::new())
    }
}

impl Regions {
    fn named(self, blocks: &[i32]) -> Vec<NamedRegion> {
        match self {
            Self::Named(regions) => regions,
            Self::Unnamed(true) => NamedRegion::all_numbered(blocks.iter().copied()),
            Self::Unnamed(false) => Vec::new(),
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
struct Expected {
    loops: Vec<u32>,
    terminals: Vec<u32>,
}

#[derive(Debug, Serialize, Deserialize)]
struct NamedPatch {
    id: i32,
    name: String,
    cap: Option<Disc>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Disc {
    node: u32,
    center: [f64; 3],
    normal: [f64; 3],
    radius: f64,
}

impl Notes {
    pub(super) fn new(notes: &MeshNotes, patches: &[Patch]) -> Self {
        let expected = notes.expectation.clone().map(|Expectation { loops, terminals }| Expected { loops, terminals });
        let disc = |cap: Cap| Disc {
            node: cap.node,
            center: cap.center.into(),
            normal: cap.normal.into(),
            radius: cap.radius,
        };
        let named = |patch: &Patch| NamedPatch { id: patch.id, name: patch.name.clone(), cap: patch.cap.map(disc) };
        Self {
            generator: notes.generator.clone(),
            options: notes.options.clone(),
            regions: Regions::Named(notes.regions.clone()),
            expected,
            patches: patches.iter().map(named).collect(),
        }
    }

    /// Returns the notes and patches of a mesh with these blocks.
    pub(super) fn into_parts(self, blocks: &[i32]) -> (MeshNotes, Vec<Patch>) {
        let expectation = self.expected.map(|Expected { loops, terminals }| Expectation { loops, terminals });
        let cap = |disc: Disc| Cap {
            node: disc.node,
            center: Point3::from(disc.center),
            normal: Vec3::from(disc.normal),
            radius: disc.radius,
        };
        let named = |NamedPatch { id, name, cap: disc }| Patch { id, name, cap: disc.map(cap) };
        let mut patches: Vec<Patch> = self.patches.into_iter().map(named).collect();
        patches.sort_by_key(|patch| patch.id);
        patches.dedup_by_key(|patch| patch.id);
        let Self { generator, options, regions, .. } = self;
        (MeshNotes { expectation, generator, options, regions: regions.named(blocks), flow: None }, patches)
    }
}
