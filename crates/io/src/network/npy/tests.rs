//! Tests of round trips and of inconsistent arrays.

use super::{read, stage};
use crate::network::content::{NetworkArray, NetworkOptions};
use crate::network::format::NetworkFormat;
use crate::network::{read_network, read_network_from};
use crate::npy::{Arrays, write_array};
use anastomesh_skeleton::NodeId;

fn bytes<const N: usize>(rows: &[[f64; N]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_array(&mut bytes, rows).unwrap();
    bytes
}

fn ints<const N: usize>(rows: &[[u32; N]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_array(&mut bytes, rows).unwrap();
    bytes
}

#[test]
fn a_network_comes_back() {
    let swc = b"1 2 0 0 0 1.5 -1\n2 2 0 0 9 1.5 1\n3 2 0 5 14 1.25 2\n4 2 0 -5 14 1 2\n";
    let network = read_network_from(swc, NetworkFormat::Swc, &NetworkOptions::default()).unwrap().skeleton;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("network.npyd");
    let arrays = [NetworkArray::NodeInts("OriginalNode", vec![0, 1, 2, 3])];
    // Twice, to test the replacement of the folder.
    for _ in 0..2 {
        stage(&path, &network, &arrays).unwrap().place().unwrap();
    }
    assert_eq!(read_network(&path, &NetworkOptions::default()).unwrap().skeleton, network);
    let original = Arrays::read::<std::io::Error>(&path, &["original_node"], None).unwrap();
    assert_eq!(original.indices::<1>("original_node", ("nodes.npy", 4)).unwrap(), [[0], [1], [2], [3]]);
}

#[test]
fn radii_stand_at_nodes_at_edges_or_at_their_ends() {
    let (nodes, edges) = (bytes(&[[0.0; 3], [0.0, 0.0, 9.0]]), ints(&[[1, 0]]));
    let files = [("nodes.npy", &*nodes), ("edges.npy", &*edges)];
    let radii_of = |name: &str, radii: &[u8]| {
        let arrays = Arrays::of(&[files[0], files[1], (name, radii)]);
        let skeleton = read(&arrays, &NetworkOptions::default()).unwrap().skeleton;
        (skeleton.nodes[0].radius, skeleton.nodes[1].radius, skeleton.edges[0].radii)
    };
    assert_eq!(radii_of("radii.npy", &bytes(&[[2.0], [3.0]])), (2.0, 3.0, [3.0, 2.0]));
    assert_eq!(radii_of("edge_radii.npy", &bytes(&[[2.5]])), (2.5, 2.5, [2.5, 2.5]));
    assert_eq!(radii_of("edge_radii.npy", &bytes(&[[2.0, 3.0]])), (3.0, 2.0, [2.0, 3.0]));
    let fault = |files: &[(&str, &[u8])]| read(&Arrays::of(files), &NetworkOptions::default()).unwrap_err().to_string();
    assert!(fault(&files).starts_with("the file has no radius array"));
    let short = bytes(&[[2.0]]);
    assert_eq!(
        fault(&[files[0], files[1], ("radii.npy", &short)]),
        "radii.npy: has 1 row, and nodes.npy has 2: give one row for each"
    );
    let roots = ints(&[[1], [2]]);
    let radius = bytes(&[[1.0], [1.0]]);
    let astray = fault(&[files[0], files[1], ("radii.npy", &radius), ("roots.npy", &roots)]);
    assert_eq!(astray, "roots.npy: row 1 refers to 2, but nodes.npy has 2 rows, numbered from 0");
}

#[test]
fn roots_are_inlets() {
    let files = [("nodes.npy", bytes(&[[0.0; 3], [0.0, 0.0, 9.0]])), ("edges.npy", ints(&[[0, 1]]))];
    let (radii, roots) = (bytes(&[[1.0], [1.0]]), ints(&[[1]]));
    let given: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (*name, &**bytes)).collect();
    let arrays = Arrays::of(&[given[0], given[1], ("radii.npy", &radii), ("roots.npy", &roots)]);
    assert_eq!(read(&arrays, &NetworkOptions::default()).unwrap().roots, [NodeId(1)]);
}
