use super::error::NetworkFault;
use super::radii::RadiusFault;
use super::swc::SwcError;
use super::vtp;
use super::vtp::VtpError;
use super::*;
use crate::file::FileError;
use crate::vtk_xml::VtkError;
use anastomesh_skeleton::LineGroup;
use proptest::prelude::*;

const TREE_VTP: &[u8] = include_bytes!("../../../../fixtures/tree_30.vtp");
const TREE_SWC: &[u8] = include_bytes!("../../../../fixtures/tree_30.swc");

fn read(bytes: &[u8], format: NetworkFormat) -> Result<NetworkFile, NetworkFault> {
    read_network_from(bytes, format, &NetworkOptions::default())
}

fn swc(text: &str) -> Result<NetworkFile, SwcError> {
    match read(text.as_bytes(), NetworkFormat::Swc) {
        Ok(network) => Ok(network),
        Err(NetworkFault::Swc(fault)) => Err(fault),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn the_fixture_is_the_same_in_both_formats() {
    let a = read(TREE_VTP, NetworkFormat::Vtp).unwrap().skeleton;
    let b = read(TREE_SWC, NetworkFormat::Swc).unwrap().skeleton;
    assert_eq!(a, b);
    assert_eq!((a.nodes.len(), a.edges.len()), (30, 29));
    let (clean, report) = anastomesh_skeleton::clean(&a).unwrap();
    assert_eq!(clean, a);
    assert!(report.is_empty());
    // Vessels do not overlap, and Murray's law holds at each junction.
    let adjacency = a.adjacency();
    let overlaps = a.overlaps(&adjacency);
    assert!(overlaps.pairs.is_empty() && overlaps.unconnected.is_empty());
    for node in a.node_ids().filter(|&n| adjacency.valence(n) == 3) {
        let cubes: f64 = adjacency.edges(node)[1..].iter().map(|&e| a.edge(e).radii[1].powi(3)).sum();
        assert!((cubes - a.node(node).radius.powi(3)).abs() < 1e-6);
    }
}

#[test]
fn swc_with_every_liberty() {
    let text = "# comment\r\n\r\n 7 3 1 0 0 0.5 0 extra columns # and a comment\r\n0 1 0 0 0 1e0 -1\r\n9 3 5 5 5 1 -1\r\n\
                8.0 3 6 5 5 1 9\r\n";
    let s = swc(text).unwrap().skeleton;
    assert_eq!(s.nodes.len(), 4);
    assert_eq!(s.edges.len(), 2);
    assert_eq!(s.edges[0].nodes.map(|n| n.0), [1, 0]);
    assert_eq!(s.edges[0].radii, [1.0, 0.5]);
    assert_eq!(s.components(&s.adjacency()).list.len(), 2);
    // Lines that end with a carriage return only, a byte order mark, and a comment that is not UTF-8.
    let old = b"\xef\xbb\xbf# 5 \xb5m\r1 1 0 0 0 1 -1\r2 1 1 0 0 1 1\r";
    assert_eq!(read(old, NetworkFormat::Swc).unwrap().skeleton.edges.len(), 1);
}

#[test]
fn swc_errors_name_line_and_id() {
    let error = |row: &str| swc(&format!("# c\n1 1 0 0 0 1 -1\n{row}\n")).unwrap_err();
    assert_eq!(error("2 3 1 0 0 1"), SwcError::TooFewColumns { line: 3, found: 6 });
    assert_eq!(error("2 3 1 0 x 1 1"), SwcError::NotANumber { line: 3, column: "z", text: "x".into() });
    assert_eq!(error("2.5 3 1 0 0 1 1"), SwcError::NotANumber { line: 3, column: "id", text: "2.5".into() });
    assert!(matches!(error("2 3 nan 0 0 1 1"), SwcError::BadCoordinate { line: 3, id: 2, column: "x", .. }));
    assert!(matches!(error("2 3 1 -inf 0 1 1"), SwcError::BadCoordinate { line: 3, id: 2, column: "y", .. }));
    assert_eq!(error("2 3 1 0 0 0 1"), SwcError::BadRadius { line: 3, id: 2, radius: 0.0 });
    assert_eq!(error("2 3 1 0 0 -4 1"), SwcError::BadRadius { line: 3, id: 2, radius: -4.0 });
    assert!(matches!(error("2 3 1 0 0 NaN 1"), SwcError::BadRadius { line: 3, .. }));
    assert_eq!(error("1 3 1 0 0 1 1"), SwcError::RepeatedId { line: 3, id: 1, first: 2 });
    assert_eq!(error("2 3 1 0 0 1 2"), SwcError::SelfParent { line: 3, id: 2 });
    assert_eq!(error("2 3 1 0 0 1 5"), SwcError::UnknownParent { line: 3, id: 2, parent: 5 });
    assert_eq!(swc("# only a comment").unwrap_err(), SwcError::NoNodes);
    assert!(matches!(swc("Dear Sir or Madam").unwrap_err(), SwcError::TooFewColumns { line: 1, found: 4 }));
}

/// Parts of a small VTP file: three points on one polyline after one vertex cell.
struct Vtp<'a> {
    points: &'a str,
    point_data: &'a str,
    cell_data: &'a str,
    connectivity: &'a str,
    offsets: &'a str,
    kind: &'a str,
}

const SMALL: Vtp = Vtp {
    points: "0 0 0 4 0 0 9 0 0",
    point_data: "<DataArray type=\"Float64\" Name=\"Radius\" format=\"ascii\">1 2 3</DataArray>",
    cell_data: "",
    connectivity: "0 1 2",
    offsets: "3",
    kind: "Int64",
};

impl Vtp<'_> {
    fn text(&self) -> String {
        let Self { points, point_data, cell_data, connectivity, offsets, kind } = self;
        format!(
            "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfVerts=\"1\" NumberOfLines=\"1\">\
             <PointData>{point_data}</PointData><CellData>{cell_data}</CellData>\
             <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">{points}</DataArray></Points>\
             <Lines><DataArray type=\"{kind}\" Name=\"connectivity\" format=\"ascii\">{connectivity}</DataArray>\
             <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{offsets}</DataArray></Lines>\
             </Piece></PolyData></VTKFile>"
        )
    }

    fn read(&self, array: Option<&str>) -> Result<NetworkFile, VtpError> {
        vtp::read(
            self.text().as_bytes(),
            &NetworkOptions { radius_array: array.map(str::to_owned), ..NetworkOptions::default() },
        )
    }
}

#[test]
fn an_array_of_nodes_is_kept_when_it_is_asked_for() {
    let data = "<DataArray type=\"Float64\" Name=\"Radius\" format=\"ascii\">1 2 3</DataArray>\
                <DataArray type=\"Float32\" Name=\"Size\" format=\"ascii\">0.5 1 4</DataArray>\
                <DataArray type=\"Float32\" Name=\"Way\" NumberOfComponents=\"2\" format=\"ascii\">1 2 3 4 5 6</DataArray>\
                <DataArray type=\"Float32\" Name=\"Short\" format=\"ascii\">1 2</DataArray>";
    let read = |array: Option<&str>| {
        let options = NetworkOptions { node_array: array.map(str::to_owned), ..NetworkOptions::default() };
        vtp::read(Vtp { point_data: data, ..SMALL }.text().as_bytes(), &options)
    };
    assert_eq!(read(Some("Size")).unwrap().node_values, [0.5, 1.0, 4.0]);
    assert!(read(None).unwrap().node_values.is_empty());
    let said = |array| read(Some(array)).unwrap_err().to_string();
    assert!(
        said("Length").contains("no node array 'Length'; node arrays: Radius, Size, Way, Short"),
        "{}",
        said("Length")
    );
    assert!(said("Way").contains("has 2 components"), "{}", said("Way"));
    assert!(matches!(read(Some("Short")).unwrap_err(), VtpError::WrongLength { expected: 3, found: 2, .. }));
}

#[test]
fn radii_on_points_lines_or_both() {
    let points = SMALL.read(None).unwrap();
    assert_eq!(points.skeleton.edges[1].radii, [2.0, 3.0]);
    assert_eq!(points.notes[0], NetworkNote::NodeRadii { array: "Radius".into() });

    // The first value belongs to the vertex cell.
    let cells = "<DataArray type=\"Float32\" Name=\"Edge_Diameter\" format=\"ascii\">77 5</DataArray>";
    let both = Vtp { cell_data: cells, ..SMALL }.read(None).unwrap();
    assert_eq!(both.skeleton.edges[1].radii, [2.5, 2.5]);
    assert!((both.skeleton.nodes[2].radius - 3.0).abs() < 1e-15);
    assert!(both.notes.contains(&NetworkNote::Halved { array: "Edge_Diameter".into() }));

    let alone = Vtp { cell_data: cells, point_data: "", ..SMALL }.read(None).unwrap();
    assert!((alone.skeleton.nodes[2].radius - 2.5).abs() < 1e-15);
    assert!(alone.notes.contains(&NetworkNote::NodeRadiiFromEdges));

    let chosen = Vtp { cell_data: cells, ..SMALL }.read(Some("Radius")).unwrap();
    assert_eq!(chosen.skeleton, points.skeleton);
    assert!(matches!(SMALL.read(Some("radii")), Err(VtpError::Radius(RadiusFault::UnknownArray { .. }))));
}

#[test]
fn the_best_name_wins_and_the_others_are_told() {
    let point_data = "<DataArray type=\"Float64\" Name=\"MaximumInscribedSphereRadius\" format=\"ascii\">9 9 9</DataArray>\
                      <DataArray type=\"Float64\" Name=\"Abscissas\" format=\"ascii\">9 9 9</DataArray>\
                      <DataArray type=\"Float64\" Name=\"radius\" format=\"ascii\">1 2 3</DataArray>";
    let network = Vtp { point_data, ..SMALL }.read(None).unwrap();
    assert!((network.skeleton.nodes[1].radius - 2.0).abs() < 1e-15);
    let unused = NetworkNote::NotUsed { arrays: vec!["MaximumInscribedSphereRadius".into()] };
    assert!(network.notes.contains(&unused));
}

#[test]
fn vtp_errors_say_what_is_wrong() {
    let error = |vtp: Vtp| vtp.read(None).unwrap_err();
    assert!(matches!(
        error(Vtp { connectivity: "0 1 3", ..SMALL }),
        VtpError::UnknownPoint { line: 0, point: 3, points: 3 }
    ));
    assert!(matches!(error(Vtp { connectivity: "0 -1 2", ..SMALL }), VtpError::UnknownPoint { point: -1, .. }));
    assert!(matches!(error(Vtp { offsets: "4", ..SMALL }), VtpError::BadOffset { line: 0, offset: 4, length: 3 }));
    assert!(matches!(error(Vtp { offsets: "", ..SMALL }), VtpError::WrongLength { expected: 1, found: 0, .. }));
    assert!(matches!(error(Vtp { points: "0 0 0", ..SMALL }), VtpError::WrongLength { expected: 9, found: 3, .. }));
    assert!(matches!(error(Vtp { points: "0 0 0 a", ..SMALL }), VtpError::File(VtkError::BadNumber { index: 3, .. })));
    assert!(matches!(error(Vtp { kind: "Float64", ..SMALL }), VtpError::NotIntegers { array: "connectivity" }));
    assert!(matches!(error(Vtp { point_data: "", ..SMALL }), VtpError::Radius(RadiusFault::NoRadius { .. })));
    let short = "<DataArray type=\"Float64\" Name=\"Radius\" format=\"ascii\">1 2</DataArray>";
    assert!(matches!(error(Vtp { point_data: short, ..SMALL }), VtpError::WrongLength { expected: 3, found: 2, .. }));
    let surface = SMALL.text().replace("NumberOfLines=\"1\"", "NumberOfPolys=\"1\"");
    let surface = vtp::read(surface.as_bytes(), &NetworkOptions::default());
    assert!(matches!(surface, Err(VtpError::NoLines { polygons: 1, vertices: 1 })));
    let negative = "<DataArray type=\"Float64\" Name=\"Radius\" format=\"ascii\">1 -2 1</DataArray>";
    let negative = Vtp { point_data: negative, ..SMALL }.text();
    let negative = read(negative.as_bytes(), NetworkFormat::Vtp);
    assert!(matches!(negative, Err(NetworkFault::Numbers(_))));
}

#[test]
fn pieces_are_joined() {
    let text = SMALL.text();
    let piece = &text[text.find("<Piece").unwrap()..text.find("</PolyData>").unwrap()];
    let twice = text.replace(piece, &piece.repeat(2));
    let s = vtp::read(twice.as_bytes(), &NetworkOptions::default()).unwrap().skeleton;
    assert_eq!((s.nodes.len(), s.edges.len()), (6, 4));
    assert_eq!(s.edges[3].nodes.map(|n| n.0), [4, 5]);
}

#[test]
fn unreadable_paths_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| read_network(&folder.path().join(name), &NetworkOptions::default()).unwrap_err();
    std::fs::write(folder.path().join("empty.swc"), "\n").unwrap();
    std::fs::create_dir(folder.path().join("folder.vtp")).unwrap();
    assert!(matches!(at("missing.vtp"), NetworkFileError::File(FileError::Read { .. })));
    assert!(matches!(at("empty.swc"), NetworkFileError::File(FileError::Empty { .. })));
    assert!(matches!(at("folder.vtp"), NetworkFileError::Directory { .. }));
    assert!(matches!(at("network.docx"), NetworkFileError::File(FileError::UnknownFormat { .. })));
}

fn damaged(bytes: &[u8], damage: &[(prop::sample::Index, u8)], cut: Option<prop::sample::Index>) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for (at, value) in damage {
        let at = at.index(bytes.len());
        bytes[at] = *value;
    }
    if let Some(cut) = cut {
        bytes.truncate(cut.index(bytes.len()));
    }
    bytes
}

proptest! {
    #[test]
    fn damaged_networks_never_panic(
        damage in prop::collection::vec((any::<prop::sample::Index>(), prop_oneof![any::<u8>(), 32..127_u8]), 0..8),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        for (bytes, format) in [(TREE_VTP, NetworkFormat::Vtp), (TREE_SWC, NetworkFormat::Swc)] {
            if let Ok(network) = read(&damaged(bytes, &damage, cut), format)
                && let Ok((clean, _)) = anastomesh_skeleton::clean(&network.skeleton)
            {
                prop_assert_eq!(clean.check(), Ok(()));
            }
        }
    }
}

#[test]
fn lines_say_which_vessel_they_are_drawn_for() {
    let array = |name: &str, values: &str| {
        format!("<DataArray type=\"Int32\" Name=\"{name}\" format=\"ascii\">{values}</DataArray>")
    };
    let read = |cell_data: &str| Vtp { cell_data, ..SMALL }.read(None);
    let both = array("GroupIds", "9 4") + &array("Blanking", "0 0");
    let network = read(&both).unwrap();
    // The first cell is a vertex.
    assert_eq!(network.groups, vec![Some(LineGroup { group: 4, blanked: false }); 3]);
    assert!(network.notes.contains(&NetworkNote::Grouped { vessels: 1 }));
    let inside = read(&(array("GroupIds", "9 4") + &array("Blanking", "0 1"))).unwrap();
    assert!(inside.groups.iter().flatten().all(|g| g.blanked));
    assert!(!inside.notes.iter().any(|n| matches!(n, NetworkNote::Grouped { .. })));
    assert!(read(&array("GroupIds", "9 4")).unwrap().groups.is_empty());
    assert!(matches!(
        read(&(array("GroupIds", "9 4 4") + &array("Blanking", "0 0"))),
        Err(VtpError::WrongLength { expected: 2, found: 3, .. })
    ));
}
