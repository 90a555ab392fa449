//! Tests of round trips for any number of threads.

use super::arrays::{LARGEST_NAMED, Width, cell_arrays};
use super::file::APPENDED_CLOSE;
use super::read::read;
use super::write::write;
use crate::volume::content::{MeshFile, MeshNotes};
use crate::volume::fixtures::labelled_tube;
use crate::volume::options::{GridOptions, WriteOptions};
use crate::volume::second::CellNodes;
use crate::vtk_xml::{Packing, VtkXml, write_blocks};
use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::SourceCounts;
use anastomesh_mesh::{Patch, VolumeMesh};
use flate2::Compression;
use std::io::Cursor;

fn bytes_of(volume: &VolumeMesh, notes: &MeshNotes) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(&mut bytes, volume, notes, &WriteOptions::default()).unwrap();
    bytes.into_inner()
}

#[test]
fn what_is_written_is_read() {
    // Enough layers for several compressed blocks.
    for layers in [1, 900] {
        let (volume, notes) = labelled_tube(layers);
        let file = read(&bytes_of(&volume, &notes)).unwrap();
        assert_eq!(file, MeshFile { volume, labelled: true, second_order: None, notes });
    }
}

#[test]
fn options_change_how_it_stands_in_the_file() {
    let (volume, notes) = labelled_tube(900);
    let read_with = |options| {
        let mut bytes = Cursor::new(Vec::new());
        write(&mut bytes, &volume, &notes, &WriteOptions::default().grid(options)).unwrap();
        read(&bytes.into_inner()).unwrap()
    };
    let usual = GridOptions::default();
    let whole = MeshFile { volume: volume.clone(), labelled: true, second_order: None, notes: notes.clone() };
    assert_eq!(read_with(GridOptions { raw: true, ..usual }), whole);
    let mut short = whole;
    short.volume.mesh.points.iter_mut().for_each(|p| *p = p.map(|x| f64::from(x as f32)));
    assert_eq!(read_with(GridOptions { float32: true, ..usual }), short);
    let alone = read_with(GridOptions { tets_alone: true, ..usual });
    assert_eq!((&alone.volume.mesh, &alone.notes), (&volume.mesh, &notes));
    assert!(!alone.labelled && alone.volume.boundary.is_empty());
}

/// meshio replaces offsets while it looks for the next one, so offsets must decrease in the order of the header.
#[test]
fn bytes_are_in_reverse_order_of_the_header() {
    let (volume, notes) = labelled_tube(1);
    for raw in [false, true] {
        let mut bytes = Cursor::new(Vec::new());
        let options = GridOptions { raw, ..GridOptions::default() };
        write(&mut bytes, &volume, &notes, &WriteOptions::default().grid(options)).unwrap();
        let text = String::from_utf8_lossy(bytes.get_ref()).into_owned();
        let offset = |part: &str| part.split_once('"').unwrap().0.parse::<u64>().unwrap();
        let offsets: Vec<u64> = text.split(" offset=\"").skip(1).map(offset).collect();
        assert!(offsets.len() > 5 && offsets.is_sorted_by(|a, b| a > b), "{offsets:?}");
        assert_eq!(offsets.last(), Some(&0));
    }
}

/// Height of a point, and number of corners of a cell.
struct Heights([Column; 2]);

impl Beside for Heights {
    fn columns(&self) -> &[Column] {
        &self.0
    }

    fn at_points(&self, _: usize, points: &[Point3]) -> Vec<f64> {
        points.iter().map(|p| p.z).collect()
    }

    fn in_tets(&self, _: usize, tets: &[[Point3; 4]]) -> Vec<f64> {
        vec![4.0; tets.len()]
    }

    fn in_faces(&self, _: usize, faces: &[[Point3; 3]]) -> Vec<f64> {
        vec![3.0; faces.len()]
    }
}

#[test]
fn values_stand_beside_the_mesh() {
    let (volume, notes) = labelled_tube(9);
    let height = Column { name: "height", at_points: true, is_integer: false };
    let corners = Column { name: "corners", at_points: false, is_integer: true };
    let mut bytes = Cursor::new(Vec::new());
    let heights = Heights([height, corners]);
    let values: &dyn Beside = &heights;
    write(&mut bytes, &volume, &notes, &WriteOptions::default().values(values)).unwrap();
    let bytes = bytes.into_inner();
    assert_eq!(read(&bytes).unwrap().volume, volume);
    let xml = VtkXml::parse(&bytes, "UnstructuredGrid").unwrap();
    let grid = xml.child(VtkXml::ROOT, "UnstructuredGrid").unwrap();
    let piece = xml.child(grid, "Piece").unwrap();
    let array = |section, name| {
        let section = xml.child(piece, section).unwrap();
        let (_, array) = xml.arrays(section).find(|(n, _)| *n == name).unwrap();
        xml.read(array).unwrap()
    };
    let heights: Vec<f64> = volume.mesh.points.iter().map(|p| p.z).collect();
    assert_eq!(array("PointData", "height").into_floats(), heights);
    let expected = [vec![4; volume.mesh.tets.len()], vec![3; volume.boundary.len()]].concat();
    assert_eq!(array("CellData", "corners").into_ints(), Some(expected));
}

#[test]
fn an_empty_mesh_and_one_without_caps() {
    let (mut volume, _) = labelled_tube(2);
    volume.patches[1].cap = None;
    let notes = MeshNotes::default();
    let file = read(&bytes_of(&volume, &notes)).unwrap();
    assert_eq!(file, MeshFile { volume, labelled: true, second_order: None, notes });
    let file = read(&bytes_of(&VolumeMesh::default(), &MeshNotes::default())).unwrap();
    assert_eq!(file, MeshFile::default());
}

#[test]
fn caps_beyond_the_list_of_names_are_kept() {
    let (mut volume, notes) = labelled_tube(2);
    let far = LARGEST_NAMED + 5;
    volume.patches[1] = Patch { id: far, name: format!("outlet_{}", far - 3), ..volume.patches[1].clone() };
    volume.boundary_patch.iter_mut().filter(|id| **id == 3).for_each(|id| *id = far);
    let file = read(&bytes_of(&volume, &notes)).unwrap();
    assert_eq!(file, MeshFile { volume, labelled: true, second_order: None, notes });
}

#[test]
fn a_mesh_of_loops_alone_expects_no_terminals() {
    let (volume, mut notes) = labelled_tube(1);
    notes.expectation = Some(Expectation { loops: vec![1], terminals: Vec::new() });
    let file = read(&bytes_of(&volume, &notes)).unwrap();
    assert_eq!(file.notes.expectation, notes.expectation);
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let (volume, notes) = labelled_tube(500);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bytes_of(&volume, &notes))
    };
    let one = with(1);
    assert!(one == with(2) && one == with(7));
}

#[test]
fn every_cut_is_noticed() {
    let (volume, notes) = labelled_tube(3);
    let whole = bytes_of(&volume, &notes);
    let body = whole.len() - APPENDED_CLOSE.len();
    for cut in (0..body).step_by(97).chain([body - 1]) {
        assert!(read(&whole[..cut]).is_err(), "cut at {cut} of {body}");
    }
}

#[test]
fn files_of_other_programs() {
    // Two pieces, a line among the cells, unnamed labels under another array name, and one bad index.
    let text = r#"<VTKFile type="UnstructuredGrid"><UnstructuredGrid>
        <Piece NumberOfPoints="4" NumberOfCells="3">
        <Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>
        <Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 0 1 2 3 0 2 1</DataArray>
        <DataArray type="Int32" Name="offsets" format="ascii">2 6 9</DataArray>
        <DataArray type="UInt8" Name="types" format="ascii">3 10 5</DataArray></Cells>
        <CellData><DataArray type="Int64" Name="ModelFaceID" format="ascii">0 0 2</DataArray></CellData></Piece>
        <Piece NumberOfPoints="4" NumberOfCells="1">
        <Points><DataArray type="Float32" NumberOfComponents="3" format="ascii">0 0 5 1 0 5 0 1 5 0 0 6</DataArray></Points>
        <Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 -9</DataArray>
        <DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>
        <DataArray type="UInt8" Name="types" format="ascii">10</DataArray></Cells>
        <CellData><DataArray type="Int64" Name="ModelFaceID" format="ascii">0</DataArray></CellData></Piece>
        </UnstructuredGrid></VTKFile>"#;
    let file = read(text.as_bytes()).unwrap();
    assert_eq!(file.volume.mesh.points.len(), 8);
    assert_eq!(file.volume.mesh.tets, [[0, 1, 2, 3], [4, 5, 6, u32::MAX]]);
    assert_eq!((file.volume.boundary, file.volume.boundary_patch), (vec![[0, 2, 1]], vec![2]));
    assert_eq!(file.volume.patches[0].name, "inlet");
    let hexahedron = text.replace("3 10 5", "12 10 5");
    assert!(read(hexahedron.as_bytes()).is_err());
    let short = text.replace("2 6 9", "2 5 9");
    assert!(read(short.as_bytes()).is_err());
    let wild = text.replace("2 6 9", "2 -6 9");
    assert!(read(wild.as_bytes()).is_err());
}

#[test]
fn a_large_patch_id_makes_no_large_file() {
    let (mut volume, notes) = labelled_tube(1);
    for id in [i32::MAX, -5] {
        volume.boundary_patch.fill(id);
        volume.patches = vec![Patch { id, name: "far".into(), cap: None }];
        let bytes = bytes_of(&volume, &notes);
        assert!(bytes.len() < 100_000);
        assert_eq!(read(&bytes).unwrap().volume.boundary_patch, volume.boundary_patch);
    }
}

#[test]
fn many_cells_or_points_need_wide_numbers() {
    let of = |points, tets, boundary| Width::of(SourceCounts { points, tets, boundary }, CellNodes::default());
    assert_eq!(of(1 << 30, 150_000_000, 40_000_000), Width::Int32);
    assert_eq!(of(4, (1 << 29) - 1, 1), Width::Int32);
    assert_eq!(of(4, 1 << 29, 0), Width::Int64);
    assert_eq!(of(4, (1 << 29) - 1, 2), Width::Int64);
    assert_eq!(of(1 << 31, 1, 0), Width::Int64);
}

#[test]
fn wide_numbers_are_read() {
    let (volume, _) = labelled_tube(200);
    let [corners, offsets, _] = cell_arrays(&volume, CellNodes::default(), Width::Int64);
    for (array, first) in [(corners, u64::from(volume.mesh.tets[0][0])), (offsets, 4)] {
        assert_eq!((array.kind, array.width), ("Int64", 8));
        let mut bytes = Cursor::new(Vec::new());
        write_blocks(&mut bytes, array.values, 8, Packing::Zlib(Compression::none()), &array.fill).unwrap();
        let bytes = bytes.into_inner();
        let size = |word: usize| u64::from_le_bytes(bytes[8 * word..8 * word + 8].try_into().unwrap());
        let mut raw = Vec::new();
        let mut block = &bytes[8 * (3 + size(0) as usize)..][..size(3) as usize];
        std::io::Read::read_to_end(&mut flate2::read::ZlibDecoder::new(&mut block), &mut raw).unwrap();
        assert_eq!(u64::from_le_bytes(raw[..8].try_into().unwrap()), first);
        assert_eq!(raw.len() as u64, if size(0) > 1 { size(1) } else { size(2) });
    }
}
