//! Results of a validity check, line by line.

use super::figures::{LengthUnit, figure};
use super::html::{Mark, Section};
use super::pictures::offenders;
use crate::report::verdict::Verdict;
use anastomesh_mesh::check::text::{describe, reason, violation};
use anastomesh_mesh::check::{CheckReport, Outcome, Verdict as Validity};
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::units::grouped;
use std::io;

/// Maximum number of listed offenders per line.
const LISTED: usize = 3;

/// Verdict for the page header.
pub fn headline(check: &CheckReport, verdict: &Verdict) -> (Mark, String) {
    let mark = match (verdict.is_good, check.verdict) {
        (false, _) | (_, Validity::Invalid) => Mark::Bad,
        (true, Validity::NoFaultFound) => Mark::Neither,
        (true, Validity::Valid) => Mark::Good,
    };
    (mark, verdict.text.clone())
}

/// Sizes of the checked mesh.
pub fn summary(check: &CheckReport, unit: LengthUnit) -> Section {
    let counts = &check.counts;
    let mut tiles = vec![
        ("tetrahedra", grouped(counts.tets)),
        ("points", grouped(counts.points)),
        ("boundary faces", grouped(counts.boundary_faces)),
        ("inlets and outlets", grouped(counts.caps)),
        ("components", grouped(counts.components)),
        ("volume", unit.volume(counts.volume)),
    ];
    if let Some(quality) = &check.quality {
        tiles.push(("mean radius ratio", figure(quality.mean)));
    }
    Section::new("Summary").tiles(&tiles)
}

/// Options that may help after a failed run.
pub fn advice(lines: &[String]) -> Section {
    let section = Section::new("What may help");
    if lines.is_empty() {
        return section;
    }
    section.list(&lines.iter().map(|line| (Mark::Neither, line.clone())).collect::<Vec<_>>())
}

/// Result of each line of the validity definition, with pictures of violations.
///
/// # Errors
/// The mesh cannot be read.
pub fn validity(check: &CheckReport, mesh: &dyn MeshSource) -> io::Result<Section> {
    let mut items = Vec::new();
    for line in &check.lines {
        let statement = line.line.statement();
        items.push(match line.outcome {
            Outcome::Pass => (Mark::Good, statement.to_owned()),
            Outcome::NotChecked(why) => (Mark::Neither, format!("{statement}: skipped, because {}", reason(why))),
            Outcome::Fail => (Mark::Bad, violation(line)),
        });
        items.extend(line.offenders.iter().take(LISTED).map(|o| (Mark::Below, describe(o))));
        let hidden = line.count.saturating_sub(line.offenders.len().min(LISTED) as u64);
        if hidden > 0 {
            items.push((Mark::Below, format!("and {} more", grouped(hidden as usize))));
        }
    }
    let section = Section::new("Validity").list(&items);
    let pictures = offenders(check, mesh)?;
    if pictures.is_empty() { Ok(section) } else { section.pictures(&pictures, true) }
}
