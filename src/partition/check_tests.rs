//! Each condition of the check, by a partition that violates it alone.

use super::super::tests::{h_shape, polyline};
use super::super::{Cluster, PartitionParams, partition};
use super::*;
use anastomesh_mesh::geometry::Vec3;
use anastomesh_skeleton::Skeleton;

/// Two junctions joined by a branch with one cut; all radii are 0.3.
fn network() -> Skeleton {
    let mut skeleton = h_shape(12.0);
    for node in &mut skeleton.nodes {
        node.position.coords *= 0.3;
        node.radius *= 0.3;
    }
    for edge in &mut skeleton.edges {
        edge.radii = [0.3; 2];
    }
    skeleton
}

/// A sound partition, and places in it.
struct Sound {
    skeleton: Skeleton,
    partition: Partition,
    /// Pieces before and after the cut.
    pieces: [usize; 2],
}

impl Sound {
    fn new() -> Self {
        let skeleton = network();
        let partition = partition(&skeleton, &PartitionParams::default()).expect("a partition");
        assert_eq!((check_partition(&skeleton, &partition), partition.cuts.len()), (Ok(()), 1));
        let branch = partition.cuts[0].branch;
        let mut beside = (0..partition.pieces.len()).filter(|&i| partition.pieces[i].branch == branch);
        let pieces = [beside.next().expect("a piece"), beside.next().expect("a piece")];
        Self { skeleton, partition, pieces }
    }

    /// Result of the check after a change.
    fn after(&self, change: impl FnOnce(&mut Partition)) -> Result<(), PartitionFlaw> {
        let mut changed = self.partition.clone();
        change(&mut changed);
        check_partition(&self.skeleton, &changed)
    }

    /// Clusters on both sides of the cut, with the numbers of their ends.
    fn sides(&self) -> [(ClusterId, u32); 2] {
        self.partition.cuts[0].sides
    }
}

fn end_of(partition: &mut Partition, (cluster, end): (ClusterId, u32)) -> &mut ClusterEnd {
    &mut partition.clusters[cluster.0 as usize].ends[end as usize]
}

/// Tube beyond an end.
fn overrun(partition: &mut Partition, (cluster, end): (ClusterId, u32)) -> &mut Tube {
    let cluster = &mut partition.clusters[cluster.0 as usize];
    &mut cluster.tubes[cluster.ends[end as usize].overrun as usize]
}

/// Tubes of a piece.
fn tubes_of(partition: &mut Partition, piece: usize) -> &mut [Tube] {
    let BranchPiece { cluster, tubes, .. } = partition.pieces[piece].clone();
    &mut partition.clusters[cluster.0 as usize].tubes[tubes.start as usize..tubes.end as usize]
}

#[test]
fn branches_are_covered_exactly_once() {
    let sound = Sound::new();
    let [first, last] = sound.pieces;
    let branch = sound.partition.cuts[0].branch;
    let length = sound.partition.pieces[last].arc[1];
    let [from, to] = sound.partition.cut_arcs[0];
    let flaw = |arc| Err(PartitionFlaw::Coverage { branch, arc });
    assert_eq!(sound.after(|p| p.cut_arcs.clear()), Err(PartitionFlaw::Coverage { branch: BranchId(0), arc: 0.0 }));
    assert_eq!(sound.after(|p| p.cut_arcs[0][0] = from + 0.1), flaw(from + 0.1));
    // A piece without length.
    let empty = sound.after(|p| {
        p.pieces[first].arc[1] = 0.0;
        p.cut_arcs[0][0] = 0.0;
    });
    assert_eq!(empty, flaw(0.0));
    // Two pieces without a connector, and a connector without a piece beyond.
    let joined = sound.after(|p| {
        p.cuts.clear();
        p.cut_arcs.clear();
        p.pieces[first].arc[1] = to;
    });
    assert_eq!(joined, flaw(to));
    let open = sound.after(|p| {
        p.pieces.remove(last);
        p.cut_arcs[0][1] = length;
    });
    assert_eq!(open, flaw(length));
    assert_eq!(sound.after(|p| p.pieces[last].arc[1] = length - 0.1), flaw(length - 0.1));
    let unknown = BranchId(77);
    let more = sound.after(|p| {
        let piece = BranchPiece { branch: unknown, ..p.pieces[first].clone() };
        p.pieces.push(piece);
    });
    assert_eq!(more, Err(PartitionFlaw::Coverage { branch: unknown, arc: 0.0 }));
}

#[test]
fn tubes_form_a_chain_on_the_axis() {
    let sound = Sound::new();
    let [first, _] = sound.pieces;
    let is_off = |change: &dyn Fn(&mut [Tube])| {
        let result = sound.after(|p| change(tubes_of(p, first)));
        matches!(result, Err(PartitionFlaw::Tubes { .. }))
    };
    assert!(is_off(&|tubes| tubes[0].ra = 0.0));
    assert!(is_off(&|tubes| tubes[0].ra = f64::NAN));
    // The tolerance is 1e-9 of the branch, which is 3.6 long.
    assert!(!is_off(&|tubes| tubes[0].a.y += 3e-9));
    assert!(is_off(&|tubes| tubes[0].a.y += 5e-9));
    // The last tube ends beside the axis: its length is nearly the same.
    assert!(is_off(&|tubes| tubes.last_mut().expect("a tube").b.y += 1e-5));
    assert!(matches!(sound.after(|p| p.pieces[first].tubes.end = 999), Err(PartitionFlaw::Tubes { .. })));
    assert!(matches!(
        sound.after(|p| p.pieces[first].tubes.end = p.pieces[first].tubes.start),
        Err(PartitionFlaw::Tubes { .. })
    ));
}

/// Check of a bent vessel, whose bend is replaced by tubes through another point.
fn through(rise: f64, middle: f64) -> Result<(), PartitionFlaw> {
    let mut skeleton = polyline([[0.0; 3], [4.0, rise, 0.0], [8.0, 0.0, 0.0]]);
    for node in &mut skeleton.nodes {
        node.radius = 0.3;
    }
    for edge in &mut skeleton.edges {
        edge.radii = [0.3; 2];
    }
    let params = PartitionParams { long: 1e9, ..PartitionParams::default() };
    let mut whole = partition(&skeleton, &params).expect("a partition");
    let tubes = tubes_of(&mut whole, 0);
    let middle = Point3::new(4.0, middle, 0.0);
    let [first, last] = [tubes[0], *tubes.last().expect("a tube")];
    assert_eq!(tubes.len(), 2);
    tubes[0] = Tube { b: middle, ..first };
    tubes[1] = Tube { a: middle, ..last };
    let branches = skeleton.branches(&skeleton.adjacency());
    follows(&skeleton, &whole, &branches.list[0], &whole.pieces[0])
}

#[test]
fn tubes_may_be_shorter_than_the_axis_by_four_radii() {
    assert_eq!(through(1.0, 1.0), Ok(()));
    // The chord is shorter than the axis by 0.94, and by 1.26.
    assert_eq!(through(2.0, 0.0), Ok(()));
    assert!(through(2.34, 0.0).is_err());
    assert!(through(1.0, 1.01).is_err(), "longer than the axis");
}

#[test]
fn every_node_is_in_the_cluster_of_its_piece() {
    let sound = Sound::new();
    for (c, cluster) in sound.partition.clusters.iter().enumerate() {
        for (i, &node) in cluster.nodes.iter().enumerate() {
            let missing = sound.after(|p| {
                p.clusters[c].nodes.remove(i);
            });
            assert_eq!(missing, Err(PartitionFlaw::Node { node }));
            let elsewhere = sound.after(|p| {
                p.clusters[c].nodes.remove(i);
                p.clusters[1 - c].nodes.push(node);
            });
            assert_eq!(elsewhere, Err(PartitionFlaw::Node { node }));
            assert_eq!(sound.after(|p| p.clusters[c].nodes.push(node)), Err(PartitionFlaw::Node { node }));
        }
    }
}

#[test]
fn nodes_on_planes_may_be_in_any_cluster_or_none() {
    let sound = Sound::new();
    let [from, to] = sound.partition.cut_arcs[0];
    let branches = sound.skeleton.branches(&sound.skeleton.adjacency());
    let mut branches = branches.list;
    let branch = &mut branches[sound.partition.cuts[0].branch.0 as usize];
    let ends = branch.ends();
    assert_eq!(branch.nodes, ends);
    // Two more nodes on the branch, which this check takes from the list of branches alone.
    let mut skeleton = sound.skeleton.clone();
    let [a, b] = [0, 1].map(|i| NodeId((skeleton.nodes.len() + i) as u32));
    skeleton.nodes.extend_from_within(..2);
    (branch.nodes, branch.arc) = (vec![ends[0], a, b, ends[1]], vec![0.0, from, to, branch.arc[1]]);
    let mut changed = sound.partition.clone();
    assert_eq!(nodes(&skeleton, &changed, &branches), Ok(()));
    changed.clusters[0].nodes.extend([a, b]);
    assert_eq!(nodes(&skeleton, &changed, &branches), Ok(()));
    // Within a piece, it has to be in its cluster.
    let branch = &mut branches[sound.partition.cuts[0].branch.0 as usize];
    branch.arc[1] = 0.5 * from;
    branch.arc[2] = 0.5 * (to + branch.arc[3]);
    let of_piece = |i: usize| sound.partition.pieces[sound.pieces[i]].cluster.0 as usize;
    let wrong = [a, b][usize::from(of_piece(0) == 0)];
    assert_eq!(nodes(&skeleton, &changed, &branches), Err(PartitionFlaw::Node { node: wrong }));
}

#[test]
fn clusters_are_connected() {
    let sound = Sound::new();
    let merged = sound.after(|p| {
        let second = p.clusters.pop().expect("a cluster");
        let (tubes, ends) = (p.clusters[0].tubes.len() as u32, p.clusters[0].ends.len() as u32);
        for piece in p.pieces.iter_mut().filter(|piece| piece.cluster == ClusterId(1)) {
            piece.cluster = ClusterId(0);
            piece.tubes = piece.tubes.start + tubes..piece.tubes.end + tubes;
        }
        for side in p.cuts[0].sides.iter_mut().filter(|side| side.0 == ClusterId(1)) {
            *side = (ClusterId(0), side.1 + ends);
        }
        let first = &mut p.clusters[0];
        first.nodes.extend(second.nodes);
        first.tubes.extend(second.tubes);
        first.ends.extend(second.ends.into_iter().map(|end| ClusterEnd { overrun: end.overrun + tubes, ..end }));
    });
    assert_eq!(merged, Err(PartitionFlaw::Disconnected { cluster: ClusterId(0) }));
    let empty = sound.after(|p| p.clusters.push(Cluster::default()));
    assert_eq!(empty, Err(PartitionFlaw::Disconnected { cluster: ClusterId(2) }));
}

#[test]
fn ends_name_their_cut_or_terminal() {
    let sound = Sound::new();
    let terminals: Vec<(u32, NodeId)> = (0..)
        .zip(&sound.partition.clusters[0].ends)
        .filter_map(|(i, end)| if let EndKind::Terminal(node) = end.kind { Some((i, node)) } else { None })
        .collect();
    let (end, other) = (terminals[0].0, terminals[1].1);
    let place = (ClusterId(0), end);
    let flaw = Err(PartitionFlaw::End { cluster: ClusterId(0), end });
    assert_eq!(sound.after(|p| end_of(p, place).kind = EndKind::Terminal(other)), flaw);
    assert_eq!(sound.after(|p| end_of(p, place).kind = EndKind::Terminal(NodeId(77))), flaw);
    assert_eq!(sound.after(|p| end_of(p, place).kind = EndKind::Cut { cut: CutId(0), side: 2 }), flaw);
    assert_eq!(sound.after(|p| end_of(p, place).overrun = p.clusters[0].tubes.len() as u32), flaw);
}

#[test]
fn ends_continue_their_vessel_outwards() {
    let sound = Sound::new();
    for side in sound.sides() {
        let is_direction = |change: &dyn Fn(&mut Partition)| {
            let (cluster, end) = side;
            match sound.after(change) {
                Err(PartitionFlaw::Direction { cluster: c, end: e }) => (c, e) == (cluster, end),
                // The plane has changed, and the path of the cut has not.
                Err(PartitionFlaw::Path { .. }) | Ok(()) => false,
                other => panic!("{other:?}"),
            }
        };
        let mut copy = sound.partition.clone();
        let axis = end_of(&mut copy, side).section.axis;
        let aside = axis.cross(&Vec3::z());
        let tilt = |share: f64| {
            move |p: &mut Partition| {
                let tube = overrun(p, side);
                tube.b += aside * share * (tube.b - tube.a).norm();
            }
        };
        assert!(!is_direction(&tilt(0.9e-6)));
        assert!(is_direction(&tilt(1.1e-6)));
        assert!(is_direction(&tilt(1e-2)));
        assert!(is_direction(&|p| overrun(p, side).ra = 0.31));
        assert!(is_direction(&|p| {
            let tube = overrun(p, side);
            tube.a += axis * 0.01;
            tube.b += axis * 0.01;
        }));
        assert!(is_direction(&|p| {
            let tube = overrun(p, side);
            tube.b = tube.a - (tube.b - tube.a);
        }));
        assert!(is_direction(&|p| end_of(p, side).section.axis *= 1.1));
        // Plane and overrun move together, away from the tubes of the piece: 1e-6 of the radius is allowed.
        let moved = |share: f64| {
            move |p: &mut Partition| {
                let origin = &mut end_of(p, side).section.origin;
                *origin += axis * share * 0.3;
                overrun(p, side).a = end_of(p, side).section.origin;
            }
        };
        assert!(!is_direction(&moved(0.9e-6)));
        assert!(is_direction(&moved(1.1e-6)));
        // Plane and overrun get another radius: 1e-9 of it is allowed.
        let wider = |share: f64| {
            move |p: &mut Partition| {
                let radius = &mut end_of(p, side).section.radius;
                *radius *= 1.0 + share;
                overrun(p, side).ra = end_of(p, side).section.radius;
            }
        };
        assert!(!is_direction(&wider(0.9e-9)));
        assert!(is_direction(&wider(1.1e-9)));
        assert!(is_direction(&wider(0.1)));
        // Plane and overrun turn together.
        assert!(is_direction(&|p| {
            end_of(p, side).section.axis = aside;
            let tube = overrun(p, side);
            tube.b = tube.a + aside;
        }));
    }
}

#[test]
fn paths_join_their_planes() {
    let sound = Sound::new();
    let count = sound.partition.cuts[0].path.len();
    let flaw = |section| Err(PartitionFlaw::Path { cut: CutId(0), section });
    assert!(count >= 2);
    assert_eq!(sound.after(|p| p.cuts[0].path[0].origin.x += 1e-9), flaw(0));
    assert_eq!(sound.after(|p| p.cuts[0].path[count - 1].origin.x += 1e-9), flaw(count - 1));
    assert_eq!(sound.after(|p| p.cuts[0].path.clear()), flaw(0));
    // The last section twice.
    let twice = sound.after(|p| p.cuts[0].path.extend_from_within(count - 1..));
    assert_eq!(twice, flaw(count));
}

#[test]
fn discs_of_a_path_do_not_intersect() {
    let disc = |x: f64, degrees: f64, radius: f64| {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        Section::new(Point3::new(x, 0.0, 0.0), Vec3::new(cos, sin, 0.0), radius)
    };
    let start = disc(0.0, 0.0, 1.0);
    assert!(follows_clear(&start, &disc(0.1, 0.0, 1.0)));
    assert!(!follows_clear(&start, &disc(-0.1, 0.0, 1.0)));
    assert!(!follows_clear(&start, &disc(0.0, 0.0, 1.0)));
    assert!(!follows_clear(&start, &disc(0.1, 180.0, 1.0)));
    assert!(!follows_clear(&start, &disc(2.0, 100.0, 1.0)));
    // Sine of 30 degrees: one half.
    assert!(follows_clear(&start, &disc(0.6, 30.0, 1.0)));
    assert!(!follows_clear(&start, &disc(0.45, 30.0, 1.0)));
    // The wider disc cuts the plane of the narrow one, or has its own plane cut by it.
    assert!(!follows_clear(&start, &disc(0.6, 30.0, 1.5)));
    assert!(!follows_clear(&disc(0.0, 0.0, 1.5), &disc(0.6, 30.0, 1.0)));
}
