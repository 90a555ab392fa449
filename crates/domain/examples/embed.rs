//! Embeds a bifurcation in a box of tissue, and distributes the flow through the walls of its vessels over the cells.
//!
//! ```sh
//! cargo run -p anastomesh-domain --example embed
//! ```

use anastomesh_domain::{EmbedPlan, Embedding, Thickness};
use anastomesh_mesh::Point3;
use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};
use std::f64::consts::TAU;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let at = [[0.0, 0.0, 0.0], [0.0, 0.0, 10.0], [6.0, 0.0, 16.0], [-6.0, 0.0, 16.0]];
    let nodes = (0..).zip(at).map(|(original, p)| Node { position: Point3::from(p), radius: 1.0, original }).collect();
    let edge = |a, b, radius| Edge { nodes: [NodeId(a), NodeId(b)], radii: [radius; 2] };
    let network = Skeleton { nodes, edges: vec![edge(0, 1, 1.0), edge(1, 2, 0.8), edge(1, 3, 0.8)] };

    // Edges of tetrahedra are as long as the vessels are wide.
    let plan = EmbedPlan::default().size(Thickness::Law { length: 0.0, radii: 2.0 });
    let made = Embedding::of(&network, &plan, &())?;
    made.pieces.check(&made.mesh.mesh, &network)?;

    // Source term of each cell: area of the walls in it.
    let mut area = vec![0.0; made.mesh.mesh.tets.len()];
    for piece in &made.pieces.list {
        let radius = network.tube(piece.edge).radius(piece.middle());
        area[piece.tet as usize] += TAU * radius * piece.length;
    }
    let sources = area.iter().filter(|&&a| a > 0.0).count();
    println!("{} tetrahedra, {sources} with a vessel; wall area {:.1}", area.len(), area.iter().sum::<f64>());
    assert!((area.iter().sum::<f64>() - TAU * (10.0 + 1.6 * 72.0_f64.sqrt())).abs() < 1e-9);
    Ok(())
}

#[test]
fn it_runs() {
    main().unwrap();
}
