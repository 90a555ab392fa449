use super::*;
use anastomesh_io::NetworkOptions;
use anastomesh_io::network::{read_network, write_reduced};
use anastomesh_mesh::nalgebra::{DMatrix, DVector};
use anastomesh_network::flow::solve;
use anastomesh_skeleton::fixtures::{network, tangle};
use serde_json::Value;
use std::path::Path;

const VISCOSITY: f64 = 3.5e-3;

/// Tapered tree of 31 vessels in metres, with two loops.
fn looped() -> Skeleton {
    let mut tree = tangle(4, 3);
    for node in &mut tree.nodes {
        node.position *= 1e-3;
    }
    let terminals = tree.adjacency().terminals();
    for (i, edge) in tree.edges.iter_mut().enumerate() {
        let radius = 4e-4 / (1.0 + 0.1 * i as f64);
        edge.radii = [radius, 0.8 * radius];
    }
    for pair in [[1, 4], [2, 7]] {
        tree.edges.push(Edge { nodes: pair.map(|i: usize| terminals[i]), radii: [9e-5, 8e-5] });
    }
    tree
}

fn steady(skeleton: &Skeleton) -> (NetworkFlow, Supply) {
    let rates = BTreeMap::from([(NodeId(0), 1e-6)]);
    let flow = solve(skeleton, &rates, VISCOSITY).unwrap();
    (flow, Supply { rates, ..Supply::default() })
}

fn written(path: &Path, model: &ReducedModel) -> Value {
    write_reduced(path, model).unwrap();
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Steady solution of the solver's equations: flow and pressure at both ends of each vessel.
///
/// Vessels: `p_in − p_out = R q_in`, and `q_in = q_out`. Junctions: pressures are equal, and flows balance.
fn solution(model: &Value) -> Vec<[f64; 4]> {
    let vessels = model["vessels"].as_array().unwrap();
    let unknowns = 4 * vessels.len();
    let (mut rows, mut right) = (Vec::new(), Vec::new());
    let mut equation = |terms: &[(usize, f64)], value: f64| {
        let mut row = vec![0.0; unknowns];
        for &(at, factor) in terms {
            row[at] += factor;
        }
        // Rows are scaled: pressures exceed flow rates by ten orders of magnitude.
        let most = row.iter().fold(0.0, |most: f64, term: &f64| most.max(term.abs()));
        rows.push(row.iter().map(|term| term / most).collect::<Vec<f64>>());
        right.push(value / most);
    };
    let [p_in, q_in, p_out, q_out] = [0, 1, 2, 3].map(|offset| move |vessel: usize| 4 * vessel + offset);
    // Flow rates are counted in units of 1e-6.
    let unit = 1e-6;
    let conditions: BTreeMap<&str, &Value> = model["boundary_conditions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|condition| (condition["bc_name"].as_str().unwrap(), condition))
        .collect();
    for (number, vessel) in vessels.iter().enumerate() {
        let resistance = vessel["zero_d_element_values"]["R_poiseuille"].as_f64().unwrap();
        equation(&[(p_in(number), 1.0), (p_out(number), -1.0), (q_in(number), -resistance * unit)], 0.0);
        equation(&[(q_in(number), 1.0), (q_out(number), -1.0)], 0.0);
        if let Some(name) = vessel["boundary_conditions"]["inlet"].as_str() {
            equation(&[(q_in(number), 1.0)], conditions[name]["bc_values"]["Q"][0].as_f64().unwrap() / unit);
        }
        if let Some(name) = vessel["boundary_conditions"]["outlet"].as_str() {
            let values = &conditions[name]["bc_values"];
            match conditions[name]["bc_type"].as_str().unwrap() {
                "PRESSURE" => equation(&[(p_out(number), 1.0)], values["P"][0].as_f64().unwrap()),
                _ => equation(
                    &[(p_out(number), 1.0), (q_out(number), -values["R"].as_f64().unwrap() * unit)],
                    values["Pd"].as_f64().unwrap(),
                ),
            }
        }
    }
    for junction in model["junctions"].as_array().unwrap() {
        let of = |key: &str| -> Vec<usize> {
            junction[key].as_array().unwrap().iter().map(|v| v.as_u64().unwrap() as usize).collect()
        };
        let (inlets, outlets) = (of("inlet_vessels"), of("outlet_vessels"));
        assert!(!inlets.is_empty() && !outlets.is_empty());
        let pressures: Vec<usize> = inlets.iter().map(|&v| p_out(v)).chain(outlets.iter().map(|&v| p_in(v))).collect();
        for pair in pressures.windows(2) {
            equation(&[(pair[0], 1.0), (pair[1], -1.0)], 0.0);
        }
        let flows = inlets.iter().map(|&v| (q_out(v), 1.0)).chain(outlets.iter().map(|&v| (q_in(v), -1.0)));
        equation(&flows.collect::<Vec<_>>(), 0.0);
    }
    assert_eq!(rows.len(), unknowns);
    let matrix = DMatrix::from_fn(unknowns, unknowns, |i, j| rows[i][j]);
    let found = matrix.full_piv_lu().solve(&DVector::from_vec(right)).unwrap();
    (0..vessels.len())
        .map(|v| [found[p_in(v)], found[q_in(v)] * unit, found[p_out(v)], found[q_out(v)] * unit])
        .collect()
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1e-10 * expected.abs()
}

#[test]
fn the_steady_model_has_the_one_dimensional_solution() {
    let skeleton = looped();
    let (flow, supply) = steady(&skeleton);
    let folder = tempfile::tempdir().unwrap();
    for lumped in [false, true] {
        let options = ModelOptions::new(1060.0, VISCOSITY).lumped(lumped);
        let model = reduced_model(&skeleton, &flow, &supply, &options).unwrap();
        assert_eq!(model.vessels.len() < skeleton.edges.len(), lumped);
        let found = solution(&written(&folder.path().join("model.json"), &model));
        for (vessel, [p_in, _, p_out, q_out]) in model.vessels.iter().zip(found) {
            let [start, end] = vessel.tips();
            assert!(close(p_in, flow.pressure[start as usize]), "{p_in} {}", flow.pressure[start as usize]);
            if let Some(&rate) = flow.of_terminal.get(&NodeId(end)) {
                assert!(close(q_out, rate), "{q_out} {rate}");
            } else {
                assert!(close(p_out, flow.pressure[end as usize]));
            }
        }
    }
}

#[test]
fn resistances_beyond_outlets_are_in_the_model() {
    let skeleton =
        network(&[[0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 2.0], [0.0, -1.0, 2.0]], 0.1, &[(0, 1), (1, 2), (1, 3)]);
    let (flow, mut supply) = steady(&skeleton);
    supply.outlets.insert(NodeId(2), OutletModel::Resistance { resistance: 1e3, distal_pressure: 7.0 });
    supply.outlets.insert(NodeId(3), OutletModel::Resistance { resistance: 1e3, distal_pressure: 7.0 });
    let model = reduced_model(&skeleton, &flow, &supply, &ModelOptions::new(1060.0, VISCOSITY)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let found = solution(&written(&folder.path().join("model.json"), &model));
    // Both sides are equal.
    assert!(close(found[1][3], 5e-7) && close(found[2][2], 7.0 + 5e-4), "{found:?}");
}

#[test]
fn models_are_read_back_as_the_network() {
    let skeleton = looped();
    let (flow, supply) = steady(&skeleton);
    let folder = tempfile::tempdir().unwrap();
    for (file, tolerance) in [("model.json", 0.0), ("model.in", 1e-15)] {
        let options = ModelOptions::new(1060.0, VISCOSITY).elastic(true);
        let model = reduced_model(&skeleton, &flow, &supply, &options).unwrap();
        let path = folder.path().join(file);
        write_reduced(&path, &model).unwrap();
        let read = read_network(&path, &NetworkOptions::default()).unwrap().skeleton;
        assert_eq!(read.nodes.len(), skeleton.nodes.len());
        for (found, expected) in read.nodes.iter().zip(&skeleton.nodes) {
            assert_eq!(found.position, expected.position);
        }
        for (found, expected) in read.edges.iter().zip(&skeleton.edges) {
            let mut expected = *expected;
            if found.nodes != expected.nodes {
                expected.nodes.reverse();
                expected.radii.reverse();
            }
            assert_eq!(found.nodes, expected.nodes);
            let differ = |(a, b): (f64, f64)| (a - b).abs() > tolerance * b;
            assert!(!found.radii.into_iter().zip(expected.radii).any(differ), "{found:?} {expected:?}");
        }
    }
    assert_eq!(read_network(&folder.path().join("model.json"), &NetworkOptions::default()).unwrap().roots, [NodeId(0)]);
}

#[test]
fn a_closed_component_has_no_model() {
    let two = network(&[[0.0; 3], [0.0, 0.0, 1.0], [5.0, 0.0, 0.0], [5.0, 0.0, 1.0]], 0.2, &[(0, 1), (2, 3)]);
    let (flow, mut supply) = steady(&two);
    supply.rates.insert(NodeId(2), 1.0);
    supply.rates.insert(NodeId(3), 1.0);
    let options = ModelOptions::new(1060.0, VISCOSITY);
    let closed = reduced_model(&two, &flow, &supply, &options).unwrap_err();
    assert_eq!((closed.node, closed.missing), (NodeId(2), "outlet"));
    supply.rates.retain(|node, _| node.0 == 0);
    assert_eq!(reduced_model(&two, &flow, &supply, &options).unwrap_err().missing, "inlet");
}
