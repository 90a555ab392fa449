//! Reads tetrahedral meshes from Gmsh's MSH 4.1, text or binary.

use super::mesh_file::{ContentFault, MeshFile};
use super::msh::{Extra, ExtraCap, MSH_TETRA, MSH_TRIANGLE, SECTION};
use crate::geometry::{Point3, Vec3};
use crate::mesh::{Cap, Patch};
use rustc_hash::FxHashMap;

/// Reads a mesh from the bytes of a `.msh` file of version 4.1. Tetrahedra and triangles are taken, points and lines
/// among the elements passed over; a triangle's label is the first physical group of its surface.
///
/// # Errors
/// When the file is no such file or incomplete, or holds other elements.
pub fn read_msh(bytes: &[u8]) -> Result<MeshFile, ContentFault> {
    let mut cursor = Cursor { bytes, at: 0, binary: false };
    let mut parts = Parts::default();
    if cursor.next_section()? != Some("MeshFormat") {
        return Err(ContentFault::Missing { what: "$MeshFormat" });
    }
    cursor.read_format()?;
    cursor.finish_section("MeshFormat")?;
    let (mut nodes, mut elements) = (false, false);
    while let Some(name) = cursor.next_section()? {
        match name {
            "PhysicalNames" => parts.read_names(&mut cursor)?,
            "Entities" => parts.read_entities(&mut cursor)?,
            "Nodes" => parts.read_nodes(&mut cursor)?,
            "Elements" => parts.read_elements(&mut cursor)?,
            SECTION => parts.read_extra(&mut cursor)?,
            _ => {}
        }
        cursor.finish_section(name)?;
        nodes |= name == "Nodes";
        elements |= name == "Elements";
    }
    if !nodes || !elements {
        return Err(ContentFault::Missing { what: if nodes { "$Elements" } else { "$Nodes" } });
    }
    parts.into_file()
}

/// A place in the file.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    binary: bool,
}

const CUT_SHORT: ContentFault = ContentFault::CutShort;

impl<'a> Cursor<'a> {
    fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], ContentFault> {
        let taken = self.rest().get(..count).ok_or(CUT_SHORT)?;
        self.at += count;
        Ok(taken)
    }

    /// The rest of the line, as text.
    fn line(&mut self) -> Result<&'a str, ContentFault> {
        let rest = self.rest();
        let length = rest.iter().position(|&b| b == b'\n').ok_or(CUT_SHORT)?;
        self.at += length + 1;
        std::str::from_utf8(&rest[..length]).map(str::trim).map_err(|_| self.bad())
    }

    fn bad(&self) -> ContentFault {
        ContentFault::BadNumber { byte: self.at }
    }

    /// The next word of a text.
    fn word(&mut self) -> Result<&'a str, ContentFault> {
        let rest = self.rest();
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).ok_or(CUT_SHORT)?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).ok_or(CUT_SHORT)?;
        let word = std::str::from_utf8(&rest[start..start + length]).map_err(|_| self.bad())?;
        self.at += start + length;
        Ok(word)
    }

    fn parsed<T: std::str::FromStr>(&mut self) -> Result<T, ContentFault> {
        let word = self.word()?;
        word.parse().map_err(|_| self.bad())
    }

    fn int(&mut self) -> Result<i32, ContentFault> {
        if !self.binary {
            return self.parsed();
        }
        let bytes = self.take(4)?;
        Ok(bytes.try_into().map_or(0, i32::from_le_bytes))
    }

    fn size(&mut self) -> Result<u64, ContentFault> {
        if !self.binary {
            return self.parsed();
        }
        let bytes = self.take(8)?;
        Ok(bytes.try_into().map_or(0, u64::from_le_bytes))
    }

    fn float(&mut self) -> Result<f64, ContentFault> {
        if !self.binary {
            return self.parsed();
        }
        let bytes = self.take(8)?;
        Ok(bytes.try_into().map_or(0.0, f64::from_le_bytes))
    }

    /// Moves to the next section; its name, or none at the end of the file.
    fn next_section(&mut self) -> Result<Option<&'a str>, ContentFault> {
        let Some(start) = self.rest().iter().position(|b| !b.is_ascii_whitespace()) else { return Ok(None) };
        self.at += start;
        match self.line()?.strip_prefix('$') {
            Some(name) => Ok(Some(name)),
            None => Err(self.bad()),
        }
    }

    /// Moves behind the line that ends a section.
    fn finish_section(&mut self, name: &str) -> Result<(), ContentFault> {
        let end = format!("$End{name}");
        let found = self.rest().windows(end.len()).position(|window| window == end.as_bytes()).ok_or(CUT_SHORT)?;
        self.at += found + end.len();
        Ok(())
    }

    fn read_format(&mut self) -> Result<(), ContentFault> {
        let line = self.line()?;
        let mut words = line.split_whitespace();
        let version = words.next().unwrap_or_default();
        if version != "4.1" {
            return Err(ContentFault::UnsupportedVersion { version: version.chars().take(20).collect() });
        }
        let (binary, width) = (words.next() == Some("1"), words.next());
        if binary {
            self.binary = true;
            if width != Some("8") || self.int()? != 1 {
                return Err(ContentFault::UnsupportedVersion { version: "4.1, other byte order or width".into() });
            }
        }
        Ok(())
    }
}

/// The sections' content.
#[derive(Default)]
struct Parts {
    /// Names of the physical groups of surfaces.
    names: Vec<(i32, String)>,
    /// First physical group of each surface.
    group_of_surface: FxHashMap<i32, i32>,
    /// First physical group of each volume.
    group_of_volume: FxHashMap<i32, i32>,
    nodes: Vec<(u64, Point3)>,
    tets: Vec<(u64, [u64; 4], i32)>,
    triangles: Vec<(u64, [u64; 3], i32)>,
    extra: Extra,
}

impl Parts {
    fn read_names(&mut self, cursor: &mut Cursor) -> Result<(), ContentFault> {
        // Text also in binary files.
        let count: u64 = cursor.line()?.parse().map_err(|_| cursor.bad())?;
        for _ in 0..count {
            let line = cursor.line()?;
            let mut words = line.splitn(3, ' ');
            let dimension = words.next().and_then(|w| w.parse::<i32>().ok()).ok_or_else(|| cursor.bad())?;
            let tag = words.next().and_then(|w| w.parse::<i32>().ok()).ok_or_else(|| cursor.bad())?;
            let name = words.next().unwrap_or_default().trim().trim_matches('"');
            if dimension == 2 {
                self.names.push((tag, name.into()));
            }
        }
        Ok(())
    }

    fn read_entities(&mut self, cursor: &mut Cursor) -> Result<(), ContentFault> {
        let counts = [cursor.size()?, cursor.size()?, cursor.size()?, cursor.size()?];
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let tag = cursor.int()?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    cursor.float()?;
                }
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

    fn read_nodes(&mut self, cursor: &mut Cursor) -> Result<(), ContentFault> {
        let (blocks, ..) = (cursor.size()?, cursor.size()?, cursor.size()?, cursor.size()?);
        for _ in 0..blocks {
            let (dimension, _tag, parametric) = (cursor.int()?, cursor.int()?, cursor.int()?);
            let count = cursor.size()?;
            let first = self.nodes.len();
            for _ in 0..count {
                self.nodes.push((cursor.size()?, Point3::origin()));
            }
            for (_, point) in &mut self.nodes[first..] {
                *point = Point3::new(cursor.float()?, cursor.float()?, cursor.float()?);
                for _ in 0..if parametric == 1 { dimension.clamp(0, 3) } else { 0 } {
                    cursor.float()?;
                }
            }
        }
        Ok(())
    }

    fn read_elements(&mut self, cursor: &mut Cursor) -> Result<(), ContentFault> {
        let (blocks, ..) = (cursor.size()?, cursor.size()?, cursor.size()?, cursor.size()?);
        for _ in 0..blocks {
            let (_dimension, entity, kind) = (cursor.int()?, cursor.int()?, cursor.int()?);
            let groups = if kind == MSH_TETRA { &self.group_of_volume } else { &self.group_of_surface };
            let group = groups.get(&entity).copied().unwrap_or(0);
            for _ in 0..cursor.size()? {
                let tag = cursor.size()?;
                match kind {
                    MSH_TRIANGLE => {
                        self.triangles.push((tag, [cursor.size()?, cursor.size()?, cursor.size()?], group));
                    }
                    MSH_TETRA => {
                        let nodes = [cursor.size()?, cursor.size()?, cursor.size()?, cursor.size()?];
                        self.tets.push((tag, nodes, group));
                    }
                    // Lines and points bound no volume.
                    1 => drop((cursor.size()?, cursor.size()?)),
                    15 => drop(cursor.size()?),
                    _ => {
                        let cell = self.tets.len() + self.triangles.len();
                        return Err(ContentFault::UnsupportedCell { kind: kind.into(), cell });
                    }
                }
            }
        }
        Ok(())
    }

    fn read_extra(&mut self, cursor: &mut Cursor) -> Result<(), ContentFault> {
        let line = cursor.line()?;
        self.extra = serde_json::from_str(line).map_err(|_| cursor.bad())?;
        Ok(())
    }

    fn into_file(mut self) -> Result<MeshFile, ContentFault> {
        let mut file = MeshFile::default();
        self.nodes.sort_by_key(|&(tag, _)| tag);
        if let Some(pair) = self.nodes.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(ContentFault::RepeatedTag { tag: pair[0].0 });
        }
        self.tets.sort_by_key(|&(tag, ..)| tag);
        self.triangles.sort_by_key(|&(tag, ..)| tag);
        let volume = &mut file.volume;
        volume.mesh.points = self.nodes.iter().map(|&(_, p)| p).collect();
        volume.mesh.tets = self.tets.iter().map(|(_, t, _)| t.map(|tag| self.index(tag))).collect();
        // One group is the name of the whole; several are regions.
        let regions = self.tets.iter().any(|tet| Some(tet.2) != self.tets.first().map(|first| first.2));
        volume.tet_block = self.tets.iter().map(|tet| if regions { tet.2 } else { 0 }).collect();
        let (notes, caps) = std::mem::take(&mut self.extra).into_notes();
        file.notes = notes;
        // Triangles without a group are no labelled boundary.
        if self.triangles.iter().any(|&(.., group)| group != 0) {
            file.labelled = true;
            volume.boundary = self.triangles.iter().map(|(_, t, _)| t.map(|tag| self.index(tag))).collect();
            volume.boundary_patch = self.triangles.iter().map(|&(.., group)| group).collect();
            volume.boundary_block = vec![0; self.triangles.len()];
            volume.patches = self.patches(&caps);
        }
        Ok(file)
    }

    /// Index of the node with a tag; one beyond all when there is none.
    fn index(&self, tag: u64) -> u32 {
        let guess = tag.wrapping_sub(1) as usize;
        if self.nodes.get(guess).is_some_and(|node| node.0 == tag) {
            return guess as u32;
        }
        self.nodes.binary_search_by_key(&tag, |node| node.0).map_or(u32::MAX, |i| i as u32)
    }

    fn patches(&self, caps: &[ExtraCap]) -> Vec<Patch> {
        let mut ids: Vec<i32> = self.group_of_surface.values().copied().collect();
        ids.extend(self.names.iter().map(|(id, _)| *id));
        ids.sort_unstable();
        ids.dedup();
        let name = |id: i32| self.names.iter().find(|(tag, _)| *tag == id).map(|(_, name)| name.clone());
        let cap = |id: i32| caps.iter().find(|cap| cap.patch == id).map(cap_of);
        ids.into_iter()
            .map(|id| Patch { id, name: name(id).unwrap_or_else(|| super::vtu_read::usual_name(id)), cap: cap(id) })
            .collect()
    }
}

fn cap_of(cap: &ExtraCap) -> Cap {
    Cap { node: cap.node, center: Point3::from(cap.center), normal: Vec3::from(cap.normal), radius: cap.radius }
}
