//! Tests that written boundaries are read back unchanged, in every readable format.

use super::*;
use crate::surface::{SurfaceFormat, read_content_from, read_surface_from};
use crate::volume::fixtures::labelled_tube;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::boundary::BoundaryPart;
use std::io::Cursor;

fn bytes_of(format: BoundaryFormat, surface: &BoundarySurface) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    write_format(&mut out, format, surface, &MeshNotes::default()).unwrap();
    out.into_inner()
}

#[test]
fn surfaces_come_back() {
    let (volume, _) = labelled_tube(9);
    for faces in [BoundaryPart::Whole, BoundaryPart::Wall] {
        let surface = BoundarySurface::new(&volume, faces).unwrap();
        let expected = surface.gather().unwrap();
        for (format, read) in [
            (BoundaryFormat::Ply, SurfaceFormat::Ply),
            (BoundaryFormat::Obj, SurfaceFormat::Obj),
            (BoundaryFormat::Off, SurfaceFormat::Off),
        ] {
            assert_eq!(read_surface_from(&bytes_of(format, &surface), read).unwrap(), expected, "{format:?}");
        }
        // STL points are numbered in order of occurrence and have 32 bits.
        let stl = read_content_from(&bytes_of(BoundaryFormat::Stl, &surface), SurfaceFormat::Stl).unwrap().mesh;
        let corners = |mesh: &TriMesh| -> Vec<[[f32; 3]; 3]> {
            let at = |v: u32| <[f64; 3]>::from(mesh.points[v as usize].coords).map(|x| x as f32);
            mesh.triangles.iter().map(|t| t.map(at)).collect()
        };
        assert_eq!((corners(&stl), stl.points.len()), (corners(&expected), expected.points.len()));
    }
}

#[test]
fn glb_says_where_its_bytes_are() {
    let (volume, _) = labelled_tube(9);
    let surface = BoundarySurface::new(&volume, BoundaryPart::Whole).unwrap();
    let bytes = bytes_of(BoundaryFormat::Glb, &surface);
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let text: serde_json::Value = serde_json::from_slice(&bytes[20..20 + word(12)]).unwrap();
    let body = 20 + word(12) + 8;
    assert_eq!((body % 4, word(body - 8)), (0, bytes.len() - body));
    assert_eq!(text["buffers"][0]["byteLength"], bytes.len() - body);
    let (points, view) = (surface.counts().points, &text["bufferViews"][1]);
    assert_eq!((&text["accessors"][0]["count"], &view["byteOffset"]), (&points.into(), &(12 * points).into()));
    let first = body + 12 * points;
    let expected = surface.gather().unwrap();
    let corners: Vec<u32> = (0..3).map(|i| word(first + 4 * i) as u32).collect();
    assert_eq!(corners, expected.triangles[0]);
    // Coordinates are relative to the node.
    let x = f32::from_le_bytes(bytes[body..body + 4].try_into().unwrap());
    let from = text["nodes"][0]["translation"][0].as_f64().unwrap();
    assert!((f64::from(x) + from - expected.points[0].x).abs() < 1e-6);
}

#[test]
fn a_file_that_cannot_be_written_is_refused_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    ensure_boundary_writable(&folder.path().join("wall.3mf")).unwrap();
    assert!(ensure_boundary_writable(&folder.path().join("wall.vtu")).is_err());
    assert!(ensure_boundary_writable(&folder.path().join("none/wall.stl")).is_err());
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
}
