//! `anastomesh mesh --embed`: tissue around vessels that are lines.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::certificate::{CertificateArgs, Certified};
use super::common::{Common, ended, print, thread_pool};
use super::domain::DomainArgs;
use super::exit::{Exit, Failure};
use super::fidelity::conclude;
use super::format::FormatArgs;
use super::grid::GridArgs;
use super::hint;
use super::log;
use super::network::NetworkArgs;
use super::prepare::CureArgs;
use super::progress::Bars;
use super::regions::advice;
use super::run::remarks;
use super::stop::{NOTHING_KEPT, Stop};
use crate::report::embed::{EmbedSummary, table};
use crate::report::verdict::Verdict;
use anastomesh_domain::{DomainError, Embedding, PiecesError};
use anastomesh_io::ensure_text_writable;
use anastomesh_io::network::{NetworkFile, NodeNames};
use anastomesh_io::volume::{MeshFormat, MeshNotes, WriteOptions, ensure_writable_as, stage_mesh};
use anastomesh_mesh::check::CheckReport;
use anastomesh_mesh::check::text::conditions;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_network::{PrepareParams, PrepareReport, Prepared, prepare};
use anastomesh_skeleton::{CleanReport, NodeId, Skeleton};
use rustc_hash::FxHashSet;

/// Peak memory per tetrahedron, in bytes.
const BYTES_PER_TET: u64 = 300;

/// Options of an embedding.
pub struct EmbedRun<'a> {
    pub network: &'a NetworkArgs,
    pub output: &'a Path,
    pub format: FormatArgs,
    pub grid: GridArgs,
    pub domain: &'a DomainArgs,
    pub cures: &'a CureArgs,
    /// Memory limit.
    pub memory: u64,
    pub certificate: &'a CertificateArgs,
    pub common: &'a Common,
}

/// Network to embed.
struct Vessels {
    network: Skeleton,
    /// Number of each edge in the file.
    edges: Vec<u32>,
    names: NodeNames,
    report: PrepareReport,
}

/// Output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    prepare: &'a PrepareReport,
    embedding: &'a EmbedSummary,
    check: &'a CheckReport,
    verdict: &'a str,
}

impl EmbedRun<'_> {
    /// Embeds the network and writes mesh and table.
    pub fn run(&self) -> Result<Exit, Failure> {
        let plan = self.domain.embedding(self.network, (self.memory / BYTES_PER_TET) as usize)?;
        let format = self.format.of(self.output)?;
        if self.format.parts.is_some() && format != MeshFormat::Pvtu {
            return Err(Failure::usage("--parts with regions around the lumen needs .pvtu"));
        }
        if format == MeshFormat::SimVascular {
            return Err(Failure::usage("--embed makes no lumen, which .svmesh needs: use another format"));
        }
        ensure_writable_as(format, self.output).map_err(|e| Failure::input(e.to_string()))?;
        ensure_text_writable(&self.table()).map_err(|e| Failure::unwritable(&self.table(), &e))?;
        self.certificate.ensure_writable(format)?;
        let pool = thread_pool(self.common.threads)?;
        let stop = Stop::listen(self.common.quiet)?;
        let bars = Bars::new(self.common.quiet, self.common.progress, stop.clone());
        let vessels = self.vessels(&bars)?;
        let Vessels { network, names, .. } = &vessels;
        let make = || {
            plan.check(network, &|node| names.of(NodeId(node)))?;
            Embedding::of(network, &plan, &bars)
        };
        let made = pool.install(make).map_err(|e| self.explain(e, &vessels.edges))?;
        bars.keep();
        pool.install(|| self.finish(&made, &vessels, &bars))
    }

    /// Reads the network. Only its radii are repaired: pieces belong to the edges of the file.
    fn vessels(&self, bars: &Bars) -> Result<Vessels, Failure> {
        let params = PrepareParams::as_is().radii(self.cures.params(true).radii);
        let NetworkFile { skeleton, notes, groups, names, .. } = self.network.file(params.radii)?;
        let Prepared { given, report, .. } = prepare(&skeleton, &groups, &params).map_err(|e| {
            let (path, error) = (self.network.network.display(), hint::of_skeleton(&e, &names));
            Failure::input(format!("{path}: {error}; correct the file"))
        })?;
        for remark in remarks(&notes, &report, &names, self.common.verbose) {
            bars.note(&remark);
        }
        let edges = kept(skeleton.edges.len(), &report.cleaned);
        Ok(Vessels { network: given, edges, names, report })
    }

    /// Writes the files and the report.
    fn finish(&self, made: &Embedding, vessels: &Vessels, bars: &Bars) -> Result<Exit, Failure> {
        let Embedding { mesh, regions, pieces, check, .. } = made;
        let options = format!("mesh{}", self.domain.typed());
        let notes = MeshNotes {
            generator: concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into(),
            options: options.clone(),
            regions: regions.clone(),
            ..MeshNotes::default()
        };
        let remark = |text: &str| bars.note(&format!("{}: {text}", self.output.display()));
        let how = WriteOptions::default()
            .format(self.format.format)
            .memory((self.memory / 4) as usize)
            .grid(self.grid.options())
            .parts(self.format.parts)
            .remark(&remark as &dyn Fn(&str));
        let (path, text) = (self.table(), table(pieces, &vessels.network, &vessels.edges, &vessels.names));
        let unwritable = |e: &dyn Display| Failure::unwritable(&path, e);
        let text = text.map_err(|e| unwritable(&e))?;
        let stage = || stage_mesh(&how, self.output, mesh, &notes, bars);
        let failed = |e: &dyn Display| {
            if bars.is_cancelled() { Failure::stopped(NOTHING_KEPT) } else { Failure::input(e.to_string()) }
        };
        let mut outputs = bars.during(Stage::Write, stage).map_err(|e| failed(&e))?;
        outputs.add_bytes(&path, &text).map_err(|e| unwritable(&e))?;
        let (input, format) = (&self.network.network, self.format.of(self.output)?);
        let certified = Certified { input, mesh: self.output, format, options: &options, check };
        self.certificate.stage(&certified, &mut outputs)?;
        outputs.place()?;
        let (verdict, summary) = (Verdict::of_check(check), EmbedSummary::of(made, &vessels.network));
        self.print(&summary, vessels, check, &verdict, bars)?;
        Ok(conclude(self.common, &verdict))
    }

    fn print(
        &self,
        summary: &EmbedSummary,
        vessels: &Vessels,
        check: &CheckReport,
        verdict: &Verdict,
        bars: &Bars,
    ) -> Result<(), Failure> {
        if self.common.json {
            let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
            let (prepare, embedding) = (&vessels.report, summary);
            let output = Output { program, prepare, embedding, check, verdict: &verdict.text };
            return print(true, &output, String::new);
        }
        if self.common.quiet {
            return Ok(());
        }
        if self.common.verbose {
            log::result(&conditions(check));
        }
        let table = self.table();
        let files: Vec<&Path> = [self.output, &table].into_iter().chain(self.certificate.path()).collect();
        log::result(&summary.text(check, &ended(&files), &bars.stages(), self.common.verbose));
        Ok(())
    }

    /// Path of the table of pieces.
    fn table(&self) -> PathBuf {
        let mut name = self.output.file_stem().unwrap_or_default().to_owned();
        name.push("_embedding.csv");
        self.output.with_file_name(name)
    }

    /// Failure of an embedding. `edges` are the numbers of the edges in the file.
    fn explain(&self, mut error: DomainError, edges: &[u32]) -> Failure {
        if error.is_cancelled() {
            return Failure::stopped(NOTHING_KEPT);
        }
        if let DomainError::Pieces(PiecesError::Outside { edge, .. } | PiecesError::Mesh { edge }) = &mut error {
            *edge = edges.get(*edge as usize).copied().unwrap_or(*edge);
        }
        let advice = advice(&error, "--embed-size");
        Failure::input(format!("{}: {error}{advice}", self.network.network.display()))
    }
}

/// Numbers of the edges that cleaning kept, of a number of edges.
fn kept(edges: usize, cleaned: &CleanReport) -> Vec<u32> {
    let repeated = cleaned.repeated.iter().map(|(edge, _)| edge);
    let dropped: FxHashSet<u32> =
        cleaned.zero_length.iter().chain(&cleaned.contracted).chain(repeated).copied().collect();
    (0..edges as u32).filter(|edge| !dropped.contains(edge)).collect()
}
