//! Tests of one network in every format, of error messages, and of damaged files.

use super::graph::{GraphFault, GraphPlace};
use super::*;
use crate::damage::damage;
use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::{Edge, NodeId, Skeleton, clean};
use proptest::prelude::*;

macro_rules! fixtures {
    ($($name:ident = $file:literal, $format:ident;)*) => {
        $(const $name: &[u8] = include_bytes!(concat!("../../../../fixtures/networks/", $file));)*
        const ALL: &[(&str, &[u8], NetworkFormat)] = &[$(($file, $name, NetworkFormat::$format)),*];
    };
}

fixtures! {
    VTK_2 = "fork_2.vtk", Vtk;
    VTK_51 = "fork_51.vtk", Vtk;
    AMIRA = "fork.am", Amira;
    CSV = "fork.csv", Csv;
    GRAPHML = "fork.graphml", GraphXml;
    GXL = "fork.gxl", GraphXml;
    PAJEK = "fork.net", Pajek;
    NETWORKX = "fork_networkx.net", Pajek;
    GRID = "fork.vtu", Vtu;
    VMV = "fork.vmv", Vmv;
    JSON = "fork.json", Json;
    VESSELS = "fork_vessels.json", Json;
    SV1D = "fork.in", Sv1d;
}

fn read(bytes: &[u8], format: NetworkFormat) -> Result<NetworkFile, String> {
    read_network_from(bytes, format, &NetworkOptions::default()).map_err(|e| e.to_string())
}

/// Positions and radii of the ends of each edge, in units of a millionth, sorted.
fn vessels(skeleton: &Skeleton) -> Vec<[[i64; 4]; 2]> {
    let end = |edge: &Edge, k: usize| {
        let p = skeleton.node(edge.nodes[k]).position;
        [p.x, p.y, p.z, edge.radii[k]].map(|v| (v * 1e6).round() as i64)
    };
    let mut vessels: Vec<_> = skeleton.edges.iter().map(|e| [end(e, 0), end(e, 1)]).collect();
    vessels.sort_unstable();
    vessels
}

#[test]
fn the_same_network_in_every_format() {
    const M: i64 = 1_000_000;
    let [a, b, c, d] = [[0, 0, 0, 2 * M], [0, 0, 10 * M, 2 * M], [0, 5 * M, 20 * M, 1_500_000], [0, -5 * M, 20 * M, M]];
    for (name, bytes, format) in ALL {
        let file = read(bytes, *format).unwrap_or_else(|e| panic!("{name}: {e}"));
        // Amira's edges contain both their ends, so one point occurs twice until the network is cleaned.
        let (skeleton, _) = clean(&file.skeleton).unwrap();
        assert_eq!(vessels(&skeleton), [[a, b], [b, d], [b, c]], "{name}");
        assert_eq!(skeleton.nodes.len(), 4, "{name}");
    }
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/networks/");
    let tetgen = read_network((folder.to_owned() + "fork.edge").as_ref(), &NetworkOptions::default()).unwrap();
    assert_eq!((vessels(&tetgen.skeleton), tetgen.names.find("3", 4)), (vec![[a, b], [b, d], [b, c]], Some(NodeId(2))));
    for table in ["fork_nodes.csv", "fork_edges.csv"] {
        let file = read_network((folder.to_owned() + table).as_ref(), &NetworkOptions::default()).unwrap();
        assert_eq!(vessels(&file.skeleton), [[a, b], [b, d], [b, c]]);
        assert_eq!(file.notes[0], NetworkNote::EdgesFrom { file: "fork_edges.csv".into() });
        assert_eq!(file.names.find("12", 4), Some(NodeId(2)));
    }
}

#[test]
fn lengths_are_multiplied_as_asked() {
    let options =
        NetworkOptions { scale: Some(10.0), radius_scale: Some(2.0), diameters: true, ..NetworkOptions::default() };
    for (name, bytes, format) in ALL {
        let network = read_network_from(bytes, *format, &options).unwrap();
        // The binary fork has diameters by name, which are not halved twice.
        let thickest = network.skeleton.edges.iter().flat_map(|e| e.radii).fold(0.0, f64::max);
        let expected = if *name == "fork_51.vtk" { 40.0 } else { 20.0 };
        assert!((thickest - expected).abs() < 1e-9, "{name}: {thickest}");
        let highest = network.skeleton.nodes.iter().map(|n| n.position.z).fold(0.0, f64::max);
        assert!((highest - 200.0).abs() < 1e-9, "{name}");
        let told = |n: &NetworkNote| *n == NetworkNote::Scaled { positions: 10.0, radii: 20.0 };
        assert!(network.notes.iter().any(told) && network.notes.contains(&NetworkNote::Diameters), "{name}");
    }
}

#[test]
fn radii_in_another_unit_are_named() {
    let options = NetworkOptions { radius_scale: Some(1000.0), ..NetworkOptions::default() };
    let network = read_network_from(JSON, NetworkFormat::Json, &options).unwrap();
    assert!(network.notes.iter().any(|n| matches!(n, NetworkNote::OutOfProportion { .. })));
    assert!(
        !read(JSON, NetworkFormat::Json)
            .unwrap()
            .notes
            .iter()
            .any(|n| matches!(n, NetworkNote::OutOfProportion { .. }))
    );
}

/// Error message of a format after a replacement in its fixture.
fn fault(bytes: &[u8], format: NetworkFormat, from: &str, to: &str) -> String {
    let text = String::from_utf8_lossy(bytes);
    assert!(text.contains(from), "{from}");
    match read(text.replacen(from, to, 1).as_bytes(), format) {
        Ok(_) => panic!("{from} → {to} is read"),
        Err(message) => message,
    }
}

/// Asserts that the message of [`fault`] contains a text.
fn says(bytes: &[u8], format: NetworkFormat, from: &str, to: &str, what: &str) {
    let message = fault(bytes, format, from, to);
    assert!(message.contains(what), "{message}");
}

#[test]
fn numbers_of_nodes_come_from_every_format_that_has_them() {
    for (name, bytes, format) in ALL {
        let asked = |array: &str| {
            let options = NetworkOptions { node_array: Some(array.into()), ..NetworkOptions::default() };
            read_network_from(bytes, *format, &options).map_err(|e| e.to_string())
        };
        if matches!(format, NetworkFormat::Amira | NetworkFormat::Sv1d) {
            assert!(asked("radius").unwrap_err().contains("has no named node arrays"), "{name}");
            continue;
        }
        let said = asked("nothing of the kind").unwrap_err();
        assert!(said.contains("'nothing of the kind'") && said.contains("; node arrays: "), "{name}: {said}");
        let there = said.rsplit(": ").next().unwrap_or_default().split(", ").filter(|name| *name != "none");
        // Vectors and words are not accepted; a format may have numbers on edges only.
        let files: Vec<NetworkFile> = there.clone().filter_map(|name| asked(name).ok()).collect();
        assert_eq!(files.is_empty(), there.count() == 0, "{name}");
        for file in files {
            assert_eq!(file.node_values.len(), file.skeleton.nodes.len(), "{name}");
        }
    }
}

#[test]
fn tables_say_where() {
    let says = |from: &str, to: &str, what: &str| says(CSV, NetworkFormat::Csv, from, to, what);
    says("0,0,10,2", "0,0,ten,2", "line 3: z is 'ten'");
    says("0,0,10,2", "0,0,10", "line 3, table of nodes: 3 columns where the first row has 4");
    says("0,0,10,2", "0,,10,2", "line 3: node '1' has no y");
    says("0,0,10,2", "0,0,10,two", "line 3: radius is 'two'");
    says("1,3", "1,4", "line 10: an edge ends at the unknown node '4'");
    says("1,3", "1,3,3", "line 10, table of edges: 3 columns where the first row has 2");
    says("source,target", "one,two", "no columns for the ends of edges");
    says("x,y,z,radius", "a,b,c,radius", "coordinates");
    says("radius", "size", "choose one of: ");
    says("\n\n", "\n", "only one table");
}

#[test]
fn graphs_say_where() {
    let xml = NetworkFormat::GraphXml;
    says(GRAPHML, xml, "target=\"n3\"", "target=\"n9\"", "the unknown node 'n9'");
    says(GRAPHML, xml, "target=\"n3\"", "aim=\"n3\"", "<edge> has no attribute 'to'");
    says(GRAPHML, xml, "<node id=\"n1\"", "<node id=\"n0\"", "duplicate node 'n0', first defined at byte");
    says(GRAPHML, xml, "<graphml", "<graph", "<graph>, not <graphml> or <gxl>");
    says(GRAPHML, xml, "</node>", "</knot>", "invalid XML at byte");
    says(GRAPHML, xml, "</graphml>", "", "the file ends inside <graphml>");
    says(GXL, xml, "<float>10</float>", "<float>ten</float>", "node 'n1' has no position");
    says(
        GXL,
        xml,
        "<attr name=\" radius\"><float>2</float>",
        "<attr name=\" radius\"><float>wide</float>",
        "is 'wide'",
    );
    says(b"<svg></svg>", xml, "svg></svg>", "svg/>", "<svg>, not <graphml> or <gxl>");
    says(PAJEK, NetworkFormat::Pajek, "2 3 4", "2 3 5", "line 10: an edge ends at the unknown node '5'");
    says(PAJEK, NetworkFormat::Pajek, "2 3 4", "2", "line 10: an edge needs");
    says(PAJEK, NetworkFormat::Pajek, "*Edgeslist", "*Matrix", "line 9: the section '*matrix'");
    says(PAJEK, NetworkFormat::Pajek, "*Vertices 4", "Vertices 4", "*Vertices");
    says(PAJEK, NetworkFormat::Pajek, "0 0 10 ellipse", "0 ellipse", "line 4: node '2' has no y");
    says(
        JSON,
        NetworkFormat::Json,
        "\"target\": 3",
        "\"target\": 7",
        "edge 2 of the list (from 0): an edge ends at the unknown node '7'",
    );
    says(JSON, NetworkFormat::Json, "\"target\": 3", "\"target\": null", "edge 2 of the list (from 0): 'target'");
    says(JSON, NetworkFormat::Json, "\"nodes\"", "\"knots\"", "no list 'nodes'");
    says(JSON, NetworkFormat::Json, "]", "", "line");
}

#[test]
fn faults_are_typed() {
    let repeated = read_network_from(
        &String::from_utf8_lossy(PAJEK).replacen("\n2 \"", "\n1 \"", 1).into_bytes(),
        NetworkFormat::Pajek,
        &NetworkOptions::default(),
    );
    let at = GraphPlace::Line;
    let expected = GraphFault::RepeatedNode { place: at(4), name: "1".into(), first: at(3) };
    assert!(matches!(repeated, Err(error::NetworkFault::Pajek(pajek::PajekError::Graph(fault))) if fault == expected));
}

#[test]
fn amira_and_the_solver_say_where() {
    let amira = |from: &str, to: &str, what: &str| says(AMIRA, NetworkFormat::Amira, from, to, what);
    amira("# AmiraMesh", "# Mesh", "first line");
    amira("ASCII", "BINARY-LITTLE-ENDIAN", "ASCII");
    amira("define VERTEX 4", "define VERTEX 99999999999", "line 4: a number of vertices");
    amira("define VERTEX 4", "define VERTEX 5", "line 26: expected ");
    amira("1 3\n", "1 4\n", "edge 1 (from 0) refers to vertex 4");
    amira("@3\n3\n", "@3\n4\n", "edges have 6 points in total, but the file has 5");
    amira("@3\n3\n", "@3\n1\n", "edges have 3 points in total, but the file has 5");
    amira("\n@5\n", "\n@6\n", "'@6' have no declaration");
    amira("thickness", "colour", "choose one of: ");
    amira("EDGE { int[2] EdgeConnectivity } @2", "EDGE { int[2] EdgeConnectivity @2", "line 14");
    let solver = |from: &str, to: &str, what: &str| says(SV1D, NetworkFormat::Sv1d, from, to, what);
    solver("NODE 3 0", "NODE 3 zero", "line 6: expected coordinate x, found 'zero'");
    solver("NODE 3", "NODE 2", "line 6: duplicate node '2'");
    solver("OUT0 2 1 2", "OUT0 2 1 7", "line 9: unknown segment '7'");
    solver("OUT0 2 1 2", "OUT0 99999999 1 2", "line 9");
    solver("JOINTOUTLET OUT0", "JOINTOUTLET OUT1", "line 7");
    solver("25 1 2", "25 1 9", "node '9'");
    solver("SEGMENT s0 0 10.0 25 0 1 12", "SEGMENT s0 0 10.0 25 0 1 -12", "line 10: the area -12");
}

#[test]
fn files_that_are_cut_end_in_an_error_or_are_sound() {
    for (name, bytes, format) in ALL {
        for cut in 0..bytes.len() {
            if let Ok(network) = read(&bytes[..cut], *format) {
                let ends = network.skeleton.edges.iter().flat_map(|e| e.nodes);
                assert!(ends.into_iter().all(|n| n.index() < network.skeleton.nodes.len()), "{name} cut at {cut}");
            }
        }
    }
}

proptest! {
    #[test]
    fn damaged_networks_never_panic(damage in damage()) {
        for (_, bytes, format) in ALL {
            if let Ok(network) = read(&damage.done_to(bytes), *format)
                && let Ok((cleaned, _)) = clean(&network.skeleton)
            {
                prop_assert_eq!(cleaned.check(), Ok(()));
            }
        }
    }
}

#[test]
fn other_cells_of_a_grid_are_counted() {
    let grid = String::from_utf8(GRID.to_vec()).unwrap();
    let file = read(GRID, NetworkFormat::Vtu).unwrap();
    assert!(file.notes.contains(&NetworkNote::OtherCells { count: 1 }), "{:?}", file.notes);
    let without = grid.replace(">1 4 3<", ">1 7 9<");
    assert!(read(without.as_bytes(), NetworkFormat::Vtu).unwrap_err().contains("no lines"));
    let short = grid.replace(">1 4 3<", ">1 4<");
    assert!(read(short.as_bytes(), NetworkFormat::Vtu).unwrap_err().contains("'types' has 2 values, expected 3"));
}

#[test]
fn a_file_without_radii_gets_the_given_one() {
    let bare = String::from_utf8(NETWORKX.to_vec()).unwrap().replace(" r ", " label ");
    let refused = read(bare.as_bytes(), NetworkFormat::Pajek).unwrap_err();
    assert!(refused.contains("radius"), "{refused}");
    let options = NetworkOptions::default().radius(2.5).scale(2.0);
    let file = read_network_from(bare.as_bytes(), NetworkFormat::Pajek, &options).unwrap();
    assert!(file.notes.contains(&NetworkNote::NoRadii));
    assert!(
        file.skeleton.nodes.iter().all(|n| n.radius == 5.0) && file.skeleton.edges.iter().all(|e| e.radii == [5.0; 2])
    );
    // Radii in the file have priority.
    let file = read_network_from(NETWORKX, NetworkFormat::Pajek, &options).unwrap();
    assert_eq!(file.skeleton.nodes[0].radius, 4.0);
}

#[test]
fn vessels_that_end_beside_their_vertex_are_joined_to_it() {
    let text = String::from_utf8_lossy(VESSELS).replace("[[0, 0, 10], [0, 5, 20]]", "[[0, 1, 11], [0, 5, 20]]");
    let network = read(text.as_bytes(), NetworkFormat::Json).unwrap();
    let (joined, vertex) = (network.names.find("point 0 of vessel 1", 5).unwrap(), network.names.find("7", 5).unwrap());
    let edge = network.skeleton.edges.iter().find(|edge| edge.nodes == [vertex, joined]).unwrap();
    assert_eq!((network.skeleton.edges.len(), edge.radii), (4, [2.0; 2]));
    assert_eq!(network.skeleton.node(vertex).position, Point3::new(0.0, 0.0, 10.0));
}

#[test]
fn faults_in_lists_of_vessels_are_named() {
    let says = |from: &str, to: &str, expected: &str| says(VESSELS, NetworkFormat::Json, from, to, expected);
    says("\"id\": 8", "\"id\": 9", "two vertices have the id 9");
    says("\"right_vertex_id\": 8", "\"right_vertex_id\": 3", "vessel 1 ends at vertex 3");
    says("[[0, 0, 10], [0, 5, 20]]", "[[0, 0, 10]]", "vessel 1 has 1 point in");
    says("[2.0, 1.5]", "[2.0]", "vessel 1 has 2 points, and the list 'radii' has length 1");
    says("[2.0, 1.5]", "[2.0, \"x\"]", "entry 1 of the list 'vessels'");
}
