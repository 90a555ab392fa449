//! Reader of Gmsh's MSH format: 4.1 (text or binary) and 2.2 (text).

use super::cursor::{MshCursor, Version};
use super::error::MshFault;
use super::names::{
    Extra, MSH_LINE_3, MSH_PRISM, MSH_PYRAMID, MSH_QUAD, MSH_TETRA, MSH_TETRA_10, MSH_TRIANGLE, MSH_TRIANGLE_6,
    SECTION, TETRA_10_ORDER,
};
use crate::patches::{distinct, usual_name};
use crate::volume::content::{MeshFile, separate_midpoints};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::region::{NamedRegion, label_faces};
use anastomesh_mesh::stacks::Polyhedra;
use anastomesh_mesh::{Cap, Patch};
use rustc_hash::FxHashMap;

/// Reads a mesh from the bytes of a `.msh` file, version 4.1 or 2.2 as text. Prisms, pyramids and quadrilaterals are
/// split into tetrahedra and triangles; points and lines are skipped. Second-order elements are read if all are. The label of a triangle is the first physical group of its surface.
///
/// # Errors
/// The file is invalid or incomplete, or has other elements.
pub(in crate::volume) fn read(bytes: &[u8]) -> Result<MeshFile, MshFault> {
    let mut cursor = MshCursor::new(bytes);
    let mut parts = MshSections::default();
    if cursor.next_section()? != Some("MeshFormat") {
        return Err(MshFault::Missing { what: "$MeshFormat" });
    }
    let version = cursor.read_format()?;
    cursor.finish_section("MeshFormat")?;
    let (mut nodes, mut elements) = (false, false);
    while let Some(name) = cursor.next_section()? {
        match name {
            "PhysicalNames" => parts.read_names(&mut cursor)?,
            "Entities" => parts.read_entities(&mut cursor, false)?,
            "PartitionedEntities" => {
                skip_ghost_entities(&mut cursor)?;
                parts.read_entities(&mut cursor, true)?;
            }
            "Nodes" if version == Version::Two => parts.read_node_list(&mut cursor)?,
            "Nodes" => parts.read_nodes(&mut cursor)?,
            "Elements" if version == Version::Two => parts.read_element_list(&mut cursor)?,
            "Elements" => parts.read_elements(&mut cursor)?,
            SECTION => parts.read_extra(&mut cursor)?,
            _ => {}
        }
        cursor.finish_section(name)?;
        nodes |= name == "Nodes";
        elements |= name == "Elements";
    }
    if !nodes || !elements {
        return Err(MshFault::Missing { what: if nodes { "$Elements" } else { "$Nodes" } });
    }
    parts.into_file()
}

/// Contents of the sections.
#[derive(Default)]
struct MshSections {
    /// Names of the physical groups of surfaces.
    names: Vec<(i32, String)>,
    /// Names of the physical groups of volumes.
    volume_names: Vec<(i32, String)>,
    /// First physical group of each surface.
    group_of_surface: FxHashMap<i32, i32>,
    /// First physical group of each volume.
    group_of_volume: FxHashMap<i32, i32>,
    nodes: Vec<(u64, Point3)>,
    tets: Vec<(u64, [u64; 4], i32)>,
    triangles: Vec<(u64, [u64; 3], i32)>,
    /// Cells to split, by their tags. They have placeholders with their tags among tetrahedra and triangles.
    prisms: Vec<(u64, [u64; 6])>,
    pyramids: Vec<(u64, [u64; 5])>,
    quads: Vec<(u64, [u64; 4])>,
    /// Nodes of second-order elements by their tags, in VTK's order. Their corners are among tetrahedra and triangles.
    tets_10: Vec<(u64, [u64; 10])>,
    triangles_6: Vec<(u64, [u64; 6])>,
    extra: Extra,
}

impl MshSections {
    fn read_names(&mut self, cursor: &mut MshCursor) -> Result<(), MshFault> {
        // Text even in binary files.
        let count: u64 = cursor.line()?.parse().map_err(|_| cursor.bad())?;
        for _ in 0..count {
            let line = cursor.line()?;
            let mut words = line.splitn(3, ' ');
            let dimension = words.next().and_then(|w| w.parse::<i32>().ok()).ok_or_else(|| cursor.bad())?;
            let tag = words.next().and_then(|w| w.parse::<i32>().ok()).ok_or_else(|| cursor.bad())?;
            let name = words.next().unwrap_or_default().trim().trim_matches('"');
            match dimension {
                2 => self.names.push((tag, name.into())),
                3 => self.volume_names.push((tag, name.into())),
                _ => {}
            }
        }
        Ok(())
    }

    /// Reads the groups of entities. Partitioned ones also have a parent and a list of partitions.
    fn read_entities(&mut self, cursor: &mut MshCursor, is_partitioned: bool) -> Result<(), MshFault> {
        let counts: [u64; 4] = cursor.sizes()?;
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let tag = cursor.int()?;
                if is_partitioned {
                    cursor.int()?;
                    cursor.int()?;
                    for _ in 0..cursor.size()? {
                        cursor.int()?;
                    }
                }
                cursor.skip_floats(if dimension == 0 { 3 } else { 6 })?;
                for i in 0..cursor.size()? {
                    let group = cursor.int()?;
                    match dimension {
                        2 if i == 0 => drop(self.group_of_surface.insert(tag, group)),
                        3 if i == 0 => drop(self.group_of_volume.insert(tag, group)),
                        _ => {}
                    }
                }
                if dimension > 0 {
                    for _ in 0..cursor.size()? {
                        cursor.int()?;
                    }
                }
            }
        }
        Ok(())
    }

    fn read_nodes(&mut self, cursor: &mut MshCursor) -> Result<(), MshFault> {
        let [blocks, ..]: [u64; 4] = cursor.sizes()?;
        for _ in 0..blocks {
            let (dimension, _tag, parametric) = (cursor.int()?, cursor.int()?, cursor.int()?);
            let count = cursor.size()?;
            let first = self.nodes.len();
            for _ in 0..count {
                self.nodes.push((cursor.size()?, Point3::origin()));
            }
            for (_, point) in &mut self.nodes[first..] {
                *point = Point3::new(cursor.float()?, cursor.float()?, cursor.float()?);
                cursor.skip_floats(if parametric == 1 { dimension.clamp(0, 3) as usize } else { 0 })?;
            }
        }
        Ok(())
    }

    fn read_elements(&mut self, cursor: &mut MshCursor) -> Result<(), MshFault> {
        let [blocks, ..]: [u64; 4] = cursor.sizes()?;
        for _ in 0..blocks {
            let (_dimension, entity, kind) = (cursor.int()?, cursor.int()?, cursor.int()?);
            let groups = if matches!(kind, MSH_TETRA | MSH_TETRA_10 | MSH_PRISM | MSH_PYRAMID) {
                &self.group_of_volume
            } else {
                &self.group_of_surface
            };
            let group = groups.get(&entity).copied().unwrap_or(0);
            for _ in 0..cursor.size()? {
                let tag = cursor.size()?;
                self.read_corners(cursor, tag, kind, group)?;
            }
        }
        Ok(())
    }

    /// Reads nodes of version 2: a tag and a position each.
    fn read_node_list(&mut self, cursor: &mut MshCursor) -> Result<(), MshFault> {
        for _ in 0..cursor.size()? {
            let tag = cursor.size()?;
            self.nodes.push((tag, Point3::new(cursor.float()?, cursor.float()?, cursor.float()?)));
        }
        Ok(())
    }

    /// Reads elements of version 2: tag, type, count of further tags (first the physical group), these tags, corners.
    fn read_element_list(&mut self, cursor: &mut MshCursor) -> Result<(), MshFault> {
        for _ in 0..cursor.size()? {
            let (tag, kind, tags) = (cursor.size()?, cursor.int()?, cursor.size()?);
            let mut group = 0;
            for i in 0..tags {
                let value = cursor.int()?;
                group = if i == 0 { value } else { group };
            }
            if matches!(kind, MSH_TRIANGLE | MSH_TRIANGLE_6 | MSH_QUAD) {
                // What a reader of version 4.1 knows from the entities.
                self.group_of_surface.insert(group, group);
            }
            self.read_corners(cursor, tag, kind, group)?;
        }
        Ok(())
    }

    /// Reads the vertices of an element of a type.
    fn read_corners(&mut self, cursor: &mut MshCursor, tag: u64, kind: i32, group: i32) -> Result<(), MshFault> {
        match kind {
            MSH_TRIANGLE => self.triangles.push((tag, cursor.sizes()?, group)),
            MSH_TETRA => self.tets.push((tag, cursor.sizes()?, group)),
            MSH_TETRA_10 => {
                let nodes: [u64; 10] = cursor.sizes()?;
                self.tets.push((tag, [nodes[0], nodes[1], nodes[2], nodes[3]], group));
                self.tets_10.push((tag, TETRA_10_ORDER.map(|place| nodes[place])));
            }
            MSH_TRIANGLE_6 => {
                let nodes: [u64; 6] = cursor.sizes()?;
                self.triangles.push((tag, [nodes[0], nodes[1], nodes[2]], group));
                self.triangles_6.push((tag, nodes));
            }
            MSH_PRISM => {
                self.prisms.push((tag, cursor.sizes()?));
                self.tets.extend([(tag, [0; 4], group); 3]);
            }
            MSH_PYRAMID => {
                self.pyramids.push((tag, cursor.sizes()?));
                self.tets.extend([(tag, [0; 4], group); 2]);
            }
            MSH_QUAD => {
                self.quads.push((tag, cursor.sizes()?));
                self.triangles.extend([(tag, [0; 3], group); 2]);
            }
            // Lines and points bound no volume.
            1 => drop(cursor.sizes::<2>()?),
            MSH_LINE_3 => drop(cursor.sizes::<3>()?),
            15 => drop(cursor.size()?),
            _ => {
                let cell = self.tets.len() + self.triangles.len();
                return Err(MshFault::UnsupportedCell { kind: kind.into(), cell });
            }
        }
        Ok(())
    }

    fn read_extra(&mut self, cursor: &mut MshCursor) -> Result<(), MshFault> {
        let line = cursor.line()?;
        self.extra = serde_json::from_str(line).map_err(|_| cursor.bad())?;
        Ok(())
    }

    fn into_file(mut self) -> Result<MeshFile, MshFault> {
        let mut file = MeshFile::default();
        self.nodes.sort_by_key(|&(tag, _)| tag);
        if let Some(pair) = self.nodes.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(MshFault::RepeatedTag { tag: pair[0].0 });
        }
        self.tets.sort_by_key(|&(tag, ..)| tag);
        self.triangles.sort_by_key(|&(tag, ..)| tag);
        let polyhedra = self.polyhedra();
        let volume = &mut file.volume;
        volume.mesh.points = self.nodes.iter().map(|&(_, p)| p).collect();
        volume.mesh.tets = self.tets.iter().map(|(_, t, _)| t.map(|tag| self.index(tag))).collect();
        let mut faces: Vec<[u32; 3]> = self.triangles.iter().map(|(_, t, _)| t.map(|tag| self.index(tag))).collect();
        polyhedra.split(&mut volume.mesh.tets, &mut faces);
        volume.boundary = faces;
        let (tets_10, triangles_6) = self.second_order();
        file.second_order = separate_midpoints(volume, tets_10, triangles_6)?;
        let extra = std::mem::take(&mut self.extra);
        let regions = extra.groups.regions();
        self.tets.iter_mut().for_each(|tet| tet.2 = regions.get(&tet.2).copied().unwrap_or(tet.2));
        let (notes, caps) = extra.into_notes();
        file.notes = notes;
        if file.notes.regions.is_empty() {
            file.notes.regions = self.regions();
        }
        let has_regions = !file.notes.regions.is_empty();
        volume.tet_block = self.tets.iter().map(|tet| if has_regions { tet.2 } else { 0 }).collect();
        // Triangles without a group are not a labelled boundary.
        if self.triangles.iter().any(|&(.., group)| group != 0) {
            file.labelled = true;
            volume.boundary_patch = self.triangles.iter().map(|&(.., group)| group).collect();
            volume.boundary_block = vec![0; self.triangles.len()];
            volume.patches = self.patches(&caps);
            if has_regions {
                label_faces(volume);
            }
        } else {
            volume.boundary.clear();
        }
        Ok(file)
    }

    /// Nodes of the second-order elements, in the order of their tags.
    fn second_order(&mut self) -> (Vec<[u32; 10]>, Vec<[u32; 6]>) {
        self.tets_10.sort_by_key(|&(tag, _)| tag);
        self.triangles_6.sort_by_key(|&(tag, _)| tag);
        let tets = self.tets_10.iter().map(|(_, nodes)| nodes.map(|tag| self.index(tag))).collect();
        (tets, self.triangles_6.iter().map(|(_, nodes)| nodes.map(|tag| self.index(tag))).collect())
    }

    /// Regions of a file without a list of them. A single group names the whole mesh; several groups are regions.
    fn regions(&self) -> Vec<NamedRegion> {
        let groups = distinct(self.tets.iter().map(|tet| tet.2).collect());
        if groups.len() < 2 {
            return Vec::new();
        }
        let name = |id: i32| self.volume_names.iter().find(|(tag, _)| *tag == id).map(|(_, name)| name.clone());
        let region = |id| name(id).map_or_else(|| NamedRegion::numbered(id), |name| NamedRegion { id, name });
        groups.into_iter().map(region).collect()
    }

    /// Cells to split, at the places of their tags in the sorted lists.
    fn polyhedra(&self) -> Polyhedra {
        let in_tets = |tag: u64| self.tets.partition_point(|tet| tet.0 < tag);
        let in_triangles = |tag: u64| self.triangles.partition_point(|triangle| triangle.0 < tag);
        Polyhedra {
            prisms: self.prisms.iter().map(|&(tag, v)| (in_tets(tag), v.map(|v| self.index(v)))).collect(),
            pyramids: self.pyramids.iter().map(|&(tag, v)| (in_tets(tag), v.map(|v| self.index(v)))).collect(),
            quads: self.quads.iter().map(|&(tag, v)| (in_triangles(tag), v.map(|v| self.index(v)))).collect(),
        }
    }

    /// Index of the node with a tag; out of range if there is none.
    fn index(&self, tag: u64) -> u32 {
        let guess = tag.wrapping_sub(1) as usize;
        if self.nodes.get(guess).is_some_and(|node| node.0 == tag) {
            return guess as u32;
        }
        self.nodes.binary_search_by_key(&tag, |node| node.0).map_or(u32::MAX, |i| i as u32)
    }

    fn patches(&self, caps: &[(i32, Cap)]) -> Vec<Patch> {
        let name = |id: i32| self.names.iter().find(|(tag, _)| *tag == id).map(|(_, name)| name.clone());
        let cap = |id: i32| caps.iter().find(|(patch, _)| *patch == id).map(|(_, cap)| *cap);
        let named = self.names.iter().map(|(id, _)| *id);
        let ids = distinct(self.group_of_surface.values().copied().chain(named).collect());
        // Usual names are for files without any; a label without a name among others is a fault that a check finds.
        let unnamed = |id| if self.names.is_empty() { usual_name(id) } else { format!("patch_{id}") };
        let patch = |id| Patch { id, name: name(id).unwrap_or_else(|| unnamed(id)), cap: cap(id) };
        ids.into_iter().map(patch).collect()
    }
}

/// Skips the number of partitions and the entities of ghost cells.
fn skip_ghost_entities(cursor: &mut MshCursor) -> Result<(), MshFault> {
    let [_, ghosts]: [u64; 2] = cursor.sizes()?;
    for _ in 0..ghosts {
        cursor.int()?;
        cursor.int()?;
    }
    Ok(())
}
