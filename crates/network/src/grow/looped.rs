//! Arteries and veins, connected by a looped capillary bed.
//!
//! Two trees grow in one ellipsoid, from inlets on opposite sides. At collisions the thinner vessel is removed with its
//! subtree. Capillaries form a jittered net in the whole ellipsoid (`net`). Those close to the trees are removed, and
//! the ends of the trees are joined to the others (`ends`). Dead ends of the net are removed, too.

use rayon::prelude::*;

use super::bed::BedParams;
use super::ends::join;
use super::generate::generate;
use super::net::Net;
use super::organ::SEMI_AXES;
use super::params::{GenerateError, GenerateParams, Organ};
use super::random::{Random, Stream};
use super::tubes::{APART, TubeTree, meet};
use anastomesh_mesh::geometry::{Point3, Tube, Vec3};
use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};

/// Maximum jitter of net nodes along each axis, in edge lengths.
const JITTER: f64 = 0.12;
/// Minimum distance of capillaries from a tree's end, in edge lengths: it leaves space for a joining vessel.
const ROOM: f64 = 0.4;

/// Arteries, veins and capillaries.
#[derive(Clone, Debug)]
pub struct Looped {
    /// All vessels.
    pub skeleton: Skeleton,
    /// Vessel type of each node: 0 for arteries, 1 for veins, 2 for capillaries.
    pub kind: Vec<u32>,
    /// Number of tree ends joined to the bed.
    pub joined: usize,
    /// Number of open tree ends without space for a joining vessel: outlets.
    pub open: usize,
}

/// Grows arteries, veins and the bed between them. `params` describes each tree.
///
/// # Errors
/// The parameters are invalid.
pub fn looped(params: &GenerateParams, bed: &BedParams) -> Result<Looped, GenerateError> {
    bed.check()?;
    if params.organ != Organ::Ellipsoid {
        return Err(GenerateError::BedOfKidney);
    }
    let size = params.size.unwrap_or_else(|| bed.usual_size(params.terminals));
    let params = GenerateParams { size: Some(size), ..*params };
    let arteries = generate(&params)?;
    let mut veins = generate(&GenerateParams { seed: !params.seed, ..params })?;
    veins.nodes.iter_mut().for_each(|node| node.position = -node.position);
    let (mut network, of_veins) = apart(arteries, veins);
    let first = network.nodes.len();
    let terminals: Vec<NodeId> = network.adjacency().terminals();
    let random = Random::new(params.seed);
    add_bed(&mut network, &terminals, bed, size, random);
    let joined = join(&mut network, &terminals, first, bed, random);
    let kept = live(&network, first);
    let open = terminals.len() - joined.len();
    let mut kind: Vec<u32> = (0..first).map(|i| u32::from(i >= of_veins)).collect();
    kind.resize(network.nodes.len(), 2);
    kind.retain({
        let mut i = 0;
        let kept = &kept;
        move |_| {
            i += 1;
            kept[i - 1]
        }
    });
    // The two inlets are ends, too.
    Ok(Looped { skeleton: compact(&network, &kept), kind, joined: joined.len(), open: open.saturating_sub(2) })
}

/// Combines both trees without colliding thinner vessels. Also returns the index of the first vein node.
fn apart(arteries: Skeleton, veins: Skeleton) -> (Skeleton, usize) {
    let (nodes, edges) = (arteries.nodes.len() as u32, arteries.edges.len());
    let mut both = arteries;
    both.nodes.extend(veins.nodes);
    both.edges.extend(veins.edges.iter().map(|e| Edge { nodes: e.nodes.map(|n| NodeId(n.0 + nodes)), ..*e }));
    let tubes = TubeTree::new(both.edge_ids().map(|edge| both.tube(edge)));
    let mut goes = vec![false; both.nodes.len()];
    tubes.tree.self_pairs(|i, j| {
        let (a, b) = (tubes.list[i as usize], tubes.list[j as usize]);
        if ((i as usize) < edges) != ((j as usize) < edges) && meet(&a, &b) {
            let thinner = if a.ra < b.ra { i } else { j };
            goes[both.edges[thinner as usize].nodes[1].index()] = true;
        }
    });
    // Edges lead from nodes to later ones.
    for edge in &both.edges {
        goes[edge.nodes[1].index()] |= goes[edge.nodes[0].index()];
    }
    let kept: Vec<bool> = goes.iter().map(|goes| !goes).collect();
    let of_veins = kept[..nodes as usize].iter().filter(|kept| **kept).count();
    (compact(&both, &kept), of_veins)
}

/// Adds the net except for capillaries that are too close to the trees or to their ends.
fn add_bed(network: &mut Skeleton, ends: &[NodeId], bed: &BedParams, size: f64, random: Random) {
    let half = Vec3::from(SEMI_AXES) * (0.5 * size);
    let net = Net::new(bed.length, &half);
    let place = |i: u64| {
        let off = |axis: u64| bed.length * JITTER * (2.0 * random.unit(Stream::Bed, 3 * i + axis) - 1.0);
        net.point(i) + Vec3::new(off(0), off(1), off(2))
    };
    let inside = |p: &Point3| p.coords.component_div(&half).norm_squared() <= 1.0;
    let thick = bed.thick();
    let room = ROOM * bed.length / APART - thick;
    let rooms = ends.iter().map(|&end| {
        let a = network.node(end).position;
        Tube { a, b: a + Vec3::x() * (0.01 * room), ra: room, rb: room }
    });
    let trees = TubeTree::new(network.edge_ids().map(|edge| network.tube(edge)).chain(rooms));
    let clear = |i: u64| -> Vec<[u64; 2]> {
        let here = place(i);
        let later = net.joined(i).into_iter().flatten().filter(|&j| j > i && inside(&here));
        let edges = later.map(|j| (j, place(j))).filter(|(_, there)| inside(there));
        let free =
            edges.filter(|(_, there)| !trees.meets(&Tube { a: here, b: *there, ra: thick, rb: thick }, &[], None));
        free.map(|(j, _)| [i, j]).collect()
    };
    let edges: Vec<[u64; 2]> = (0..net.len()).into_par_iter().flat_map_iter(clear).collect();
    let mut places: Vec<u64> = edges.iter().flatten().copied().collect();
    places.par_sort_unstable();
    places.dedup();
    let first = network.nodes.len();
    let node = |&i: &u64| Node { position: place(i), radius: bed.radius, original: 0 };
    network.nodes.extend(places.iter().map(node));
    let id = |i: u64| NodeId((first + places.partition_point(|&p| p < i)) as u32);
    network.edges.extend(edges.iter().enumerate().map(|(k, ends)| {
        let radius = bed.any_radius(random, Stream::Bed, net.len() * 3 + k as u64);
        Edge { nodes: ends.map(id), radii: [radius; 2] }
    }));
}

/// Marks the remaining nodes: the trees (before `first`), and net nodes of the first inlet's component that are no dead
/// ends.
fn live(network: &Skeleton, first: usize) -> Vec<bool> {
    let adjacency = network.adjacency();
    let mut valence: Vec<usize> = network.node_ids().map(|n| adjacency.valence(n)).collect();
    let mut pending: Vec<NodeId> = network.node_ids().skip(first).filter(|n| valence[n.index()] == 1).collect();
    let mut live = vec![true; network.nodes.len()];
    while let Some(node) = pending.pop() {
        live[node.index()] = false;
        for &edge in adjacency.edges(node) {
            let other = network.edge(edge).other(node);
            valence[other.index()] -= 1;
            if other.index() >= first && valence[other.index()] == 1 && live[other.index()] {
                pending.push(other);
            }
        }
    }
    let mut reached = vec![false; network.nodes.len()];
    reached[0] = true;
    pending.push(NodeId(0));
    while let Some(node) = pending.pop() {
        for &edge in adjacency.edges(node) {
            let other = network.edge(edge).other(node).index();
            if live[other] && !reached[other] {
                reached[other] = true;
                pending.push(NodeId(other as u32));
            }
        }
    }
    reached
}

/// Returns the network of the kept nodes, renumbered. Each node has the radius of its thickest vessel.
fn compact(network: &Skeleton, kept: &[bool]) -> Skeleton {
    let mut number = vec![u32::MAX; kept.len()];
    let mut out = Skeleton::default();
    for (i, node) in network.nodes.iter().enumerate().filter(|(i, _)| kept[*i]) {
        number[i] = out.nodes.len() as u32;
        out.nodes.push(Node { radius: 0.0, original: number[i], ..*node });
    }
    for edge in &network.edges {
        if edge.nodes.iter().all(|n| kept[n.index()]) {
            let nodes = edge.nodes.map(|n| NodeId(number[n.index()]));
            for n in nodes {
                let radius = &mut out.nodes[n.index()].radius;
                *radius = radius.max(edge.radii[0]);
            }
            out.edges.push(Edge { nodes, ..*edge });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small(seed: u64) -> Looped {
        let params = GenerateParams { seed, terminal_radius: 4.0, ..GenerateParams::new(Organ::Ellipsoid, 150) };
        looped(&params, &BedParams::default()).expect("possible")
    }

    #[test]
    fn the_bed_closes_arteries_and_veins_to_loops() {
        let made = small(3);
        let network = &made.skeleton;
        network.check().expect("a network");
        assert_eq!(made.kind.len(), network.nodes.len());
        let adjacency = network.adjacency();
        let components = network.components(&adjacency).list;
        assert_eq!(components.len(), 1);
        let capillaries = made.kind.iter().filter(|kind| **kind == 2).count();
        assert!(capillaries > 1500 && components[0].loops() > capillaries / 3, "{capillaries}");
        // Capillaries have no open ends; nearly all tree ends are joined.
        let terminals = adjacency.terminals();
        assert!(terminals.iter().all(|n| made.kind[n.index()] < 2) && terminals.len() <= made.open + 2);
        assert!(made.joined > 20 * made.open, "{} joined, {} open", made.joined, made.open);
        for kind in 0..2 {
            assert!(made.kind.iter().filter(|k| **k == kind).count() > 100);
        }
    }

    #[test]
    fn vessels_overlap_nowhere_but_within_a_tree() {
        let made = small(4);
        let overlaps = made.skeleton.overlaps(&made.skeleton.adjacency());
        let bed = overlaps.pairs.iter().filter(|o| o.nodes.as_flattened().iter().any(|n| made.kind[n.index()] == 2));
        assert_eq!(bed.count(), 0);
    }

    #[test]
    fn lengths_and_radii_are_as_asked_for() {
        let made = small(5);
        let edges = made.skeleton.edge_ids().zip(&made.skeleton.edges);
        let bed = edges.filter(|(_, e)| e.nodes.iter().all(|n| made.kind[n.index()] == 2));
        let (mut count, mut length, mut radius) = (0.0, 0.0, 0.0);
        for (id, edge) in bed {
            count += 1.0;
            length += made.skeleton.length(id);
            radius += edge.radii[0];
            assert!((1.0..2.5).contains(&edge.radii[0]));
        }
        assert!((length / count / 60.0 - 1.0).abs() < 0.03 && (radius / count / 1.75 - 1.0).abs() < 0.02);
    }

    #[test]
    fn a_seed_gives_one_network_for_any_number_of_threads() {
        let of = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| small(6)).skeleton
        };
        assert_eq!(of(1), of(3));
        assert_ne!(of(1), small(7).skeleton);
    }

    #[test]
    fn beds_that_make_no_sense_are_refused() {
        let params = GenerateParams::new(Organ::Ellipsoid, 50);
        for bed in [BedParams { radius: 0.0, length: 60.0 }, BedParams { radius: 8.0, length: 60.0 }] {
            assert!(matches!(looped(&params, &bed), Err(GenerateError::BadBed { .. })));
        }
        let kidney = looped(&GenerateParams::new(Organ::Kidney, 50), &BedParams::default());
        assert!(matches!(kidney, Err(GenerateError::BedOfKidney)));
    }
}
