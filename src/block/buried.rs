//! Buried tips, which lie within another vessel and cannot be capped.

use crate::partition::{Cluster, ClusterEnd, EndKind};
use anastomesh_mesh::geometry::{Point3, Tube, point_segment};
use anastomesh_skeleton::NodeId;

/// Terminals whose whole disc lies within the tube of another vessel, with their indices in `Cluster::ends`. The wall
/// encloses that vessel, and none exists at the tip.
pub(crate) fn buried(cluster: &Cluster) -> impl Iterator<Item = (u32, NodeId, &ClusterEnd)> {
    let mut beyond = vec![false; cluster.tubes.len()];
    for end in &cluster.ends {
        beyond[end.overrun as usize] = true;
    }
    (0..).zip(&cluster.ends).filter_map(move |(i, end)| match end.kind {
        EndKind::Terminal(node) => is_buried(&cluster.tubes, &beyond, end).then_some((i, node, end)),
        EndKind::Cut { .. } => None,
    })
}

/// `beyond` flags the tubes beyond the ends.
fn is_buried(tubes: &[Tube], beyond: &[bool], end: &ClusterEnd) -> bool {
    let (tip, radius) = (end.section.origin, end.section.radius);
    let covers = |i: &usize| {
        let (t, distance) = point_segment(&tip, &tubes[*i].a, &tubes[*i].b);
        distance + radius <= tubes[*i].radius(t)
    };
    let ends_here = |i: &usize| [tubes[*i].a, tubes[*i].b].contains(&tip);
    let other = |i: &usize| !beyond[*i] && !ends_here(i);
    let mut covering = (0..tubes.len()).filter(other).filter(covers).peekable();
    if covering.peek().is_none() {
        return false;
    }
    let own = own_vessel(tubes, beyond, tip);
    covering.any(|i| !own.contains(&i))
}

/// Tubes from a tip to the next branch point.
fn own_vessel(tubes: &[Tube], beyond: &[bool], tip: Point3) -> Vec<usize> {
    let mut own: Vec<usize> = Vec::new();
    let mut place = tip;
    loop {
        let touches = |i: &usize| [tubes[*i].a, tubes[*i].b].contains(&place) && !beyond[*i];
        let mut onward = (0..tubes.len()).filter(touches).filter(|i| !own.contains(i));
        let (Some(next), None) = (onward.next(), onward.next()) else { return own };
        own.push(next);
        place = if tubes[next].a == place { tubes[next].b } else { tubes[next].a };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::fixtures::bifurcation;

    #[test]
    fn a_tip_is_buried_where_its_disc_lies_in_another_vessel() {
        let cluster = bifurcation(3);
        assert_eq!(buried(&cluster).count(), 0);
        let (i, tip) = (0..).zip(&cluster.ends).find(|(_, e)| matches!(e.kind, EndKind::Terminal(_))).expect("a tip");
        let around = |radius: f64| {
            let mut crowded = cluster.clone();
            let (tip, aside) = (tip.section.origin, tip.section.frame().0 * 0.5);
            crowded.tubes.push(Tube { a: tip + aside, b: tip + aside * 9.0, ra: radius, rb: radius });
            buried(&crowded).map(|(end, _, _)| end).collect::<Vec<u32>>()
        };
        assert_eq!(around(tip.section.radius), Vec::<u32>::new());
        assert_eq!(around(tip.section.radius + 0.51), [i]);
    }

    #[test]
    fn a_vessel_does_not_bury_its_own_tip() {
        let mut end = bifurcation(3).ends[0].clone();
        end.section.origin = Point3::origin();
        end.section.radius = 1.0;
        let tube = |a: [f64; 3], b: [f64; 3], radius: f64| Tube { a: a.into(), b: b.into(), ra: radius, rb: radius };
        // The wide part of the vessel returns to its tip. The tube beyond the end touches the tip, too.
        let mut tubes = vec![
            tube([20.0, 0.0, 0.0], [30.0, 0.0, 0.0], 1.0),
            tube([0.0; 3], [8.0, 0.0, 0.0], 1.0),
            tube([0.0; 3], [-4.0, 0.0, 0.0], 1.0),
            tube([8.0, 0.0, 0.0], [8.0, 6.0, 0.0], 3.0),
            tube([8.0, 6.0, 0.0], [0.0, 1.0, 0.0], 3.0),
        ];
        let beyond = [false, false, true, false, false, false];
        assert_eq!(own_vessel(&tubes, &beyond, end.section.origin), [1, 3, 4]);
        assert!(!is_buried(&tubes, &beyond, &end));
        // A tube beyond another end.
        tubes.push(tube([0.0, 2.0, 0.0], [0.0, -2.0, 0.0], 3.0));
        assert!(!is_buried(&tubes, &[false, false, true, false, false, true], &end));
        tubes[5] = tube([8.0, 6.0, 0.0], [8.0, 20.0, 0.0], 1.0);
        assert_eq!(own_vessel(&tubes, &beyond, end.section.origin), [1, 3]);
        assert!(is_buried(&tubes, &beyond, &end));
    }
}
