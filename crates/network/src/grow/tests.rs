use super::organ::Shape;
use super::random::Random;
use super::*;
use anastomesh_mesh::geometry::Vec3;
use anastomesh_skeleton::{NodeId, Skeleton};
use std::collections::HashSet;

fn params(organ: Organ, terminals: u32, seed: u64) -> GenerateParams {
    GenerateParams { seed, ..GenerateParams::new(organ, terminals) }
}

fn grown(organ: Organ, terminals: u32, seed: u64) -> Skeleton {
    generate(&params(organ, terminals, seed)).unwrap_or_else(|e| panic!("{e}"))
}

/// Invariants of every grown network.
fn check(s: &Skeleton, p: &GenerateParams) {
    s.check().unwrap_or_else(|e| panic!("{p:?}: {e}"));
    let n = p.terminals as usize;
    assert_eq!((s.nodes.len(), s.edges.len()), (2 * n, 2 * n - 1), "{p:?}");
    let adjacency = s.adjacency();
    let components = s.components(&adjacency);
    assert_eq!((components.list.len(), components.list[0].loops()), (1, 0), "{p:?}");
    assert_eq!(adjacency.terminals().len(), n + 1, "{p:?}");
    assert_eq!(s.roots(&adjacency, &components), [Some(NodeId(0))], "{p:?}");
    for node in s.node_ids().skip(1) {
        let edges = adjacency.edges(node);
        assert!(edges.len() == 1 || edges.len() == 3, "{p:?}: {node:?}");
        // Murray's law; terminals vary a little around their radius.
        let [up, down @ ..] = edges else { panic!("no edge") };
        let power = |e: &anastomesh_skeleton::EdgeId| libm::pow(s.edge(*e).radii[0], p.exponent);
        match down {
            [] => assert!((s.edge(*up).radii[0] / p.terminal_radius - 1.0).abs() < 0.05),
            _ => assert!((power(up) / down.iter().map(power).sum::<f64>() - 1.0).abs() < 1e-9),
        }
    }
    for (id, edge) in s.edge_ids().zip(&s.edges) {
        assert!(edge.nodes[0] < edge.nodes[1] && edge.radii[0] == edge.radii[1]);
        assert!(s.length(id) > edge.radii[0], "{p:?}: edge {id:?} of {} radii", s.length(id) / edge.radii[0]);
    }
}

#[test]
fn networks_of_all_sizes_are_trees_by_murrays_law() {
    for organ in [Organ::Kidney, Organ::Ellipsoid] {
        for terminals in (2..40).chain([100, 333, 1000, 4000]) {
            for seed in 0..3 {
                let p = params(organ, terminals, seed);
                check(&grown(organ, terminals, seed), &p);
            }
        }
    }
    let odd =
        GenerateParams { exponent: 2.3, terminal_radius: 0.004, size: Some(40.0), ..params(Organ::Ellipsoid, 500, 9) };
    check(&generate(&odd).expect("possible"), &odd);
}

#[test]
fn a_seed_gives_one_network_for_any_number_of_threads() {
    let of = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| grown(Organ::Kidney, 6000, seed))
    };
    assert_eq!(of(1, 5), of(3, 5));
    assert_ne!(of(2, 5), of(2, 6));
}

#[test]
fn vessels_of_each_order_are_as_in_a_rats_kidney() {
    for seed in 0..2 {
        let s = grown(Organ::Kidney, 29_566, seed);
        let orders = Morphometry::of(&s).orders;
        assert_eq!(orders.len(), RAT_KIDNEY.len());
        for (order, (ours, theirs)) in orders.iter().zip(&RAT_KIDNEY).enumerate() {
            let off = |value: f64, [mean, deviation]: [f64; 2]| ((value - mean).abs(), deviation, mean);
            // Counts: within the deviation, plus two for orders 6 and 7, where it is 6 and 1.
            let (count, deviation, _) = off(ours.count as f64, theirs.count);
            assert!(count <= deviation + if (6..8).contains(&order) { 2.0 } else { 0.0 }, "{seed} {order} {ours:?}");
            // Radii: within the deviation, or 18 % if no exponent of Murray's law reaches the deviation.
            let (radius, deviation, mean) = off(ours.radius, theirs.radius);
            assert!(radius <= deviation.max(0.18 * mean), "{seed} {order} {ours:?}");
            // Lengths: within the deviation, except for order 4 and orders without deviation or with few vessels.
            let (length, deviation, _) = off(ours.length, theirs.length);
            assert!(length <= deviation || [4, 5, 8, 9, 10].contains(&order), "{seed} {order} {ours:?}");
        }
    }
}

#[test]
fn terminals_fill_the_organ_evenly() {
    for organ in [Organ::Kidney, Organ::Ellipsoid] {
        let p = params(organ, 8000, 1);
        let s = grown(organ, 8000, 1);
        let shape = Shape::new(organ, p.resolved_size(), Random::new(1));
        let adjacency = s.adjacency();
        let ends: Vec<Vec3> = adjacency.terminals().iter().skip(1).map(|n| s.node(*n).position.coords).collect();
        let outside = ends.iter().filter(|e| !shape.holds(&(**e).into())).count();
        assert!(outside < 200, "{organ:?}: {outside}");
        // Each octant of the half away from the hilum has about an eighth of the terminals.
        for octant in 0..8 {
            let sign = |axis: usize| if octant >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let here = ends.iter().filter(|e| (0..3).all(|axis| e[axis] * sign(axis) > 0.0)).count();
            let least = if organ == Organ::Kidney && octant & 1 == 1 { 600 } else { 900 };
            assert!((least..1300).contains(&here), "{organ:?}: {here} in octant {octant}");
        }
        // No coinciding terminals: cells of half the spacing rarely contain more than one.
        let cell = 0.5 * shape.spacing(8000);
        let cells: HashSet<[i64; 3]> = ends.iter().map(|e| [0, 1, 2].map(|i| (e[i] / cell).floor() as i64)).collect();
        assert!(cells.len() > 7700, "{organ:?}: {}", cells.len());
    }
}

#[test]
fn few_vessels_overlap() {
    for (organ, most) in [(Organ::Kidney, 150), (Organ::Ellipsoid, 400)] {
        let s = grown(organ, 3000, 1);
        let overlaps = s.overlaps(&s.adjacency());
        assert!(overlaps.pairs.len() < most, "{organ:?}: {}", overlaps.pairs.len());
    }
}

#[test]
fn what_cannot_be_grown_is_refused() {
    let usual = params(Organ::Kidney, 100, 0);
    let wrong = [
        GenerateParams { terminals: 1, ..usual },
        GenerateParams { terminals: u32::MAX, ..usual },
        GenerateParams { terminal_radius: 0.0, ..usual },
        GenerateParams { terminal_radius: f64::NAN, ..usual },
        GenerateParams { terminal_radius: 1e-300, ..usual },
        GenerateParams { exponent: 0.5, ..usual },
        GenerateParams { exponent: 1.5, terminals: 30_000, ..usual },
        GenerateParams { exponent: f64::INFINITY, ..usual },
        GenerateParams { size: Some(-1.0), ..usual },
        GenerateParams { size: Some(f64::NAN), ..usual },
        GenerateParams { size: Some(1e12), ..usual },
        GenerateParams { size: Some(200.0), ..usual },
    ];
    for p in wrong {
        assert!(generate(&p).is_err(), "{p:?}");
    }
    let Err(GenerateError::TooDense { least, .. }) = generate(&GenerateParams { size: Some(200.0), ..usual }) else {
        panic!("not too dense")
    };
    assert!(generate(&GenerateParams { size: Some(1.01 * least), ..usual }).is_ok());
}
