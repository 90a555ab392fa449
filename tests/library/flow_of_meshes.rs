//! Inlets, outlets and data of vessels in the mesh of a network.

use anastomesh::Point3;
use anastomesh::flow::{Caps, Datum, FlowPlan, Inflow, OutletKind, OutletPlan, Outlets, Reference, VesselData};
use anastomesh::io::flow::USUAL_REYNOLDS;
use anastomesh::io::network::NodeNames;
use anastomesh::mesh::beside::Beside;
use anastomesh::mesh::source::gather;
use anastomesh::meshing::{MeshPlan, Meshed, mesh_network};
use anastomesh::skeleton::Skeleton;
use anastomesh::skeleton::fixtures::network;

/// Plan with a total resistance of 3.
fn plan() -> FlowPlan {
    let outlets = OutletPlan::default().kind(OutletKind::Resistance).reference(Some(Reference::TotalResistance(3.0)));
    FlowPlan::default().density(1000.0).viscosity(4.0).inflow(Inflow::Rate(2.0)).outlets(outlets)
}

fn caps_of(made: &Meshed, skeleton: &Skeleton, plan: &FlowPlan) -> Caps {
    Caps::of(&made.mesh, skeleton, plan, &NodeNames::default()).unwrap()
}

/// A trunk with five thin side vessels and a wide end, beside a straight vessel.
fn meshed() -> (Skeleton, Meshed) {
    let mut points: Vec<[f64; 3]> = (0..7).map(|i| [0.0, 0.0, 20.0 * f64::from(i)]).collect();
    points.extend((1..6).map(|i| [if i % 2 == 0 { 14.0 } else { -14.0 }, 0.0, 20.0 * f64::from(i) + 10.0]));
    points.extend([[40., 0., 0.], [40., 0., 30.]]);
    let trunk = (0..6).map(|i| (i, i + 1));
    let edges: Vec<(u32, u32)> = trunk.chain((1..6).map(|i| (i, i + 6))).chain([(12, 13)]).collect();
    let mut skeleton = network(&points, 2.0, &edges);
    for edge in &mut skeleton.edges[6..11] {
        edge.radii = [0.8; 2];
    }
    let plan = MeshPlan::default().roots(vec![0, 12]);
    let made = mesh_network(&skeleton, &plan, &()).unwrap();
    (skeleton, made)
}

#[test]
fn each_cap_has_its_area_and_the_flow_of_its_vessel() {
    let (skeleton, made) = meshed();
    let caps = caps_of(&made, &skeleton, &plan());
    let names: Vec<_> = caps.rows.iter().map(|row| (row.id, row.name.as_str(), row.cap.node)).collect();
    assert_eq!(names[..4], [(2, "inlet", 0), (3, "inlet_1", 12), (4, "outlet_0", 6), (5, "outlet_1", 7)]);
    assert_eq!((names.len(), names[8]), (9, (10, "outlet_6", 13)));
    for row in &caps.rows {
        let disc = std::f64::consts::PI * row.cap.radius * row.cap.radius;
        assert!((row.area / disc - 1.0).abs() < 0.05, "{row:?}");
        // All outlets have the pressure of the total flow rate through the total resistance.
        assert_eq!(row.outlet.is_none(), row.name.starts_with("inlet"));
        if let Some(outlet) = row.outlet {
            assert!((outlet.resistance() * row.flow / 12.0 - 1.0).abs() < 1e-12, "{row:?}");
            assert!((row.pressure / 12.0 - 1.0).abs() < 1e-12, "{row:?}");
        }
    }
    let flows: Vec<f64> = caps.rows.iter().map(|row| row.flow).collect();
    assert_eq!(flows[..2], [2.0; 2]);
    assert!((flows[8] - 2.0).abs() < 1e-14 && (flows[2..8].iter().sum::<f64>() - 2.0).abs() < 1e-12, "{flows:?}");
    let usual = caps_of(&made, &skeleton, &plan().inflow(Inflow::Usual));
    let inlet = &usual.rows[0];
    let speed = inlet.flow / (std::f64::consts::PI * inlet.cap.radius.powi(2));
    assert!((1000.0 * speed * 2.0 * inlet.cap.radius / 4.0 - USUAL_REYNOLDS).abs() < 1e-12);
}

#[test]
fn outlets_become_one_patch_or_one_of_each_order() {
    let (skeleton, made) = meshed();
    let count = |id| made.mesh.boundary_patch.iter().filter(|&&patch| patch == id).count();
    let outlets: usize = (4..=10).map(count).sum();
    let mut caps = caps_of(&made, &skeleton, &plan());
    assert!(caps.group(&made.mesh, Outlets::Separate).is_none());
    let grouped = gather(&caps.group(&made.mesh, Outlets::Grouped).unwrap()).unwrap();
    let names: Vec<_> = grouped.patches.iter().map(|patch| (patch.id, patch.name.as_str())).collect();
    assert_eq!(names, [(1, "wall"), (2, "inlet"), (3, "inlet_1"), (4, "outlets")]);
    assert_eq!(grouped.boundary_patch.iter().filter(|&&patch| patch == 4).count(), outlets);
    assert!(caps.rows[2..].iter().all(|row| row.id == 4 && row.name == "outlets"));
    assert_eq!(caps.alone(), [0, 12]);
    let flow = caps.flow();
    assert!((flow.caps[&4].flow - 4.0).abs() < 1e-12);
    let conductance: f64 = caps.rows[2..].iter().map(|row| 1.0 / row.outlet.unwrap().resistance()).sum();
    assert!((flow.caps[&4].outlet.resistance() * conductance - 1.0).abs() < 1e-12);

    let mut caps = caps_of(&made, &skeleton, &plan());
    let (wide, thin) = (caps.rows[2].order, caps.rows[3].order);
    assert!(thin < wide && caps.rows[2].strahler == 1, "{thin} {wide}");
    let by_order = gather(&caps.group(&made.mesh, Outlets::ByOrder).unwrap()).unwrap();
    let names: Vec<_> = by_order.patches[3..].iter().map(|patch| (patch.id, patch.name.clone())).collect();
    assert_eq!(names, [(4, format!("outlets_order_{thin}")), (5, format!("outlets_order_{wide}"))]);
    assert_eq!(by_order.boundary_patch.iter().filter(|&&patch| patch == 4).count(), (5..=9).map(count).sum::<usize>());
}

/// A vessel along z that forks at 10 into two of two edges each.
fn fork() -> Skeleton {
    let points =
        [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [6.0, 0.0, 16.0], [12.0, 0.0, 22.0], [-6.0, 0.0, 16.0], [-12.0, 0.0, 22.0]];
    let mut network = network(&points, 1.0, &[(0, 1), (1, 2), (2, 3), (4, 1), (5, 4)]);
    network.edges[0].radii = [1.4, 1.0];
    network.nodes[0].radius = 1.4;
    network
}

#[test]
fn places_know_their_vessel() {
    let network = fork();
    let made = mesh_network(&network, &MeshPlan::default(), &()).expect("meshed").mesh;
    let data = VesselData::new(Datum::ALL.to_vec(), &network, &made).unwrap();
    let at = |place: [f64; 3]| {
        let column = |i: usize| {
            let values = data.at_points(i, &[Point3::from(place)]);
            if data.columns()[i].at_points { values[0] } else { data.in_tets(i, &[[Point3::from(place); 4]])[0] }
        };
        [0, 1, 2, 3, 4, 5].map(column)
    };
    let [radius, distance, branch, generation, strahler, node] = at([0.3, 0.0, 5.0]);
    assert!((radius - 1.2).abs() < 1e-9 && (distance - 5.0).abs() < 1e-9);
    assert_eq!([generation, strahler, node], [0.0, 2.0, 0.0]);
    for side in [1.0, -1.0] {
        // Both are counted from the fork, whichever way their edges run.
        let [radius, distance, other, generation, strahler, node] = at([side * 9.0, 0.0, 19.0]);
        assert!((radius - 1.0).abs() < 1e-9 && (distance - 9.0 * 2_f64.sqrt()).abs() < 1e-9, "{distance}");
        assert_eq!([generation, strahler], [1.0, 1.0]);
        assert!(other != branch && [2.0, 3.0, 4.0, 5.0].contains(&node));
    }
}

#[test]
fn cells_have_their_shape() {
    let network = fork();
    let made = mesh_network(&network, &MeshPlan::default(), &()).expect("meshed").mesh;
    let data = VesselData::new(vec![Datum::Ratio], &network, &made).unwrap();
    let p = Point3::new;
    let corner = [p(0.0, 0.0, 0.0), p(1.0, 0.0, 1.0), p(1.0, 1.0, 0.0), p(0.0, 1.0, 1.0)];
    assert!((data.in_tets(0, &[corner])[0] - 1.0).abs() < 1e-12);
    assert!((data.in_faces(0, &[[corner[0], corner[1], corner[2]]])[0] - 1.0).abs() < 1e-12);
}
