use super::*;
use crate::plan::{FlowPlan, FlowSolution, Inflow, InletSite};
use anastomesh_skeleton::fixtures::{network, tangle};
use std::f64::consts::PI;

const RATE: f64 = 2.0;
const DISTAL: f64 = 100.0;

/// A vessel that divides into one of radius 0.4 and one of 0.2, and a straight vessel beside it.
fn two() -> Skeleton {
    let points = [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [-1.0, 0.0, 2.0], [9.0, 0.0, 0.0], [9.0, 0.0, 5.0]];
    let mut network = network(&points, 0.4, &[(0, 1), (1, 2), (1, 3), (4, 5)]);
    network.edges[2].radii = [0.2; 2];
    network
}

fn solve(network: &Skeleton, inlets: &[u32], outlets: OutletPlan) -> Result<FlowSolution, FlowError> {
    let site = |&node: &u32| InletSite { node: NodeId(node), patch: "inlet".into(), name: String::new(), radius: 0.4 };
    let inlets: Vec<InletSite> = inlets.iter().map(site).collect();
    let plan = FlowPlan::default().viscosity(10.0).inflow(Inflow::Rate(RATE));
    plan.outlets(outlets.distal_pressure(DISTAL)).solve(network, &inlets, &|node| format!("n{node}"))
}

fn resistances(reference: Reference, split: OutletSplit) -> OutletPlan {
    OutletPlan::default().kind(OutletKind::Resistance).reference(Some(reference)).split(split)
}

fn flows(solution: &FlowSolution) -> Vec<f64> {
    solution.outlets.keys().map(|node| solution.flow.of_terminal[node]).collect()
}

/// Pressure at each outlet equals that of its model.
fn assert_consistent(solution: &FlowSolution) {
    for (node, model) in &solution.outlets {
        let pressure = model.mean_pressure(solution.flow.of_terminal[node]);
        assert!((solution.flow.pressure[node.index()] / pressure - 1.0).abs() < 1e-12);
    }
}

#[test]
fn resistances_in_parallel_are_the_total_and_keep_the_flows() {
    let free = solve(&two(), &[0, 4], OutletPlan::default()).unwrap();
    let plan = resistances(Reference::TotalResistance(7.0), OutletSplit::Network);
    let solution = solve(&two(), &[0, 4], plan).unwrap();
    assert_consistent(&solution);
    let conductance: f64 = solution.outlets.values().map(|model| 1.0 / model.resistance()).sum();
    assert!((7.0 * conductance - 1.0).abs() < 1e-12);
    for (flow, free) in flows(&solution).iter().zip(flows(&free)) {
        assert!((flow / free - 1.0).abs() < 1e-12);
    }
    // All outlets have the pressure of the total flow rate.
    assert!((solution.flow.pressure[2] - DISTAL - 7.0 * 2.0 * RATE).abs() < 1e-9);
}

#[test]
fn a_mean_pressure_is_reached_at_each_component() {
    let trunk_drop = solve(&two(), &[0, 4], OutletPlan::default()).unwrap().flow.pressure[0] - DISTAL;
    let tube_drop = 8.0 * 10.0 * 5.0 * RATE / (PI * 0.4_f64.powi(4));
    let wanted = DISTAL + 1.5 * trunk_drop.max(tube_drop);
    for split in [OutletSplit::Network, OutletSplit::Murray { exponent: 3.0 }, OutletSplit::Murray { exponent: 2.0 }] {
        let solution = solve(&two(), &[0, 4], resistances(Reference::MeanPressure(wanted), split)).unwrap();
        assert_consistent(&solution);
        for inlet in [0, 4] {
            assert!((solution.flow.pressure[inlet] / wanted - 1.0).abs() < 1e-10, "{split:?}");
        }
        let [wide, thin, tube] = [2, 3, 5].map(|node| solution.outlets[&NodeId(node)].resistance());
        assert!((tube - (wanted - DISTAL - tube_drop) / RATE).abs() < 1e-9 * tube);
        if let OutletSplit::Murray { exponent } = split {
            assert!((thin / wide / libm::pow(2_f64, exponent) - 1.0).abs() < 1e-12);
        }
    }
    let low = Reference::MeanPressure(DISTAL + 0.99 * trunk_drop.max(tube_drop));
    let error = solve(&two(), &[0, 4], resistances(low, OutletSplit::Network)).unwrap_err();
    assert!(matches!(error, FlowError::PressureTooLow { .. }), "{error}");
}

#[test]
fn a_tree_of_thousands_of_outlets_reaches_its_mean_pressure() {
    let tree = tangle(12, 3);
    let drop = solve(&tree, &[0], OutletPlan::default()).unwrap().flow.pressure[0] - DISTAL;
    let wanted = DISTAL + 1.01 * drop;
    let plan = resistances(Reference::MeanPressure(wanted), OutletSplit::Murray { exponent: 3.0 });
    let solution = solve(&tree, &[0], plan).unwrap();
    assert_consistent(&solution);
    assert!((solution.flow.pressure[0] / wanted - 1.0).abs() < 1e-10);
    assert!((flows(&solution).iter().sum::<f64>() / RATE - 1.0).abs() < 1e-10);
}

#[test]
fn a_windkessel_has_the_resistance_and_the_time_constant() {
    let kind = OutletKind::Rcr { time_constant: 1.5, proximal_fraction: 0.1 };
    let plan = resistances(Reference::TotalResistance(7.0), OutletSplit::Network);
    let [plain, rcr] = [plan, plan.kind(kind)].map(|plan| solve(&two(), &[0, 4], plan).unwrap());
    for (node, model) in rcr.outlets {
        let OutletModel::Rcr { proximal, capacitance, distal, distal_pressure } = model else { panic!("{model:?}") };
        let resistance = plain.outlets[&node].resistance();
        assert!((proximal / resistance - 0.1).abs() < 1e-12 && (distal / resistance - 0.9).abs() < 1e-12);
        assert!((distal * capacitance / 1.5 - 1.0).abs() < 1e-12);
        assert_eq!(distal_pressure, DISTAL);
    }
}

#[test]
fn structured_trees_begin_with_the_radius_of_their_outlet() {
    let tree = StructuredTree::new(0.05);
    let solution = solve(&two(), &[0, 4], OutletPlan::default().kind(OutletKind::StructuredTree(tree))).unwrap();
    assert_consistent(&solution);
    let expected = |radius| tree.outlet(radius, 1.0, 10.0, DISTAL);
    assert_eq!([2, 3].map(|node| solution.outlets[&NodeId(node)]), [0.4, 0.2].map(expected));
    let thick = OutletPlan::default().kind(OutletKind::StructuredTree(StructuredTree::new(0.3)));
    let error = solve(&two(), &[0, 4], thick).unwrap_err();
    assert!(matches!(&error, FlowError::OutletTooThin { node, .. } if node == "n3"), "{error}");
}

#[test]
fn references_and_ranges_are_checked() {
    let check = |plan: OutletPlan| plan.check().unwrap_err();
    for kind in [OutletKind::Resistance, OutletKind::Rcr { time_constant: 1.0, proximal_fraction: 0.1 }] {
        assert!(matches!(check(OutletPlan::default().kind(kind)), FlowError::NoReference { .. }));
    }
    let plan = resistances(Reference::TotalResistance(1.0), OutletSplit::Network);
    assert!(plan.check().is_ok());
    let faults = [
        plan.reference(Some(Reference::TotalResistance(0.0))),
        plan.reference(Some(Reference::MeanPressure(5.0))).distal_pressure(5.0),
        plan.distal_pressure(f64::INFINITY),
        plan.split(OutletSplit::Murray { exponent: f64::NAN }),
        plan.kind(OutletKind::Rcr { time_constant: 0.0, proximal_fraction: 0.1 }),
        plan.kind(OutletKind::Rcr { time_constant: 1.0, proximal_fraction: 1.0 }),
        plan.kind(OutletKind::StructuredTree(StructuredTree::new(-1.0))),
    ];
    assert!(faults.into_iter().all(|plan| matches!(check(plan), FlowError::OutOfRange { .. })));
}
