//! Tests of blockwise reading, of unsupported layouts, and of damaged files.

use super::super::names::{VTK_TETRA, VTK_TRIANGLE};
use super::*;
use crate::volume::fixtures::labelled_tube;
use crate::volume::options::{GridOptions, WriteOptions};
use crate::volume::vtu::write;
use crate::vtk_xml::{Packing, write_blocks};
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::source::gather;
use flate2::Compression;
use std::io::{Cursor, Seek, Write};

/// A tube with contiguous blocks.
fn blocks(layers: u32, count: usize) -> (VolumeMesh, MeshNotes) {
    let (mut volume, notes) = labelled_tube(layers);
    let (tets, faces) = (volume.mesh.tets.len(), volume.boundary.len());
    volume.tet_block = (0..tets).map(|i| 10 - (i * count / tets) as i32).collect();
    volume.boundary_block = (0..faces).map(|i| 10 - (i * count / faces) as i32).collect();
    (volume, notes)
}

fn bytes_of(volume: &VolumeMesh, notes: &MeshNotes) -> Vec<u8> {
    bytes_with(volume, notes, GridOptions::default())
}

fn bytes_with(volume: &VolumeMesh, notes: &MeshNotes, options: GridOptions) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(&mut bytes, volume, notes, &WriteOptions::default().grid(options)).unwrap();
    bytes.into_inner()
}

fn open(bytes: &[u8]) -> Result<VtuPieces, VtuPiecesError> {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(bytes).unwrap();
    VtuPieces::open(file.path(), 1 << 20)
}

#[test]
fn what_is_written_is_read_in_pieces() {
    for (layers, count) in [(3, 1), (3, 4), (900, 7)] {
        let (volume, notes) = blocks(layers, count);
        let pieces = open(&bytes_of(&volume, &notes)).unwrap();
        assert_eq!((pieces.parts() as usize, pieces.notes()), (count, &notes));
        assert_eq!(gather(&pieces).unwrap(), volume);
        let some: Vec<u32> = (0..volume.mesh.points.len() as u32).filter(|i| i % 5 == 0 || i % 300 == 7).collect();
        let points: Vec<_> = some.iter().map(|&i| volume.mesh.points[i as usize]).collect();
        assert_eq!(pieces.points_of(&some).unwrap(), points);
    }
}

#[test]
fn arrays_as_they_are_and_short_coordinates_are_read_in_pieces() {
    let (mut volume, notes) = blocks(900, 7);
    let raw = open(&bytes_with(&volume, &notes, GridOptions { raw: true, ..GridOptions::default() })).unwrap();
    assert_eq!(gather(&raw).unwrap(), volume);
    let options = GridOptions { raw: true, float32: true, tets_alone: false };
    let bytes = bytes_with(&volume, &notes, options);
    volume.mesh.points.iter_mut().for_each(|p| *p = p.map(|x| f64::from(x as f32)));
    assert_eq!(gather(&open(&bytes).unwrap()).unwrap(), volume);
    let cut = bytes.len() / 2;
    assert!(open(&bytes[..cut]).is_err());
}

#[test]
fn other_layouts_are_told_apart() {
    let said = |volume: &VolumeMesh, notes: &MeshNotes| match open(&bytes_of(volume, notes)) {
        Err(VtuPiecesError::Layout { what }) => what,
        other => panic!("{other:?}"),
    };
    // Alternating blocks.
    let (volume, notes) = labelled_tube(3);
    assert_eq!(said(&volume, &notes), "the cells of a block do not stand together");
    let (mut volume, notes) = blocks(3, 2);
    volume.boundary_block.reverse();
    volume.boundary_block[0] = 10;
    assert_eq!(said(&volume, &notes), "the cells of a block do not stand together");
    let alone = bytes_with(&volume, &notes, GridOptions { tets_alone: true, ..GridOptions::default() });
    assert!(matches!(open(&alone), Err(VtuPiecesError::Layout { what: "it labels no boundary" })));
    let text = b"<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid></UnstructuredGrid></VTKFile>";
    assert!(matches!(open(text), Err(VtuPiecesError::Layout { .. })));
    assert!(matches!(open(b""), Err(VtuPiecesError::Layout { .. })));
}

#[test]
fn damaged_files_are_errors() {
    let (volume, notes) = blocks(3, 2);
    let whole = bytes_of(&volume, &notes);
    let reads = |bytes: &[u8]| {
        open(bytes).is_ok_and(|pieces| {
            let all: Vec<u32> = (0..pieces.counts().points as u32).collect();
            let piece = |i| pieces.tets(i).is_ok() && pieces.boundary(i).is_ok() && pieces.points(i).is_ok();
            (0..pieces.parts()).all(piece) && pieces.points_of(&all).is_ok()
        })
    };
    assert!(reads(&whole));
    let end = whole.len() - b"\n</AppendedData>\n</VTKFile>\n".len();
    for cut in (0..end).step_by(61).chain([end - 1]) {
        assert!(!reads(&whole[..cut]), "cut at {cut} of {end}");
    }
    // No value of a byte causes a panic or excessive memory use.
    for at in (0..end).step_by(3) {
        let mut other = whole.clone();
        other[at] ^= 1 << (at % 8);
        reads(&other);
    }
}

#[test]
fn vertex_numbers_of_64_bits() {
    let mut body = Cursor::new(Vec::new());
    let mut array = |name: &str, kind: &str, width: usize, bytes: Vec<u8>| {
        let offset = body.stream_position().unwrap();
        let values = bytes.len() / width;
        write_blocks(&mut body, values, width, Packing::Zlib(Compression::fast()), |out| {
            out.push(bytes.len(), |i| [bytes[i]])
        })
        .unwrap();
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"appended\" offset=\"{offset}\"/>")
    };
    let wide = |values: &[u64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let narrow = |values: &[i32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let names = array("patch_names", "String", 1, b"lumen\0wall\0".to_vec());
    let corners: Vec<u8> =
        [0.0_f64, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let points = array("Points", "Float64", 8, corners);
    let cells = [
        array("connectivity", "Int64", 8, wide(&[0, 1, 2, 3, 0, 2, 1 << 40])),
        array("offsets", "Int64", 8, wide(&[4, 7])),
        array("types", "UInt8", 1, vec![VTK_TETRA, VTK_TRIANGLE]),
    ]
    .concat();
    let data = [array("patch", "Int32", 4, narrow(&[0, 1])), array("block", "Int32", 4, narrow(&[5, 5]))].concat();
    let head = format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" header_type=\"UInt64\" \
         compressor=\"vtkZLibDataCompressor\"><UnstructuredGrid><FieldData>{names}</FieldData>\
         <Piece NumberOfPoints=\"4\" NumberOfCells=\"2\"><Points>{points}</Points><Cells>{cells}</Cells>\
         <CellData>{data}</CellData></Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_"
    );
    let pieces = open(&[head.as_bytes(), body.get_ref()].concat()).unwrap();
    assert_eq!(&*pieces.tets(0).unwrap().tets, [[0, 1, 2, 3]]);
    let FacePiece { faces, patches, .. } = pieces.boundary(0).unwrap();
    assert_eq!((&*faces, &*patches), (&[[0, 2, u32::MAX]][..], &[1][..]));
}
