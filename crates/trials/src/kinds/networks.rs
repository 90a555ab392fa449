//! Kinds of networks with extreme valence, angles, radii and units, and with coincidences.

use super::make::MakeNetwork;
use super::repeated::bifurcation;
use crate::network::Network;
use crate::random::{Random, decade};
use crate::vector::{along, frame, turned};
use std::f64::consts::TAU;

pub const KINDS: [(&str, MakeNetwork); 14] = [
    ("star of 30 to 60 vessels", star),
    ("star in a plane", flat_star),
    ("fork of 0.1 degrees", fork),
    ("radii over eight decades", decades),
    ("trunk with hairs of 1e-4 radii", hairs),
    ("units of 1e-30 to 1e30", units),
    ("loop that closes within a lumen", lumen_loop),
    ("exactly coincident vessels", coincident),
    ("nodes in one place", one_place),
    ("collinear vessels that overlap", collinear),
    ("vessel that turns back on itself", reversed),
    ("tree within a vessel", tree_within),
    ("tangent vessels", tangent),
    ("lattice", lattice),
];

/// Vessels of many radii from one node.
fn star(r: &mut Random) -> Network {
    let mut net = Network::default();
    let middle = net.node([0.0; 3], 1.0);
    for _ in 0..30 + r.below(31) {
        let (tip, radius) = (along([0.0; 3], r.direction(), r.between(8.0, 40.0)), r.between(0.1, 1.0));
        net.tip(middle, tip, radius);
    }
    net
}

/// Vessels from one node whose directions lie exactly in a plane.
fn flat_star(r: &mut Random) -> Network {
    let mut net = Network::default();
    let middle = net.node([0.0; 3], 1.0);
    let count = 3 + r.below(25);
    for i in 0..count {
        let angle = TAU * (i as f64 + 0.8 * r.unit()) / count as f64;
        net.tip(middle, [30.0 * angle.cos(), 30.0 * angle.sin(), 0.0], r.between(0.3, 1.0));
    }
    net
}

/// Bifurcation whose daughters overlap for most of their length.
fn fork(r: &mut Random) -> Network {
    let angle = r.scale(-1, 1).min(5.0).to_radians();
    let net = bifurcation(angle, r.between(0.05, 1.0));
    let frame = frame(r.direction());
    Network { points: net.points.iter().map(|p| turned(*p, &frame)).collect(), ..net }
}

/// Chain whose radius changes by up to a decade at each node, within eight decades.
fn decades(r: &mut Random) -> Network {
    let mut net = Network::default();
    let (mut trunk, up) = (net.node([0.0; 3], 1e4), r.chance(0.3));
    for k in 0..8 {
        let radius = decade(4 - k);
        let direction = if up { r.direction() } else { [1.0, 0.0, 0.0] };
        let next = along(net.points[trunk], direction, radius * r.between(3.0, 30.0));
        trunk = net.tip(trunk, next, 0.1 * radius);
    }
    net
}

/// Wide vessel with side branches that are 10 to 10,000 times thinner.
fn hairs(r: &mut Random) -> Network {
    let mut net = Network::default();
    let ids = net.line(10, 1.0, |t| [40.0 * t, 0.0, 0.0]);
    for _ in 0..=r.below(6) {
        let (node, thin, angle) = (ids[1 + r.below(9)], r.scale(-4, -1), r.angle());
        let tip = along(net.points[node], [0.0, angle.cos(), angle.sin()], r.between(1.5, 6.0));
        let tip = net.node(tip, thin);
        net.edge_of_radius(node, tip, thin);
    }
    net
}

/// Bifurcation in any unit.
fn units(r: &mut Random) -> Network {
    let mut net = bifurcation(r.between(0.3, 2.0), r.between(0.3, 1.5));
    net.points.iter_mut().for_each(|p| p[2] = 0.5);
    net.scaled(decade(r.below(61) as i32 - 30))
}

/// Loop of several nodes, partly inside the lumen that it leaves.
fn lumen_loop(r: &mut Random) -> Network {
    let mut net = Network::default();
    let ids = net.line(30, 1.0, |t| [30.0 * t, 0.0, 0.0]);
    let (from, to) = (5 + r.below(10), 16 + r.below(10));
    let (high, radius) = (r.between(0.2, 3.0), r.between(0.1, 0.9));
    let (start, end) = (net.points[ids[from]][0], net.points[ids[to]][0]);
    let arch = net.line(8, radius, |t| {
        let t = 0.1 + 0.8 * t;
        [start + (end - start) * t, 4.0 * high * t * (1.0 - t), 0.0]
    });
    net.edge(ids[from], arch[0]);
    net.edge(arch[8], ids[to]);
    net
}

/// Copies of a vessel at exactly equal positions, with other radii.
fn coincident(r: &mut Random) -> Network {
    let mut net = Network::default();
    for _ in 0..2 + r.below(3) {
        let (radius, from) = (r.pick(&[1.0, 0.5, r.clone().between(0.2, 2.0)]), r.pick(&[0.0, 7.5]));
        net.line(8, radius, |t| [from + 30.0 * t, 0.0, 0.0]);
    }
    net
}

/// Several nodes at one position, joined by edges of length zero.
fn one_place(r: &mut Random) -> Network {
    let mut net = Network::default();
    let ids = net.line(6, 1.0, |t| [30.0 * t, 0.0, 0.0]);
    for _ in 0..=r.below(4) {
        let at = ids[r.below(7)];
        let twin = net.tip(at, net.points[at], r.between(0.1, 1.0));
        let tip = along(net.points[at], r.direction(), r.between(0.0, 12.0));
        net.tip(twin, tip, 0.5);
    }
    net
}

/// Vessels on one line that overlap, touch or leave a gap.
fn collinear(r: &mut Random) -> Network {
    let mut net = Network::default();
    for _ in 0..2 + r.below(4) {
        let (start, length) = (f64::from(r.below(20) as u32), r.between(1.0, 20.0).round());
        let radius = r.pick(&[1.0, 0.5, 0.25]);
        net.line(1 + r.below(5) as u32, radius, |t| [start + length * t, 0.0, 0.0]);
    }
    net
}

/// Path that goes back over its own nodes' positions.
fn reversed(r: &mut Random) -> Network {
    let mut net = Network::default();
    let turn = r.between(0.3, 0.9);
    let shift = if r.chance(0.5) { 0.0 } else { r.scale(-9, 0) };
    net.line(20, r.between(0.2, 2.0), |t| {
        if t < turn { [30.0 * t, 0.0, 0.0] } else { [30.0 * (2.0 * turn - t), shift, 0.0] }
    });
    net
}

/// Whole tree inside the lumen of a wide vessel, or partly outside.
fn tree_within(r: &mut Random) -> Network {
    let mut net = bifurcation(r.between(0.05, 0.4), r.between(0.1, 0.8));
    let wide = r.between(2.0, 20.0);
    net.line(12, wide, |t| [-40.0 + 90.0 * t, 0.0, 0.0]);
    net
}

/// Parallel vessels whose surfaces touch at exactly one line, or nearly.
fn tangent(r: &mut Random) -> Network {
    let mut net = Network::default();
    let apart = 2.0 + r.pick(&[0.0, 1e-12, -1e-12, 1e-6, -1e-6, 1e-3, 1e-2]);
    let skew = r.pick(&[0.0, 0.0, 1.0]);
    net.line(6, 1.0, |t| [30.0 * t, 0.0, 0.0]);
    net.line(6, 1.0, |t| [30.0 * t * (1.0 - skew) + 15.0 * skew, apart, 30.0 * (t - 0.5) * skew]);
    net
}

/// Cubic lattice of vessels with many loops; wide ones fill it.
fn lattice(r: &mut Random) -> Network {
    let (side, radius) = (2 + r.below(3), r.between(0.05, 0.4));
    let mut net = Network::default();
    for i in 0..side * side * side {
        net.node([i % side, i / side % side, i / side / side].map(|x| x as f64), radius);
    }
    for i in 0..net.points.len() {
        let place = [i % side, i / side % side, i / side / side];
        for (k, step) in [1, side, side * side].into_iter().enumerate() {
            if place[k] + 1 < side && r.chance(0.9) {
                net.edge(i, i + step);
            }
        }
    }
    if net.edges.is_empty() {
        net.edge(0, 1);
    }
    net
}
