//! Failures of `anastomesh mesh`, after the reports that belong to them.

use super::Args;
use crate::cli::exit::Failure;
use crate::cli::progress::Bars;
use crate::cli::regions::advice;
use crate::cli::run::failure;
use crate::cli::stop;
use crate::pipeline::{MeshPlan, RunReport};
use crate::report::verdict::missing;
use crate::run::{MeshingError, Networks};
use anastomesh_domain::DomainError;
use anastomesh_skeleton::NodeId;

impl Args {
    /// Failure to make the regions.
    pub(super) fn no_regions(&self, error: &DomainError) -> Failure {
        let advice = advice(error, "--tissue-size");
        Failure::input(format!("{}: {error}{advice}", self.network.network.display()))
    }

    /// Writes the refined network and the HTML report of a run without mesh.
    fn write_reports(&self, plan: &MeshPlan, networks: &Networks, report: &RunReport) -> Result<(), Failure> {
        let mut outputs = self.stage_refined(networks)?;
        self.stage_page(plan, networks, (report, None), &mut outputs)?;
        Ok(outputs.place()?)
    }

    /// Failure of a run, after its reports.
    pub(super) fn explain(&self, error: MeshingError, plan: &MeshPlan, bars: &Bars) -> Failure {
        let MeshingError::Blocks { report, networks } = error else { return self.explain_alone(error) };
        bars.keep();
        self.tell_refined(&networks);
        let written = self.write_reports(plan, &networks, &report);
        if let Err(failure) = written.and_then(|()| self.print(plan, &networks, &report, None)) {
            return failure;
        }
        if !self.common.quiet {
            self.blocks.advise(&report, true);
        }
        let missing = missing(&report, &|node| networks.names.of(NodeId(node)));
        Failure::stage(format!("{missing}; --keep-going meshes the rest"))
    }

    /// Failure of a run before its blocks.
    pub(super) fn explain_alone(&self, error: MeshingError) -> Failure {
        failure(error, &self.network.network, || self.stopped())
    }

    /// Failure of a stopped run, with the command that continues it.
    pub(super) fn stopped(&self) -> Failure {
        Failure::stopped(self.stopped_text())
    }

    pub(super) fn stopped_text(&self) -> String {
        match &self.work.dir {
            Some(dir) => {
                let (dir, command) = (dir.display(), stop::command_line());
                format!("stopped; finished blocks are kept in {dir}. Continue with\n  {command}")
            }
            None => {
                "stopped; nothing is kept. With --work-dir DIR, finished blocks are kept and the same command continues"
                    .into()
            }
        }
    }
}
