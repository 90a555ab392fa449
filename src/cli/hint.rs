//! Command-line options that remedy errors and notes of the library.

use crate::pipeline::{RunError, StoreError, TooLarge};
use anastomesh_flow::FlowError;
use anastomesh_io::faults::FileError;
use anastomesh_io::network::{NetworkFileError, NetworkFormat, NetworkNote, NodeNames};
use anastomesh_io::surface::SurfaceFormat;
use anastomesh_skeleton::{NodeId, SkeletonError};
use std::path::Path;

/// Error of a network file, with the remedy.
pub fn of_file(error: &NetworkFileError) -> String {
    let remedy = match error.arrays_without_radii() {
        Some([]) => " (--radius R sets all radii)",
        Some(_) => " (--radius-array NAME selects one, --radius R sets all radii)",
        None => instead_of_network(error),
    };
    format!("{error}{remedy}")
}

/// Remedy for a surface that is given as a network.
fn instead_of_network(error: &NetworkFileError) -> &'static str {
    match error {
        NetworkFileError::File(FileError::UnknownFormat { path, .. }) if SurfaceFormat::of(path).is_ok() => {
            "; to mesh a surface, use `anastomesh tetrahedralize`"
        }
        _ => "",
    }
}

/// Remedy for a network that is given as a surface.
pub fn instead_of_surface(path: &Path) -> &'static str {
    if NetworkFormat::of(path).is_ok() { "; to mesh a network, use `anastomesh mesh`" } else { "" }
}

/// Note on a network file, with the option that changes it.
pub fn of_note(note: &NetworkNote) -> String {
    let hint = match note {
        NetworkNote::NotUsed { .. } => " (choose with --radius-array)",
        NetworkNote::OutOfProportion { .. } => " (--radius-scale multiplies radii alone)",
        _ => "",
    };
    format!("{note}{hint}")
}

/// Error of a network, with nodes named as in the file.
pub fn of_skeleton(error: &SkeletonError, names: &NodeNames) -> String {
    let text = error.to_string();
    match error {
        SkeletonError::BadPosition { original, .. } | SkeletonError::BadNodeRadius { original, .. } => {
            text.replacen(&format!("node {original} "), &format!("node {} ", names.of(NodeId(*original))), 1)
        }
        _ => text,
    }
}

/// Error of a block store, with the option that helps.
pub fn of_store(error: &StoreError) -> String {
    let hint = match error {
        StoreError::Missing { .. } => ", or give --make-missing to make the rest in this run",
        StoreError::Damaged { .. } => ", or give --make-missing to make them in this run",
        StoreError::Other { .. } => ", or give --restart to delete its blocks",
        StoreError::Write { .. } => " (--work-dir)",
        StoreError::Read(_) => ", or start again with --restart",
        _ => "",
    };
    format!("{error}{hint}")
}

/// Error of a flow plan, with the options that help.
pub fn of_flow(error: &FlowError) -> String {
    let hint = match error {
        FlowError::NoReference { .. } => " (--total-resistance, --mean-pressure)",
        FlowError::TooFast { .. } => " (--inflow, --viscosity, --density, --units)",
        FlowError::UnknownInlet { .. } | FlowError::Columns { .. } | FlowError::NotInwards { .. } => " (--inflow)",
        FlowError::PressureTooLow { .. } => " (--mean-pressure)",
        FlowError::OutletTooThin { .. } => " (--tree-minimum-radius)",
        _ => "",
    };
    format!("{error}{hint}")
}

/// Error of a run that exceeds a limit, with the options that help.
pub fn of_size(error: &TooLarge) -> String {
    let hint = match error {
        TooLarge::Block { .. } | TooLarge::Regions { .. } => " (--memory, --rho)",
        TooLarge::Whole { .. } => " (--memory)",
        TooLarge::Disk { .. } => " (--rho)",
    };
    format!("{error}{hint}")
}

/// Error of a run, with the options that help.
pub fn of_run(error: &RunError) -> String {
    match error {
        RunError::Store(error) => of_store(error),
        RunError::TooLarge(error) => of_size(error),
        error => error.to_string(),
    }
}
