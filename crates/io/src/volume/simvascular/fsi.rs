//! Input of `svMultiPhysics` for fluid–structure interaction: the lumen as fluid on a moving mesh, all other regions as
//! hyperelastic solids. Faces are named `REGION_PATCH`, since names must differ between meshes.

use super::layout::{MESH, surface_path};
use super::solver::{condition, general, remark};
use super::steps::Steps;
use crate::flow::{BLOOD_VISCOSITY, Flow, Role, plain};
use anastomesh_mesh::Patch;
use anastomesh_mesh::region::RegionMesh;
use std::fmt::Write;

/// Region of the case.
pub(super) struct Part {
    name: String,
    patches: Vec<Patch>,
}

impl Part {
    pub(super) fn of(mesh: &RegionMesh) -> Self {
        Self { name: plain(&mesh.region.name), patches: mesh.volume.patches.clone() }
    }

    /// Name of a face in the case.
    fn face(&self, patch: &Patch) -> String {
        format!("{}_{}", self.name, plain(&patch.name))
    }
}

/// Material of a solid.
struct Material {
    /// Young's modulus in Pa.
    modulus: f64,
    /// Density as a share of that of blood.
    density: f64,
    source: &'static str,
}

/// Arterial wall: modulus of human arteries in the physiological range (Holzapfel, Sommer and Regitnig 2004); density
/// 1.12 g/cm³.
const WALL: Material = Material { modulus: 4e5, density: 1.06, source: "arterial wall" };
/// Soft tissue, such as muscle and liver, at small strains (Levental, Georges and Janmey 2007).
const TISSUE: Material = Material { modulus: 1e4, density: 1.0, source: "soft tissue" };
/// Poisson's ratio of solids: nearly incompressible. Linear tetrahedra lock closer to 0.5.
const POISSON: f64 = 0.45;

impl Material {
    fn of(region: &str) -> Self {
        if region.starts_with("wall") { WALL } else { TISSUE }
    }
}

/// Contents of the file.
pub(super) fn text(lumen: &Part, solids: &[Part], flow: &Flow, steps: &Steps) -> String {
    let parts: Vec<&Part> = std::iter::once(lumen).chain(solids).collect();
    let meshes: String = parts.iter().enumerate().map(|(domain, part)| mesh(part, domain)).collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svMultiPhysicsFile version=\"0.1\">\n\n{}{meshes}{}{}{}\
         </svMultiPhysicsFile>\n",
        general(steps),
        projections(&parts),
        interaction(lumen, solids, flow),
        motion(lumen),
    )
}

fn mesh(part: &Part, domain: usize) -> String {
    let name = &part.name;
    let mut text = format!("<Add_mesh name=\"{name}\">\n  <Mesh_file_path> {name}/{MESH} </Mesh_file_path>\n");
    for patch in &part.patches {
        let _ = writeln!(
            text,
            "  <Add_face name=\"{}\">\n    <Face_file_path> {name}/{} </Face_file_path>\n  </Add_face>",
            part.face(patch),
            surface_path(&plain(&patch.name))
        );
    }
    let _ = writeln!(text, "  <Domain> {domain} </Domain>\n</Add_mesh>\n");
    text
}

/// Joins the faces of an interface: those of the later mesh are projected onto those of the earlier one. Ends in tissue are not
/// joined: blood passes them, and the tissue beyond is fixed.
fn projections(parts: &[&Part]) -> String {
    let mut text = String::new();
    for (i, later) in parts.iter().enumerate() {
        for patch in later.patches.iter().filter(|patch| Role::of(patch) == Role::Wall) {
            let has = |part: &&&Part| part.patches.iter().any(|other| other.id == patch.id);
            if let Some(earlier) = parts[..i].iter().find(has) {
                let _ = writeln!(
                    text,
                    "<Add_projection name=\"{}\">\n  <Project_from_face> {} </Project_from_face>\n</Add_projection>\n",
                    later.face(patch),
                    earlier.face(patch)
                );
            }
        }
    }
    text
}

/// Power of ten from SI to the units of the case, found by the viscosity: pascal and poise differ by ten.
fn pressure_unit(flow: &Flow) -> f64 {
    let power = libm::log10(flow.viscosity / BLOOD_VISCOSITY).round();
    if power.is_finite() { 10_f64.powi(power as i32) } else { 1.0 }
}

fn interaction(lumen: &Part, solids: &[Part], flow: &Flow) -> String {
    let mut text = format!(
        "<Add_equation type=\"FSI\">\n{COUPLED}\n  <Domain id=\"0\">\n    <Equation> fluid </Equation>\n    <Density> {:e} \
         </Density>\n    <Viscosity model=\"Constant\">\n      <Value> {:e} </Value>\n    </Viscosity>\n    \
         <Backflow_stabilization_coefficient> 0.2 </Backflow_stabilization_coefficient>\n  </Domain>\n\n",
        flow.density, flow.viscosity
    );
    for (solid, domain) in solids.iter().zip(1..) {
        let Material { modulus, density, source } = Material::of(&solid.name);
        let _ = writeln!(
            text,
            "  <!-- {}: {source}. The modulus is {modulus:e} Pa, in the unit of pressure that the viscosity tells. -->\n  \
             <Domain id=\"{domain}\">\n    <Equation> struct </Equation>\n    <Constitutive_model type=\"neoHookean\"> \
             </Constitutive_model>\n    <Dilational_penalty_model> ST91 </Dilational_penalty_model>\n    <Density> {:.4e} \
             </Density>\n    <Elasticity_modulus> {:e} </Elasticity_modulus>\n    <Poisson_ratio> {POISSON} \
             </Poisson_ratio>\n  </Domain>\n",
            solid.name,
            density * flow.density,
            modulus * pressure_unit(flow),
        );
    }
    text += FSI_OUTPUT;
    text += &remark(&lumen.patches, flow);
    let mut add = |face: &str, condition: &str| {
        let _ = writeln!(text, "  <Add_BC name=\"{face}\">\n{condition}  </Add_BC>");
    };
    let is_shared = |patch: &Patch| solids.iter().any(|solid| solid.patches.iter().any(|other| other.id == patch.id));
    for patch in &lumen.patches {
        // On an interface, fluid and solid move together.
        if Role::of(patch) != Role::Wall || !is_shared(patch) {
            add(&lumen.face(patch), &condition(patch, flow));
        }
    }
    for solid in solids {
        for patch in solid.patches.iter().filter(|patch| is_held(patch)) {
            add(&solid.face(patch), FIXED);
        }
    }
    text + "</Add_equation>\n\n"
}

/// True for surfaces of a solid that do not move: ends of walls, ends of vessels in tissue, and the organ's surface.
fn is_held(patch: &Patch) -> bool {
    Role::of(patch) != Role::Wall || patch.name.starts_with("ring") || patch.name.starts_with("organ")
}

/// Motion of the fluid's mesh, which stays at inlets and outlets.
fn motion(lumen: &Part) -> String {
    let mut text =
        format!("<Add_equation type=\"mesh\">\n{COUPLED}  <Poisson_ratio> 0.3 </Poisson_ratio>\n\n{MESH_OUTPUT}");
    for patch in lumen.patches.iter().filter(|patch| Role::of(patch) != Role::Wall) {
        let _ = writeln!(text, "  <Add_BC name=\"{}\">\n{FIXED}  </Add_BC>", lumen.face(patch));
    }
    text + "</Add_equation>\n\n"
}

const FIXED: &str = "    <Type> Dir </Type>\n    <Value> 0.0 </Value>\n";

const COUPLED: &str = "  <Coupled> true </Coupled>
  <Min_iterations> 1 </Min_iterations>
  <Max_iterations> 10 </Max_iterations>
  <Tolerance> 1e-6 </Tolerance>
";

const FSI_OUTPUT: &str = "  <LS type=\"GMRES\">
    <Linear_algebra type=\"fsils\">
      <Preconditioner> fsils </Preconditioner>
    </Linear_algebra>
    <Tolerance> 1e-6 </Tolerance>
    <Max_iterations> 500 </Max_iterations>
    <Krylov_space_dimension> 100 </Krylov_space_dimension>
  </LS>

  <Output type=\"Spatial\">
    <Displacement> true </Displacement>
    <Velocity> true </Velocity>
    <Pressure> true </Pressure>
    <VonMises_stress> true </VonMises_stress>
  </Output>
  <Output type=\"Alias\">
    <Displacement> FS_Displacement </Displacement>
  </Output>

";

const MESH_OUTPUT: &str = "  <LS type=\"CG\">
    <Linear_algebra type=\"fsils\">
      <Preconditioner> fsils </Preconditioner>
    </Linear_algebra>
    <Tolerance> 1e-6 </Tolerance>
  </LS>

  <Output type=\"Spatial\">
    <Displacement> true </Displacement>
  </Output>

";

#[cfg(test)]
mod tests {
    use super::*;

    fn part(name: &str, patches: &[(i32, &str)]) -> Part {
        let patches = patches.iter().map(|&(id, name)| Patch { id, name: name.into(), cap: None });
        Part { name: name.into(), patches: patches.collect() }
    }

    #[test]
    fn ends_in_tissue_are_fixed_and_not_joined() {
        let lumen = part("lumen", &[(2, "inlet"), (3, "outlet_0"), (4, "interface_lumen_wall")]);
        let solids = [
            part("wall", &[(4, "interface_lumen_wall"), (5, "interface_wall_tissue"), (6, "ring_outlet_0")]),
            part("tissue", &[(2, "inlet"), (3, "outlet_0"), (5, "interface_wall_tissue"), (6, "ring_outlet_0")]),
        ];
        let joined = projections(&[&lumen, &solids[0], &solids[1]]);
        assert!(joined.contains("tissue_interface_wall_tissue"), "{joined}");
        assert!(!joined.contains("inlet") && !joined.contains("> tissue_outlet_0"), "{joined}");
        assert!(!joined.contains("lumen_outlet_0"), "{joined}");
        let text = interaction(&lumen, &solids, &Flow::new(1060.0, 0.0035));
        for face in ["tissue_inlet", "tissue_outlet_0", "tissue_ring_outlet_0", "wall_ring_outlet_0"] {
            assert!(text.contains(&format!("  <Add_BC name=\"{face}\">\n{FIXED}")), "{face}: {text}");
        }
    }
}
