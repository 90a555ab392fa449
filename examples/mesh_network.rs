//! A network meshed as `anastomesh mesh NETWORK -o MESH --refine` does: cures, refinement, fallbacks, validity check,
//! comparison with the network, flow.
//!
//! ```sh
//! cargo run --release --example mesh_network fixtures/tree_30.vtp tree.vtu
//! ```

use anastomesh::io::{NetworkOptions, read_network, write_mesh};
use anastomesh::meshing::{MeshPlan, Run, Store};
use anastomesh::network::RefineParams;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [network, mesh] = &arguments[..] else { return Err("usage: mesh_network NETWORK MESH".into()) };
    mesh_network(network.as_ref(), mesh.as_ref())
}

/// Meshes a network with refinement and writes the mesh.
///
/// # Errors
/// If a file cannot be read or written, there is no mesh, or it has defects.
pub fn mesh_network(network: &Path, output: &Path) -> Result<(), Box<dyn Error>> {
    // The cures fill radii that cannot be used.
    let file = read_network(network, &NetworkOptions::default().any_radii(true))?;
    let (plan, refine) = (MeshPlan::default(), RefineParams::default());
    let mut noted = format!("mesh --rho {} --follow {}", plan.rho, plan.follow);
    let iterations = refine.iterations;

    let store = Store::in_memory();
    let made = Run::new(file).plan(plan).refine(refine).mesh_into(&store, &|_| Ok(()), &())?;
    for attempt in &made.attempts {
        println!("{:?}: {:?}", attempt.strategy, attempt.fault);
    }
    if let Some(fidelity) = &made.fidelity {
        print!("{fidelity}");
    }
    for row in made.caps.iter().flat_map(|caps| &caps.rows) {
        println!("{}: flow {:.3e}, area {:.3e}", row.name, row.flow, row.area);
    }
    // A network that gives a valid mesh as it is is not refined.
    if made.networks.refine.is_some() {
        noted = format!("{noted} --refine {iterations}");
    }
    write_mesh(output, &made.mesh, &made.notes(concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into(), noted))?;
    match &made.defects[..] {
        [] => Ok(()),
        defects => Err(format!("the mesh is not what was asked for: {defects:?}").into()),
    }
}

#[test]
fn it_runs() {
    let folder = tempfile::tempdir().unwrap();
    mesh_network("fixtures/tree_30.swc".as_ref(), &folder.path().join("tree.vtu")).unwrap();
}
