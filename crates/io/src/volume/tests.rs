//! Tests of round trips in every format, of independence from the parts of the source, and of full disks.

use super::content::MeshNotes;
use super::fixtures::{labelled_tube, slab};
use super::format::MeshFormat;
use super::in_pieces::InPieces;
use super::options::{GridOptions, WriteOptions};
use super::read::read_mesh;
use super::vtu::Recounted;
use super::write::{ensure_writable, write_format, write_mesh, write_mesh_to, write_mesh_with};
use crate::file::FileError;
use anastomesh_mesh::adjacency::boundary_faces;
use anastomesh_mesh::check::check_tets;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::StopsAfter;
use anastomesh_mesh::shapes::walled_channel;
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece, gather};
use anastomesh_mesh::stacks::MixedMesh;
use anastomesh_mesh::{NamedRegion, Patch, VolumeMesh};
use proptest::prelude::*;
use std::borrow::Cow;
use std::fs;
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::path::Path;

const STREAMED: [MeshFormat; 4] = [MeshFormat::Vtu, MeshFormat::Msh, MeshFormat::Msh2, MeshFormat::Medit];

fn bytes_of(format: MeshFormat, mesh: &dyn MeshSource, notes: &MeshNotes) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_mesh_to(&mut bytes, format, mesh, notes).unwrap();
    bytes
}

/// A tube with several patches; some patch names are missing, others are unused.
fn tube(layers: u32) -> (VolumeMesh, MeshNotes) {
    let (mut volume, notes) = labelled_tube(layers);
    for (i, patch) in volume.boundary_patch.iter_mut().enumerate() {
        *patch += [0, 0, 4, 0, 2, 0, -7][i % 7];
    }
    (volume, notes)
}

fn same_bytes(volume: &VolumeMesh, notes: &MeshNotes, sizes: &[usize]) {
    let cut = InPieces { volume, sizes };
    assert_eq!(&gather(&cut).unwrap().mesh, &volume.mesh);
    for format in STREAMED {
        assert!(bytes_of(format, &cut, notes) == bytes_of(format, volume, notes), "{format:?} {sizes:?}");
    }
}

#[test]
fn pieces_make_no_difference() {
    // Enough layers for several compressed blocks and waves.
    for (layers, sizes) in [(1, [1]), (40, [1]), (200, [7]), (3000, [1000])] {
        let (volume, notes) = tube(layers);
        same_bytes(&volume, &notes, &sizes);
    }
    let (mut volume, mut notes) = tube(20);
    notes.regions = [0, 1].map(NamedRegion::numbered).to_vec();
    same_bytes(&volume, &notes, &[13]);
    volume.tet_block.clear();
    volume.boundary_block.clear();
    volume.boundary_patch.clear();
    same_bytes(&volume, &notes, &[13]);
    same_bytes(&VolumeMesh::default(), &MeshNotes::default(), &[1]);
}

#[test]
fn pieces_make_no_difference_to_the_family_of_files() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, notes) = tube(9);
    write_mesh(&folder.path().join("whole.ele"), &volume, &notes).unwrap();
    write_mesh(&folder.path().join("cut.ele"), &InPieces { volume: &volume, sizes: &[1, 7, 30] }, &notes).unwrap();
    for kind in ["node", "ele", "face", "edge", "neigh"] {
        let read = |name: &str| std::fs::read(folder.path().join(name).with_extension(kind)).unwrap();
        assert!(read("cut") == read("whole"), "{kind}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    #[test]
    fn random_pieces_make_no_difference(layers in 1_u32..60, sizes in prop::collection::vec(1_usize..400, 1..20)) {
        let (volume, notes) = tube(layers);
        same_bytes(&volume, &notes, &sizes);
    }
}

#[test]
fn a_source_that_lies_is_found_out() {
    let (volume, notes) = tube(4);
    for error in [0, 2] {
        let cut = InPieces { volume: &volume, sizes: &[5] };
        let counts = SourceCounts { points: cut.counts().points + error - 1, ..cut.counts() };
        let liar = Recounted { mesh: &cut, counts };
        for format in STREAMED {
            let result = write_mesh_to(&mut Vec::new(), format, &liar, &notes);
            assert_eq!(result.unwrap_err().kind(), io::ErrorKind::InvalidData, "{format:?}");
        }
    }
}

/// Disk with limited space.
struct Disk {
    bytes: Cursor<Vec<u8>>,
    room: u64,
}

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let free = self.room.saturating_sub(self.bytes.position());
        if free == 0 && !bytes.is_empty() {
            return Err(io::ErrorKind::StorageFull.into());
        }
        self.bytes.write(&bytes[..bytes.len().min(free as usize)])
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Disk {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.bytes.seek(to)
    }
}

#[test]
fn a_full_disk_is_an_error_wherever_it_happens() {
    let (volume, notes) = tube(6);
    for format in STREAMED {
        let whole = bytes_of(format, &volume, &notes);
        let length = whole.len() as u64;
        for room in (0..length).step_by(53).chain([length - 1]) {
            let mut disk = Disk { bytes: Cursor::default(), room };
            let error = write_format(&mut disk, format, &volume, &notes).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::StorageFull, "{format:?} {room} of {length}");
        }
        let mut disk = Disk { bytes: Cursor::default(), room: length };
        write_format(&mut disk, format, &volume, &notes).unwrap();
        assert!(disk.bytes.into_inner() == whole);
    }
}

/// Source that fails before its end.
struct Broken<'a>(&'a VolumeMesh);

impl MeshSource for Broken<'_> {
    fn counts(&self) -> SourceCounts {
        self.0.counts()
    }
    fn patches(&self) -> &[Patch] {
        &self.0.patches
    }
    fn parts(&self) -> u32 {
        2
    }
    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        if part == 0 { self.0.points(0) } else { Ok(Cow::default()) }
    }
    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        let tets = &self.0.mesh.tets;
        let half = TetPiece { tets: tets[..tets.len() / 2].into(), ..TetPiece::default() };
        if part == 0 { Ok(half) } else { Err(io::Error::other("a block is gone")) }
    }
    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        if part == 0 { self.0.boundary(0) } else { Ok(FacePiece::default()) }
    }
}

#[test]
fn earlier_files_stay_when_writing_fails() {
    let (volume, notes) = tube(6);
    for name in ["a.vtu", "a.msh", "a.mesh", "a.ele", "a.pvtu"] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        write_mesh(&path, &volume, &notes).unwrap();
        let files = || std::fs::read_dir(folder.path()).unwrap().count();
        let before = (files(), std::fs::read(&path).unwrap());
        let error = write_mesh(&path, &Broken(&volume), &notes).unwrap_err().to_string();
        assert!(error.contains("a block is gone"), "{error}");
        assert!((files(), std::fs::read(&path).unwrap()) == before, "{name}");
    }
}

#[test]
fn a_full_disk_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.mesh");
    std::fs::write(&path, "earlier").unwrap();
    let (volume, _) = tube(6);
    let error = crate::file::write_whole(&path, |file| {
        let mut disk = Disk { bytes: Cursor::default(), room: 3000 };
        let written = super::medit::write(&mut disk, &volume, &MeshNotes::default());
        file.write_all(disk.bytes.get_ref())?;
        written
    });
    let error: super::error::MeshFileError = FileError::write(&path)(error.unwrap_err());
    let text = error.to_string();
    assert!(text.contains("out.mesh: cannot be written: ") && text.contains("the disk is full"), "{text}");
    assert_eq!(std::fs::read(&path).unwrap(), b"earlier");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn files_appear_whole_and_paths_are_tried_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tube.vtu");
    let (volume, notes) = labelled_tube(2);
    ensure_writable(&path).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    write_mesh(&path, &volume, &notes).unwrap();
    assert_eq!(read_mesh(&path).unwrap().volume, volume);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    for wrong in ["missing/tube.vtu", "tube.docx", "tube"] {
        assert!(ensure_writable(&folder.path().join(wrong)).is_err(), "{wrong}");
    }
}

#[test]
fn every_format_reads_what_it_writes() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, notes) = labelled_tube(3);
    for name in ["a.vtu", "a.msh", "a.mesh", "a.ele"] {
        let path = folder.path().join(name);
        ensure_writable(&path).unwrap();
        write_mesh(&path, &volume, &notes).unwrap();
        let back = read_mesh(&path).unwrap();
        assert_eq!(back.volume.mesh, volume.mesh, "{name}");
        assert_eq!(back.volume.boundary_patch, volume.boundary_patch, "{name}");
        assert!(back.labelled, "{name}");
    }
    assert!(write_mesh_to(&mut Vec::new(), MeshFormat::Tetgen, &volume, &notes).is_err());
}

#[test]
fn every_format_keeps_regions_and_interfaces() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, regions) = walled_channel(1);
    let notes = MeshNotes { regions, generator: "anastomesh".into(), ..MeshNotes::default() };
    for name in ["a.vtu", "a.pvtu", "a.msh", "b.msh2", "a.mesh", "a.npyd"] {
        let path = folder.path().join(name);
        write_mesh(&path, &volume, &notes).unwrap();
        let back = read_mesh(&path).unwrap();
        assert_eq!(back.notes.regions, notes.regions, "{name}");
        assert_eq!(back.volume, volume, "{name}");
    }
    // TetGen's files have numbers only.
    let path = folder.path().join("a.ele");
    write_mesh(&path, &volume, &notes).unwrap();
    let back = read_mesh(&path).unwrap();
    assert_eq!(back.notes.regions, [1, 2, 3].map(NamedRegion::numbered));
    assert_eq!(back.volume.boundary_patch, volume.boundary_patch);
    assert_eq!(VolumeMesh { patches: volume.patches.clone(), ..back.volume }, volume);
}

#[test]
fn a_mesh_whose_writing_is_stopped_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (volume, notes) = labelled_tube(400);
    for name in ["a.vtu", "a.pvtu", "a.msh", "a.mesh", "a.ele"] {
        let path = folder.path().join(name);
        for times in [0, 3] {
            let error =
                write_mesh_with(&WriteOptions::default(), &path, &volume, &notes, &StopsAfter::new(times)).unwrap_err();
            assert!(error.to_string().contains("cancelled"), "{error}");
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "{name}");
        }
    }
}

#[test]
fn prisms_are_whole_cells_in_vtu_and_msh_and_split_when_read() {
    let folder = tempfile::tempdir().unwrap();
    let options = WriteOptions::default().prisms(true);
    for name in ["prisms.vtu", "prisms.msh", "prisms2.msh", "prisms.pvtu"] {
        let path = folder.path().join(name);
        let format = (name == "prisms2.msh").then_some(MeshFormat::Msh2);
        write_mesh_with(&options.format(format), &path, &slab(), &MeshNotes::default(), &()).unwrap();
        let read = read_mesh(&path).unwrap().volume;
        assert_eq!(read.mesh.tets.len(), 12, "{name}");
        assert!(check_tets(&read.mesh, None).failed().next().is_none(), "{name}");
        // The same prisms again, and the sides of the inlet.
        let mixed = MixedMesh::of(&read);
        assert!(mixed.cells.iter().all(|cell| cell.vertices().len() == 6), "{name}");
        assert_eq!(mixed.cells.iter().map(|cell| cell.layer).collect::<Vec<_>>(), [1, 2, 1, 2], "{name}");
        assert_eq!(mixed, MixedMesh::of(&slab()), "{name}");
    }
    let text = fs::read(folder.path().join("prisms.vtu")).unwrap();
    assert!(String::from_utf8_lossy(&text).contains("NumberOfCells=\"16\""));
    let error = write_mesh_with(&options, &folder.path().join("a.mesh"), &slab(), &MeshNotes::default(), &());
    assert!(error.unwrap_err().to_string().contains(".vtu, .pvtu and .msh"));
}

#[test]
fn files_have_the_layer_of_each_tetrahedron() {
    let folder = tempfile::tempdir().unwrap();
    let given = [7; 12];
    for (layers, expected) in [(None, [[1; 3], [2; 3], [1; 3], [2; 3]].as_flattened()), (Some(&given[..]), &given)] {
        let options = WriteOptions::default().layers(layers).grid(GridOptions::default().raw(true));
        let bytes: Vec<u8> = expected.iter().flat_map(|layer: &i32| layer.to_le_bytes()).collect();
        let has = |path: &Path, bytes: &[u8]| {
            let file = fs::read(path).unwrap();
            file.windows(bytes.len()).any(|window| window == bytes)
        };
        for (name, file) in [("a.vtu", "a.vtu"), ("b.pvtu", "b/b_0000.vtu"), ("c.npyd", "c.npyd/tet_layer.npy")] {
            write_mesh_with(&options, &folder.path().join(name), &slab(), &MeshNotes::default(), &()).unwrap();
            assert!(has(&folder.path().join(file), &bytes), "{name}");
        }
        assert!(has(&folder.path().join("b.pvtu"), b"Name=\"layer\""));
    }
    let (volume, notes) = labelled_tube(2);
    write_mesh(&folder.path().join("d.vtu"), &volume, &notes).unwrap();
    assert!(!String::from_utf8_lossy(&fs::read(folder.path().join("d.vtu")).unwrap()).contains("\"layer\""));
}

/// Prisms of another program, with the outer triangle first or last.
#[test]
fn prisms_in_any_order_are_split_alike_on_both_sides() {
    let (mut file, folder) = (slab(), tempfile::tempdir().unwrap());
    file.mesh.points.reverse();
    for face in file.mesh.tets.iter_mut().flatten().chain(file.boundary.iter_mut().flatten()) {
        *face = 11 - *face;
    }
    let path = folder.path().join("prisms.msh");
    write_mesh_with(&WriteOptions::default().prisms(true), &path, &file, &MeshNotes::default(), &()).unwrap();
    let mut bytes = fs::read(&path).unwrap();
    // Each second prism is seen from its other triangle: block of elements of type 6, with tag and six nodes each.
    let start = bytes.windows(20).position(|w| w[..12] == [3, 0, 0, 0, 1, 0, 0, 0, 6, 0, 0, 0]).unwrap() + 20;
    for prism in [1, 3] {
        let nodes = &mut bytes[start + 56 * prism + 8..start + 56 * prism + 56];
        let turned = [3, 5, 4, 0, 2, 1].map(|i: usize| nodes[8 * i..8 * i + 8].to_vec()).concat();
        nodes.copy_from_slice(&turned);
    }
    fs::write(&path, bytes).unwrap();
    let read = read_mesh(&path).unwrap().volume;
    assert!(check_tets(&read.mesh, None).failed().next().is_none());
    assert_eq!(boundary_faces(&read.mesh).len(), slab().boundary.len());
}
