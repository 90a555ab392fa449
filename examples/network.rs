//! A network meshed in memory: a vessel that forks, from its nodes to a labelled mesh that has been checked.
//!
//! ```sh
//! cargo run --release --example network
//! ```

use anastomesh::WALL;
use anastomesh::meshing::{MeshPlan, mesh_network};
use anastomesh::network::{Skeleton, clean};
use anastomesh::skeleton::{Edge, Node, NodeId};
use anastomesh::{Point3, TetMesh};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let nodes = [([0.0, 0.0, -9.0], 1.0), ([0.0, 0.0, 0.0], 1.0), ([5.0, 0.0, 7.0], 0.8), ([-5.0, 0.0, 7.0], 0.8)];
    let node = |(i, &(place, radius)): (usize, &([f64; 3], f64))| Node {
        position: Point3::from(place),
        radius,
        original: i as u32,
    };
    let edge = |[a, b]: [u32; 2]| Edge { nodes: [NodeId(a), NodeId(b)], radii: [nodes[b as usize].1; 2] };
    let network = Skeleton {
        nodes: nodes.iter().enumerate().map(node).collect(),
        edges: [[0, 1], [1, 2], [1, 3]].map(edge).to_vec(),
    };
    let (network, cleaned) = clean(&network)?;
    assert!(cleaned.is_empty(), "there is nothing to clean in this network");

    let mut plan = MeshPlan::default();
    plan.roots = vec![0];
    let made = mesh_network(&network, &plan, &())?;
    assert!(made.check.is_valid(), "{}", made.check);

    let wall = made.mesh.boundary_patch.iter().filter(|&&patch| patch == WALL).count();
    println!("{} tetrahedra, {wall} triangles of the wall", made.mesh.mesh.tets.len());
    for patch in &made.mesh.patches {
        if let Some(cap) = patch.cap {
            println!("{} closes node {} with a disc of radius {}", patch.name, cap.node, cap.radius);
        }
    }
    let names: Vec<&str> = made.mesh.patches.iter().map(|patch| patch.name.as_str()).collect();
    assert_eq!(names, ["wall", "inlet", "outlet_0", "outlet_1"]);
    println!("volume {:.2}", volume(&made.mesh.mesh));
    Ok(())
}

fn volume(mesh: &TetMesh) -> f64 {
    let corners = mesh.tets.iter().map(|t| t.map(|v| mesh.points[v as usize]));
    corners.map(|[a, b, c, d]| (b - a).cross(&(c - a)).dot(&(d - a)) / 6.0).sum()
}

#[test]
fn it_runs() {
    main().unwrap();
}
