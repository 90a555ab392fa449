//! Invariant checks of a partition.

// Arc lengths of neighbouring pieces and connectors are copies of one number.

use super::{BranchPiece, ClusterEnd, ClusterId, CutId, EndKind, Partition};
use anastomesh_mesh::geometry::DisjointSets;
use anastomesh_mesh::geometry::{Point3, Section, Tube};
use anastomesh_skeleton::{Branch, BranchId, NodeId, Skeleton};

/// Violated invariant of a partition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartitionFlaw {
    /// Pieces and connectors do not cover a branch exactly once.
    #[error("branch {} is not covered exactly once near arc length {arc}", branch.0)]
    Coverage {
        /// The branch.
        branch: BranchId,
        /// Arc length of the flaw.
        arc: f64,
    },
    /// The tubes of a piece do not follow the vessel's axis or are not connected.
    #[error("the tubes of cluster {} deviate from branch {} at {at}", cluster.0, branch.0)]
    Tubes {
        /// The cluster.
        cluster: ClusterId,

        /// The branch.
        branch: BranchId,
        /// Position of the flaw.
        at: Point3,
    },
    /// A node is in no cluster, in several clusters, or in the wrong one.
    #[error("node {} is not in exactly one cluster", node.0)]
    Node {
        /// The node.
        node: NodeId,
    },
    /// The pieces of a cluster are not connected.
    #[error("cluster {} is not connected", cluster.0)]
    Disconnected {
        /// The cluster.
        cluster: ClusterId,
    },
    /// An end and its cut do not refer to each other, or a terminal has no end.
    #[error("end {end} of cluster {} does not match its cut or terminal", cluster.0)]
    End {
        /// The cluster.
        cluster: ClusterId,
        /// Index of the end.
        end: u32,
    },
    /// An end's plane or overrun does not continue its vessel outwards.
    #[error("end {end} of cluster {} does not point outwards along its vessel", cluster.0)]
    Direction {
        /// The cluster.
        cluster: ClusterId,
        /// Index of the end.
        end: u32,
    },
    /// A connector's path does not connect the end planes, or its cross-sections intersect.
    #[error("the path of cut {} is invalid at section {section}", cut.0)]
    Path {
        /// The cut.
        cut: CutId,
        /// Index of the section.
        section: usize,
    },
}

/// Checks a partition of a skeleton:
/// - pieces and connectors cover every branch exactly once, and the tubes of each piece follow it;
/// - every node with an edge is in exactly one connected cluster (inside a connector: in none);
/// - ends, cuts and terminals refer to each other; ends point outwards, and vessels cross their planes straight;
/// - connectors run from plane to plane without intersecting cross-sections.
///
/// # Errors
/// Returns the first flaw found.
pub fn check_partition(skeleton: &Skeleton, partition: &Partition) -> Result<(), PartitionFlaw> {
    let adjacency = skeleton.adjacency();
    let branches = skeleton.branches(&adjacency);
    coverage(partition, &branches.list)?;
    for piece in &partition.pieces {
        follows(skeleton, partition, &branches.list[piece.branch.0 as usize], piece)?;
    }
    nodes(skeleton, partition, &branches.list)?;
    connected(skeleton, partition, &branches.list)?;
    for (i, cluster) in partition.clusters.iter().enumerate() {
        for end in 0..cluster.ends.len() as u32 {
            check_end(skeleton, partition, ClusterId(i as u32), end)?;
        }
    }
    let terminals = skeleton.node_ids().filter(|&n| adjacency.valence(n) == 1).count();
    let is_terminal = |e: &&ClusterEnd| matches!(e.kind, EndKind::Terminal(_));
    let capped = partition.clusters.iter().flat_map(|c| &c.ends).filter(is_terminal).count();
    if terminals != capped {
        return Err(PartitionFlaw::End { cluster: ClusterId(0), end: 0 });
    }
    (0..partition.cuts.len()).try_for_each(|cut| check_cut(partition, CutId(cut as u32)))
}

fn coverage(partition: &Partition, branches: &[Branch]) -> Result<(), PartitionFlaw> {
    let mut parts: Vec<(u32, [f64; 2], bool)> = partition.pieces.iter().map(|p| (p.branch.0, p.arc, false)).collect();
    if partition.cut_arcs.len() != partition.cuts.len() {
        return Err(PartitionFlaw::Coverage { branch: BranchId(0), arc: 0.0 });
    }
    let cuts = partition.cuts.iter().zip(&partition.cut_arcs);
    parts.extend(cuts.map(|(cut, &arc)| (cut.branch.0, arc, true)));
    parts.sort_by(|a, b| a.0.cmp(&b.0).then(a.1[0].total_cmp(&b.1[0])));
    let mut rest = parts.as_slice();
    for (id, branch) in branches.iter().enumerate() {
        let flaw = |arc| PartitionFlaw::Coverage { branch: BranchId(id as u32), arc };
        let count = rest.iter().take_while(|p| p.0 == id as u32).count();
        let (own, others) = rest.split_at(count);
        rest = others;
        let mut reached = 0.0;
        for (i, &(_, [lo, hi], cut)) in own.iter().enumerate() {
            // Pieces and connectors alternate, with pieces first and last. Both have a positive length.
            if lo != reached || hi <= lo || cut != (i % 2 == 1) {
                return Err(flaw(lo));
            }
            reached = hi;
        }
        if reached != branch.length() || own.len() % 2 == 0 {
            return Err(flaw(reached));
        }
    }
    rest.first().map_or(Ok(()), |p| Err(PartitionFlaw::Coverage { branch: BranchId(p.0), arc: p.1[0] }))
}

/// Checks that a piece's tubes form a chain from its start to its end, on the axis, with nearly its length.
fn follows(
    skeleton: &Skeleton,
    partition: &Partition,
    branch: &Branch,
    piece: &BranchPiece,
) -> Result<(), PartitionFlaw> {
    let cluster = &partition.clusters[piece.cluster.0 as usize];
    let flaw = |at| PartitionFlaw::Tubes { cluster: piece.cluster, branch: piece.branch, at };
    let range = piece.tubes.start as usize..piece.tubes.end as usize;
    let [lo, hi] = piece.arc;
    let start = branch.point(skeleton, lo);
    let Some(tubes) = cluster.tubes.get(range).filter(|t| !t.is_empty()) else { return Err(flaw(start)) };
    let tolerance = 1e-9 * branch.length();
    let mut at = start;
    let mut length = 0.0;
    for tube in tubes {
        // Written positively so that NaN fails.
        let sound = tube.ra > 0.0 && tube.rb > 0.0 && tube.length() > 0.0;
        if (tube.a - at).norm() > tolerance || !sound {
            return Err(flaw(tube.a));
        }
        // A chord is at most as long as the axis that it replaces.
        length += tube.length();
        at = tube.b;
    }
    let bent = 2.0 * (branch.radius(skeleton, lo) + branch.radius(skeleton, hi));
    let close = (at - branch.point(skeleton, hi)).norm() <= tolerance;
    if !close || length > (hi - lo) + tolerance || length < (hi - lo) - bent {
        return Err(flaw(at));
    }
    Ok(())
}

fn nodes(skeleton: &Skeleton, partition: &Partition, branches: &[Branch]) -> Result<(), PartitionFlaw> {
    const NOWHERE: u32 = u32::MAX;
    let mut of_node = vec![NOWHERE; skeleton.nodes.len()];
    for (i, cluster) in partition.clusters.iter().enumerate() {
        for &node in &cluster.nodes {
            if of_node[node.0 as usize] != NOWHERE {
                return Err(PartitionFlaw::Node { node });
            }
            of_node[node.0 as usize] = i as u32;
        }
    }
    let mut seen = of_node.clone();
    for piece in &partition.pieces {
        let branch = &branches[piece.branch.0 as usize];
        for (&node, s) in branch.nodes.iter().zip(&branch.arc) {
            if (piece.arc[0]..=piece.arc[1]).contains(s) {
                let plane = (*s == piece.arc[0] && *s > 0.0) || (*s == piece.arc[1] && *s < branch.length());
                if !plane && of_node[node.0 as usize] != piece.cluster.0 {
                    return Err(PartitionFlaw::Node { node });
                }
                seen[node.0 as usize] = NOWHERE;
            }
        }
    }
    // Remaining nodes were claimed by a cluster without a piece that contains them.
    seen.iter().position(|&c| c != NOWHERE).map_or(Ok(()), |i| Err(PartitionFlaw::Node { node: NodeId(i as u32) }))
}

/// Checks connectivity: pieces are connected exactly if they share a node at the end of a branch.
fn connected(skeleton: &Skeleton, partition: &Partition, branches: &[Branch]) -> Result<(), PartitionFlaw> {
    let pieces = &partition.pieces;
    let mut sets = DisjointSets::new(pieces.len() + skeleton.nodes.len());
    for (i, piece) in (0..).zip(pieces) {
        let branch = &branches[piece.branch.0 as usize];
        let [a, b] = branch.ends();
        for (node, touches) in [(a, piece.arc[0] == 0.0), (b, piece.arc[1] == branch.length())] {
            if touches {
                sets.join(i, pieces.len() as u32 + node.0);
            }
        }
    }
    let mut of_cluster = vec![None; partition.clusters.len()];
    let mut of_root = vec![None; sets.len()];
    for (i, piece) in (0..).zip(pieces) {
        let own = sets.root(i) as usize;
        let cluster = piece.cluster;
        let same = *of_cluster[cluster.0 as usize].get_or_insert(own) == own;
        if !same || *of_root[own].get_or_insert(cluster) != cluster {
            return Err(PartitionFlaw::Disconnected { cluster });
        }
    }
    let empty = of_cluster.iter().position(Option::is_none);
    empty.map_or(Ok(()), |i| Err(PartitionFlaw::Disconnected { cluster: ClusterId(i as u32) }))
}

fn check_end(skeleton: &Skeleton, partition: &Partition, id: ClusterId, index: u32) -> Result<(), PartitionFlaw> {
    let cluster = &partition.clusters[id.0 as usize];
    let end = &cluster.ends[index as usize];
    let named = match end.kind {
        EndKind::Cut { cut, side } => {
            let cut = partition.cuts.get(cut.0 as usize);
            cut.and_then(|c| c.sides.get(side as usize)) == Some(&(id, index))
        }
        EndKind::Terminal(node) => {
            let at = skeleton.nodes.get(node.0 as usize).map(|n| n.position);
            at == Some(end.section.origin) && cluster.nodes.contains(&node)
        }
    };
    if !named || end.overrun as usize >= cluster.tubes.len() {
        return Err(PartitionFlaw::End { cluster: id, end: index });
    }
    let section = &end.section;
    let tolerance = 1e-6;
    let along = |t: &Tube| {
        let d = t.b - t.a;
        d.dot(&section.axis) > 0.0 && d.cross(&section.axis).norm() <= tolerance * d.norm()
    };
    // The overrun starts at the plane, and a tube of a piece ends there; both follow the axis.
    let overrun = &cluster.tubes[end.overrun as usize];
    let leaves = overrun.a == section.origin && overrun.ra == section.radius && along(overrun);
    let mut tubes = cluster.tubes.iter().enumerate().filter(|(i, _)| *i != end.overrun as usize);
    let close = |p: &Point3| (p - section.origin).norm() <= tolerance * section.radius;
    let arrives = tubes.any(|(_, t)| {
        let back = Tube { a: t.b, b: t.a, ra: t.rb, rb: t.ra };
        (close(&t.b) && along(t) && close_to(t.rb, section.radius))
            || (close(&back.b) && along(&back) && close_to(back.rb, section.radius))
    });
    let unit = close_to(section.axis.norm(), 1.0);
    if unit && leaves && arrives {
        return Ok(());
    }
    Err(PartitionFlaw::Direction { cluster: id, end: index })
}

fn close_to(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

fn check_cut(partition: &Partition, id: CutId) -> Result<(), PartitionFlaw> {
    let cut = &partition.cuts[id.0 as usize];
    let flaw = |section| PartitionFlaw::Path { cut: id, section };
    let end = |side: usize| {
        let (cluster, end) = cut.sides[side];
        let end = partition.clusters.get(cluster.0 as usize)?.ends.get(end as usize)?;
        (end.kind == EndKind::Cut { cut: id, side: side as u8 }).then_some(end.section)
    };
    let (Some(first), Some(mut last)) = (end(0), end(1)) else { return Err(flaw(0)) };
    last.axis = -last.axis;
    if cut.path.len() < 2 || cut.path[0] != first {
        return Err(flaw(0));
    }
    let end = cut.path.len() - 1;
    if cut.path[end] != last {
        return Err(flaw(end));
    }
    let meet = cut.path.windows(2).position(|s| !follows_clear(&s[0], &s[1]));
    meet.map_or(Ok(()), |i| Err(flaw(i + 1)))
}

/// True if the discs of `a` and `b` do not intersect, in this order along the path.
fn follows_clear(a: &Section, b: &Section) -> bool {
    // Extent of a disc over a plane: its centre minus the radius times the sine of the angle between the axes.
    let sine = a.axis.cross(&b.axis).norm();
    a.axis.dot(&b.axis) > 0.0 && a.height(&b.origin) > sine * b.radius && -b.height(&a.origin) > sine * a.radius
}

#[cfg(test)]
#[path = "check_tests.rs"]
mod tests;
