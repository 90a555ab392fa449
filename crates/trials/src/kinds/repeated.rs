//! Kinds of networks that `tests/library/nasty_networks.rs` runs, too.

use super::make::MakeNetwork;
use crate::network::Network;
use crate::random::{Random, decade};
use crate::vector::along;
use std::f64::consts::TAU;

pub const KINDS: [(&str, MakeNetwork); 18] = [
    ("star of 4 to 30 vessels", star),
    ("fork of 0.5 to 20 degrees", fork),
    ("radius that jumps twentyfold", jump),
    ("twig shorter than its radius", twig),
    ("small loop within a lumen", small_loop),
    ("parallel vessels 0.1 to 2.2 radii apart", parallel),
    ("exact crossing", crossing),
    ("thin component within a wide one", within),
    ("ring", ring),
    ("helix", helix),
    ("vessel wider than long", disc),
    ("noise along a vessel, in tiny or huge units", noise),
    ("vessel drawn twice, almost in one place", doubled),
    ("theta graph", theta),
    ("tree in a plane", plane_tree),
    ("radii over four decades", decades),
    ("daughters that fold back by 170 to 180 degrees", folded),
    ("tips in a crowd", crowd),
];

/// Vessels of equal radius from one node.
fn star(r: &mut Random) -> Network {
    let mut net = Network::default();
    let middle = net.node([0.0; 3], 1.0);
    for _ in 0..4 + r.below(27) {
        let tip = along([0.0; 3], r.direction(), r.between(8.0, 20.0));
        net.tip(middle, tip, 1.0);
    }
    net
}

/// Bifurcation with a narrow angle.
fn fork(r: &mut Random) -> Network {
    let angle = r.between(0.5, 20.0).to_radians();
    bifurcation(angle, 1.0)
}

/// Bifurcation in the plane z = 0: one daughter straight on, the other at an angle to it.
pub fn bifurcation(angle: f64, radius: f64) -> Network {
    let mut net = Network::default();
    let root = net.node([-15.0, 0.0, 0.0], radius);
    let middle = net.tip(root, [0.0; 3], radius);
    net.tip(middle, [30.0, 0.0, 0.0], radius);
    net.tip(middle, [30.0 * angle.cos(), 30.0 * angle.sin(), 0.0], radius);
    net
}

/// Thin vessel that leaves a wide one.
fn jump(r: &mut Random) -> Network {
    let mut net = Network::default();
    let ids = net.line(2, 4.0, |t| [80.0 * t, 0.0, 0.0]);
    let thin = r.between(0.2, 1.0);
    let tip = net.node([40.0, r.between(10.0, 30.0), 0.0], thin);
    net.edge_of_radius(ids[1], tip, thin);
    net
}

/// Side branch that may end inside its parent.
fn twig(r: &mut Random) -> Network {
    let mut net = Network::default();
    let ids = net.line(20, 1.0, |t| [30.0 * t, 0.0, 0.0]);
    net.tip(ids[10], [15.0, r.between(0.05, 1.5), 0.0], r.between(0.05, 1.0));
    net
}

/// Short loop inside the lumen of a vessel.
fn small_loop(r: &mut Random) -> Network {
    let mut net = Network::default();
    let ids = net.line(30, 1.0, |t| [30.0 * t, 0.0, 0.0]);
    let off = net.tip(ids[14], [15.0, r.between(0.1, 0.9), 0.0], 0.8);
    net.edge(off, ids[16]);
    net
}

/// Parallel vessels that overlap or nearly touch.
fn parallel(r: &mut Random) -> Network {
    let mut net = Network::default();
    let apart = r.between(0.1, 2.2);
    net.line(30, 1.0, |t| [30.0 * t, 0.0, 0.0]);
    net.line(30, 1.0, |t| [30.0 * t, apart, 0.2 * t]);
    net
}

/// Vessels whose axes cross without a common node.
fn crossing(r: &mut Random) -> Network {
    let mut net = Network::default();
    net.line(20, 1.0, |t| [30.0 * t - 15.0, 0.0, 0.0]);
    let tilt = r.between(0.0, 3.0);
    net.line(20, 1.0, |t| [tilt * (t - 0.5), 30.0 * t - 15.0, 0.0]);
    net
}

/// Thin component in the lumen of a wide vessel.
fn within(r: &mut Random) -> Network {
    let mut net = Network::default();
    net.line(20, 4.0, |t| [60.0 * t, 0.0, 0.0]);
    let off = r.between(0.0, 2.0);
    net.line(10, 0.5, |t| [20.0 + 20.0 * t, off, 0.0]);
    net
}

/// Closed ring without terminals.
fn ring(r: &mut Random) -> Network {
    let mut net = Network::default();
    let around = r.between(1.2, 8.0);
    let ids = net.line(23, 1.0, |t| {
        let angle = TAU * t * 23.0 / 24.0;
        [around * angle.cos(), around * angle.sin(), 0.0]
    });
    net.edge(ids[23], ids[0]);
    net
}

/// Helix whose windings may overlap.
fn helix(r: &mut Random) -> Network {
    let mut net = Network::default();
    let (pitch, around) = (r.between(0.5, 5.0), r.between(0.5, 4.0));
    net.line(150, 1.0, |t| {
        let angle = 30.0 * t;
        [around * angle.cos(), around * angle.sin(), pitch * angle / TAU]
    });
    net
}

/// Single vessel shorter than its radius.
fn disc(r: &mut Random) -> Network {
    let mut net = Network::default();
    let root = net.node([0.0; 3], 1.0);
    net.tip(root, [r.between(0.001, 2.0), 0.0, 0.0], 1.0);
    net
}

/// Noisy axis in units of 1e-9 or 1e9.
fn noise(r: &mut Random) -> Network {
    let mut net = Network::default();
    let unit = r.pick(&[1e-9, 1e9]);
    let noise: Vec<_> = (0..=100).map(|_| along([0.0; 3], r.direction(), r.between(0.0, 0.4))).collect();
    net.line(100, 1.0, |t| {
        let n = noise[(100.0 * t).round() as usize];
        [40.0 * t + n[0], n[1], n[2]]
    });
    net.scaled(unit)
}

/// Two copies of a vessel, 1e-12 to 0.1 radii apart.
fn doubled(r: &mut Random) -> Network {
    let mut net = Network::default();
    for _ in 0..2 {
        let off = along([0.0; 3], r.direction(), r.scale(-12, -1));
        net.line(30, 1.0, |t| [30.0 * t + off[0], off[1], off[2]]);
    }
    net
}

/// Three paths between two nodes.
fn theta(r: &mut Random) -> Network {
    let mut net = Network::default();
    let [from, to] = [0.0, 20.0].map(|x| net.node([x, 0.0, 0.0], 1.0));
    for side in [-1.0, 0.0, 1.0] {
        let (high, radius) = (side * r.between(0.5, 12.0), r.between(0.2, 1.0));
        let ids = net.line(8, radius, |t| [2.0 + 16.0 * t, high * (1.0 - (2.0 * t - 1.0).powi(2)), 0.0]);
        net.edge(from, ids[0]);
        net.edge(ids[8], to);
    }
    net
}

/// Binary tree whose nodes have one z coordinate.
fn plane_tree(r: &mut Random) -> Network {
    let mut net = Network::default();
    let mut front = vec![(net.node([0.0; 3], 1.0), 1.57, 1.0)];
    for _ in 0..4 {
        for (node, heading, radius) in std::mem::take(&mut front) {
            for side in [-1.0, 1.0] {
                let angle: f64 = heading + side * r.between(0.2, 1.2);
                let place = along(net.points[node], [angle.cos(), angle.sin(), 0.0], radius * r.between(3.0, 10.0));
                front.push((net.tip(node, place, 0.79 * radius), angle, 0.79 * radius));
            }
        }
    }
    net
}

/// Vessel whose radius falls tenfold at each node.
fn decades(r: &mut Random) -> Network {
    let mut net = Network::default();
    let mut trunk = net.node([0.0; 3], 100.0);
    for k in 0..5 {
        let radius = decade(2 - k);
        let place = along(net.points[trunk], [1.0, 0.0, 0.0], radius * r.between(4.0, 12.0));
        let next = net.node(place, 0.1 * radius);
        net.edge_of_radius(trunk, next, radius);
        trunk = next;
    }
    net
}

/// Daughters that run back along their parent.
fn folded(r: &mut Random) -> Network {
    let mut net = Network::default();
    let root = net.node([-20.0, 0.0, 0.0], 1.0);
    let fork = net.tip(root, [0.0; 3], 1.0);
    for side in [-1.0, 1.0] {
        let angle = r.between(0.0, 10.0).to_radians();
        net.tip(fork, [-r.between(5.0, 30.0) * angle.cos(), side * 20.0 * angle.sin(), 0.0], r.between(0.2, 1.0));
    }
    net
}

/// Bifurcation whose squares overflow or underflow.
pub fn extreme_units(r: &mut Random) -> Network {
    let mut net = bifurcation(r.between(0.5, 1.5), 1.0);
    net.points[3][2] = 1.0;
    net.scaled(r.pick(&[1e-150, 1e150]))
}

/// Seven terminals whose caps compete for room.
fn crowd(r: &mut Random) -> Network {
    let mut net = Network::default();
    let root = net.node([-15.0, 0.0, 0.0], 1.0);
    let fork = net.tip(root, [0.0; 3], 1.0);
    for _ in 0..6 {
        net.tip(fork, [15.0, r.between(-2.0, 2.0), r.between(-2.0, 2.0)], 0.5);
    }
    net
}
