//! Meshes with regions: cell zones, face zones of the interfaces, and a case of diffusion for `laplacianFoam`.
//!
//! Only outer faces are in patches. Interface faces are internal, as `OpenFOAM` requires.

use super::boundary::Boundary;
use super::diffusion;
use super::rules::Settings;
use super::{case, head, poly_mesh};
use crate::file::AtomicFolder;
use crate::flow::plain;
use crate::volume::content::MeshNotes;
use anastomesh_mesh::faces::Faces;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::region::{NamedRegion, region_faces};
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece, gather};
use anastomesh_mesh::{Patch, VolumeMesh, face_key};
use rustc_hash::FxHashMap;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write};

pub(super) const CELL_ZONES: &str = "constant/polyMesh/cellZones";
pub(super) const FACE_ZONES: &str = "constant/polyMesh/faceZones";

/// Writes the files of a case. Cells are tetrahedra, also those of layers. The mesh is held in memory.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidData` if the labelled outer faces are not the boundary.
pub(super) fn write(
    folder: &AtomicFolder,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    remark: &dyn Fn(&str),
    progress: &dyn Progress,
) -> io::Result<()> {
    let volume = mesh.whole().map_or_else(|| gather(mesh).map(Cow::Owned), |volume| Ok(Cow::Borrowed(volume)))?;
    let (outer, interfaces) = OuterMesh::of(&volume);
    let faces = Faces::of(&outer)?;
    let boundary = Boundary::of(&outer, &faces, None)?;
    let figures = poly_mesh::write(folder, &outer, &faces, None, &boundary, None, progress)?;
    let settings = Settings::of(&figures, false, 0.0, false, false);
    settings.doubts.iter().for_each(|doubt| remark(doubt));
    write_cell_zones(folder, &volume, &notes.regions)?;
    write_face_zones(folder, &volume, &faces, &interfaces)?;
    folder.put("constant/polyMesh/boundary", case::boundary(&boundary).as_bytes())?;
    folder.put("system/decomposeParDict", case::decompose(None).as_bytes())?;
    let has_lumen = NamedRegion::id_of(&notes.regions, NamedRegion::LUMEN).is_some();
    for (name, text) in diffusion::texts(&boundary, &figures, has_lumen) {
        folder.put(name, text.as_bytes())?;
    }
    Ok(())
}

/// Mesh without the labels of interfaces.
struct OuterMesh<'a> {
    volume: &'a VolumeMesh,
    boundary: Vec<[u32; 3]>,
    labels: Vec<i32>,
    blocks: Vec<i32>,
    patches: Vec<Patch>,
}

/// Interface faces by their vertices: patch and smaller region.
type Interfaces = FxHashMap<[u32; 3], (i32, i32)>;

impl<'a> OuterMesh<'a> {
    /// Separates the labels of outer faces from those of interfaces.
    fn of(volume: &'a VolumeMesh) -> (Self, Interfaces) {
        let found = region_faces(&volume.mesh, &volume.tet_block);
        let inner: FxHashMap<[u32; 3], i32> =
            found.iter().filter(|f| f.beyond.is_some()).map(|f| (face_key(f.vertices), f.region)).collect();
        let mut outer =
            Self { volume, boundary: Vec::new(), labels: Vec::new(), blocks: Vec::new(), patches: Vec::new() };
        let mut interfaces = Interfaces::default();
        for (i, &face) in volume.boundary.iter().enumerate() {
            let patch = volume.boundary_patch.get(i).copied().unwrap_or(0);
            if let Some(&region) = inner.get(&face_key(face)) {
                interfaces.insert(face_key(face), (patch, region));
                continue;
            }
            outer.boundary.push(face);
            outer.labels.push(patch);
            outer.blocks.push(volume.boundary_block.get(i).copied().unwrap_or(0));
        }
        let mut used = outer.labels.clone();
        used.sort_unstable();
        used.dedup();
        let is_used = |patch: &&Patch| used.binary_search(&patch.id).is_ok();
        outer.patches = volume.patches.iter().filter(is_used).cloned().collect();
        (outer, interfaces)
    }
}

impl MeshSource for OuterMesh<'_> {
    fn counts(&self) -> SourceCounts {
        SourceCounts { boundary: self.boundary.len(), ..self.volume.counts() }
    }

    fn patches(&self) -> &[Patch] {
        &self.patches
    }

    fn parts(&self) -> u32 {
        1
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        self.volume.points(part)
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        self.volume.tets(part)
    }

    fn boundary(&self, _: u32) -> io::Result<FacePiece<'_>> {
        Ok(FacePiece {
            faces: Cow::Borrowed(&self.boundary),
            patches: Cow::Borrowed(&self.labels),
            blocks: Cow::Borrowed(&self.blocks),
        })
    }
}

/// Writes the cells of each region.
fn write_cell_zones(folder: &AtomicFolder, volume: &VolumeMesh, regions: &[NamedRegion]) -> io::Result<()> {
    let mut cells: BTreeMap<i32, Vec<usize>> = regions.iter().map(|region| (region.id, Vec::new())).collect();
    for tet in 0..volume.mesh.tets.len() {
        cells.entry(volume.tet_block.get(tet).copied().unwrap_or(0)).or_default().push(tet);
    }
    let mut file = folder.file(CELL_ZONES)?;
    write!(file, "{}{}\n(\n", head::text("regIOobject", CELL_ZONES), cells.len())?;
    for (id, cells) in cells {
        let name = plain(&NamedRegion::name_of(regions, id));
        writeln!(file, "{name}\n{{\n    type cellZone;\n    cellLabels List<label>\n{}\n(", cells.len())?;
        cells.iter().try_for_each(|cell| writeln!(file, "{cell}"))?;
        file.write_all(b")\n;\n}\n")?;
    }
    file.write_all(b")\n")?;
    file.commit()
}

/// Face zone: numbers of its faces, and whether each is oriented against the zone.
#[derive(Default)]
struct FaceZone {
    faces: Vec<usize>,
    flips: String,
}

/// Writes the faces of each interface, which face out of the region with the smaller id.
fn write_face_zones(
    folder: &AtomicFolder,
    volume: &VolumeMesh,
    faces: &Faces,
    interfaces: &Interfaces,
) -> io::Result<()> {
    let mut zones: BTreeMap<i32, FaceZone> = BTreeMap::new();
    let mut number = 0;
    faces.each(|part| {
        for face in &part.inner {
            if let Some(&(patch, region)) = interfaces.get(&face_key(face.vertices)) {
                let zone = zones.entry(patch).or_default();
                zone.faces.push(number);
                let owner = volume.tet_block.get(face.tets[0] as usize).copied().unwrap_or(0);
                let _ = writeln!(zone.flips, "{}", u8::from(owner != region));
            }
            number += 1;
        }
        Ok(())
    })?;
    let mut file = folder.file(FACE_ZONES)?;
    write!(file, "{}{}\n(\n", head::text("regIOobject", FACE_ZONES), zones.len())?;
    for (patch, FaceZone { faces, flips }) in zones {
        let named = volume.patches.iter().find(|known| known.id == patch);
        let name = named.map_or_else(|| format!("interface_{patch}"), |known| plain(&known.name));
        writeln!(file, "{name}\n{{\n    type faceZone;\n    faceLabels List<label>\n{}\n(", faces.len())?;
        faces.iter().try_for_each(|face| writeln!(file, "{face}"))?;
        write!(file, ")\n;\n    flipMap List<bool>\n{}\n(\n{flips})\n;\n}}\n", faces.len())?;
    }
    file.write_all(b")\n")?;
    file.commit()
}
