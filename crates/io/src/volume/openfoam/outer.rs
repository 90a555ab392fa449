//! Boundary of a mesh with regions: its outer faces, and both sides of the lumen's surface.
//!
//! A fixed concentration holds at faces of the boundary only. A condition on the cells of the lumen would hold half a cell inside
//! it, and lower concentrations beyond by a tenth at usual resolutions. So the lumen has points of its own on its surface.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::region::{NamedRegion, RegionFace, region_faces};
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use anastomesh_mesh::{Patch, VolumeMesh, face_key};
use rustc_hash::FxHashMap;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io;

/// Internal interface faces by their vertices: patch and smaller region.
pub(super) type Interfaces = FxHashMap<[u32; 3], (i32, i32)>;

/// Other side of a patch: its region, and its patch there.
pub(super) struct Side {
    pub(super) region: String,
    pub(super) patch: String,
}

/// Mesh without the labels of internal interfaces.
pub(super) struct OuterMesh<'a> {
    volume: &'a VolumeMesh,
    points: Cow<'a, [Point3]>,
    tets: Cow<'a, [[u32; 4]]>,
    boundary: Vec<[u32; 3]>,
    labels: Vec<i32>,
    blocks: Vec<i32>,
    patches: Vec<Patch>,
    /// Other side of each patch on the surface of the lumen.
    pub(super) sides: BTreeMap<i32, Side>,
}

impl<'a> OuterMesh<'a> {
    /// Separates the lumen, if any, and the labels of outer faces from those of interfaces.
    pub(super) fn of(volume: &'a VolumeMesh, lumen: Option<i32>, regions: &[NamedRegion]) -> (Self, Interfaces) {
        let found = region_faces(&volume.mesh, &volume.tet_block);
        let inner: FxHashMap<[u32; 3], &RegionFace> =
            found.iter().filter(|f| f.beyond.is_some()).map(|f| (face_key(f.vertices), f)).collect();
        let mut outer = Self {
            volume,
            points: Cow::Borrowed(&volume.mesh.points),
            tets: Cow::Borrowed(&volume.mesh.tets),
            boundary: Vec::new(),
            labels: Vec::new(),
            blocks: Vec::new(),
            patches: Vec::new(),
            sides: BTreeMap::new(),
        };
        let surface: Vec<LumenFace> = lumen.map_or_else(Vec::new, |lumen| lumen_faces(&found, lumen));
        let twins = outer.add_twins(&surface, lumen);
        let mut interfaces = Interfaces::default();
        for (i, &face) in volume.boundary.iter().enumerate() {
            let patch = volume.boundary_patch.get(i).copied().unwrap_or(0);
            match inner.get(&face_key(face)) {
                Some(found) if lumen.is_some_and(|lumen| is_beside(found, lumen)) => {}
                Some(found) => drop(interfaces.insert(face_key(face), (patch, found.region))),
                None => {
                    let block = volume.boundary_block.get(i).copied().unwrap_or(0);
                    let own = if Some(block) == lumen { renumbered(face, &twins) } else { face };
                    outer.put(own, patch, block);
                }
            }
        }
        let mut used = outer.labels.clone();
        used.sort_unstable();
        used.dedup();
        let is_used = |patch: &&Patch| used.binary_search(&patch.id).is_ok();
        outer.patches = volume.patches.iter().filter(is_used).cloned().collect();
        if let Some(lumen) = lumen {
            outer.add_surface(&surface, &twins, lumen, regions);
        }
        (outer, interfaces)
    }

    fn put(&mut self, face: [u32; 3], patch: i32, block: i32) {
        self.boundary.push(face);
        self.labels.push(patch);
        self.blocks.push(block);
    }

    /// Adds a point of the lumen for each point of its surface, and returns their numbers by those of the surface.
    fn add_twins(&mut self, surface: &[LumenFace], lumen: Option<i32>) -> FxHashMap<u32, u32> {
        let mut twins = FxHashMap::default();
        if surface.is_empty() {
            return twins;
        }
        let points = self.points.to_mut();
        for &v in surface.iter().flat_map(|face| &face.vertices) {
            twins.entry(v).or_insert_with(|| {
                points.push(points[v as usize]);
                points.len() as u32 - 1
            });
        }
        for (tet, vertices) in self.tets.to_mut().iter_mut().enumerate() {
            if self.volume.tet_block.get(tet).copied() == lumen {
                *vertices = renumbered(*vertices, &twins);
            }
        }
        twins
    }

    /// Adds both sides of the lumen's surface, as patches of their own.
    fn add_surface(&mut self, surface: &[LumenFace], twins: &FxHashMap<u32, u32>, lumen: i32, regions: &[NamedRegion]) {
        let mut next = self.volume.patches.iter().map(|patch| patch.id).max().unwrap_or(0).saturating_add(1);
        let mut beyond: Vec<i32> = surface.iter().map(|face| face.beyond).collect();
        beyond.sort_unstable();
        beyond.dedup();
        let inside = NamedRegion::name_of(regions, lumen);
        for region in beyond {
            let outside = NamedRegion::name_of(regions, region);
            let names = [format!("{inside}_to_{outside}"), format!("{outside}_to_{inside}")];
            let ids = [next, next.saturating_add(1)];
            next = next.saturating_add(2);
            for (id, name) in ids.into_iter().zip(&names) {
                self.patches.push(Patch { id, name: name.clone(), cap: None });
            }
            let [first, second] = names;
            self.sides.insert(ids[0], Side { region: outside.clone(), patch: second });
            self.sides.insert(ids[1], Side { region: inside.clone(), patch: first });
            for face in surface.iter().filter(|face| face.beyond == region) {
                let [a, b, c] = face.vertices;
                self.put(renumbered(face.vertices, twins), ids[0], lumen);
                self.put([a, c, b], ids[1], region);
            }
        }
    }
}

/// Face on the surface of the lumen, oriented out of it.
struct LumenFace {
    vertices: [u32; 3],
    beyond: i32,
}

/// Faces between the lumen and other regions.
fn lumen_faces(found: &[RegionFace], lumen: i32) -> Vec<LumenFace> {
    let of_face = |face: &RegionFace| {
        let (_, beyond) = face.beyond?;
        let [a, b, c] = face.vertices;
        match (face.region == lumen, beyond == lumen) {
            (true, _) => Some(LumenFace { vertices: face.vertices, beyond }),
            (_, true) => Some(LumenFace { vertices: [a, c, b], beyond: face.region }),
            _ => None,
        }
    };
    found.iter().filter_map(of_face).collect()
}

/// True for an interface of a region.
fn is_beside(face: &RegionFace, region: i32) -> bool {
    face.region == region || face.beyond.is_some_and(|(_, beyond)| beyond == region)
}

fn renumbered<const N: usize>(vertices: [u32; N], twins: &FxHashMap<u32, u32>) -> [u32; N] {
    vertices.map(|v| twins.get(&v).copied().unwrap_or(v))
}

impl MeshSource for OuterMesh<'_> {
    fn counts(&self) -> SourceCounts {
        SourceCounts { points: self.points.len(), boundary: self.boundary.len(), ..self.volume.counts() }
    }

    fn patches(&self) -> &[Patch] {
        &self.patches
    }

    fn parts(&self) -> u32 {
        1
    }

    fn points(&self, _: u32) -> io::Result<Cow<'_, [Point3]>> {
        Ok(Cow::Borrowed(&self.points))
    }

    fn tets(&self, _: u32) -> io::Result<TetPiece<'_>> {
        Ok(TetPiece { tets: Cow::Borrowed(&self.tets), blocks: Cow::Borrowed(&self.volume.tet_block) })
    }

    fn boundary(&self, _: u32) -> io::Result<FacePiece<'_>> {
        Ok(FacePiece {
            faces: Cow::Borrowed(&self.boundary),
            patches: Cow::Borrowed(&self.labels),
            blocks: Cow::Borrowed(&self.blocks),
        })
    }
}
