//! Field data of a VTU file: patch names, caps, and expectations for checks.

use super::error::VtuFault;
use super::names::field;
use crate::patches::{usual_name, usual_patches};
use crate::volume::content::MeshNotes;
use crate::vtk_xml::{ElementId, Values, VtkXml};
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::{Cap, NamedRegion, Patch};
use rustc_hash::FxHashMap;

/// True if a byte array contains text, by its name.
fn holds_text(name: &str) -> bool {
    name.ends_with("_names") || [field::GENERATOR, field::OPTIONS].contains(&name)
}

/// Field data of a file.
#[derive(Default)]
pub(super) struct Fields {
    ints: FxHashMap<String, Vec<i64>>,
    floats: FxHashMap<String, Vec<f64>>,
    strings: FxHashMap<String, Vec<String>>,
}

impl Fields {
    pub(super) fn is_empty(&self) -> bool {
        self.ints.is_empty() && self.floats.is_empty() && self.strings.is_empty()
    }

    pub(super) fn read(xml: &VtkXml, grid: ElementId) -> Result<Self, VtuFault> {
        let mut fields = Self::default();
        for data in xml.children(grid, "FieldData") {
            for (name, array) in xml.arrays(data) {
                let is_text = match xml.attribute(array, "type") {
                    Some("String") => true,
                    Some("UInt8") => holds_text(name),
                    _ => false,
                };
                let values = xml.read(array)?;
                if is_text {
                    fields.strings.insert(name.into(), values.into_strings().unwrap_or_default());
                } else if matches!(values.values, Values::Int(_)) {
                    fields.ints.insert(name.into(), values.into_ints().unwrap_or_default());
                } else {
                    fields.floats.insert(name.into(), values.into_floats());
                }
            }
        }
        Ok(fields)
    }

    fn text(&self, name: &str) -> String {
        self.strings.get(name).and_then(|texts| texts.first()).cloned().unwrap_or_default()
    }

    fn counts(&self, name: &str) -> Option<Vec<u32>> {
        self.ints.get(name).map(|values| values.iter().map(|&v| u32::try_from(v).unwrap_or(u32::MAX)).collect())
    }

    pub(super) fn notes(&self) -> MeshNotes {
        // Empty lists are not written: a mesh of loops only has no terminals.
        let expectation = self
            .counts(field::LOOPS)
            .map(|loops| Expectation { loops, terminals: self.counts(field::TERMINALS).unwrap_or_default() });
        MeshNotes {
            expectation,
            generator: self.text(field::GENERATOR),
            options: self.text(field::OPTIONS),
            regions: self.regions(),
            flow: None,
        }
    }

    /// Regions, ascending; those without a name have the default name.
    fn regions(&self) -> Vec<NamedRegion> {
        let ids = self.ints.get(field::REGION_IDS).map_or(&[][..], Vec::as_slice);
        let names = self.strings.get(field::REGION_NAMES).map_or(&[][..], Vec::as_slice);
        let name = |i: usize| names.get(i).filter(|name| !name.is_empty());
        let region = |(i, &id): (usize, &i64)| {
            let id = i32::try_from(id).ok()?;
            Some(name(i).map_or_else(|| NamedRegion::numbered(id), |name| NamedRegion::new(id, name)))
        };
        let mut regions: Vec<NamedRegion> = ids.iter().enumerate().filter_map(region).collect();
        regions.sort_by_key(|region| region.id);
        regions.dedup_by_key(|region| region.id);
        regions
    }

    /// Patches with a name or a cap (names end at some id). If none has a name, the occurring ones with default names.
    pub(super) fn patches(&self, label_array: &str, used: &[i32]) -> Vec<Patch> {
        self.named_patches(label_array).unwrap_or_else(|| {
            let caps = self.caps();
            let capped = |patch: Patch| Patch { cap: caps.get(&patch.id).copied(), ..patch };
            usual_patches(used).into_iter().map(capped).collect()
        })
    }

    /// Patches with a name or a cap; `None` if the file has no names.
    pub(super) fn named_patches(&self, label_array: &str) -> Option<Vec<Patch>> {
        let names = self.strings.get(&format!("{label_array}_names"))?;
        let mut caps = self.caps();
        let named = names.iter().enumerate().skip(1).filter(|(_, name)| !name.is_empty());
        let mut patches: Vec<Patch> = named
            .map(|(id, name)| Patch { id: id as i32, name: name.clone(), cap: caps.remove(&(id as i32)) })
            .collect();
        patches.extend(caps.into_iter().map(|(id, cap)| Patch { id, name: usual_name(id), cap: Some(cap) }));
        patches.sort_by_key(|patch| patch.id);
        Some(patches)
    }

    /// Caps by patch; empty if their arrays are inconsistent.
    fn caps(&self) -> FxHashMap<i32, Cap> {
        let ints = |name| self.ints.get(name).map_or(&[][..], Vec::as_slice);
        let floats = |name| self.floats.get(name).map_or(&[][..], Vec::as_slice);
        let (centers, _) = floats(field::CAP_CENTER).as_chunks::<3>();
        let (normals, _) = floats(field::CAP_NORMAL).as_chunks::<3>();
        let (nodes, radii) = (ints(field::CAP_NODE), floats(field::CAP_RADIUS));
        let mut caps = FxHashMap::default();
        for (i, &id) in ints(field::CAP_PATCH).iter().enumerate() {
            let (Some(&node), Some(&center)) = (nodes.get(i), centers.get(i)) else { break };
            let (Some(&normal), Some(&radius)) = (normals.get(i), radii.get(i)) else { break };
            let node = u32::try_from(node).unwrap_or(u32::MAX);
            caps.insert(id as i32, Cap { node, center: Point3::from(center), normal: Vec3::from(normal), radius });
        }
        caps
    }
}
