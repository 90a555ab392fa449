//! Short summary of a run: input, mesh, validity, output files, time.

use super::rows::{Ended, row};
use crate::fidelity::Fidelity;
use crate::pipeline::{Forecast, RunReport};
use anastomesh_mesh::check::CheckReport;
use anastomesh_mesh::check::text::{faults, shape, sizes, tally, verdict};
use anastomesh_mesh::units::{bytes_of, counted, digits, grouped, rounded, seconds_of};
use std::fmt::{self, Write as _};

/// Maximum number of listed items of a kind.
const SPELT_OUT: usize = 3;

/// Contents of a summary.
#[derive(Clone, Debug)]
pub struct Summary<'a> {
    pub run: &'a RunReport,
    /// Check result; `None` without a mesh.
    pub check: Option<&'a CheckReport>,
    pub fidelity: Option<&'a Fidelity>,
    pub ended: Ended,
    /// True if all details are printed above it.
    pub listed: bool,
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let [nodes, edges] = self.run.network;
        let size = format!("{}, {}{}", counted(nodes, "node"), counted(edges, "edge"), self.overlaps());
        out.write_str(&row("network", &size))?;
        out.write_str(&row("blocks", &self.blocks()))?;
        self.troubles(out)?;
        if let Some(check) = self.check {
            out.write_str(&of_mesh(check))?;
        }
        if let Some(fidelity) = self.fidelity {
            out.write_str(&row("vessels", &vessels(fidelity)))?;
        }
        out.write_str(&self.ended.rows(&self.run.stages))?;
        self.check.map_or(Ok(()), |check| out.write_str(&of_check(check, self.listed)))
    }
}

impl Summary<'_> {
    fn overlaps(&self) -> String {
        match self.run.overlaps.len() {
            0 => String::new(),
            n => format!("; {}", counted(n, "overlapping pair")),
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
        text
    }

    /// Appends failed blocks, axes outside the wall, and fused vessels.
    fn troubles(&self, out: &mut fmt::Formatter) -> fmt::Result {
        for failed in self.run.failed.iter().take(SPELT_OUT) {
            writeln!(out, "  FAILED {} (nodes {:?}): {}", failed.block, failed.nodes, failed.reason)?;
            if let Some(dump) = &failed.dump {
                writeln!(out, "    input written to {dump}")?;
            }
        }
        more(out, self.run.failed.len())?;
        let astray = || self.run.fused.iter().filter(|f| f.astray.outside.is_some() || f.astray.fused.is_some());
        for fused in astray().take(SPELT_OUT) {
            let (block, nodes) = (&fused.block, &fused.nodes);
            if let Some(at) = fused.astray.outside {
                let place = format!("{:.4} {:.4} {:.4}", at.x, at.y, at.z);
                writeln!(out, "  {block} (nodes {nodes:?}): a vessel axis lies outside the wall at {place}")?;
            }
            if let Some([p, _]) = fused.astray.fused {
                let place = format!("{:.4} {:.4} {:.4}", p.x, p.y, p.z);
                writeln!(out, "  {block} (nodes {nodes:?}): vessels fused into one lumen at {place}")?;
            }
        }
        more(out, astray().count())
    }
}

/// Size and quality of the mesh.
pub fn of_mesh(check: &CheckReport) -> String {
    let shape = shape(check).map_or_else(String::new, |shape| row("shape", &shape));
    row("mesh", &sizes(check)) + &shape
}

/// Options that show more faults.
const MORE_FAULTS: &str = " (-v lists ten, --report shows their positions)";

/// Result of a check: passed conditions, failed ones, verdict. With `listed`, all are printed elsewhere.
pub fn of_check(check: &CheckReport, listed: bool) -> String {
    format!("{}{}{}\n", row("check", &tally(check, listed)), faults(check, MORE_FAULTS), verdict(check.verdict))
}

/// Fidelity of a mesh: displacement if vessels were moved, else the radius error of the wall.
fn vessels(fidelity: &Fidelity) -> String {
    let volume = format!("volume {:+.1} %", 100.0 * fidelity.swelling());
    let (axis, wall) = (&fidelity.axis.spread, &fidelity.wall);
    if fidelity.is_moved() {
        let [median, most] = [axis.median, axis.worst].map(digits);
        return format!("axis displacement median {median} radii, max {most}; {volume}");
    }
    format!("median radius error {:.1} %, {volume}", 100.0 * wall.median)
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
        let text = Summary { run: &run(), check: Some(&check), fidelity: None, ended, listed: false }.to_string();
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
        assert!(text.ends_with("\nNOT valid\n"), "{text}");
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
        let text = Summary {
            run: &run,
            check: None,
            fidelity: None,
            ended: Ended { seconds: 158.0, ..Ended::default() },
            listed: false,
        }
        .to_string();
        let expected = "\
network  1,234 nodes, 1,233 edges
blocks   0 clusters, 0 connectors, 5 FAILED
  FAILED cluster 0 (nodes [0]): no room
    input written to d/0.json
  FAILED cluster 1 (nodes [1]): no room
    input written to d/1.json
  FAILED cluster 2 (nodes [2]): no room
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
        };
        let found = Forecast {
            clusters: 59_000,
            connectors: 58_999,
            largest_nodes: 12,
            estimate,
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
