//! Input of `svMultiPhysics`: laminar flow with given inflow and a model at each outlet. All paths are relative to the
//! folder.

use super::inflow::Inflow;
use super::layout::{MESH, rates_path, surface_path, velocities_path};
use super::steps::Steps;
use crate::flow::{CapFlow, Flow, OutletModel, Profile, Role, plain};
use anastomesh_mesh::Patch;
use std::fmt::Write;

/// Contents of the file. Second-order elements get pressures of first order (Taylor–Hood).
pub(super) fn text(patches: &[Patch], flow: &Flow, steps: &Steps, is_second_order: bool) -> String {
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
    let (spaces, solver) = if is_second_order { (TAYLOR_HOOD, WHOLE) } else { ("", SPLIT) };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svMultiPhysicsFile version=\"0.1\">\n\n{}\
         <Add_mesh name=\"msh\">\n  <Mesh_file_path> {MESH} </Mesh_file_path>\n{faces}</Add_mesh>\n\n\
         <Add_equation type=\"fluid\">\n{EQUATION}{spaces}  <Density> {:e} </Density>\n  <Viscosity model=\"Constant\">\n    \
         <Value> {:e} </Value>\n  </Viscosity>\n\n{OUTPUT}{solver}\n{}{conditions}</Add_equation>\n\n</svMultiPhysicsFile>\n",
        general(steps),
        flow.density,
        flow.viscosity,
        remark(patches, flow)
    )
}

pub(super) fn general(steps: &Steps) -> String {
    let Steps { step, count, increment, restart, why, .. } = steps;
    format!(
        "<!-- Run inside this folder: svmultiphysics solver.xml. {why}. -->\n<GeneralSimulationParameters>\n  \
         <Continue_previous_simulation> false </Continue_previous_simulation>\n  \
         <Number_of_spatial_dimensions> 3 </Number_of_spatial_dimensions>\n  \
         <Number_of_time_steps> {count} </Number_of_time_steps>\n  <Time_step_size> {step:e} </Time_step_size>\n  \
         <Increment_in_saving_VTK_files> {increment} </Increment_in_saving_VTK_files>\n  \
         <Increment_in_saving_restart_files> {restart} </Increment_in_saving_restart_files>\n\
         {GENERAL}</GeneralSimulationParameters>\n\n"
    )
}

/// Comment on resistances with a pressure beyond them, which the solver does not have.
pub(super) fn remark(patches: &[Patch], flow: &Flow) -> String {
    let mut outlets = patches.iter().filter(|patch| patch.is_outlet()).map(|patch| flow.at(patch).outlet);
    let beyond = |outlet| match outlet {
        OutletModel::Resistance { distal_pressure, .. } => Some(distal_pressure).filter(|pressure| *pressure != 0.0),
        _ => None,
    };
    outlets.find_map(beyond).map_or_else(String::new, |pressure| {
        format!(
            "  <!-- The solver's resistances end at pressure 0. Add {pressure:e}, the pressure beyond the outlets, to all \
             pressures of the results; velocities are the same. -->\n"
        )
    })
}

pub(super) fn condition(patch: &Patch, flow: &Flow) -> String {
    let at = flow.at(patch);
    match Role::of(patch) {
        Role::Inlet => inlet(&plain(&patch.name), &at, flow),
        Role::Outlet => outlet(&at),
        Role::Wall => {
            "    <Type> Dir </Type>\n    <Time_dependence> Steady </Time_dependence>\n    <Value> 0.0 </Value>\n".into()
        }
    }
}

fn inlet(name: &str, at: &CapFlow, flow: &Flow) -> String {
    let profile = if flow.profile == Profile::Uniform { "Flat" } else { "Parabolic" };
    let ramp = match Inflow::of(at, flow) {
        Inflow::Velocities => {
            return format!(
                "    <Type> Dir </Type>\n    <Time_dependence> General </Time_dependence>\n    \
                 <Temporal_and_spatial_values_file_path> {} </Temporal_and_spatial_values_file_path>\n",
                velocities_path(name)
            );
        }
        Inflow::Ramp => "    <Ramp_function> true </Ramp_function>\n",
        Inflow::Rates => "",
    };
    format!(
        "    <Type> Dir </Type>\n    <Time_dependence> Unsteady </Time_dependence>\n    \
         <Temporal_values_file_path> {} </Temporal_values_file_path>\n{ramp}    <Profile> {profile} </Profile>\n    \
         <Impose_flux> true </Impose_flux>\n",
        rates_path(name)
    )
}

fn outlet(at: &CapFlow) -> String {
    let (kind, value) = match at.outlet {
        OutletModel::Pressure(pressure) => ("Steady", format!("    <Value> {pressure:e} </Value>\n")),
        OutletModel::Resistance { resistance, .. } => ("Resistance", format!("    <Value> {resistance:e} </Value>\n")),
        OutletModel::Rcr { proximal, capacitance, distal, distal_pressure } => {
            // The capacitance starts at its mean pressure, which shortens the way to periodic flow.
            let initial = distal_pressure + distal * at.flow;
            let values = format!(
                "    <RCR_values>\n      <Proximal_resistance> {proximal:e} </Proximal_resistance>\n      \
                 <Capacitance> {capacitance:e} </Capacitance>\n      \
                 <Distal_resistance> {distal:e} </Distal_resistance>\n      \
                 <Distal_pressure> {distal_pressure:e} </Distal_pressure>\n      \
                 <Initial_pressure> {initial:e} </Initial_pressure>\n    </RCR_values>\n"
            );
            ("RCR", values)
        }
    };
    format!("    <Type> Neu </Type>\n    <Time_dependence> {kind} </Time_dependence>\n{value}")
}

const GENERAL: &str = "  <Spectral_radius_of_infinite_time_step> 0.5 </Spectral_radius_of_infinite_time_step>
  <Searched_file_name_to_trigger_stop> STOP_SIM </Searched_file_name_to_trigger_stop>
  <Save_results_to_VTK_format> true </Save_results_to_VTK_format>
  <Name_prefix_of_saved_VTK_files> result </Name_prefix_of_saved_VTK_files>
  <Start_saving_after_time_step> 1 </Start_saving_after_time_step>
  <Convert_BIN_to_VTK_format> false </Convert_BIN_to_VTK_format>
  <Verbose> true </Verbose>
  <Warning> false </Warning>
  <Debug> false </Debug>
";

const EQUATION: &str = "  <Coupled> true </Coupled>
  <Min_iterations> 1 </Min_iterations>
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

";

const TAYLOR_HOOD: &str = "  <Use_taylor_hood_type_basis> true </Use_taylor_hood_type_basis>
";

/// Linear solver that takes momentum and mass apart, for elements of equal order.
const SPLIT: &str = "  <LS type=\"NS\">
    <Linear_algebra type=\"fsils\">
      <Preconditioner> fsils </Preconditioner>
    </Linear_algebra>
    <Max_iterations> 30 </Max_iterations>
    <NS_GM_max_iterations> 20 </NS_GM_max_iterations>
    <NS_CG_max_iterations> 1000 </NS_CG_max_iterations>
    <Tolerance> 1e-3 </Tolerance>
    <NS_GM_tolerance> 1e-3 </NS_GM_tolerance>
    <NS_CG_tolerance> 1e-3 </NS_CG_tolerance>
    <Absolute_tolerance> 1e-17 </Absolute_tolerance>
    <Krylov_space_dimension> 250 </Krylov_space_dimension>
  </LS>
";

/// Linear solver for pressures of a lower order than velocities.
const WHOLE: &str = "  <LS type=\"GMRES\">
    <Linear_algebra type=\"fsils\">
      <Preconditioner> fsils </Preconditioner>
    </Linear_algebra>
    <Max_iterations> 100 </Max_iterations>
    <Tolerance> 1e-4 </Tolerance>
    <Absolute_tolerance> 1e-12 </Absolute_tolerance>
    <Krylov_space_dimension> 250 </Krylov_space_dimension>
  </LS>
";
