//! Input of `svMultiPhysics`: steady laminar flow with given inflow and a resistance at each outlet.

use super::layout::{MESH, surface_path};
use crate::flow::{Flow, Role, plain};
use anastomesh_mesh::Patch;
use std::fmt::Write;

/// Number of time steps to a steady state. Each is a tenth of the diffusion time of the widest inlet.
const STEPS: u32 = 30;

/// Contents of the file.
pub(super) fn text(patches: &[Patch], flow: &Flow) -> String {
    let mut faces = String::new();
    let mut conditions = String::new();
    for patch in patches {
        let name = plain(&patch.name);
        let _ = writeln!(
            faces,
            "  <Add_face name=\"{name}\">\n    <Face_file_path> {} </Face_file_path>\n  </Add_face>",
            surface_path(&name)
        );
        let _ = writeln!(conditions, "  <Add_BC name=\"{name}\">\n{}  </Add_BC>", condition(patch, flow));
    }
    let radius =
        patches.iter().filter(|p| p.is_inlet()).filter_map(|p| Some(p.cap.as_ref()?.radius)).fold(0.0, f64::max);
    let step = 0.1 * radius * radius * flow.density / flow.viscosity;
    // Default for inlets of unknown width.
    let step = if step > 0.0 { step } else { 1e-3 };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svMultiPhysicsFile version=\"0.1\">\n\n<GeneralSimulationParameters>\n  \
         <Continue_previous_simulation> false </Continue_previous_simulation>\n  \
         <Number_of_spatial_dimensions> 3 </Number_of_spatial_dimensions>\n  \
         <Number_of_time_steps> {STEPS} </Number_of_time_steps>\n  \
         <Time_step_size> {step:e} </Time_step_size>\n{GENERAL}</GeneralSimulationParameters>\n\n\
         <Add_mesh name=\"msh\">\n  <Mesh_file_path> {MESH} </Mesh_file_path>\n{faces}</Add_mesh>\n\n\
         <Add_equation type=\"fluid\">\n{EQUATION}  <Density> {:e} </Density>\n  <Viscosity model=\"Constant\">\n    \
         <Value> {:e} </Value>\n  </Viscosity>\n\n{OUTPUT}\n{conditions}</Add_equation>\n\n</svMultiPhysicsFile>\n",
        flow.density, flow.viscosity
    )
}

fn condition(patch: &Patch, flow: &Flow) -> String {
    let at = flow.at(patch);
    match Role::of(patch) {
        // Inflow is opposite to the normal.
        Role::Inlet => format!(
            "    <Type> Dir </Type>\n    <Time_dependence> Steady </Time_dependence>\n    <Profile> Parabolic </Profile>\n    \
             <Impose_flux> true </Impose_flux>\n    <Value> {:e} </Value>\n",
            -at.flow
        ),
        Role::Outlet => format!(
            "    <Type> Neu </Type>\n    <Time_dependence> Resistance </Time_dependence>\n    <Value> {:e} </Value>\n",
            at.outlet.resistance()
        ),
        Role::Wall => {
            "    <Type> Dir </Type>\n    <Time_dependence> Steady </Time_dependence>\n    <Value> 0.0 </Value>\n".into()
        }
    }
}

const GENERAL: &str = "  <Spectral_radius_of_infinite_time_step> 0.5 </Spectral_radius_of_infinite_time_step>
  <Searched_file_name_to_trigger_stop> STOP_SIM </Searched_file_name_to_trigger_stop>
  <Save_results_to_VTK_format> true </Save_results_to_VTK_format>
  <Name_prefix_of_saved_VTK_files> result </Name_prefix_of_saved_VTK_files>
  <Increment_in_saving_VTK_files> 10 </Increment_in_saving_VTK_files>
  <Start_saving_after_time_step> 1 </Start_saving_after_time_step>
  <Increment_in_saving_restart_files> 30 </Increment_in_saving_restart_files>
  <Convert_BIN_to_VTK_format> false </Convert_BIN_to_VTK_format>
  <Verbose> true </Verbose>
  <Warning> false </Warning>
  <Debug> false </Debug>
";

const EQUATION: &str = "  <Coupled> true </Coupled>
  <Min_iterations> 3 </Min_iterations>
  <Max_iterations> 10 </Max_iterations>
  <Tolerance> 1e-6 </Tolerance>
  <Backflow_stabilization_coefficient> 0.2 </Backflow_stabilization_coefficient>
";

const OUTPUT: &str = "  <Output type=\"Spatial\">
    <Velocity> true </Velocity>
    <Pressure> true </Pressure>
    <Traction> true </Traction>
    <WSS> true </WSS>
  </Output>
  <Output type=\"Boundary_integral\">
    <Velocity> true </Velocity>
    <Pressure> true </Pressure>
  </Output>

  <LS type=\"NS\">
    <Linear_algebra type=\"fsils\">
      <Preconditioner> fsils </Preconditioner>
    </Linear_algebra>
    <Max_iterations> 15 </Max_iterations>
    <NS_GM_max_iterations> 10 </NS_GM_max_iterations>
    <NS_CG_max_iterations> 300 </NS_CG_max_iterations>
    <Tolerance> 1e-3 </Tolerance>
    <NS_GM_tolerance> 1e-3 </NS_GM_tolerance>
    <NS_CG_tolerance> 1e-3 </NS_CG_tolerance>
    <Absolute_tolerance> 1e-17 </Absolute_tolerance>
    <Krylov_space_dimension> 250 </Krylov_space_dimension>
  </LS>
";
