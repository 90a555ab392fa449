//! Tests of round trips for any partition, and of preserved files after failures.

use super::error::PvtuFault;
use super::mixed::stage_mixed;
use super::write::{Pieces, stage};
use crate::volume::error::MeshFault;
use crate::volume::fixtures::{labelled_tube, slab};
use crate::volume::in_pieces::InPieces;
use crate::volume::{MeshFileError, MeshNotes, ensure_writable, read_mesh, write_mesh};
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::check::check_tets;
use anastomesh_mesh::stacks::MixedMesh;
use std::fs;
use std::io;
use std::path::Path;

/// A tube in blocks of `block` tetrahedra, the last inside the first.
fn tube(layers: u32, block: usize) -> (VolumeMesh, MeshNotes) {
    let (mut volume, notes) = labelled_tube(layers);
    let blocks = volume.mesh.tets.len() / block;
    volume.tet_block = (0..volume.mesh.tets.len()).map(|i| (i / block) as i32).collect();
    // Consistent labels: a face has the block of its tetrahedron.
    let mut owner = rustc_hash::FxHashMap::default();
    for (tet, &block) in volume.mesh.tets.iter().zip(&volume.tet_block) {
        for side in anastomesh_mesh::TET_FACES {
            owner.insert(sorted(side.map(|corner| tet[corner])), block);
        }
    }
    volume.boundary_block = volume.boundary.iter().map(|&face| owner[&sorted(face)]).collect();
    assert!(blocks > 1);
    (volume, notes)
}

fn sorted(mut face: [u32; 3]) -> [u32; 3] {
    face.sort_unstable();
    face
}

/// Boundary in an order that does not depend on the pieces.
fn in_order(mut volume: VolumeMesh) -> VolumeMesh {
    let mut faces: Vec<_> = volume
        .boundary
        .iter()
        .zip(&volume.boundary_patch)
        .zip(&volume.boundary_block)
        .map(|((a, b), c)| (*a, *b, *c))
        .collect();
    faces.sort_unstable();
    volume.boundary = faces.iter().map(|face| face.0).collect();
    volume.boundary_patch = faces.iter().map(|face| face.1).collect();
    volume.boundary_block = faces.iter().map(|face| face.2).collect();
    volume
}

/// All files below a folder, by path.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
            found.push((path.display().to_string(), Vec::new()));
        } else {
            found.push((path.display().to_string(), fs::read(&path).unwrap()));
        }
    }
    found.sort();
    found
}

#[test]
fn what_is_written_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a tube & more.pvtu");
    let (volume, notes) = tube(40, 300);
    let tets = volume.mesh.tets.len();
    for (limit, memory, count) in [(1000, 0, tets.div_ceil(900)), (600, 1 << 16, tets.div_ceil(600)), (tets, 0, 1)] {
        stage(&path, &volume, &notes, Pieces { tets: limit, memory, ..Pieces::default() }, &())
            .unwrap()
            .place()
            .unwrap();
        assert_eq!(fs::read_dir(folder.path().join("a tube & more")).unwrap().count(), count);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
        let back = read_mesh(&path).unwrap();
        assert_eq!(back.notes, notes);
        assert!(back.labelled);
        assert_eq!(in_order(back.volume), in_order(volume.clone()));
    }
}

#[test]
fn neither_memory_nor_the_pieces_that_are_read_make_a_difference() {
    let (volume, notes) = tube(30, 170);
    let written = |memory, sizes: Option<&[usize]>| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tube.pvtu");
        let pieces = Pieces { tets: 400, memory, ..Pieces::default() };
        match sizes {
            Some(sizes) => {
                stage(&path, &InPieces { volume: &volume, sizes }, &notes, pieces, &()).unwrap().place().unwrap();
            }
            None => stage(&path, &volume, &notes, pieces, &()).unwrap().place().unwrap(),
        }
        let named = files(folder.path()).into_iter();
        named.map(|(name, bytes)| (name[folder.path().as_os_str().len()..].to_owned(), bytes)).collect::<Vec<_>>()
    };
    let whole = written(usize::MAX, None);
    assert!(whole.len() > 8);
    assert!(whole == written(0, None));
    for sizes in [&[1][..], &[7], &[1000], &[3, 500, 1, 90]] {
        assert!(whole == written(50_000, Some(sizes)), "{sizes:?}");
    }
}

#[test]
fn pieces_have_the_boundary_of_their_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, notes) = tube(30, 200);
    stage(&folder.path().join("t.pvtu"), &volume, &notes, Pieces { tets: 450, memory: 0, ..Pieces::default() }, &())
        .unwrap()
        .place()
        .unwrap();
    for entry in fs::read_dir(folder.path().join("t")).unwrap() {
        let piece = read_mesh(&entry.unwrap().path()).unwrap();
        let volume = piece.volume;
        assert!(volume.mesh.tets.len() <= 450);
        let blocks = [volume.tet_block[0], *volume.tet_block.last().unwrap()];
        assert!(volume.boundary_block.iter().all(|block| (blocks[0]..=blocks[1]).contains(block)));
        let points = volume.mesh.points.len();
        let mut used = vec![false; points];
        volume.mesh.tets.iter().flatten().for_each(|&v| used[v as usize] = true);
        assert!(used.iter().all(|&used| used));
    }
}

#[test]
fn odd_meshes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odd.pvtu");
    let back = |volume: &VolumeMesh| {
        stage(&path, volume, &MeshNotes::default(), Pieces { tets: 100, memory: 0, ..Pieces::default() }, &())
            .unwrap()
            .place()
            .unwrap();
        in_order(read_mesh(&path).unwrap().volume)
    };
    assert_eq!(back(&VolumeMesh::default()), VolumeMesh::default());
    // Unused points, alternating blocks, and faces of a block without tetrahedra.
    let (mut volume, _) = labelled_tube(5);
    for at in [0.5, 7.0] {
        volume.mesh.points.push(anastomesh_mesh::geometry::Point3::new(at, 0.0, 0.0));
    }
    volume.boundary_block[3] = 99;
    assert_eq!(back(&volume), in_order(volume.clone()));
    // No labels, and a single block.
    for values in [&mut volume.tet_block, &mut volume.boundary_block, &mut volume.boundary_patch] {
        values.fill(0);
    }
    let expected = in_order(volume.clone());
    volume.tet_block.clear();
    volume.boundary_block.clear();
    volume.boundary_patch.clear();
    assert_eq!(back(&volume), expected);
    volume.mesh.tets[70][2] = volume.mesh.points.len() as u32;
    let before = files(folder.path());
    let error = write_mesh(&path, &volume, &MeshNotes::default()).unwrap_err();
    assert!(matches!(error, MeshFileError::Write { source, .. } if source.kind() == io::ErrorKind::InvalidData));
    assert!(files(folder.path()) == before);
}

#[test]
fn folders_with_other_things_stay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.pvtu");
    let (volume, notes) = tube(3, 100);
    let refused = || {
        let error = write_mesh(&path, &volume, &notes).unwrap_err().to_string();
        assert!(error.contains("the pieces go into the folder"), "{error}");
        assert!(ensure_writable(&path).is_err());
    };
    fs::create_dir(folder.path().join("out")).unwrap();
    ensure_writable(&path).unwrap();
    fs::write(folder.path().join("out/thesis.tex"), "years").unwrap();
    refused();
    assert_eq!(files(folder.path()).len(), 2);
    fs::remove_dir_all(folder.path().join("out")).unwrap();
    fs::write(folder.path().join("out"), "a file").unwrap();
    refused();
    fs::remove_file(folder.path().join("out")).unwrap();
    write_mesh(&path, &volume, &notes).unwrap();
    write_mesh(&path, &volume, &notes).unwrap();
    assert_eq!(files(folder.path()).len(), 3);
}

#[test]
fn broken_pieces_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.pvtu");
    let (volume, notes) = tube(6, 100);
    stage(&path, &volume, &notes, Pieces { tets: 300, memory: 0, ..Pieces::default() }, &()).unwrap().place().unwrap();
    let piece = folder.path().join("out/out_0001.vtu");
    let sound = fs::read(&piece).unwrap();
    fs::write(&piece, &sound[..sound.len() / 2]).unwrap();
    assert!(matches!(read_mesh(&path), Err(MeshFileError::Content { path, .. }) if path == piece));
    fs::remove_file(&piece).unwrap();
    assert!(matches!(read_mesh(&path), Err(MeshFileError::Read { path, .. }) if path == piece));
    let none = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid/></VTKFile>";
    fs::write(&path, none).unwrap();
    assert!(matches!(
        read_mesh(&path),
        Err(MeshFileError::Content { fault: MeshFault::Pvtu(PvtuFault::Missing { what: "Piece" }), .. })
    ));
}

#[test]
fn pieces_of_other_programs() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.pvtu");
    let piece = |points: &str, ids: &str, tets: &str, ghosts: &str| {
        let n = ids.split(' ').count();
        let count = tets.split(' ').count() / 4;
        let (ends, kinds) = (["4 8", "4"][2 - count], ["10 10", "10"][2 - count]);
        format!(
            "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{count}\">\
             <PointData GlobalIds=\"Nodes\"><DataArray type=\"Int64\" Name=\"Nodes\">{ids}</DataArray></PointData>\
             <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">{points}</DataArray></Points>\
             <Cells><DataArray type=\"Int64\" Name=\"connectivity\">{tets}</DataArray><DataArray type=\"Int64\" \
             Name=\"offsets\">{ends}</DataArray><DataArray type=\"UInt8\" Name=\"types\">{kinds}</DataArray></Cells>\
             <CellData><DataArray type=\"UInt8\" Name=\"vtkGhostType\">{ghosts}</DataArray></CellData></Piece>\
             </UnstructuredGrid></VTKFile>"
        )
    };
    let index = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid><Piece Source=\"a.vtu\"/><Piece \
                 Source=\"b.vtu\"/></PUnstructuredGrid></VTKFile>";
    fs::write(&path, index).unwrap();
    fs::write(folder.path().join("a.vtu"), piece("0 0 0 1 0 0 0 1 0 0 0 1", "50 10 -3 20", "0 1 2 3", "0")).unwrap();
    let second = piece("0 0 1 1 0 0 0 1 0 0 0 0 1 1 1", "20 10 -3 50 60", "3 1 2 0 1 2 0 4", "1 0");
    fs::write(folder.path().join("b.vtu"), &second).unwrap();
    let mesh = read_mesh(&path).unwrap().volume.mesh;
    assert_eq!(mesh.points.len(), 5);
    assert_eq!(mesh.points[3], anastomesh_mesh::geometry::Point3::origin());
    assert_eq!(mesh.tets, [[3, 1, 0, 2], [1, 0, 2, 4]]);
    fs::write(folder.path().join("b.vtu"), second.replace("0 0 1 1 0 0", "0 0 2 1 0 0")).unwrap();
    assert!(matches!(
        read_mesh(&path),
        Err(MeshFileError::Content { fault: MeshFault::Pvtu(PvtuFault::PointsDiffer { id: 20 }), .. })
    ));
}

#[test]
fn prisms_in_several_pieces_are_split_alike_on_both_sides() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("prisms.pvtu");
    // Two blocks of two prisms each. The numbers of points run against the order of the pieces.
    let mut volume = slab();
    volume.mesh.points.reverse();
    for v in volume.mesh.tets.iter_mut().flatten().chain(volume.boundary.iter_mut().flatten()) {
        *v = 11 - *v;
    }
    volume.tet_block = (0..12).map(|tet| tet / 6).collect();
    let whole = MixedMesh::of(&volume);
    assert!(whole.cells.iter().all(|cell| cell.vertices().len() == 6));
    for (tets, count) in [(1, 4), (2, 2), (9, 1)] {
        stage_mixed(&path, &volume, &MeshNotes::default(), Pieces { tets, ..Pieces::default() }, &())
            .unwrap()
            .place()
            .unwrap();
        assert_eq!(fs::read_dir(folder.path().join("prisms")).unwrap().count(), count);
        let read = read_mesh(&path).unwrap().volume;
        assert_eq!(read.mesh.points, volume.mesh.points);
        assert!(check_tets(&read.mesh, None).failed().next().is_none(), "{count}");
        let again = MixedMesh::of(&read);
        assert_eq!((again.cells.len(), again.faces.len()), (whole.cells.len(), whole.faces.len()), "{count}");
        let text = String::from_utf8(fs::read(&path).unwrap()).unwrap();
        assert!(text.contains("Name=\"layer\""));
    }
}
