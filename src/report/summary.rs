//! Short summary of a run: input, mesh, fidelity, validity, output files, time.

use super::rows::{Ended, row};
use super::second_order::of_midpoints;
use crate::fidelity::{Changes, Fidelity};
use crate::pipeline::{Forecast, RunReport, named};
use crate::run::Attempt;
use anastomesh_domain::ShellsReport;
use anastomesh_mesh::check::text::{faults, region_sizes, shape, sizes, tally};
use anastomesh_mesh::check::{CheckReport, RegionCounts};
use anastomesh_mesh::second_order::Curving;
use anastomesh_mesh::units::{bytes_of, counted, digits, grouped, percent, place, rounded, seconds_of};
use anastomesh_network::{NameOf, RefineReport};
use std::fmt::{self, Write as _};

/// Maximum number of listed items of a kind.
const SPELT_OUT: usize = 3;
/// Maximum number of listed overlaps with all details.
const LISTED: usize = 50;

/// Contents of a summary.
pub struct Summary<'a> {
    pub run: &'a RunReport,
    /// Report of the refinement of the meshed network.
    pub refine: Option<&'a RefineReport>,
    /// Passes over the network, and the index of the one that gave the mesh.
    pub attempts: (&'a [Attempt], usize),
    /// Names of nodes in the file.
    pub name: NameOf<'a>,
    /// Check result; `None` without a mesh.
    pub check: Option<&'a CheckReport>,
    /// Thickness of shells around the lumen; `None` without any.
    pub shells: Option<&'a ShellsReport>,
    /// Midpoints of second-order elements; `None` for linear ones.
    pub midpoints: Option<&'a Curving>,
    pub fidelity: Option<&'a Fidelity>,
    /// Changes of the network; `None` without a mesh.
    pub changes: Option<&'a Changes>,
    pub ended: Ended,
    /// True if all details are printed above it.
    pub listed: bool,
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let [nodes, edges] = self.run.network;
        out.write_str(&row("network", &format!("{}, {}", counted(nodes, "node"), counted(edges, "edge"))))?;
        self.overlaps(out)?;
        out.write_str(&row("blocks", &self.blocks()))?;
        if let Some(passes) = passes(self.attempts) {
            out.write_str(&row("passes", &passes))?;
        }
        self.troubles(out)?;
        if let Some(check) = self.check {
            out.write_str(&of_mesh(check))?;
        }
        if let Some(shells) = self.shells {
            out.write_str(&row("shells", &of_shells(shells)))?;
        }
        if let Some(midpoints) = self.midpoints {
            out.write_str(&of_midpoints(midpoints))?;
        }
        out.write_str(&fidelity_rows(self.fidelity, self.changes, self.name))?;
        out.write_str(&self.ended.rows(&self.run.stages))?;
        self.check.map_or(Ok(()), |check| out.write_str(&of_check(check, self.listed)))
    }
}

/// Rows on the difference between the result and the given network.
pub fn fidelity_rows(fidelity: Option<&Fidelity>, changes: Option<&Changes>, name: NameOf) -> String {
    let measured = fidelity.map(|fidelity| fidelity.rows(name)).into_iter().flatten();
    let mut rows: String = measured.map(|(label, text)| row(label, &text)).collect();
    if let Some(changes) = changes {
        rows += &row("changes", &changes.text(name));
    }
    rows
}

/// Thickness of shells in one line.
fn of_shells(shells: &ShellsReport) -> String {
    let ShellsReport { points, complete, thin, moved, thinnest } = *shells;
    let full = percent(complete as f64 / points.max(1) as f64);
    let least = thinnest.map_or_else(String::new, |(share, at)| {
        let share = percent(share);
        format!("; least {share} at {}, below half at {}", place(at), counted(thin, "point"))
    });
    let moved = match moved {
        0 => String::new(),
        n => format!("; {} of a folded wall moved", counted(n, "point")),
    };
    format!("full thickness at {full} of the wall{least}{moved}")
}

/// Passes over the network with the fault of each; `None` if there was one alone.
fn passes((attempts, kept): (&[Attempt], usize)) -> Option<String> {
    let words = |value: serde_json::Value| match value {
        serde_json::Value::Object(map) => map.keys().map(|key| key.replace('_', " ")).collect(),
        value => value.as_str().unwrap_or_default().replace('_', " "),
    };
    let pass = |(i, attempt): (usize, &Attempt)| {
        let name = serde_json::to_value(attempt.strategy).map_or_else(|_| String::new(), words);
        let fault = serde_json::to_value(attempt.fault).map_or_else(|_| String::new(), words);
        let fault = if fault.is_empty() { "sound".into() } else { format!("fault: {fault}") };
        format!("{name} ({fault}{})", if i == kept { ", kept" } else { "" })
    };
    (attempts.len() > 1).then(|| attempts.iter().enumerate().map(pass).collect::<Vec<_>>().join(", "))
}

impl Summary<'_> {
    /// Appends the number of overlaps, before and after a refinement, and the deepest that remain.
    fn overlaps(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let places = self.run.overlapping_places();
        let pairs = counted(self.run.overlaps.len(), "edge pair");
        match self.refine {
            None if places.is_empty() => return Ok(()),
            None => out.write_str(&row("overlaps", &format!("{} ({pairs})", counted(places.len(), "place"))))?,
            Some(report) => {
                let before = grouped(report.given.overlaps);
                let early =
                    if report.gave_up { ", which ended early: too many vessels are close to each other" } else { "" };
                out.write_str(&row("overlaps", &format!("{pairs} ({before} before refinement{early})")))?;
            }
        }
        let listed = if self.listed { places.len().min(LISTED) } else { SPELT_OUT };
        for m in places.iter().take(listed) {
            let [[a, b], [c, d]] = m.edges.map(|ends| ends.map(self.name));
            let [distance, radii] = [m.distance, m.radii].map(digits);
            writeln!(out, "  edges {a}-{b} and {c}-{d}: distance {distance}, sum of radii {radii}")?;
        }
        match places.len().saturating_sub(listed) {
            0 => Ok(()),
            hidden => writeln!(out, "    and {} more (-v lists more, --json all)", grouped(hidden)),
        }
    }

    fn blocks(&self) -> String {
        let (b, run) = (&self.run.blocks, self.run);
        let mut text = format!("{}, {}", counted(b.clusters, "cluster"), counted(b.connectors, "connector"));
        for (count, what) in [(run.retries.len(), "retried"), (run.fused.len(), "fused"), (run.failed.len(), "FAILED")]
        {
            if count > 0 {
                let _ = write!(text, ", {} {what}", grouped(count));
            }
        }
        if !run.retries.is_empty() || !run.fused.is_empty() {
            text.push_str(" (-v lists them)");
        }
        let gaps: usize = run.closed_gaps.iter().map(|gaps| gaps.places.len()).sum();
        if gaps > 0 {
            let _ = write!(text, "; {} between vessels that touch closed", counted(gaps, "narrow gap"));
        }
        text
    }

    /// Appends failed blocks, axes outside the wall, and fused vessels.
    fn troubles(&self, out: &mut fmt::Formatter) -> fmt::Result {
        for failed in self.run.failed.iter().take(SPELT_OUT) {
            let nodes = named(&failed.nodes, self.name);
            writeln!(out, "  FAILED {} (nodes {nodes}): {}", failed.block, failed.reason)?;
            if let Some(dump) = &failed.dump {
                writeln!(out, "    input written to {dump}")?;
            }
        }
        more(out, self.run.failed.len())?;
        let astray = || self.run.fused.iter().filter(|f| f.astray.outside.is_some() || f.astray.fused.is_some());
        for fused in astray().take(SPELT_OUT) {
            let (block, nodes) = (&fused.block, named(&fused.nodes, self.name));
            if let Some(at) = fused.astray.outside {
                let place = format!("{:.4} {:.4} {:.4}", at.x, at.y, at.z);
                writeln!(out, "  {block} (nodes {nodes}): a vessel axis lies outside the wall at {place}")?;
            }
            if let Some([p, _]) = fused.astray.fused {
                let place = format!("{:.4} {:.4} {:.4}", p.x, p.y, p.z);
                writeln!(out, "  {block} (nodes {nodes}): vessels fused into one lumen at {place}")?;
            }
        }
        more(out, astray().count())
    }
}

/// Size and quality of the mesh.
pub fn of_mesh(check: &CheckReport) -> String {
    let shape = shape(check).map_or_else(String::new, |shape| row("shape", &shape));
    let region = |region: &RegionCounts| row("region", &format!("{}: {}", region.name, region_sizes(region)));
    let regions: String = check.regions.iter().map(region).collect();
    row("mesh", &sizes(check)) + &regions + &shape
}

/// Options that show more faults.
const MORE_FAULTS: &str = " (-v lists ten, --report shows their positions)";

/// Result of a check without its verdict: passed and failed conditions. With `listed`, all are printed elsewhere.
pub fn of_check(check: &CheckReport, listed: bool) -> String {
    row("check", &tally(check, listed)) + &faults(check, MORE_FAULTS)
}

fn more(out: &mut fmt::Formatter, count: usize) -> fmt::Result {
    match count.saturating_sub(SPELT_OUT) {
        0 => Ok(()),
        hidden => writeln!(out, "    and {} more (-v lists them)", grouped(hidden)),
    }
}

/// Expected cost of a run with this number of threads.
pub fn forecast(forecast: &Forecast, threads: usize) -> String {
    let Forecast { clusters, connectors, largest_nodes, estimate, .. } = forecast;
    let [clusters, connectors] = [(*clusters, "cluster"), (*connectors, "connector")].map(|(n, what)| counted(n, what));
    let [written, stored] = [estimate.written_bytes, estimate.stored_bytes].map(bytes_of);
    let seconds = seconds_of(forecast.seconds(threads));
    let mut out = row("blocks", &format!("{clusters} (largest {}), {connectors}", counted(*largest_nodes, "node")));
    out += &row("mesh", &format!("about {} tetrahedra", rounded(estimate.tets)));
    out += &row("time", &format!("about {seconds} on {}", counted(threads, "thread")));
    out += &row("memory", &format!("about {}", bytes_of(forecast.memory(threads))));
    out += &row("disk", &format!("about {written} for the mesh, {stored} for temporary blocks"));
    out.push_str("estimate only (--dry-run)\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Estimate, FailedBlock, StageTime};
    use anastomesh_mesh::check::check_tets;
    use anastomesh_mesh::shapes::cube_lattice;

    fn summary<'a>(run: &'a RunReport, check: Option<&'a CheckReport>, ended: Ended) -> Summary<'a> {
        let name: NameOf = &|node| (node + 1).to_string();
        let (refine, fidelity, changes) = (None, None, None);
        Summary {
            run,
            refine,
            attempts: (&[], 0),
            name,
            check,
            shells: None,
            midpoints: None,
            fidelity,
            changes,
            ended,
            listed: false,
        }
    }

    fn run() -> RunReport {
        RunReport {
            network: [1234, 1233],
            stages: vec![
                StageTime { stage: "blocks", seconds: 130.0 },
                StageTime { stage: "write", seconds: 22.5 },
                StageTime { stage: "check", seconds: 5.0 },
                StageTime { stage: "split", seconds: 0.01 },
            ],
            ..RunReport::default()
        }
    }

    #[test]
    fn a_summary_is_a_few_lines() {
        let mut mesh = cube_lattice(2);
        for t in &mut mesh.tets[..9] {
            t.swap(0, 1);
        }
        let check = check_tets(&mesh, None);
        let files = vec![("tree.vtu".to_owned(), 1_016_155)];
        let ended = Ended { files, seconds: 160.0, memory: Some(250_000_000) };
        let text = summary(&run(), Some(&check), ended).to_string();
        let expected = "\
network  1,234 nodes, 1,233 edges
blocks   0 clusters, 0 connectors
mesh     48 tetrahedra, 27 points, 48 boundary faces, 0 caps, volume 0.62500
";
        assert!(text.starts_with(expected), "{text}");
        assert!(text.contains("\nfile     tree.vtu (1.0 MB)\n"), "{text}");
        assert!(text.contains("\ntime     3 min (blocks 2 min, write 22 s); max memory 250 MB\n"), "{text}");
        assert!(text.contains("\nFAIL 9 tetrahedra are inverted or flat\n         tetrahedron 0 at "), "{text}");
        assert!(text.contains("\n         and 6 more (-v lists ten, --report shows their positions)\n"), "{text}");
        assert!(text.lines().all(|line| !line.contains("NOT valid")), "{text}");
    }

    #[test]
    fn failed_blocks_are_counted_and_the_first_spelt_out() {
        let failed = |i: u32| FailedBlock {
            block: format!("cluster {i}"),
            nodes: vec![i],
            reason: "no room".into(),
            uncapped: Vec::new(),
            too_fine: false,
            dump: Some(format!("d/{i}.json")),
        };
        let run = RunReport { failed: (0..5).map(failed).collect(), ..run() };
        let text = summary(&run, None, Ended { seconds: 158.0, ..Ended::default() }).to_string();
        let expected = "\
network  1,234 nodes, 1,233 edges
blocks   0 clusters, 0 connectors, 5 FAILED
  FAILED cluster 0 (nodes 1): no room
    input written to d/0.json
  FAILED cluster 1 (nodes 2): no room
    input written to d/1.json
  FAILED cluster 2 (nodes 3): no room
    input written to d/2.json
    and 2 more (-v lists them)
time     3 min (blocks 2 min, write 22 s)
";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_forecast_is_in_units_that_people_read() {
        let estimate = Estimate {
            tets: 1.81e8,
            largest_block_tets: 4e4,
            largest_block_bytes: 30_000_000,
            stored_bytes: 3_077_000_000,
            written_bytes: 4_163_000_000,
            operations: 0.0,
            ..Estimate::default()
        };
        let found = Forecast {
            clusters: 59_000,
            connectors: 58_999,
            largest_nodes: 12,
            estimate,
            contoured: [1.3e8, 0.0],
            overlapping: 0,
            retry_operations: 0.0,
        };
        let found = forecast(&found, 2);
        let expected = "\
blocks   59,000 clusters (largest 12 nodes), 58,999 connectors
mesh     about 181.0 million tetrahedra
time     about 5 min on 2 threads
memory   about 120 MB
disk     about 4.2 GB for the mesh, 3.1 GB for temporary blocks
estimate only (--dry-run)
";
        assert_eq!(found, expected);
    }
}
