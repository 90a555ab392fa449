use super::*;
use anastomesh_skeleton::fixtures::network;

fn waveform(rates: [f64; 3]) -> Waveform {
    Waveform::new(vec![0.0, 0.5, 1.0], rates.to_vec()).unwrap()
}

fn table(columns: &[(&str, [f64; 3])]) -> Inflow {
    Inflow::Table(FlowTable::new(columns.iter().map(|&(name, rates)| (name.into(), waveform(rates))).collect()))
}

/// Two inlets that meet, and one outlet.
fn fork() -> (Skeleton, [InletSite; 2]) {
    let points = [[1.0, 0.0, 2.0], [-1.0, 0.0, 2.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let site = |node: u32, patch: &str, name: &str| InletSite {
        node: NodeId(node),
        patch: patch.into(),
        name: name.into(),
        radius: 0.5,
    };
    (network(&points, 0.5, &[(0, 2), (1, 2), (2, 3)]), [site(0, "inlet", "7"), site(1, "inlet_1", "9")])
}

fn solved(inflow: Inflow) -> Result<FlowSolution, FlowError> {
    let (network, inlets) = fork();
    FlowPlan::default().viscosity(1e3).inflow(inflow).solve(&network, &inlets, &|node| node.to_string())
}

#[test]
fn one_column_is_for_all_inlets_and_several_are_named() {
    let shared = solved(table(&[("flow", [1.0, 3.0, 1.0])])).unwrap();
    assert_eq!(shared.flow.of_terminal.values().copied().collect::<Vec<_>>()[..2], [2.0; 2]);
    assert!((shared.flow.of_terminal[&NodeId(3)] - 4.0).abs() < 1e-12);
    // By node and by patch, in any order.
    let named = solved(table(&[("9", [0.0, 2.0, 0.0]), ("inlet", [1.0, -0.5, 1.0])])).unwrap();
    assert_eq!([named.flow.of_terminal[&NodeId(0)], named.flow.of_terminal[&NodeId(1)]], [0.25, 1.0]);
    assert_eq!(named.waveforms[&NodeId(1)], waveform([0.0, 2.0, 0.0]));
}

#[test]
fn columns_and_inlets_have_to_match() {
    let fault = |columns: &[(&str, [f64; 3])]| solved(table(columns)).unwrap_err().to_string();
    let one = [1.0; 3];
    assert!(fault(&[("inlet", one)]).starts_with("inlet_1 has 0 columns"));
    assert!(fault(&[("inlet", one), ("7", one)]).starts_with("inlet has 2 columns"));
    let unknown = fault(&[("inlet", one), ("aorta", one)]);
    assert_eq!(unknown, "column 'aorta' is not an inlet; inlets (patch or node): inlet (7), inlet_1 (9)");
    assert!(fault(&[("flow", [1.0, -1.0, 1.0])]).contains("a mean flow rate of 0e0"));
}

#[test]
fn the_largest_rate_decides_the_reynolds_number() {
    let reynolds = |rate: f64| 2.0 * BLOOD_DENSITY * rate / (PI * 0.5 * 1e3);
    let limit = MAX_REYNOLDS / reynolds(1.0);
    assert!(solved(Inflow::Rate(0.99 * limit)).is_ok());
    assert!(matches!(solved(Inflow::Rate(1.01 * limit)), Err(FlowError::TooFast { .. })));
    let backwards = table(&[("flow", [2.0 * limit, -1.01 * limit, 2.0 * limit])]);
    assert!(matches!(solved(backwards), Err(FlowError::TooFast { flow, .. }) if flow == 2.0 * limit));
    let usual = solved(Inflow::Usual).unwrap();
    assert!((reynolds(usual.flow.of_terminal[&NodeId(0)]) - USUAL_REYNOLDS).abs() < 1e-12);
}

#[test]
fn pressures_beyond_outlets_are_added() {
    let (network, inlets) = fork();
    let plan = FlowPlan::default().viscosity(1e3).inflow(Inflow::Rate(1.0));
    let solve = |plan: FlowPlan| plan.solve(&network, &inlets, &|node| node.to_string()).unwrap();
    let [free, raised] = [0.0, 5.0].map(|p| solve(plan.clone().outlets(OutletPlan::default().distal_pressure(p))));
    assert_eq!(raised.outlets[&NodeId(3)], OutletModel::Pressure(5.0));
    for (free, raised) in free.flow.pressure.iter().zip(&raised.flow.pressure) {
        assert!((raised - free - 5.0).abs() < 1e-9);
    }
}

#[test]
fn times_have_ranges() {
    let plan = FlowPlan::default().inflow(table(&[("flow", [1.0; 3])])).periods(2);
    assert_eq!(plan.transient(), Some(Transient::new(1.0).periods(2)));
    assert!(plan.clone().ramp(Some(2.0)).check().is_ok());
    for ramp in [-0.1, 2.1, f64::NAN] {
        assert!(matches!(plan.clone().ramp(Some(ramp)).check(), Err(FlowError::OutOfRange { what: "the ramp", .. })));
    }
    assert!(plan.periods(0).check().is_err());
    assert!(FlowPlan::default().density(f64::NAN).check().is_err());
    assert_eq!(FlowPlan::default().transient(), None);
}
