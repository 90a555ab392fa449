//! Tests of pieces with ghost cells.

use crate::volume::fixtures::{labelled_tube, slab};
use crate::volume::in_pieces::InPieces;
use crate::volume::{MeshNotes, WriteOptions, read_mesh, write_mesh_with};
use crate::vtk_xml::VtkXml;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::{VolumeMesh, face_key};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;

fn written(mesh: &dyn MeshSource, notes: &MeshNotes, parts: usize) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let options = WriteOptions::default().parts(NonZeroUsize::new(parts));
    write_mesh_with(&options, &folder.path().join("a.pvtu"), mesh, notes, &()).unwrap();
    folder
}

/// Integers of an array of a file.
fn ints(path: &Path, section: &str, name: &str) -> Vec<i64> {
    let bytes = fs::read(path).unwrap();
    let xml = VtkXml::parse(&bytes, "UnstructuredGrid").unwrap();
    let grid = xml.child(VtkXml::ROOT, "UnstructuredGrid").unwrap();
    let section = xml.child(xml.child(grid, "Piece").unwrap(), section).unwrap();
    let (_, array) = xml.arrays(section).find(|(n, _)| *n == name).unwrap();
    xml.read(array).unwrap().into_ints().unwrap()
}

fn sorted(cells: impl IntoIterator<Item = [u32; 4]>) -> Vec<[u32; 4]> {
    let mut cells: Vec<_> = cells.into_iter().collect();
    cells.sort_unstable();
    cells
}

/// Checks the pieces against the mesh.
fn check(folder: &Path, volume: &VolumeMesh, parts: usize) {
    let mut points_of: BTreeMap<usize, BTreeSet<i64>> = BTreeMap::new();
    let mut copies: BTreeMap<usize, BTreeSet<i64>> = BTreeMap::new();
    let (mut originals, mut own_points) = (Vec::new(), Vec::new());
    for part in 0..parts {
        let path = folder.join(format!("a/a_{part:04}.vtu"));
        let ids = ints(&path, "PointData", "GlobalPointIds");
        let ghosts = ints(&path, "PointData", "vtkGhostType");
        own_points.extend(ids.iter().zip(&ghosts).filter(|(_, ghost)| **ghost == 0).map(|(id, _)| *id));
        let corners = ints(&path, "Cells", "connectivity");
        let numbers = ints(&path, "CellData", "GlobalCellIds");
        let marks = ints(&path, "CellData", "vtkGhostType");
        let mut at = 0;
        for (&number, &mark) in numbers.iter().zip(&marks) {
            let size = if number < volume.mesh.tets.len() as i64 { 4 } else { 3 };
            let vertices: Vec<i64> = corners[at..at + size].iter().map(|&v| ids[v as usize]).collect();
            at += size;
            if let Some(tet) = volume.mesh.tets.get(number as usize) {
                assert_eq!(vertices, tet.map(i64::from));
            } else {
                let face = volume.boundary[number as usize - volume.mesh.tets.len()];
                assert_eq!(vertices, face.map(i64::from));
            }
            if mark == 0 {
                originals.push(number);
                if size == 4 {
                    points_of.entry(part).or_default().extend(vertices);
                }
            } else {
                copies.entry(part).or_default().insert(number);
            }
        }
    }
    originals.sort_unstable();
    assert!(originals.into_iter().eq(0..(volume.mesh.tets.len() + volume.boundary.len()) as i64));
    own_points.sort_unstable();
    assert!(own_points.into_iter().eq(0..volume.mesh.points.len() as i64));
    // Ghosts are the tetrahedra of other pieces with a point of the piece.
    for (part, points) in &points_of {
        let path = folder.join(format!("a/a_{part:04}.vtu"));
        let own: BTreeSet<i64> = ints(&path, "CellData", "GlobalCellIds").into_iter().collect();
        let beside =
            (0..).zip(&volume.mesh.tets).filter(|(_, tet)| tet.iter().any(|&v| points.contains(&i64::from(v))));
        let expected = beside.map(|(number, _)| number).filter(|number| own.contains(number)).count();
        let touching =
            volume.mesh.tets.iter().filter(|tet| tet.iter().any(|&v| points.contains(&i64::from(v)))).count();
        assert_eq!(expected, touching, "{part}");
    }
}

#[test]
fn pieces_have_ghost_cells_and_numbers() {
    let (volume, notes) = labelled_tube(9);
    for parts in [1, 2, 7] {
        let folder = written(&volume, &notes, parts);
        assert_eq!(fs::read_dir(folder.path().join("a")).unwrap().count(), parts);
        check(folder.path(), &volume, parts);
        // Each cell is read once.
        let read = read_mesh(&folder.path().join("a.pvtu")).unwrap();
        assert_eq!(read.volume.mesh.points, volume.mesh.points);
        assert_eq!(sorted(read.volume.mesh.tets.iter().copied()), sorted(volume.mesh.tets.iter().copied()));
        assert_eq!(read.notes, notes);
        let faces = |volume: &VolumeMesh| {
            let labels = volume.boundary_patch.iter().copied();
            volume.boundary.iter().map(|face| face_key(*face)).zip(labels).collect::<BTreeSet<_>>()
        };
        assert_eq!(faces(&read.volume), faces(&volume));
        assert_eq!(read.volume.patches, volume.patches);
    }
    let index = fs::read_to_string(written(&volume, &notes, 2).path().join("a.pvtu")).unwrap();
    assert!(index.contains("GhostLevel=\"1\"") && index.contains("UInt8"), "{index}");
}

#[test]
fn sources_in_pieces_and_layers_too() {
    let (volume, notes) = labelled_tube(9);
    let folder = written(&InPieces { volume: &volume, sizes: &[7, 100] }, &notes, 3);
    check(folder.path(), &volume, 3);
    check(written(&slab(), &MeshNotes::default(), 2).path(), &slab(), 2);
}

#[test]
fn a_part_larger_than_the_memory_is_refused() {
    let (volume, notes) = labelled_tube(9);
    let pieces = InPieces { volume: &volume, sizes: &[100] };
    let folder = tempfile::tempdir().unwrap();
    let options = WriteOptions::default().parts(NonZeroUsize::new(2)).memory(1000);
    let error = write_mesh_with(&options, &folder.path().join("a.pvtu"), &pieces, &notes, &()).unwrap_err().to_string();
    assert!(error.contains("ask for more parts or more memory"), "{error}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
