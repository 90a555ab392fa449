use super::branch::Place;
use super::*;
use anastomesh_mesh::geometry::Point3;
use proptest::prelude::*;

/// A skeleton with unit radii and distinct lattice points as nodes.
pub(super) fn skeleton(nodes: u32, edges: &[(u32, u32)]) -> Skeleton {
    let position = |i: u32| Point3::new(f64::from(i % 7) * 3.0, f64::from(i / 7 % 7) * 4.0, f64::from(i / 49) * 5.0);
    Skeleton {
        nodes: (0..nodes).map(|i| Node { position: position(i), radius: 1.0, original: i }).collect(),
        edges: edges.iter().map(|&(a, b)| Edge { nodes: [NodeId(a), NodeId(b)], radii: [1.0, 1.0] }).collect(),
    }
}

fn check_branches(s: &Skeleton) -> Branches {
    let adjacency = s.adjacency();
    let branches = s.branches(&adjacency);
    assert_eq!(branches.list.iter().map(|b| b.edges.len()).sum::<usize>(), s.edges.len());
    for (id, branch) in branches.list.iter().enumerate() {
        assert_eq!(branch.nodes.len(), branch.edges.len() + 1);
        assert_eq!(branch.arc.len(), branch.nodes.len());
        for (i, &edge) in branch.edges.iter().enumerate() {
            assert_eq!(branches.of_edge[edge.index()], (BranchId(id as u32), i as u32));
            let [a, b] = s.edge(edge).nodes;
            let (from, to) = (branch.nodes[i], branch.nodes[i + 1]);
            assert!((a, b) == (from, to) || (b, a) == (from, to));
            let tube = branch.tube(s, i);
            assert_eq!((tube.a, tube.b), (s.node(from).position, s.node(to).position));
        }
        let inner = &branch.nodes[1..branch.nodes.len() - 1];
        assert!(inner.iter().all(|&n| adjacency.valence(n) == 2));
        let ring = branch.is_closed() && adjacency.valence(branch.nodes[0]) == 2;
        assert!(ring || branch.ends().iter().all(|&n| adjacency.valence(n) != 2));
    }
    branches
}

proptest! {
    #[test]
    fn branches_and_components_of_any_graph(edges in prop::collection::vec((0..20_u32, 0..20_u32), 0..40)) {
        let s = skeleton(20, &edges);
        check_branches(&s);
        let adjacency = s.adjacency();
        let components = s.components(&adjacency);
        prop_assert_eq!(components.list.iter().map(|c| c.nodes.len()).sum::<usize>(), 20);
        prop_assert_eq!(components.list.iter().map(|c| c.edges.len()).sum::<usize>(), edges.len());
        for edge in &s.edges {
            prop_assert_eq!(components.of_node[edge.nodes[0].index()], components.of_node[edge.nodes[1].index()]);
        }
        // A spanning forest has nodes − components edges; every other edge closes a loop.
        let loops: usize = components.list.iter().map(Component::loops).sum();
        prop_assert_eq!(loops + 20, edges.len() + components.list.len());
    }
}

#[test]
fn chains_rings_and_lassos() {
    // A chain 0-1-2, a ring 3-4-5, a lasso 6-7 with the loop 7-8-9-7.
    let s = skeleton(10, &[(1, 0), (1, 2), (3, 4), (4, 5), (5, 3), (6, 7), (7, 8), (8, 9), (9, 7)]);
    let branches = check_branches(&s);
    let lengths: Vec<usize> = branches.list.iter().map(|b| b.edges.len()).collect();
    assert_eq!(lengths, [2, 1, 3, 3]);
    let closed: Vec<bool> = branches.list.iter().map(Branch::is_closed).collect();
    assert_eq!(closed, [false, false, true, true]);
    let components = s.components(&s.adjacency());
    assert_eq!(components.list.iter().map(Component::loops).collect::<Vec<_>>(), [0, 1, 1]);
    assert_eq!(s.roots(&s.adjacency(), &components), [Some(NodeId(0)), None, Some(NodeId(6))]);
    assert_eq!(s.check(), Ok(()));
}

#[test]
fn places_on_a_branch() {
    let s = skeleton(3, &[(1, 0), (1, 2)]);
    let branches = s.branches(&s.adjacency());
    let branch = &branches.list[0];
    assert!((branch.length() - 6.0).abs() < 1e-15);
    assert_eq!(branch.locate(3.0), Place { piece: 1, t: 0.0 });
    assert_eq!(branch.locate(6.0), Place { piece: 1, t: 1.0 });
    assert_eq!(branch.locate(-1.0), Place { piece: 0, t: 0.0 });
    assert_eq!(branch.locate(9.0), Place { piece: 1, t: 1.0 });
    assert!((branch.point(&s, 4.5) - Point3::new(4.5, 0.0, 0.0)).norm() < 1e-15);
    assert!((branch.section(&s, 1.0).axis - anastomesh_mesh::geometry::Vec3::x()).norm() < 1e-15);
}

#[test]
fn a_very_long_chain_needs_no_stack() {
    let edges: Vec<(u32, u32)> = (1..300_000).map(|i| (i - 1, i)).collect();
    let s = skeleton(300_000, &edges);
    assert_eq!(check_branches(&s).list.len(), 1);
    assert_eq!(s.components(&s.adjacency()).list.len(), 1);
}

#[test]
fn check_finds_each_violation() {
    let good = skeleton(3, &[(0, 1), (1, 2)]);
    assert_eq!(good.check(), Ok(()));
    let broken = |f: &dyn Fn(&mut Skeleton)| {
        let mut s = good.clone();
        f(&mut s);
        s.check().unwrap_err()
    };
    assert!(matches!(broken(&|s| s.edges.clear()), SkeletonError::NoVessel { nodes: 3 }));
    assert!(matches!(broken(&|s| s.nodes[1].position.x = f64::NAN), SkeletonError::BadPosition { original: 1, .. }));
    assert!(matches!(broken(&|s| s.nodes[2].radius = 0.0), SkeletonError::BadNodeRadius { original: 2, .. }));
    assert!(matches!(broken(&|s| s.edges[0].radii[1] = -1.0), SkeletonError::BadEdgeRadius { edge: EdgeId(0), .. }));
    assert!(matches!(broken(&|s| s.edges[1].nodes[1].0 = 9), SkeletonError::UnknownNode { edge: EdgeId(1), .. }));
    assert!(matches!(broken(&|s| s.edges[1].nodes[1].0 = 1), SkeletonError::NoLength { edge: EdgeId(1) }));
    assert!(matches!(broken(&|s| s.edges[1].nodes = [NodeId(1), NodeId(0)]), SkeletonError::RepeatedEdge { .. }));
    assert!(matches!(
        broken(&|s| {
            s.edges.pop();
        }),
        SkeletonError::Isolated { node: NodeId(2) }
    ));
}
