//! Readers of meshes: every encoding gives the same mesh, and damaged files have an error that names the reason.

use super::common::{cuboid, label, tube, vtu};
use super::program::{msh_2, msh_4};
use anastomesh_verify::{Cap, Mesh, read_mesh};
use std::io::Write as _;

/// Mesh in a file of this name, or the text of the error.
fn read(name: &str, bytes: impl AsRef<[u8]>) -> Result<Mesh, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("a file");
    read_mesh(&path).map_err(|e| format!("{e:#}"))
}

/// Cube with coordinates that 32 bits store exactly, and negative labels.
fn cube() -> Mesh {
    let mut mesh = cuboid([1, 1, 1]);
    label(&mut mesh, &|_| 0);
    mesh.points.iter_mut().for_each(|p| *p = p.map(|x| 1.5 * x - 0.25));
    mesh.labels.iter_mut().zip(-4..).for_each(|(label, i)| *label = i);
    mesh
}

/// Way in which the arrays of a VTU file are stored.
#[derive(Clone, Copy, Debug)]
struct Encoding {
    is_appended: bool,
    is_base64: bool,
    is_big: bool,
    /// Bytes of a number in a header.
    word: usize,
    /// Bytes of a compressed block; 0 without compression.
    block: usize,
}

impl Encoding {
    fn header(&self, numbers: &[usize]) -> Vec<u8> {
        let kind = if self.word == 8 { "UInt64" } else { "UInt32" };
        bytes(kind, self.is_big, &numbers.iter().map(|&n| n as f64).collect::<Vec<_>>())
    }

    fn encode(&self, data: &[u8]) -> Vec<u8> {
        let parts = if self.block == 0 {
            vec![[self.header(&[data.len()]), data.to_vec()].concat()]
        } else {
            let blocks: Vec<Vec<u8>> = data.chunks(self.block).map(compressed).collect();
            // The size of the last block is 0 if it is full.
            let mut numbers = vec![blocks.len(), self.block, data.len() % self.block];
            numbers.extend(blocks.iter().map(Vec::len));
            vec![self.header(&numbers), blocks.concat()]
        };
        if self.is_base64 { parts.iter().map(|part| base64(part)).collect::<String>().into() } else { parts.concat() }
    }
}

fn compressed(data: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(data).expect("memory");
    encoder.finish().expect("memory")
}

fn base64(data: &[u8]) -> String {
    let letters: Vec<char> = ('A'..='Z').chain('a'..='z').chain('0'..='9').chain(['+', '/']).collect();
    let four = |three: &[u8]| {
        let bits = three.iter().chain(&[0; 2]).take(3).fold(0, |bits, &byte| bits * 256 + usize::from(byte));
        let letter = |i: usize| if i <= three.len() { letters[bits >> (18 - 6 * i) & 63] } else { '=' };
        (0..4).map(letter).collect::<String>()
    };
    data.chunks(3).map(four).collect()
}

/// Bytes of numbers of a VTK type.
fn bytes(kind: &str, is_big: bool, numbers: &[f64]) -> Vec<u8> {
    let little = |x: f64| match kind {
        "Float64" => x.to_le_bytes().to_vec(),
        "Float32" => (x as f32).to_le_bytes().to_vec(),
        _ => (x as i64).to_le_bytes()
            [..kind.trim_start_matches(char::is_alphabetic).parse::<usize>().expect("bits") / 8]
            .to_vec(),
    };
    let ordered = |x: &f64| if is_big { little(*x).into_iter().rev().collect() } else { little(*x) };
    numbers.iter().flat_map(ordered).collect()
}

/// VTU file of a mesh, with types of its coordinates, its indices and its labels.
fn encoded(mesh: &Mesh, how: &Encoding, [real, index, patch]: [&str; 3]) -> Vec<u8> {
    let mut appended = Vec::new();
    let mut array = |kind: &str, name: &str, numbers: &[f64]| {
        let data = how.encode(&bytes(kind, how.is_big, numbers));
        let head = format!("<DataArray type='{kind}' Name='{name}' format=");
        if how.is_appended {
            let offset = appended.len();
            appended.extend(data);
            return format!("{head}'appended' offset='{offset}'/>");
        }
        format!("{head}'binary'>\n {}\n </DataArray>", String::from_utf8(data).expect("base64"))
    };
    let (tets, triangles) = (mesh.tets.len(), mesh.triangles.len());
    let vertices: Vec<f64> =
        mesh.tets.as_flattened().iter().chain(mesh.triangles.as_flattened()).map(|&v| f64::from(v)).collect();
    let ends: Vec<f64> =
        (1..=tets).map(|i| 4 * i).chain((1..=triangles).map(|i| 4 * tets + 3 * i)).map(|n| n as f64).collect();
    let types: Vec<f64> = (0..tets + triangles).map(|i| if i < tets { 10. } else { 5. }).collect();
    let labels: Vec<f64> = std::iter::repeat_n(0., tets).chain(mesh.labels.iter().map(|&label| label as f64)).collect();
    let order = if how.is_big { "BigEndian" } else { "LittleEndian" };
    let compressor = if how.block > 0 { "compressor='vtkZLibDataCompressor'" } else { "" };
    let mut file = format!(
        "<?xml version='1.0'?><!-- a mesh --><VTKFile type='UnstructuredGrid' byte_order='{order}' {compressor} \
         header_type='UInt{}'><UnstructuredGrid><Piece><Points>{}</Points><Cells>{}{}{}</Cells><CellData>{}</CellData>\
         </Piece></UnstructuredGrid>",
        8 * how.word,
        array(real, "Points", mesh.points.as_flattened()),
        array(index, "connectivity", &vertices),
        array(index, "offsets", &ends),
        array("UInt8", "types", &types),
        array(patch, "patch", &labels),
    )
    .into_bytes();
    if how.is_appended {
        let encoding = if how.is_base64 { "base64" } else { "raw" };
        file.extend(format!("<AppendedData encoding='{encoding}'>\n _").bytes());
        file.extend(appended);
        file.extend(b"\n </AppendedData>");
    }
    file.extend(b"</VTKFile>");
    file
}

#[test]
fn every_encoding_of_a_vtu_file_gives_the_same_mesh() {
    let mesh = cube();
    let flags = |n: usize| [1, 2, 4, 8].map(|bit| n & bit > 0);
    for [is_appended, is_base64, is_big, is_wide] in (0..16).map(flags).filter(|flags| flags[0] || flags[1]) {
        // 192 bytes of coordinates are 3 full blocks of 64, or one of 100 and a rest; 18 bytes of types are one block.
        for block in [0, 64, 100, 1000] {
            let word = if is_wide { 8 } else { 4 };
            let how = Encoding { is_appended, is_base64, is_big, word, block };
            assert_eq!(read("m.vtu", encoded(&mesh, &how, ["Float64", "Int64", "Int32"])), Ok(mesh.clone()), "{how:?}");
        }
    }
}

const PLAIN: Encoding = Encoding { is_appended: true, is_base64: false, is_big: false, word: 4, block: 0 };

#[test]
fn every_type_of_a_vtu_file_gives_the_same_mesh() {
    let mesh = cube();
    for real in ["Float32", "Float64"] {
        for index in ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"] {
            for patch in ["Int8", "Int16", "Int32", "Int64"] {
                let file = encoded(&mesh, &PLAIN, [real, index, patch]);
                assert_eq!(read("m.vtu", file), Ok(mesh.clone()), "{real} {index} {patch}");
            }
        }
    }
    // The largest numbers of unsigned types are not negative.
    let mut unsigned = mesh.clone();
    for (kind, largest) in [("UInt8", 255), ("UInt16", 65535), ("UInt32", 4_294_967_295_i64)] {
        unsigned.labels = vec![largest; mesh.labels.len()];
        assert_eq!(
            read("m.vtu", encoded(&unsigned, &PLAIN, ["Float64", "Int32", kind])),
            Ok(unsigned.clone()),
            "{kind}"
        );
    }
    let error = |types| read("m.vtu", encoded(&mesh, &PLAIN, types)).expect_err("an unknown type");
    assert_eq!(error(["Float64", "Int24", "Int32"]), "array 'connectivity' of Cells: type 'Int24' is not supported");
    let reason = "array 'connectivity' of Cells: floating-point numbers instead of integers";
    assert_eq!(error(["Float64", "Float32", "Int32"]), reason);
    // Integers are coordinates, too.
    let mut whole = mesh;
    whole.points.iter_mut().for_each(|p| *p = p.map(f64::round));
    assert_eq!(read("m.vtu", encoded(&whole, &PLAIN, ["Int16", "Int32", "Int32"])), Ok(whole.clone()));
}

#[test]
fn damaged_blocks_of_a_vtu_file_are_errors() {
    let zlib = Encoding { block: 100, ..PLAIN };
    let sound = encoded(&cube(), &zlib, ["Float64", "Int64", "Int32"]);
    let start = sound.windows(2).position(|pair| pair == b" _").expect("appended data") + 2;
    // Header: number of blocks, size, size of the last, compressed sizes. A block is shorter or longer than it says.
    for (at, by) in [(4, 1), (4, -1), (8, 1), (8, -1)] {
        let mut damaged = sound.clone();
        damaged[start + at] = damaged[start + at].wrapping_add_signed(by);
        let error = read("m.vtu", damaged).expect_err("a damaged block");
        let block = usize::from(at == 8);
        assert_eq!(error, format!("array '' of Points: block {block} of its compressed data is damaged"), "{at} {by}");
    }
    let mut damaged = sound.clone();
    damaged[start + 20] ^= 255;
    assert!(read("m.vtu", damaged).expect_err("no zlib").contains("block 0 of its compressed data is damaged"));
    assert_eq!(read("m.vtu", &sound[..start + 30]), Err("array '' of Points: the file ends inside it".into()));
    let odd = Encoding { block: 0, ..PLAIN };
    let mut damaged = encoded(&cube(), &odd, ["Float64", "Int64", "Int32"]);
    let start = damaged.windows(2).position(|pair| pair == b" _").expect("appended data") + 2;
    damaged[start] -= 1;
    assert!(
        read("m.vtu", damaged).expect_err("191 bytes").contains("its length is no multiple of the size of a number")
    );
}

/// VTU file of one tetrahedron with the texts of its arrays, and further arrays of cells and fields.
fn small([connectivity, offsets, types]: [&str; 3], cells: &str, fields: &str) -> String {
    let array = |kind: &str, name: &str, text: &str| {
        format!("<DataArray type='{kind}' Name='{name}' format='ascii'> {text} </DataArray>\n")
    };
    let split = |texts: &str| -> String {
        let arrays = texts.lines().filter_map(|line| line.split_once(": "));
        arrays.map(|(name, text)| array(if text.contains('.') { "Float64" } else { "Int64" }, name, text)).collect()
    };
    format!(
        "<VTKFile type='UnstructuredGrid'><FieldData>{}</FieldData><Piece><PointData>{}</PointData><Points>{}</Points>\n\
         <CellData>{}</CellData><Cells>{}{}{}</Cells></Piece></VTKFile>",
        split(fields),
        array("Int64", "types", "7 7 7 7"),
        array("Float64", "Points", "0 0 0 1 0 0 0 1 0 0 0 1"),
        split(cells),
        array("Int64", "connectivity", connectivity),
        array("Int64", "offsets", offsets),
        array("Int64", "types", types),
    )
}

/// A tetrahedron, then a triangle.
const TWO: [&str; 3] = ["0 1 2 3 0 2 1", "4 7", "10 5"];

#[test]
fn points_and_lines_of_a_vtu_file_are_ignored() {
    let cells = ["0 1 2 3 0 2 1 0 1 0 1 0 1 2", "4 7 8 10 12 14", "10 5 1 2 3 4"];
    let mesh = read("m.vtu", small(cells, "patch: 0 6 1 2 3 4", "")).expect("readable");
    assert_eq!((mesh.tets, mesh.triangles, mesh.labels), (vec![[0, 1, 2, 3]], vec![[0, 2, 1]], vec![6]));
    assert_eq!(mesh.points[3], [0.0, 0.0, 1.0]);
}

#[test]
fn labels_have_several_names_in_vtu_files() {
    let labels = |cells: &str| read("m.vtu", small(TWO, cells, "")).expect("readable").labels;
    assert_eq!(labels(""), [0]);
    assert_eq!(labels("other: 1 2"), [0]);
    for name in ["patch", "PatchId", "gmsh:physical", "CellEntityIds", "ModelFaceID"] {
        assert_eq!(labels(&format!("{name}: 1 2")), [2], "{name}");
    }
    assert_eq!(labels("ModelFaceID: 1 2\npatch: 3 4"), [4]);
}

#[test]
fn fields_of_a_vtu_file_describe_regions_patches_and_caps() {
    // Texts: 'v', nothing, 'in', 'é'; then 'lumen' and 'wall' without a last zero.
    let fields = "patch_names: 118 0 0 105 110 0 195 169 0\nregion_ids: 1 5\nregion_names: 97 98 0 99\n\
        expected_loops: 2 3\nexpected_terminals: 4\ncap_patch: 2 3\ncap_node: 8 9\ncap_center: 1.5 2 3 4 5 6\n\
        cap_normal: 0.0 0 1 0 1 0\ncap_radius: 0.5 0.25";
    let mesh = read("m.vtu", small(TWO, "region: 5 0", fields)).expect("readable");
    assert_eq!(mesh.tet_regions, [5]);
    assert_eq!(mesh.regions, [(1, "ab".into()), (5, "c".into())]);
    assert_eq!(mesh.patches, [(2, "in".into()), (3, "é".into())]);
    assert_eq!((mesh.expected_loops, mesh.expected_terminals), (Some(vec![2, 3]), Some(vec![4])));
    let caps = [
        Cap { patch: 2, node: 8, center: [1.5, 2., 3.], normal: [0., 0., 1.], radius: 0.5 },
        Cap { patch: 3, node: 9, center: [4., 5., 6.], normal: [0., 1., 0.], radius: 0.25 },
    ];
    assert_eq!(mesh.caps, caps);
    for (whole, cut) in [(" 9\n", "\n"), (" 4 5 6", ""), (" 0 1 0\n", "\n"), (" 0.25", "")] {
        let error = read("m.vtu", small(TWO, "", &fields.replace(whole, cut))).expect_err("a short array");
        assert_eq!(error, "arrays of caps differ in length", "{whole}");
    }
    // Both arrays of regions are required, and caps need all of theirs.
    let without = |name: &str| small(TWO, "", &fields.replace(name, "other"));
    assert!(read("m.vtu", without("region_ids")).expect("readable").regions.is_empty());
    assert!(read("m.vtu", without("cap_patch")).expect("readable").caps.is_empty());
    assert_eq!(read("m.vtu", without("cap_node")), Err("FieldData has no array 'cap_node'".into()));
}

#[test]
fn damaged_vtu_files_have_reasons() {
    let [connectivity, offsets, types] = TWO;
    for (cells, labels, reason) in [
        ([connectivity, offsets, "10 12"], "", "cell 1 of type 12 with 3 vertices is not supported"),
        ([connectivity, offsets, "5 10"], "", "cell 0 of type 5 with 4 vertices is not supported"),
        ([connectivity, "3 7", types], "", "cell 0 of type 10 with 3 vertices is not supported"),
        ([connectivity, "4 8", types], "", "cell 1 has a bad offset"),
        ([connectivity, "4 3", types], "", "cell 1 has a bad offset"),
        ([connectivity, "-4 3", types], "", "cell 0 has a bad offset"),
        ([connectivity, "4", types], "", "arrays of cells differ in length"),
        (TWO, "patch: 1", "arrays of cells differ in length"),
        (TWO, "patch: 1 2 3", "arrays of cells differ in length"),
        (TWO, "region: 1", "arrays of cells differ in length"),
        (TWO, "patch: 0.5 1", "array 'patch' of CellData: floating-point numbers instead of integers"),
        ([connectivity, offsets, "ten 5"], "", "array 'types' of Cells: a word is not a number"),
    ] {
        assert_eq!(read("m.vtu", small(cells, labels, "")), Err(reason.into()));
    }
    let sound = small(TWO, "", "");
    for (from, to, reason) in [
        ("<Piece>", "<Piece><Piece/>", "UnstructuredGrid of 2 pieces instead of an unstructured grid of one"),
        ("<Piece>", "", "UnstructuredGrid of 0 pieces instead of an unstructured grid of one"),
        ("'ascii'> 0 0 0", "'octal'> 0 0 0", "array '' of Points: unknown format 'octal'"),
        ("'ascii'> 0 0 0", "'appended' offset='9'> 0 0 0", "array '' of Points: its offset is beyond the file"),
        ("<Points>", "<Places>", "Points has no array ''"),
        ("VTKFile", "VTK", "not an XML file of VTK"),
    ] {
        assert_eq!(read("m.vtu", sound.replace(from, to)), Err(reason.into()), "{from}");
    }
    let lines = read("m.vtu", sound.replace("UnstructuredGrid", "PolyData")).expect_err("lines");
    assert!(lines.starts_with("PolyData of 1 "), "{lines}");
    let cut = "byte 545: syntax error: tag not closed: `>` not found before end of input";
    assert_eq!(read("m.vtu", &sound[..sound.len() - 1]), Err(cut.into()));
    assert_eq!(read("m.vtk", sound), Err("meshes '.vtk' are not supported; use .vtu, .msh or .ele".into()));
}

#[test]
fn a_vtu_file_of_a_network_is_read_completely() {
    assert_eq!(read("m.vtu", vtu(&tube())), Ok(tube()));
}

#[test]
fn gmsh_files_give_the_same_mesh() {
    let mut mesh = cuboid([1, 1, 1]);
    label(&mut mesh, &|_| 1);
    assert_eq!(read("m.msh", msh_4(&mesh, false)), Ok(mesh.clone()));
    assert_eq!(read("m.msh2", msh_4(&mesh, true)), Ok(mesh.clone()));
    mesh.patches = vec![(1, "wall".into())];
    assert_eq!(read("m.msh", msh_2(&mesh)), Ok(mesh));
}

/// MSH 2.2 file of one tetrahedron.
const MSH_2: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 9 \"edge\"\n2 4 \"the wall\"\n3 5 \"blood\"\n\
    $EndPhysicalNames\n$Nodes\n4\n7 0 0 0\n3 1 0 0\n4 0 1 0\n5 0 0 1\n$EndNodes\n$Elements\n5\n1 15 2 8 1 7\n2 1 2 9 1 7 3\n\
    3 2 2 4 1 7 4 3\n4 2 0 7 3 5\n5 4 3 5 1 0 7 3 4 5\n$EndElements\n";

#[test]
fn msh_2_files_have_tags_and_elements_that_are_ignored() {
    let mesh = read("m.msh", MSH_2).expect("readable");
    assert_eq!((mesh.tets, mesh.triangles), (vec![[0, 1, 2, 3]], vec![[0, 2, 1], [0, 1, 3]]));
    assert_eq!((mesh.labels, mesh.patches), (vec![4, 0], vec![(4, "the wall".into())]));
    assert_eq!(mesh.points[1], [1.0, 0.0, 0.0]);
    // A vertex without a node is no index.
    let missing = read("m.msh", MSH_2.replace("7 3 4 5\n$End", "7 3 4 6\n$End")).expect("readable");
    assert_eq!(missing.tets, [[0, 1, 2, u32::MAX]]);
    for (from, to, reason) in [
        ("2.2 0 8", "2.2 1 8", "MSH 2.2 binary is not supported"),
        ("2.2 0 8", "4.0 0 8", "MSH 4.0 is not supported"),
        ("$MeshFormat", "$Format", "no section $MeshFormat"),
        ("2 4 \"the", "2 \"the", "bad line '2 \"the wall\"' of $PhysicalNames"),
        ("3 1 0 0", "7 1 0 0", "section $Nodes: node 7 is listed twice"),
        ("5 0 0 1", "5 0 0", "section $Nodes: the file ends early or has a word that is not a number"),
        ("2 1 2 9 1 7 3", "2 5 2 9 1 7 3", "element '2 5 2 9 1 7 3' is damaged or not supported"),
        ("4 2 0 7 3 5", "4 2 0 7 3", "element '4 2 0 7 3' is damaged or not supported"),
        ("4 2 0 7 3 5", "4 2", "element '4 2' is damaged or not supported"),
    ] {
        assert_eq!(read("m.msh", MSH_2.replace(from, to)), Err(reason.into()), "{to}");
    }
}

/// MSH 4.1 file with entities of all dimensions, several physical groups, and coordinates on curves and surfaces.
const MSH_4: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 4 \"wall\"\n$EndPhysicalNames\n$Entities\n\
    1 1 2 1\n1 0 0 0 1 80\n1 0 0 0 1 1 1 0 2 1 -1\n1 0 0 0 1 1 1 2 4 40 1 1\n2 0 0 0 1 1 1 0 0\n1 0 0 0 1 1 1 1 5 2 1 2\n\
    $EndEntities\n$Nodes\n4 4 3 7\n0 1 0 1\n7\n0 0 0\n1 1 1 1\n3\n1 0 0 0.5\n2 1 1 1\n4\n0 1 0 0.5 0.6\n3 1 0 1\n5\n0 0 1\n\
    $EndNodes\n$Elements\n5 5 1 5\n0 1 15 1\n1 7\n1 1 1 1\n2 7 3\n2 1 2 1\n3 7 4 3\n2 2 2 1\n4 7 3 5\n3 1 4 1\n5 7 3 4 5\n\
    $EndElements\n";

#[test]
fn msh_4_files_have_groups_and_nodes_with_parameters() {
    let mesh = read("m.msh", MSH_4).expect("readable");
    assert_eq!((mesh.tets, mesh.triangles), (vec![[0, 1, 2, 3]], vec![[0, 2, 1], [0, 1, 3]]));
    assert_eq!((mesh.labels, mesh.patches), (vec![4, 0], vec![(4, "wall".into())]));
    assert_eq!(mesh.points, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]);
    let reason = "the file ends early or has a word that is not a number";
    let [nodes, elements] = ["Nodes", "Elements"].map(|name| format!("section ${name}: {reason}"));
    for (from, to, reason) in [
        ("2 2 2 1\n", "2 2 9 1\n", "section $Elements: elements of type 9 are not supported"),
        ("5 7 3 4 5", "5 7 3 4", elements.as_str()),
        ("0 0 1\n$End", "0 0 z\n$End", &nodes),
    ] {
        assert_eq!(read("m.msh", MSH_4.replace(from, to)), Err(reason.into()), "{to}");
    }
}

#[test]
fn notes_of_a_msh_file_describe_regions_and_caps() {
    let notes = r#"$Anastomesh
{"loops": [0, 1], "terminals": [3], "groups": [[2, 5]], "regions": [{"id": 2, "name": "lumen"}, {"name": "x"}],
"caps": [{"patch": 4, "node": 3, "center": [1, 2, 3], "normal": [0, 0, 1], "radius": 0.5}, {}]}
$EndAnastomesh
"#;
    for file in [MSH_2, MSH_4] {
        let mesh = read("m.msh", file.to_owned() + notes).expect("readable");
        assert_eq!((mesh.expected_loops, mesh.expected_terminals), (Some(vec![0, 1]), Some(vec![3])));
        assert_eq!(mesh.regions, [(2, "lumen".into()), (-1, "x".into())]);
        assert_eq!(mesh.tet_regions, [2]);
        assert_eq!(mesh.caps[0], Cap { patch: 4, node: 3, center: [1., 2., 3.], normal: [0., 0., 1.], radius: 0.5 });
        let Cap { patch, node, center, normal, radius } = mesh.caps[1];
        assert_eq!((patch, node), (-1, -1));
        assert!(center.iter().chain(&normal).chain([&radius]).all(|x| x.is_nan()));
        // Without the group, its number is the region.
        let mesh = read("m.msh", file.to_owned() + &notes.replace("[2, 5]", "[2, 6]")).expect("readable");
        assert_eq!(mesh.tet_regions, [5]);
        let error = read("m.msh", file.to_owned() + &notes.replace("\"loops\"", "loops"));
        assert_eq!(error, Err("section $Anastomesh is not JSON".into()));
    }
}

#[test]
fn tetgen_files_count_from_the_first_node() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |files: [&str; 3]| {
        for (extension, text) in ["node", "ele", "face"].into_iter().zip(files) {
            let path = folder.path().join("m").with_extension(extension);
            if text.is_empty() {
                let _ = std::fs::remove_file(path);
            } else {
                std::fs::write(path, text).expect("a file");
            }
        }
        read_mesh(&folder.path().join("m.ele")).map_err(|e| format!("{e:#}"))
    };
    let nodes = "4 3 1 0\n# x y z, and an attribute\n5 0 0 0 9\n6 1 0 0 9\n\n7 0 1 0 9 # the third\n8 0 0 1 9\n";
    let (tets, faces) = ("1 4 1\n1 5 6 7 8 2\n", "2 1\n1 5 7 6 3\n2 5 6 8 -4\n");
    let mesh = of([nodes, tets, faces]).expect("readable");
    assert_eq!(mesh.points, [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]);
    assert_eq!((mesh.tets, mesh.triangles), (vec![[0, 1, 2, 3]], vec![[0, 2, 1], [0, 1, 3]]));
    assert_eq!((mesh.labels, mesh.is_undirected), (vec![3, -4], true));
    let labels = |faces: &str| of([nodes, tets, faces]).expect("readable").labels;
    assert_eq!(labels("1 0\n1 5 7 6 3\n"), [0]);
    assert_eq!(labels("1\n1 5 7 6 3\n"), [0]);
    assert_eq!(labels("1 1\n1 5 7 6\n"), [0]);
    assert_eq!(labels(""), [0; 0]);
    let reason = |nodes: &str, tets: &str, faces: &str| {
        let text = of([nodes, tets, faces]).expect_err("damaged");
        text.rsplit('/').next().unwrap_or_default().to_owned()
    };
    assert_eq!(reason(&nodes.replace("7 0 1", "8 0 1"), tets, faces), "node 2 of the .node file is out of order");
    assert_eq!(reason(&nodes.replace("1 0 9", "1"), tets, faces), "m.node: row 3 is not a row of numbers");
    assert_eq!(reason(nodes, "1 4 1\n1 5 6 7\n", faces), "m.ele: row 1 is not a row of numbers");
    assert_eq!(reason(nodes, tets, "1 1\n1 5 7 f\n"), "m.face: row 1 is not a row of numbers");
    let rows = "m.ele: the number of rows differs from the first line";
    assert_eq!(reason(nodes, "2 4 0\n1 5 6 7 8\n", faces), rows);
    assert_eq!(reason(nodes, "# nothing\n", faces), rows);
    assert_eq!(reason("", tets, faces), "m.node is not readable");
}
