//! Kinds of networks that are random as a whole: walks, blobs, helices and clouds.

use super::make::MakeNetwork;
use crate::network::Network;
use crate::random::{Random, decade};
use crate::vector::along;
use std::f64::consts::TAU;

pub const KINDS: [(&str, MakeNetwork); 7] = [
    ("random walk", walk),
    ("random walk of up to 100,000 nodes", long_walk),
    ("blob of many short vessels", blob),
    ("two helices that fuse", fused),
    ("random graph", graph),
    ("random tree", tree),
    ("integer coordinates", integers),
];

/// Walk of 3 to 300 nodes that crosses itself.
fn walk(r: &mut Random) -> Network {
    let count = 3 + (297.0 * r.unit().powi(3)) as usize;
    steps(r, count)
}

/// Walk with a branch now and then. Few walks are long, as each takes minutes.
fn long_walk(r: &mut Random) -> Network {
    let count = (decade(2) * 1000.0_f64.powf(r.unit().powi(6))) as usize;
    steps(r, count)
}

fn steps(r: &mut Random, count: usize) -> Network {
    let mut net = Network::default();
    let (length, persistence) = (r.between(0.5, 8.0), r.between(0.0, 1.5));
    let mut node = net.node([0.0; 3], 1.0);
    let mut heading = r.direction();
    for _ in 0..count {
        let turn = r.direction();
        heading = crate::vector::unit(along(turn, heading, persistence + 1e-9));
        let (place, radius) = (along(net.points[node], heading, length), r.between(0.2, 1.0));
        let next = net.tip(node, place, radius);
        node = if r.chance(0.02) { r.below(net.points.len()) } else { next };
    }
    net
}

/// Nodes so close to each other that all lumens are one.
fn blob(r: &mut Random) -> Network {
    let mut net = Network::default();
    net.node([0.0; 3], 1.0);
    for _ in 0..5 + r.below(40) {
        let from = r.below(net.points.len());
        let (place, radius) = (along(net.points[from], r.direction(), r.between(0.05, 1.5)), r.between(0.3, 1.5));
        net.tip(from, place, radius);
    }
    net
}

/// Double helix whose strands touch, with a common end or without.
fn fused(r: &mut Random) -> Network {
    let mut net = Network::default();
    let (pitch, around, turns) = (r.between(2.0, 8.0), r.between(0.8, 4.0), r.between(1.0, 4.0));
    let strands = [0.0, 0.5].map(|phase| {
        net.line(80, 1.0, |t| {
            let angle = TAU * (turns * t + phase);
            [around * angle.cos(), around * angle.sin(), pitch * turns * t]
        })
    });
    if r.chance(0.5) {
        net.edge(strands[0][80], strands[1][80]);
    }
    net
}

/// Random points, each joined to some of the others.
fn graph(r: &mut Random) -> Network {
    let mut net = Network::default();
    let count = 4 + r.below(20);
    for _ in 0..count {
        let (place, radius) = (along([0.0; 3], r.direction(), r.between(0.0, 20.0)), r.between(0.1, 1.0));
        net.node(place, radius);
    }
    for i in 1..count {
        let to = r.below(i);
        net.edge(i, to);
        if r.chance(0.3) {
            let other = r.below(i);
            if other != to {
                net.edge(i, other);
            }
        }
    }
    net
}

/// Tree whose radii follow Murray's law with noise.
fn tree(r: &mut Random) -> Network {
    let mut net = Network::default();
    let root = net.node([0.0; 3], 1.0);
    let trunk = net.tip(root, [8.0, 0.0, 0.0], 1.0);
    let mut front = vec![(trunk, [1.0, 0.0, 0.0])];
    for _ in 0..2 + r.below(4) {
        for (node, heading) in std::mem::take(&mut front) {
            for _ in 0..2 {
                let heading = crate::vector::unit(along(heading, r.direction(), r.between(0.3, 1.2)));
                let radius = net.radii[node] * r.between(0.6, 0.9);
                let place = along(net.points[node], heading, radius * r.between(4.0, 12.0));
                front.push((net.tip(node, place, radius), heading));
            }
        }
    }
    net
}

/// Small integers as coordinates: many exact coincidences, crossings and right angles.
fn integers(r: &mut Random) -> Network {
    let mut net = Network::default();
    net.node([0.0; 3], 0.25);
    for _ in 0..3 + r.below(12) {
        let from = r.below(net.points.len());
        let place = [(); 3].map(|()| f64::from(r.below(7) as u32));
        let radius = r.pick(&[0.25, 0.5, 1.0]);
        net.tip(from, place, radius);
    }
    net
}
