//! Recorded partitions: a change of any rule shows in their text, in `snapshots/`. The other tests say what is right; these say what
//! has changed.

use std::fmt::Write;
use std::sync::Arc;

use super::tests::{acute, h_shape, polyline, skeleton, wiggly};
use super::*;
use anastomesh_io::{NetworkOptions, read_network};
use anastomesh_mesh::geometry::Tube;
use anastomesh_network::{PrepareParams, prepare};
use anastomesh_skeleton::{NodeSizes, SizeAt};

fn fixture(name: &str) -> Skeleton {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name);
    let given = read_network(&path, &NetworkOptions::default().any_radii(true)).expect("a fixture").skeleton;
    prepare(&given, &[], &PrepareParams::default()).expect("vessels").skeleton
}

/// Text of a partition. Lengths have four decimals.
fn text(layout: &Layout) -> String {
    let Partition { clusters, cuts, cut_arcs, pieces, uncut, warnings, .. } = layout.explicit();
    let mut out = String::new();
    for (i, (cut, [from, to])) in cuts.iter().zip(&cut_arcs).enumerate() {
        let Cut { branch, path, size, .. } = cut;
        let along: Vec<String> = path.iter().map(|s| format!("{:.4}", s.radius)).collect();
        writeln!(out, "cut {i} of branch {}: {from:.4} to {to:.4}, radii {along:?}, size {size:.4?}", branch.0)
            .expect("text");
    }
    for (i, cluster) in clusters.iter().enumerate() {
        let nodes: Vec<u32> = cluster.nodes.iter().map(|node| node.0).collect();
        let length: f64 = cluster.tubes.iter().map(Tube::length).sum();
        let (tubes, cells) = (cluster.tubes.len(), cluster.cells.len());
        writeln!(
            out,
            "cluster {i}: nodes {nodes:?}, {tubes} tubes of {length:.4}, {cells} cells, fine {:.4?}, size {:.4?}",
            cluster.fine.iter().map(|place| (place.within, place.factor)).collect::<Vec<_>>(),
            cluster.size
        )
        .expect("text");
        for ClusterEnd { section, kind, overrun } in &cluster.ends {
            let [x, y, z]: [f64; 3] = section.origin.into();
            let beyond = cluster.tubes[*overrun as usize].length();
            let up = section.up.map_or(String::new(), |up| format!(", up {:.4?}", <[f64; 3]>::from(up)));
            writeln!(out, "  {kind:?} at {x:.4} {y:.4} {z:.4}, radius {:.4}, overrun {beyond:.4}{up}", section.radius)
                .expect("text");
        }
    }
    for BranchPiece { branch, arc, cluster, .. } in &pieces {
        writeln!(out, "piece of branch {}: {arc:.4?} in cluster {}", branch.0, cluster.0).expect("text");
    }
    for (branch, reason) in &uncut {
        writeln!(out, "branch {} uncut: {reason:?}", branch.0).expect("text");
    }
    for warning in &warnings {
        writeln!(out, "{warning:.4?}").expect("text");
    }
    out + &format!("{:.4?}\n", layout.summary())
}

fn laid_out(skeleton: Skeleton, params: &PartitionParams) -> Layout {
    lay_out(&Arc::new(skeleton), params, &()).expect("a partition")
}

/// Texts of several partitions.
#[derive(Default)]
struct Texts(String);

impl Texts {
    fn add(&mut self, name: &str, layout: &Layout) {
        write!(self.0, "# {name}\n\n{}\n", text(layout)).expect("text");
    }
}

#[test]
fn grown_and_measured_networks_are_cut_as_recorded() {
    let (usual, mut all) = (PartitionParams::default(), Texts::default());
    all.add("tree", &laid_out(fixture("tree_30.swc"), &usual));
    all.add("measured", &laid_out(fixture("measured.swc"), &usual));
    all.add("crotch", &laid_out(fixture("crotch.vtp"), &usual));
    let tips = PartitionParams { cut_terminals: true, rho: 5.0, large: 2, ..PartitionParams::default() };
    all.add("tree with cut tips", &laid_out(fixture("tree_30.swc"), &tips));
    insta::assert_snapshot!("networks", all.0);
}

#[test]
fn single_vessels_are_cut_as_recorded() {
    let (usual, mut all) = (PartitionParams::default(), Texts::default());
    let line = |radii: &[f64], step: f64| {
        let points: Vec<_> = radii.iter().enumerate().map(|(i, &r)| ([step * i as f64, 0.0, 0.0], r)).collect();
        let edges: Vec<_> = (1..radii.len() as u32).map(|i| [i - 1, i]).collect();
        skeleton(&points, &edges)
    };
    all.add("long", &laid_out(line(&[1.0, 1.0], 700.0), &usual));
    all.add("tapered", &laid_out(line(&[3.0, 2.5, 1.2, 1.0, 0.4], 14.0), &usual));
    all.add("bent", &laid_out(polyline(wiggly(60, 0.9, 0.6)), &usual));
    all.add("kinked", &laid_out(polyline([[0.0; 3], [40.0, 0.0, 0.0], [40.0, 30.0, 0.0], [40.0, 33.0, 9.0]]), &usual));
    let sized = laid_out(line(&[1.0; 5], 30.0), &usual);
    let sizes = NodeSizes::new("Size", &[0.5, 0.7, 1.0, 2.0, 4.0]).expect("numbers");
    all.add("sized", &sized.sized(Some(SizeAt::Nodes(sizes))));
    insta::assert_snapshot!("vessels", all.0);
}

#[test]
fn bifurcations_are_cut_as_recorded() {
    let (usual, mut all) = (PartitionParams::default(), Texts::default());
    for (name, length) in [("near", 5.5), ("apart", 12.0), ("far", 60.0)] {
        all.add(name, &laid_out(h_shape(length), &usual));
    }
    all.add("acute", &laid_out(acute(25.0, 30.0), &usual));
    all.add("fine", &laid_out(h_shape(40.0), &usual).sized(Some(SizeAt::Forks(0.5))));
    let hair = [([-30.0, 0.0, 0.0], 2.0), ([0.0; 3], 2.0), ([30.0, 0.0, 0.0], 2.0), ([5.0, 18.0, 0.0], 0.1)];
    all.add("hair", &laid_out(skeleton(&hair, &[[0, 1], [1, 2], [1, 3]]), &usual));
    // Two vessels between the same bifurcations, and the tip of a third vessel near one of them.
    let loops = [
        ([0.0; 3], 1.0),
        ([20.0, 9.0, 0.0], 1.0),
        ([20.0, -9.0, 0.0], 0.8),
        ([40.0, 0.0, 0.0], 1.0),
        ([-20.0, 0.0, 0.0], 1.2),
        ([60.0, 0.0, 0.0], 1.2),
        ([21.0, 7.0, 9.0], 0.7),
        ([20.0, 10.5, 1.5], 0.7),
    ];
    let edges = [[0, 1], [1, 3], [0, 2], [2, 3], [4, 0], [3, 5], [2, 6], [6, 7]];
    all.add("loop", &laid_out(skeleton(&loops, &edges), &usual));
    let moved = PartitionParams { shifted_cuts: [(BranchId(0), 0.7), (BranchId(2), -0.4)].into(), ..usual };
    all.add("loop with moved cuts", &laid_out(skeleton(&loops, &edges), &moved));
    insta::assert_snapshot!("bifurcations", all.0);
}
