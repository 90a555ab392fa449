//! Whole mesh as stored in its work directory. The record has the data besides the blocks that are needed to read the mesh
//! without its network.

use std::path::Path;

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

use super::numbering::Numbering;
use super::{CancelOnly, Whole};
use crate::pipeline::store::{BlockRecords, Extents, MANIFEST, Store, StoreError};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::{Cap, Patch};

/// Name of the file, after that of the program.
pub(super) const NAME: &str = "whole";

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

/// Stored form of patches.
pub(super) mod patches {
    use super::{LeftPatch, Patch};
    use serde::{Deserialize, Deserializer, Serializer};

    pub(in super::super) fn serialize<S: Serializer>(patches: &[Patch], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(patches.iter().map(LeftPatch::of))
    }

    pub(in super::super) fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Vec<Patch>, D::Error> {
        Ok(Vec::<LeftPatch>::deserialize(from)?.into_iter().map(LeftPatch::patch).collect())
    }
}

/// A finished mesh in a work directory, to be read without its network.
#[derive(Debug)]
pub struct LeftWhole {
    store: Store,
    /// With parts whose records are those of the store.
    plan: Box<Numbering>,
}

impl LeftWhole {
    /// True if a folder is a work directory.
    pub fn may_be_in(folder: &Path) -> bool {
        folder.join(MANIFEST).is_file()
    }

    /// Reads the whole from a folder; `None` if no run has finished, or if it is damaged.
    pub fn open(folder: &Path) -> Option<Self> {
        // Two records per part, in order.
        let (extents, mut plan): (Extents, Box<Numbering>) = Store::left(folder, NAME)?;
        if extents.len() != 2 * plan.parts.len() || !plan.is_sound() {
            return None;
        }
        for (i, part) in plan.parts.iter_mut().enumerate() {
            let [geometry, connectivity] = [2 * i, 2 * i + 1].map(Extents::record);
            part.records = BlockRecords { geometry, connectivity };
        }
        Some(Self { store: Store::of_extents(folder, &extents)?, plan })
    }

    /// The mesh, to be read in passes that end when they are told to.
    pub fn whole<'a>(&'a self, progress: &'a dyn Progress) -> Whole<'a> {
        Whole { store: &self.store, listener: CancelOnly(progress), plan: Cow::Borrowed(&self.plan) }
    }
}

impl Whole<'_> {
    /// Leaves it in its work directory, if its blocks are in one.
    ///
    /// # Errors
    /// The record cannot be written.
    pub fn leave(&self) -> Result<(), StoreError> {
        let records = self.plan.parts.iter().map(|part| part.records);
        let records = records.flat_map(|BlockRecords { geometry, connectivity }| [geometry, connectivity]);
        let Some(extents) = self.store.extents(records) else { return Ok(()) };
        self.store.leave(NAME, &(extents, &*self.plan))
    }
}
