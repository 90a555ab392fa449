//! Tests on real networks of other origin, which are not in the repository: skipped without the shared data.

use crate::common;
use anastomesh::io::{NetworkOptions, read_network};
use anastomesh::network::split;
use anastomesh::network::{Skeleton, clean};
use anastomesh::skeleton::CleanReport;
use anastomesh::testing::NetworkInfo;
use std::path::Path;

fn read(path: &Path, radius_array: Option<&str>) -> (Skeleton, CleanReport) {
    let options = NetworkOptions::default().radius_array(radius_array.map(str::to_owned));
    let network = read_network(path, &options).unwrap_or_else(|e| panic!("{e}"));
    clean(&network.skeleton).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn every_network_is_read_cleaned_and_split() {
    let Some(data) = common::shared().map(|shared| shared.join("data")) else { return };
    let mut count = 0;
    for folder in ["kidney", "skeletons"] {
        let entries = std::fs::read_dir(data.join(folder)).expect("a folder of networks");
        for path in entries.map(|e| e.expect("an entry").path()) {
            if matches!(path.extension().and_then(|e| e.to_str()), Some("swc" | "vtp")) {
                let (skeleton, _) = read(&path, None);
                assert_eq!(skeleton.check(), Ok(()), "{}", path.display());
                let (after, report) = split(&skeleton);
                assert_eq!(after.check(), Ok(()), "{}", path.display());
                let adjacency = after.adjacency();
                assert!(after.node_ids().all(|n| adjacency.valence(n) <= 3), "{}", path.display());
                let shortest = report.nodes.iter().map(|s| s.shortest_link).fold(f64::INFINITY, f64::min);
                eprintln!("{}: {} nodes split, shortest link {shortest:.3} r", path.display(), report.nodes.len());
                count += 1;
            }
        }
    }
    assert_eq!(count, 18);
}

/// The data's README counts edge pairs without common nodes by the closest points of the axes. Our counts include the
/// taper and are equal or slightly higher.
#[test]
fn overlaps_are_those_that_are_known() {
    let Some(data) = common::shared().map(|shared| shared.join("data")) else { return };
    let info = |file: &str, radius: Option<&str>| {
        let (skeleton, cleaned) = read(&data.join(file), radius);
        NetworkInfo::new(&skeleton, cleaned, Vec::new())
    };
    let counts = |i: &NetworkInfo| (i.overlaps.unconnected.len(), i.overlaps.far);
    assert_eq!(counts(&info("kidney/subtree_289_clear.vtp", None)).0, 0);
    assert_eq!(counts(&info("kidney/subtree_989.vtp", None)).0, 34);
    assert_eq!(counts(&info("kidney/tree_refined.vtp", None)).0, 1948);
    assert_eq!(counts(&info("skeletons/vascularmd_ICA.swc", None)), (85, 26));
    // Traced on a grid: some hundred pairs touch exactly, one of them at an inner point of its taper.
    let brava = counts(&info("skeletons/brava_BG001.swc", None));
    assert!((408..=411).contains(&brava.0) && brava.1 == 71, "{brava:?}");
    assert_eq!(counts(&info("skeletons/opencco_tree3D_synth.vtp", Some("Radius"))), (170, 4));
    let secomb = info("skeletons/secomb_mesentery_546.vtp", Some("Radius"));
    assert_eq!((counts(&secomb).0, secomb.loops, secomb.cleaned.repeated.len()), (32, 158, 1));
    let crossings = secomb.overlaps.pairs.iter().filter(|o| !o.shares_node() && o.distance < 1e-3 * o.radii);
    assert_eq!(crossings.count(), 22);
}

/// File, then nodes, edges, components and loops after cleaning. Counted independently, with Python readers of VTK, XML
/// and CSV (benches/README.md).
const COUNTS: [(&str, [usize; 4]); 8] = [
    ("skeletons/hipct_test.am", [19778, 19777, 1, 0]),
    ("skeletons/brain_arteries_metres.vtk", [12709, 12708, 1, 0]),
    ("skeletons/kidney_main_artery.vtk", [22, 21, 1, 0]),
    ("skeletons/vascpy_diameter_named_radius.vtk", [912, 897, 15, 0]),
    ("skeletons/vesselvio_vertices.csv", [3197, 3249, 1, 53]),
    ("measured/opencco_fig6_2D.xml", [1990, 1989, 1, 0]),
    ("measured/sv1d_left_coronary.in", [92, 91, 1, 0]),
    ("measured/vascpy_one_loop.vtk", [162, 160, 3, 1]),
];

#[test]
fn networks_of_other_formats_have_their_counts() {
    let Some(data) = common::shared().map(|shared| shared.join("data")) else { return };
    for (file, counts) in COUNTS {
        let (skeleton, cleaned) = read(&data.join(file), None);
        let info = NetworkInfo::new(&skeleton, cleaned, Vec::new());
        assert_eq!([info.nodes, info.edges, info.components, info.loops], counts, "{file}");
    }
    // Each table finds the other.
    let tables = ["vertices", "edges"].map(|t| read(&data.join(format!("skeletons/vesselvio_{t}.csv")), None).0);
    assert_eq!(tables[0], tables[1]);
}
