//! HTML report option, shared by commands that make or check a mesh.

use std::io;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::config::options_in_force;
use super::exit::Failure;
use super::stop;
use crate::report::page::{Mark, Page, Section};
use anastomesh_io::{OutputSet, ensure_text_writable};

#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub struct ReportArgs {
    /// Write an HTML report with pictures, plots, tables and the check, as one self-contained page
    #[arg(long, value_name = "PAGE.html")]
    report: Option<PathBuf>,
}

impl ReportArgs {
    /// Path of the report, if requested.
    pub fn page(&self) -> Option<&PathBuf> {
        self.report.as_ref()
    }

    /// Checks before any work that the report can be written.
    pub fn ensure_writable(&self) -> Result<(), Failure> {
        let Some(path) = &self.report else { return Ok(()) };
        if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("html")) {
            return Err(Failure::input(format!("{}: unrecognised report extension; known: .html", path.display())));
        }
        ensure_text_writable(path).map_err(|e| Failure::unwritable(path, &e))
    }

    /// Writes the requested report about a file, with the sections that `fill` adds and the command line.
    pub fn write(
        &self,
        about: &Path,
        verdict: Option<(Mark, String)>,
        plan: &impl Serialize,
        fill: impl FnOnce(&mut Page) -> io::Result<()>,
    ) -> Result<(), Failure> {
        let mut outputs = OutputSet::default();
        self.stage((about, &mut outputs), verdict, plan, fill)?;
        Ok(outputs.place()?)
    }

    /// Adds the report to the outputs of a run.
    pub fn stage(
        &self,
        (about, outputs): (&Path, &mut OutputSet),
        verdict: Option<(Mark, String)>,
        plan: &impl Serialize,
        fill: impl FnOnce(&mut Page) -> io::Result<()>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.report else { return Ok(()) };
        let mut page = Page::new(about.file_name().unwrap_or(about.as_os_str()).to_string_lossy(), verdict);
        fill(&mut page).map_err(|e| Failure::input(format!("{}: {e}", about.display())))?;
        let plan = serde_json::to_string_pretty(plan).unwrap_or_default();
        page.add(
            Section::new("Command and options")
                .command(&stop::command_line())
                .table(&["option", "value", "source"], options_in_force())
                .folded("Resolved parameters (JSON)", &plan),
        );
        outputs.add_bytes(path, page.html().as_bytes()).map_err(|e| Failure::unwritable(path, &e))
    }
}
