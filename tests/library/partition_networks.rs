//! Partitions of real networks. The data is not in the repository; without it these tests print a note and pass.

use crate::common;
use std::path::Path;

use anastomesh::io::{NetworkOptions, read_network};
use anastomesh::network::clean;
use anastomesh::testing::{PartitionParams, PartitionSummary, check_partition, partition};

fn cut_up(path: &Path) -> Option<PartitionSummary> {
    let file = read_network(path, &NetworkOptions::default()).ok()?;
    let (skeleton, _) = clean(&file.skeleton).ok()?;
    let partition = partition(&skeleton, &PartitionParams::default()).expect("a cleaned skeleton can be partitioned");
    assert_eq!(check_partition(&skeleton, &partition), Ok(()), "{}", path.display());
    let summary = partition.summary();
    println!("{}: {summary:?}", path.display());
    Some(summary)
}

#[test]
fn the_fixture_is_cut() {
    let summary = cut_up(&common::fixture("tree_30.swc")).expect("the fixture is a network");
    assert!(summary.clusters > 3, "{summary:?}");
}

#[test]
fn blocks_are_blocks() {
    let Some(shared) = common::shared() else { return };
    for (name, least) in [("subtree_59", 24), ("subtree_289_clear", 120), ("subtree_989", 380), ("subtree_9947", 3900)]
    {
        let path = shared.join("data/kidney").join(name).with_extension("vtp");
        let summary = cut_up(&path).expect("a kidney subtree can be read");
        assert!(summary.clusters >= least && summary.junction_clusters * 100 >= least * 98, "{name}: {summary:?}");
        assert!(summary.largest_nodes <= 20, "{name}: {summary:?}");
    }
}

#[test]
fn every_network_can_be_partitioned() {
    let Some(shared) = common::shared() else { return };
    let mut count = 0;
    for folder in ["data/kidney", "data/skeletons"] {
        let Ok(entries) = std::fs::read_dir(shared.join(folder)) else { continue };
        let mut paths: Vec<_> = entries.flatten().map(|e| e.path()).collect();
        paths.sort();
        count += paths.iter().filter_map(|p| cut_up(p)).count();
    }
    assert!(count > 10);
}
