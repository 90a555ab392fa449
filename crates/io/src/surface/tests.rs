//! Tests of all surface formats: round trips, files of other programs, and damaged files.

use super::content::SurfaceNote;
use super::error::SurfaceFault;
use super::write::write_format;
use super::*;
use crate::damage::damage;
use crate::file::FileError;
use crate::text::Place;
use crate::text::TextFault;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::facets::FacetError;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::shapes::sphere_surface;
use proptest::prelude::*;

const FORMATS: [(SurfaceFormat, &str); 4] = [
    (SurfaceFormat::Off, "off"),
    (SurfaceFormat::Ply, "ply"),
    (SurfaceFormat::Stl, "stl"),
    (SurfaceFormat::Obj, "obj"),
];

/// Surface of a tetrahedron, as in all hand-written files of this module.
fn corner() -> TriMesh {
    let points =
        vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0), Point3::new(0.0, 0.0, 1.0)];
    TriMesh { points, triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] }
}

fn read(text: &str, format: SurfaceFormat) -> Result<TriMesh, SurfaceFault> {
    read_surface_from(text.as_bytes(), format)
}

fn written(mesh: &TriMesh, format: SurfaceFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_format(&mut bytes, format, mesh).unwrap();
    bytes
}

/// Corner coordinates of the triangles: the information that STL preserves.
fn places(mesh: &TriMesh) -> Vec<[Point3; 3]> {
    mesh.triangles.iter().map(|t| t.map(|v| mesh.points[v as usize])).collect()
}

#[test]
fn what_is_written_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let mut mesh = sphere_surface(2);
    for (i, p) in mesh.points.iter_mut().enumerate() {
        p.coords *= 1.0 / 3.0 * 10_f64.powi(i as i32 % 40 - 20);
    }
    for (format, extension) in FORMATS {
        let path = folder.path().join(format!("sphere.{}", extension.to_uppercase()));
        write_surface(&path, &mesh).unwrap();
        let back = read_surface(&path).unwrap();
        if format == SurfaceFormat::Stl {
            assert_eq!(places(&back), places(&mesh));
            assert_eq!(back.points.len(), mesh.points.len(), "corners are joined");
        } else {
            assert_eq!(back, mesh, "{extension}");
        }
    }
}

#[test]
fn stl_is_binary_when_nothing_is_lost() {
    let mesh = corner();
    let bytes = written(&mesh, SurfaceFormat::Stl);
    assert_eq!(bytes.len(), 84 + 50 * 4);
    assert_eq!(places(&read_surface_from(&bytes, SurfaceFormat::Stl).unwrap()), places(&mesh));
    // Programs write arbitrary text into the header.
    let mut solid = bytes.clone();
    solid[..6].copy_from_slice(b"solid ");
    assert_eq!(read_surface_from(&solid, SurfaceFormat::Stl).unwrap().triangles.len(), 4);
    let fault = read_surface_from(&bytes[..bytes.len() - 1], SurfaceFormat::Stl).unwrap_err();
    assert_eq!(fault, SurfaceFault::Length { announced: 284, found: 283 });
    let mut infinite = bytes;
    infinite[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let fault = read_surface_from(&infinite, SurfaceFormat::Stl).unwrap_err();
    assert_eq!(fault, SurfaceFault::NotFinite { point: 3, byte: 84 + 50 + 12 });
}

#[test]
fn what_follows_the_last_triangle_of_binary_stl_is_counted() {
    let whole = written(&corner(), SurfaceFormat::Stl);
    let read = |bytes: &[u8]| read_content_from(bytes, SurfaceFormat::Stl);
    assert_eq!(read(&whole).unwrap().notes, []);
    for surplus in [1, 49, 50, 1000] {
        let longer = [whole.as_slice(), &vec![b' '; surplus]].concat();
        let content = read(&longer).unwrap();
        assert_eq!(places(&content.mesh), places(&corner()));
        assert_eq!(content.notes, [SurfaceNote::Surplus { bytes: surplus as u64, triangles: 4 }]);
        assert_eq!(content.notes[0].to_string().contains("the count may be wrong"), surplus >= 50);
        assert_eq!(read_surface_from(&longer, SurfaceFormat::Stl), Ok(content.mesh));
    }
    // A count that was never written is an error.
    let mut unwritten = whole;
    unwritten[80..84].fill(0);
    assert_eq!(read(&unwritten), Err(SurfaceFault::Length { announced: 84, found: 284 }));
}

#[test]
fn triangles_know_their_faces_and_points_their_corners() {
    let points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 0.25 1\n";
    let off = format!("OFF\n5 5 0\n{points}3 0 1 4\n4 3 2 1 0\n3 1 2 4\n3 2 3 4\n3 3 0 4\n");
    let content = read_content_from(off.as_bytes(), SurfaceFormat::Off).unwrap();
    assert_eq!((content.first, content.face_of.as_slice()), (0, &[0, 1, 1, 2, 3, 4][..]));
    let content = read_content_from(OBJ.as_bytes(), SurfaceFormat::Obj).unwrap();
    assert_eq!((content.first, content.face_of, content.corner_of), (1, vec![], vec![]));
    let content = read_content_from(STL.as_bytes(), SurfaceFormat::Stl).unwrap();
    assert_eq!((content.first, content.corner_of.as_slice()), (0, &[0, 1, 2, 4][..]));
    let crossed = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 2 4 3\n";
    let fault = read(crossed, SurfaceFormat::Obj).unwrap_err();
    let SurfaceFault::Polygon { face: 2, fault: FacetError::Crossing { first, second }, .. } = fault else { panic!() };
    let mut named = [first, second].concat();
    named.sort_unstable();
    assert_eq!(named, [1, 2, 3, 4]);
}

#[test]
fn off_and_its_variants() {
    let plain = "OFF\n# a comment\n\n4 4 6\n0 0 0\n1 0 0\n0 1 0 # here\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    assert_eq!(read(plain, SurfaceFormat::Off), Ok(corner()));
    for head in ["OFF 4 4 0", "OFF 4 4", "4 4 0", "\u{feff}OFF\r\n4 4 0", "COFF\n4 4 0", "STCNOFF\n4 4 0"] {
        let columns = format!(
            "{head}\n0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 1 1 1\n0 0 1 1 1 1\n3 0 2 1 9 9 9\n3 0 1 3\n3 1 2 3 0.5\n3 2 0 3"
        );
        assert_eq!(read(&columns, SurfaceFormat::Off), Ok(corner()), "{head}");
    }
    for head in ["4OFF", "nOFF", "OFF BINARY"] {
        let fault = read(&format!("{head}\n4 4 0\n"), SurfaceFormat::Off).unwrap_err();
        assert!(matches!(fault, SurfaceFault::Variant { place: Place::Line(1), .. }), "{head}: {fault}");
    }
}

#[test]
fn off_with_faults() {
    let fault = |text: &str| read(text, SurfaceFormat::Off).unwrap_err();
    let points = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
    let place = Place::Line(6);
    assert_eq!(fault(&format!("{points}2 0 1\n")), SurfaceFault::NotATriangle { face: 0, corners: 2, place });
    for index in [3, -1] {
        let bad = SurfaceFault::BadIndex { face: 0, index, points: 3, first: 0, place };
        assert_eq!(fault(&format!("{points}3 0 1 {index}\n")), bad);
    }
    let text = |fault| match fault {
        SurfaceFault::Text(text) => text,
        other => panic!("{other}"),
    };
    assert!(matches!(text(fault(&format!("{points}3 0 1\n"))), TextFault::CutShort { .. }));
    assert_eq!(text(fault(&format!("{points}3 0 1 2\n3 0 1 2\n"))), TextFault::Surplus { line: 7 });
    assert!(matches!(
        text(fault("OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n")),
        TextFault::NotFinite { line: 3, .. }
    ));
    assert!(matches!(text(fault("OFF\n3 1 0\n0 0 x\n1 0 0\n0 1 0\n3 0 1 2\n")), TextFault::NotANumber { line: 3, .. }));
    let lie = text(fault("OFF\n3000000000 1 0\n0 0 0\n"));
    assert!(matches!(lie, TextFault::CountTooLarge { line: 2, count: 3_000_000_000, .. }));
    assert!(matches!(fault("solid cube\n"), SurfaceFault::Unexpected { place: Place::Line(1), .. }));
    assert_eq!(fault("OFF\n1 0 0\n0 0 0\n"), SurfaceFault::NoFaces { points: 1 });
}

/// A surface in the three encodings, with irrelevant elements and properties.
fn ply(encoding: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\r\nformat {encoding} 1.0\ncomment made by hand\nelement camera 2\nproperty short id\n\
         property list uchar float lens\nelement vertex 4\nproperty uchar red\nproperty float x\nproperty float y\n\
         property double z\nelement face 4\nproperty list ushort uint vertex_index\nproperty int8 tag\n\
         element nothing 9000\nend_header\n"
    )
    .into_bytes();
    let put = |bytes: &mut Vec<u8>, low: &[u8], value: f64| match encoding {
        "ascii" => bytes.extend(format!("{value} ").bytes()),
        "binary_little_endian" => bytes.extend(low),
        _ => bytes.extend(low.iter().rev()),
    };
    for (id, lens) in [(-5_i16, 2_u8), (7, 0)] {
        put(&mut bytes, &id.to_le_bytes(), id.into());
        put(&mut bytes, &[lens], lens.into());
        for _ in 0..lens {
            put(&mut bytes, &0.5_f32.to_le_bytes(), 0.5);
        }
    }
    let mesh = corner();
    for p in &mesh.points {
        put(&mut bytes, &[200], 200.0);
        put(&mut bytes, &(p.x as f32).to_le_bytes(), p.x);
        put(&mut bytes, &(p.y as f32).to_le_bytes(), p.y);
        put(&mut bytes, &p.z.to_le_bytes(), p.z);
    }
    for triangle in &mesh.triangles {
        put(&mut bytes, &3_u16.to_le_bytes(), 3.0);
        for corner in triangle {
            put(&mut bytes, &corner.to_le_bytes(), (*corner).into());
        }
        put(&mut bytes, &(-1_i8).to_le_bytes(), -1.0);
    }
    bytes
}

const ENCODINGS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn ply_in_all_encodings() {
    for encoding in ENCODINGS {
        let bytes = ply(encoding);
        assert_eq!(read_surface_from(&bytes, SurfaceFormat::Ply), Ok(corner()), "{encoding}");
        let head = bytes.windows(10).position(|w| w == b"end_header").unwrap();
        for cut in head..bytes.len() - 2 {
            assert!(read_surface_from(&bytes[..cut], SurfaceFormat::Ply).is_err(), "{encoding} cut at {cut}");
        }
        let mut longer = bytes.clone();
        longer.extend(b" 17");
        assert!(read_surface_from(&longer, SurfaceFormat::Ply).is_err(), "{encoding}");
    }
}

#[test]
fn ply_with_faults() {
    let fault = |from: &str, to: &str| {
        let text = String::from_utf8(ply("ascii")).unwrap();
        assert!(text.contains(from), "{from}");
        read(&text.replacen(from, to, 1), SurfaceFormat::Ply).unwrap_err()
    };
    assert!(matches!(fault("vertex 4", "vertex 40000000000"), SurfaceFault::Text(TextFault::CountTooLarge { .. })));
    assert!(matches!(fault("vertex 4", "vertex -4"), SurfaceFault::Text(TextFault::OutOfRange { line: 7, .. })));
    assert!(matches!(fault("ascii", "utf8"), SurfaceFault::Unexpected { place: Place::Line(2), .. }));
    assert!(matches!(fault("list ushort", "list float"), SurfaceFault::Unexpected { place: Place::Line(13), .. }));
    assert!(matches!(fault("3 0 2 1", "2 0 2"), SurfaceFault::NotATriangle { face: 0, corners: 2, .. }));
    assert!(matches!(fault("3 1 2 3", "3 1 2 4"), SurfaceFault::BadIndex { face: 2, index: 4, points: 4, .. }));
    assert!(matches!(fault("double z", "double w"), SurfaceFault::Missing { .. }));
    assert!(matches!(fault("vertex_index", "vertices"), SurfaceFault::Missing { .. }));
    assert!(matches!(fault("end_header", "end"), SurfaceFault::Unexpected { .. }));
    let mut bytes = ply("binary_little_endian");
    let end = bytes.len();
    // Count of the last face: before 12 bytes of indices and 1 byte of tag, and itself 2 bytes wide.
    bytes[end - 15] = 2;
    let fault = read_surface_from(&bytes, SurfaceFormat::Ply).unwrap_err();
    assert!(matches!(fault, SurfaceFault::NotATriangle { face: 3, corners: 2, place: Place::Byte(_) }), "{fault}");
}

#[test]
fn polygons_become_triangles_in_their_place() {
    let points = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 0.25 1\n";
    let off = format!("OFF\n5 5 0\n{points}3 0 1 4\n4 3 2 1 0 255 0 0\n3 1 2 4\n3 2 3 4\n3 3 0 4\n");
    let from_off = read(&off, SurfaceFormat::Off).unwrap();
    assert_eq!(from_off.triangles.len(), 6);
    assert_eq!((from_off.triangles[0], from_off.triangles[3]), ([0, 1, 4], [1, 2, 4]));
    // Same orientation as the polygon: downwards.
    for t in &from_off.triangles[1..3] {
        let [a, b, c] = t.map(|v| from_off.points[v as usize]);
        assert!((b - a).cross(&(c - a)).z < 0.0);
    }
    let lines: String = points.lines().map(|line| format!("v {line}\n")).collect();
    let obj = format!("f 1 2 5\nf 4 3 2 1\n{lines}f 2 3 5\nf 3 4 5\nf -2 1 -1\n");
    assert_eq!(read(&obj, SurfaceFormat::Obj), Ok(from_off.clone()));
    let head = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
        element face 5\nproperty list uchar int vertex_indices\nend_header\n";
    let ply = format!("{head}{points}3 0 1 4\n4 3 2 1 0\n3 1 2 4\n3 2 3 4\n3 3 0 4\n");
    assert_eq!(read(&ply, SurfaceFormat::Ply), Ok(from_off));
    let crossed = read(&off.replace("4 3 2 1 0", "4 3 1 2 0"), SurfaceFormat::Off).unwrap_err();
    let SurfaceFault::Polygon { face: 1, place: Place::Line(9), fault: found } = crossed else { panic!("{crossed}") };
    assert!(matches!(found, FacetError::Crossing { .. }), "{found}");
}

const STL: &str = "solid a b c\n  facet normal nan nan nan\n outer loop\n VERTEX 0 0 0\n vertex 1 0 -0.0\n vertex 0 1 0\n\
    endloop\nendfacet\nendsolid\nsolid second\nfacet normal 0 0 1\nouter loop\nvertex 1e0 0 0\nvertex 0 0 1\n\
    vertex 0 1.0 0\nendloop\nendfacet\nendsolid second\n";

#[test]
fn stl_as_text() {
    let mesh = read(STL, SurfaceFormat::Stl).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(mesh.points.len(), 4);
    let fault = |from: &str, to: &str| read(&STL.replacen(from, to, 1), SurfaceFormat::Stl).unwrap_err();
    assert!(matches!(fault(" vertex 0 1 0\n", ""), SurfaceFault::NotATriangle { face: 0, corners: 2, .. }));
    assert!(matches!(fault("endsolid second\n", ""), SurfaceFault::Text(TextFault::CutShort { .. })));
    assert!(matches!(fault("outer loop", ""), SurfaceFault::Unexpected { place: Place::Line(4), .. }));
    assert!(matches!(fault("endloop", "end loop"), SurfaceFault::Unexpected { place: Place::Line(7), .. }));
    assert!(matches!(fault("VERTEX 0 0 0", "vertex 0 0"), SurfaceFault::Text(TextFault::LineTooShort { line: 4, .. })));
}

const OBJ: &str = "# by hand\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0 0.1 0.2 0.3\nvt 0 0\nvn 0 0 1\n\
    f 1/1/1 3/1/1 2/1/1\nf 1 2 4\nv 0 0 1\ns off\nf -3//1 -2//1 \\\n -1//1\nusemtl red\nf 3/1 1/1 4/1\nl 1 2\n";

#[test]
fn obj_by_hand() {
    assert_eq!(read(OBJ, SurfaceFormat::Obj), Ok(corner()));
    let fault = |from: &str, to: &str| read(&OBJ.replacen(from, to, 1), SurfaceFormat::Obj).unwrap_err();
    let place = Place::Line(10);
    assert_eq!(fault("f 1 2 4", "f 1 2 5"), SurfaceFault::BadIndex { face: 2, index: 5, points: 4, first: 1, place });
    assert!(matches!(fault("f 1 2 4", "f 1 2 0"), SurfaceFault::BadIndex { face: 2, index: 0, .. }));
    assert!(matches!(fault("f 1 2 4", "f 1 2 -9"), SurfaceFault::BadIndex { face: 2, index: -9, .. }));
    assert_eq!(fault("f 1 2 4", "f 1 2"), SurfaceFault::NotATriangle { face: 2, corners: 2, place });
    assert!(matches!(fault("f 1 2 4", "f 1 a 4"), SurfaceFault::Text(TextFault::NotANumber { line: 10, .. })));
    assert!(matches!(fault("v 1 0 0 1.0", "v 1 0"), SurfaceFault::Text(TextFault::LineTooShort { line: 5, .. })));
    assert!(matches!(read("hello\n", SurfaceFormat::Obj), Err(SurfaceFault::NoFaces { points: 0 })));
}

#[test]
fn files_that_are_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    assert!(matches!(read_surface(&path("a.xyz")), Err(FileError::UnknownFormat { .. })));
    assert!(matches!(read_surface(&path("a.off")), Err(FileError::Read { .. })));
    std::fs::write(path("a.off"), "\n \n").unwrap();
    assert!(matches!(read_surface(&path("a.off")), Err(FileError::Empty { .. })));
    let bad = TriMesh { points: vec![Point3::origin(); 2], triangles: vec![[0, 1, 2]] };
    for (_, extension) in FORMATS {
        let out = path(&format!("out.{extension}"));
        assert!(matches!(write_surface(&out, &bad), Err(FileError::BadMesh { cell: 0, .. })));
        assert!(!out.exists());
    }
    assert!(matches!(write_surface(&path("no/folder.off"), &corner()), Err(FileError::Write { .. })));
}

/// A valid file of each kind.
fn sound_files() -> Vec<(SurfaceFormat, Vec<u8>)> {
    let mesh = sphere_surface(1);
    let mut files: Vec<_> = FORMATS.into_iter().map(|(format, _)| (format, written(&mesh, format))).collect();
    files.extend(ENCODINGS.map(|encoding| (SurfaceFormat::Ply, ply(encoding))));
    files.push((SurfaceFormat::Stl, STL.into()));
    files.push((SurfaceFormat::Stl, written(&corner(), SurfaceFormat::Stl)));
    files.push((SurfaceFormat::Obj, OBJ.into()));
    files
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Damaged files are read or rejected; meshes from them are valid.
    #[test]
    fn damaged_files_make_no_panic(which in 0..10_usize, damage in damage()) {
        let (format, bytes) = sound_files().swap_remove(which);
        let bytes = damage.done_to(&bytes);
        if let Ok(mesh) = read_surface_from(&bytes, format) {
            prop_assert!(mesh.points.iter().all(|p| p.iter().all(|x| x.is_finite())));
            prop_assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.points.len()));
        }
    }
}

/// Markers and names of a file.
fn markers(bytes: &[u8], format: SurfaceFormat) -> (Vec<i32>, Vec<(i32, String)>) {
    let content = read_content_from(bytes, format).unwrap();
    (content.markers, content.names)
}

#[test]
fn groups_of_obj_are_markers() {
    let points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let named = |a: &str, b: &str| vec![(1, a.to_owned()), (2, b.to_owned())];
    let groups = format!(
        "{points}o all\ng outer wall # of the vessel\nf 1 2 3 4\ng cap\nf 1 2 3\ng outer wall # of the vessel\nf 2 3 4\n"
    );
    // A quadrilateral is two triangles.
    let (of_faces, names) = markers(groups.as_bytes(), SurfaceFormat::Obj);
    assert_eq!((of_faces, names[1].clone()), (vec![1, 1, 2, 1], (2, "cap".into())));
    let materials = format!("{points}usemtl a\nf 1 2 3\nusemtl b\nf 2 3 4\n");
    assert_eq!(markers(materials.as_bytes(), SurfaceFormat::Obj), (vec![1, 2], named("a", "b")));
    let single = format!("{points}g a\nf 1 2 3\nf 2 3 4\n");
    assert_eq!(markers(single.as_bytes(), SurfaceFormat::Obj), (vec![], vec![]));
}

#[test]
fn solids_of_stl_are_markers() {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let solids = format!("solid wall\n{facet}endsolid wall\nsolid inlet 1\n{facet}{facet}endsolid\n");
    let (of_faces, names) = markers(solids.as_bytes(), SurfaceFormat::Stl);
    assert_eq!((of_faces, names), (vec![1, 2, 2], vec![(1, "wall".into()), (2, "inlet 1".into())]));
    let single = format!("solid wall\n{facet}endsolid wall\n");
    assert_eq!(markers(single.as_bytes(), SurfaceFormat::Stl).0, [0; 0]);
}

#[test]
fn integer_properties_of_ply_faces_are_markers() {
    let head = |kind: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement face 2\n\
             property {kind} label\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
        )
    };
    let of_ints = format!("{}7 4 0 1 2 3\n-3 3 0 1 2\n", head("int"));
    assert_eq!(markers(of_ints.as_bytes(), SurfaceFormat::Ply).0, [7, 7, -3]);
    let of_floats = format!("{}7 4 0 1 2 3\n-3 3 0 1 2\n", head("float"));
    assert_eq!(markers(of_floats.as_bytes(), SurfaceFormat::Ply).0, [0; 0]);
}

#[test]
fn polygons_of_vtp_have_the_face_ids_of_simvascular() {
    let file = |offsets: &str| {
        format!(
            "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfVerts=\"1\" NumberOfLines=\"0\" \
             NumberOfStrips=\"0\" NumberOfPolys=\"2\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\
             0 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\
             0 1 2 3 0 1 2</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{offsets}</DataArray></Polys>\
             <CellData><DataArray type=\"Int32\" Name=\"ModelFaceID\" format=\"ascii\">9 2 5</DataArray></CellData>\
             </Piece></PolyData></VTKFile>"
        )
    };
    let content = read_content_from(file("4 7").as_bytes(), SurfaceFormat::Vtp).unwrap();
    assert_eq!((content.markers, content.mesh.triangles.len()), (vec![2, 2, 5], 3));
    for offsets in ["4 8", "4 3", "4"] {
        assert!(read_content_from(file(offsets).as_bytes(), SurfaceFormat::Vtp).is_err(), "{offsets}");
    }
}
