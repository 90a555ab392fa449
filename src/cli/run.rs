//! Notes and failures of commands that mesh a network.

use std::path::Path;

use super::exit::Failure;
use super::hint;
use super::stop::NOTHING_KEPT;
use crate::pipeline::RunError;
use crate::run::MeshingError;
use anastomesh_flow::FlowError;
use anastomesh_io::network::{NetworkNote, NodeNames};
use anastomesh_network::PrepareReport;
use anastomesh_network::RefineError;
use anastomesh_skeleton::NodeId;

/// Text lines on reading and preparation; with `all`, in full.
pub fn remarks(notes: &[NetworkNote], report: &PrepareReport, names: &NodeNames, all: bool) -> Vec<String> {
    let mut lines: Vec<String> = notes.iter().map(hint::of_note).collect();
    if report.changed() {
        lines.extend(report.text(all, &|node| names.of(NodeId(node))).lines().map(ToString::to_string));
    }
    lines
}

/// Failure of a run before its blocks. `stopped` makes the failure of a stopped run.
pub fn failure(error: MeshingError, network: &Path, stopped: impl FnOnce() -> Failure) -> Failure {
    match error {
        MeshingError::Skeleton(e) => Failure::input(format!("{}: {e}; correct the file", network.display())),
        MeshingError::Inlet(e) => Failure::usage(format!("--root: {e}")),
        MeshingError::Flow(e @ FlowError::NotConverged(_)) => Failure::stage(e.to_string()),
        MeshingError::Flow(e) => Failure::input(hint::of_flow(&e)),
        MeshingError::Refine(e) => refine_failure(&e),
        MeshingError::Run(RunError::Cancelled) => stopped(),
        MeshingError::Run(e @ (RunError::Root(_) | RunError::Plan(_))) => Failure::usage(e.to_string()),
        MeshingError::Run(e @ (RunError::TooLarge(_) | RunError::Store(_))) => Failure::input(hint::of_run(&e)),
        e @ (MeshingError::Run(_) | MeshingError::Blocks { .. }) => Failure::stage(e.to_string()),
    }
}

/// Failure of a refinement.
pub fn refine_failure(error: &RefineError) -> Failure {
    match error {
        RefineError::Skeleton(_) => Failure::input(error.to_string()),
        RefineError::Cancelled => Failure::stopped(NOTHING_KEPT),
        _ => Failure::usage(error.to_string()),
    }
}
