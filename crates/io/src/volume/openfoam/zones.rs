//! Meshes with regions: cell zones, face zones of the interfaces, and a case of diffusion for `laplacianFoam`.
//!
//! Outer faces and those of the lumen are in patches. Faces between other regions are internal, as `OpenFOAM` requires.

use super::boundary::{Boundary, FoamPatch};
use super::diffusion;
use super::outer::{Interfaces, OuterMesh};
use super::rules::Settings;
use super::{case, head, poly_mesh};
use crate::file::AtomicFolder;
use crate::flow::plain;
use crate::volume::content::MeshNotes;
use anastomesh_mesh::faces::Faces;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::region::NamedRegion;
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_mesh::{VolumeMesh, face_key};
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
    let lumen = NamedRegion::id_of(&notes.regions, NamedRegion::LUMEN);
    let (outer, interfaces) = OuterMesh::of(&volume, lumen, &notes.regions);
    let faces = Faces::of(&outer)?;
    let boundary = Boundary::of(&outer, &faces, None)?;
    let figures = poly_mesh::write(folder, &outer, &faces, None, &boundary, None, progress)?;
    let settings = Settings::of(&figures, false, 0.0, false, false);
    settings.doubts.iter().for_each(|doubt| remark(doubt));
    write_cell_zones(folder, &volume, &notes.regions)?;
    write_face_zones(folder, &volume, &faces, &interfaces)?;
    folder.put("constant/polyMesh/boundary", patch_list(&boundary, &outer).as_bytes())?;
    folder.put("system/decomposeParDict", case::decompose(None).as_bytes())?;
    for (name, text) in diffusion::texts(&boundary, &figures) {
        folder.put(name, text.as_bytes())?;
    }
    Ok(())
}

/// Patch list, in which the two sides of the lumen's surface are mapped to each other.
fn patch_list(boundary: &Boundary, outer: &OuterMesh) -> String {
    let entry = |patch: &FoamPatch| match outer.sides.get(&patch.patch.id) {
        Some(side) => case::mapped_patch(patch, &plain(&side.region), &plain(&side.patch)),
        None => case::patch(patch, patch.faces, patch.first),
    };
    case::patch_list(&boundary.patches.iter().map(entry).collect::<Vec<_>>())
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
