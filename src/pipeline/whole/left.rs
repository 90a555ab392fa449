//! A whole as it is left in its work directory: all that has to be known of it beside its blocks, so that it can be read without
//! its network.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{Listener, PartPlan, Whole};
use crate::block::Sizes;
use crate::geometry::{Point3, Vec3};
use crate::mesh::source::SourceCounts;
use crate::mesh::{Cap, Patch};
use crate::pipeline::make::{JointPlace, Kept};
use crate::pipeline::store::{Extents, MANIFEST, Store, StoreError};
use crate::progress::Progress;

const NAME: &str = "whole";

/// What is left. Records are numbered as the parts.
#[derive(Serialize, Deserialize)]
struct Left {
    extents: Extents,
    parts: Vec<LeftPart>,
    patches: Vec<LeftPatch>,
    patch_of: Vec<(u32, i32)>,
    open: BTreeMap<JointPlace, i32>,
    joined: Vec<[(u32, u32); 2]>,
    /// Points, tetrahedra, boundary faces.
    counts: [u64; 3],
}

/// As [`PartPlan`].
#[derive(Serialize, Deserialize)]
struct LeftPart {
    sizes: Sizes,
    block: i32,
    first_point: u32,
    first_tet: u64,
    joined_to: Option<[JointPlace; 2]>,
}

/// As [`Patch`], with the letters of its name as bytes; a cap is its node, centre, normal and radius.
#[derive(Serialize, Deserialize)]
struct LeftPatch {
    id: i32,
    name: Vec<u8>,
    cap: Option<(u32, [f64; 7])>,
}

impl LeftPatch {
    fn of(Patch { id, name, cap }: &Patch) -> Self {
        let disc = |Cap { node, center: c, normal: n, radius }: &Cap| (*node, [c.x, c.y, c.z, n.x, n.y, n.z, *radius]);
        Self { id: *id, name: name.as_bytes().to_vec(), cap: cap.as_ref().map(disc) }
    }

    fn patch(self) -> Patch {
        let cap = self.cap.map(|(node, [a, b, c, x, y, z, radius])| Cap {
            node,
            center: Point3::new(a, b, c),
            normal: Vec3::new(x, y, z),
            radius,
        });
        Patch { id: self.id, name: String::from_utf8_lossy(&self.name).into_owned(), cap }
    }
}

/// A finished mesh in a work directory, to be read without its network.
///
#[derive(Debug)]
pub struct LeftWhole {
    store: Store,
    /// With parts whose records are those of the store.
    left: Box<LeftPlan>,
}

/// A whole without its store.
#[derive(Debug)]
struct LeftPlan {
    parts: Vec<PartPlan>,
    patches: Vec<Patch>,
    patch_of: Vec<(u32, i32)>,
    open: BTreeMap<JointPlace, i32>,
    joined: Vec<[(u32, u32); 2]>,
    counts: SourceCounts,
}

impl LeftWhole {
    /// Whether a folder is a work directory.
    pub fn may_be_in(folder: &Path) -> bool {
        folder.join(MANIFEST).is_file()
    }

    /// What is left in a folder; none where no run has come so far, or it is damaged.
    pub fn open(folder: &Path) -> Option<Self> {
        let left: Left = Store::left(folder, NAME)?;
        if left.extents.len() != left.parts.len() {
            return None;
        }
        let part = |(i, part): (usize, LeftPart)| PartPlan {
            kept: Kept { record: Extents::record(i), sizes: part.sizes },
            block: part.block,
            first_point: part.first_point,
            first_tet: part.first_tet,
            joined_to: part.joined_to,
        };
        let [points, tets, boundary] = left.counts.map(|count| count as usize);
        Some(Self {
            store: Store::of_extents(folder, &left.extents)?,
            left: Box::new(LeftPlan {
                parts: left.parts.into_iter().enumerate().map(part).collect(),
                patches: left.patches.into_iter().map(LeftPatch::patch).collect(),
                patch_of: left.patch_of,
                open: left.open,
                joined: left.joined,
                counts: SourceCounts { points, tets, boundary },
            }),
        })
    }

    /// The mesh, to be read in passes that end when they are told to.
    pub fn whole<'a>(&'a self, progress: &'a dyn Progress) -> Whole<'a> {
        let LeftPlan { parts, patches, patch_of, open, joined, counts } = &*self.left;
        Whole {
            store: &self.store,
            listener: Listener(progress),
            parts: parts.clone(),
            patches: patches.clone(),
            patch_of: patch_of.clone(),
            open: open.clone(),
            joined: joined.clone(),
            counts: *counts,
        }
    }
}

impl Whole<'_> {
    /// Leaves it in its work directory, if its blocks are in one.
    ///
    /// # Errors
    /// When that cannot be written.
    pub fn leave(&self) -> Result<(), StoreError> {
        let Some(extents) = self.store.extents(self.parts.iter().map(|part| part.kept.record)) else { return Ok(()) };
        let part = |plan: &PartPlan| LeftPart {
            sizes: plan.kept.sizes,
            block: plan.block,
            first_point: plan.first_point,
            first_tet: plan.first_tet,
            joined_to: plan.joined_to,
        };
        let SourceCounts { points, tets, boundary } = self.counts;
        let left = Left {
            extents,
            parts: self.parts.iter().map(part).collect(),
            patches: self.patches.iter().map(LeftPatch::of).collect(),
            patch_of: self.patch_of.clone(),
            open: self.open.clone(),
            joined: self.joined.clone(),
            counts: [points, tets, boundary].map(|count| count as u64),
        };
        self.store.leave(NAME, &left)
    }
}
