use super::*;
use anastomesh_io::results::{FlowResult, InnerFlux, Near, OuterFlux};
use anastomesh_mesh::adjacency::{NONE, face_vertices, tet_adjacency};
use anastomesh_mesh::shapes::tube_lattice;
use anastomesh_mesh::{Point3, TetMesh, Vec3};
use anastomesh_skeleton::fixtures::network;
use std::f64::consts::PI;

const FLUID: ResultFluid = ResultFluid { density: 1000.0, viscosity: 2.0 };
const RATE: f64 = 3.0;

/// Poiseuille flow in a lattice of a tube around the z axis: radius and pressure drop per length are those of the mesh.
fn poiseuille(mesh: &TetMesh, radius: f64, length: f64) -> FlowResult {
    let slope = 8.0 * FLUID.viscosity * RATE / (PI * radius.powi(4));
    let speed = |p: &Point3| {
        let share = (p.x * p.x + p.y * p.y) / (radius * radius);
        Vec3::new(0.0, 0.0, 2.0 * RATE / (PI * radius * radius) * (1.0 - share).max(0.0))
    };
    let mut result = FlowResult::default();
    result.is_nodal = true;
    result.name = "test".into();
    let adjacency = tet_adjacency(&mesh.tets, mesh.points.len());
    for (number, tet) in mesh.tets.iter().enumerate() {
        let corners = tet.map(|v| mesh.points[v as usize]);
        let center = Point3::from(corners.iter().map(|p| p.coords).sum::<Vec3>() / 4.0);
        let [u, v, w] = [1, 2, 3].map(|i| corners[i] - corners[0]);
        result.cells.push(center);
        result.volumes.push(u.cross(&v).dot(&w).abs() / 6.0);
        result.pressures.push(slope * (length - center.z));
        for side in 0..4 {
            let (handle, other) = (4 * number as u32 + side, adjacency.neighbors[number][side as usize]);
            let nodes = face_vertices(&mesh.tets, handle).map(|v| mesh.points[v as usize]);
            let area = 0.5 * (nodes[1] - nodes[0]).cross(&(nodes[2] - nodes[0]));
            let flux = nodes.iter().map(&speed).sum::<Vec3>().dot(&area) / 3.0;
            if other != NONE {
                if other / 4 > number as u32 {
                    result.inner.push(InnerFlux { cells: [number as u32, other / 4], flux });
                }
                continue;
            }
            let middle = Point3::from(nodes.iter().map(|p| p.coords).sum::<Vec3>() / 3.0);
            let is_wall = area.z.abs() < 0.5 * area.norm();
            let height = ((center - middle).dot(&area) / area.norm()).abs();
            let near = Near { speed: speed(&Point3::new(radius - height, 0.0, 0.0)).z, height };
            let pressure = slope * (length - middle.z);
            result.outer.push(OuterFlux {
                cell: number as u32,
                center: middle,
                area,
                flux,
                pressure,
                is_wall,
                shear: None,
                near,
            });
        }
    }
    result
}

/// Tube along z with its network.
fn tube() -> (FlowResult, Skeleton) {
    let mesh = tube_lattice(8, 60, 0.25);
    let [radius, length] =
        [|p: &Point3| libm::hypot(p.x, p.y), |p: &Point3| p.z].map(|of| mesh.points.iter().map(of).fold(0.0, f64::max));
    let middle = 0.4 * length;
    let skeleton = network(&[[0.0; 3], [0.0, 0.0, middle], [0.0, 0.0, length]], radius, &[(0, 1), (2, 1)]);
    (poiseuille(&mesh, radius, length), skeleton)
}

fn along(result: &FlowResult, skeleton: &Skeleton) -> Result<Along, Misfit> {
    Along::of(skeleton, &[NodeId(0)].into(), result, FLUID)
}

#[test]
fn poiseuille_flow_is_found_along_a_tube() {
    let (result, skeleton) = tube();
    let found = along(&result, &skeleton).unwrap();
    let [branch] = &found.branches[..] else { panic!("{:?}", found.branches) };
    assert_eq!(branch.stations, STATIONS);
    // The flow of the interpolated velocity; its sections are equal.
    let inflow = found.of_terminal[&NodeId(0)];
    let sign = if branch.nodes[0] == 0 { 1.0 } else { -1.0 };
    assert!((sign * branch.flow / inflow - 1.0).abs() < 1e-3 && branch.spread < 1e-3 * inflow, "{branch:?} {inflow}");
    assert!((inflow / RATE - 1.0).abs() < 0.05, "{inflow}");
    assert!((branch.expected_flow / branch.flow - 1.0).abs() < 1e-3);
    // Edges have the flow in their own direction.
    assert!(found.edge_flow(0)[0] > 0.0 && found.edge_flow(1)[0] < 0.0);
    let radius = skeleton.nodes[0].radius;
    let shear = 4.0 * FLUID.viscosity * RATE / (PI * radius.powi(3));
    assert!((branch.shear / shear - 1.0).abs() < 0.02, "{} {shear}", branch.shear);
    let slope = 8.0 * FLUID.viscosity * RATE / (PI * radius.powi(4));
    for (node, pressure) in skeleton.nodes.iter().zip(&found.pressure) {
        let expected = slope * (skeleton.nodes[2].position.z - node.position.z);
        assert!((pressure - expected).abs() < 0.01 * slope * skeleton.nodes[2].position.z, "{pressure} {expected}");
    }
}

#[test]
fn kinematic_results_are_multiplied_by_the_density() {
    let (mut result, skeleton) = tube();
    let dynamic = along(&result, &skeleton).unwrap();
    result.is_kinematic = true;
    let kinematic = along(&result, &skeleton).unwrap();
    for (a, b) in kinematic.pressure.iter().zip(&dynamic.pressure) {
        assert!((a - FLUID.density * b).abs() <= 1e-9 * kinematic.pressure[0].abs());
    }
    // Shear comes from the velocity, unless the solver wrote it.
    assert_eq!(kinematic.shear, dynamic.shear);
    result.outer.iter_mut().filter(|face| face.is_wall).for_each(|face| face.shear = Some(0.5));
    let written = along(&result, &skeleton).unwrap();
    assert!((written.branches[0].shear - 500.0).abs() < 1e-9);
}

#[test]
fn results_of_other_meshes_are_refused() {
    let (result, skeleton) = tube();
    let mut moved = skeleton.clone();
    moved.nodes.iter_mut().for_each(|node| node.position.x += 3.0 * node.radius);
    let error = along(&result, &moved).unwrap_err();
    assert!(matches!(error, Misfit::Outside { .. }) && error.to_string().contains("outside the vessels"), "{error}");

    let [radius, length] = [skeleton.nodes[0].radius, skeleton.nodes[2].position.z];
    let more = [[0.0; 3], [0.0, 0.0, length], [40.0 * radius, 0.0, 0.0], [50.0 * radius, 0.0, 0.0]];
    let two = network(&more, radius, &[(0, 1), (2, 3)]);
    assert!(matches!(along(&result, &two), Err(Misfit::Empty { nodes: [2, 3] })));

    let mut closed = result.clone();
    closed.outer.iter_mut().for_each(|face| face.is_wall = true);
    assert!(matches!(along(&closed, &skeleton), Err(Misfit::NoCap { node: 0 })));

    let error = Along::of(&skeleton, &[NodeId(2)].into(), &result, FLUID).unwrap_err();
    assert!(matches!(error, Misfit::Outflow { node: 2, rate } if rate > 0.0), "{error}");
}
