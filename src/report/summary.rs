//! What a run did, read in ten seconds: what came in, what was made, whether it is valid, where it is, how long it took.

use crate::fidelity::Fidelity;
use crate::mesh::check::{CheckReport, Offender};
use crate::pipeline::{Forecast, RunReport};
use crate::report::check::{describe, extent, verdict};
use std::fmt::{self, Write as _};

/// Things of a kind that are spelt out.
const SPELT_OUT: usize = 3;

/// Stages that took a smaller share of the time are not mentioned.
const MENTIONED: f64 = 0.02;

/// A file that was written, and its size in bytes.
pub type Written = (String, u64);

/// What there is to say of a run.
#[derive(Clone, Debug)]
pub struct Summary<'a> {
    pub run: &'a RunReport,
    /// None where there is no mesh.
    pub check: Option<&'a CheckReport>,
    pub fidelity: Option<&'a Fidelity>,
    pub files: &'a [Written],
    /// Most bytes of memory that were in use, where the system tells.
    pub memory: Option<u64>,
}

impl fmt::Display for Summary<'_> {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let run = self.run;
        let [nodes, edges] = run.network.map(grouped);
        line(out, "network", &format!("{nodes} nodes, {edges} edges{}", self.overlaps()))?;
        line(out, "blocks", &self.blocks())?;
        self.troubles(out)?;
        let Some(check) = self.check else { return line(out, "time", &self.time()) };
        line(out, "mesh", &sizes(check))?;
        if let Some(q) = &check.quality {
            let angles = format!("dihedral angles {:.0}° to {:.0}°", q.dihedral_min, q.dihedral_max);
            line(out, "shape", &format!("radius ratio {:.2} in the mean, {:.2} at least; {angles}", q.mean, q.min))?;
        }
        if let Some(f) = self.fidelity {
            let (wall, volume) = (100.0 * f.wall.median, 100.0 * f.swelling());
            line(out, "vessels", &format!("wall {wall:.1} % off the radius in the median, volume {volume:+.1} %"))?;
        }
        for (name, bytes) in self.files {
            line(out, "file", &format!("{name} ({})", bytes_of(*bytes)))?;
        }
        line(out, "time", &self.time())?;
        for failed in check.failed() {
            writeln!(out, "FAIL {}: {}", failed.line.statement(), extent(failed))?;
            let shown: Vec<&Offender> = failed.offenders.iter().take(SPELT_OUT).collect();
            for offender in &shown {
                line(out, "", &describe(offender))?;
            }
            let hidden = failed.count.saturating_sub(shown.len() as u64);
            if hidden > 0 {
                line(out, "", &format!("and {hidden} more (-v shows ten, --report where they are)"))?;
            }
        }
        writeln!(out, "{}", verdict(check.verdict))
    }
}

impl Summary<'_> {
    fn overlaps(&self) -> String {
        match self.run.overlaps.len() {
            0 => String::new(),
            n => format!("; {} overlapping pairs", grouped(n)),
        }
    }

    fn blocks(&self) -> String {
        let (b, run) = (&self.run.blocks, self.run);
        let mut text = format!("{} clusters, {} connectors", grouped(b.clusters), grouped(b.connectors));
        for (count, what) in [(run.retries.len(), "retried"), (run.fused.len(), "fused"), (run.failed.len(), "FAILED")]
        {
            if count > 0 {
                let _ = write!(text, ", {count} {what}");
            }
        }
        if !run.retries.is_empty() || !run.fused.is_empty() {
            text.push_str(" (-v lists them)");
        }
        text
    }

    /// Blocks that failed, axes that are outside, vessels that became one.
    fn troubles(&self, out: &mut fmt::Formatter) -> fmt::Result {
        for failed in self.run.failed.iter().take(SPELT_OUT) {
            writeln!(out, "  FAILED {} (nodes {:?}): {}", failed.block, failed.nodes, failed.reason)?;
            if let Some(dump) = &failed.dump {
                writeln!(out, "    its input is in {dump}")?;
            }
        }
        more(out, self.run.failed.len())?;
        let astray = || self.run.fused.iter().filter(|f| f.astray.outside.is_some() || f.astray.fused.is_some());
        for fused in astray().take(SPELT_OUT) {
            let (block, nodes) = (&fused.block, &fused.nodes);
            if let Some(at) = fused.astray.outside {
                let place = format!("{:.4} {:.4} {:.4}", at.x, at.y, at.z);
                writeln!(out, "  {block} (nodes {nodes:?}): an axis is not within the wall at {place}")?;
            }
            if let Some([p, _]) = fused.astray.fused {
                let place = format!("{:.4} {:.4} {:.4}", p.x, p.y, p.z);
                writeln!(out, "  {block} (nodes {nodes:?}): vessels became one lumen at {place}")?;
            }
        }
        more(out, astray().count())
    }

    fn time(&self) -> String {
        let all: f64 = self.run.stages.iter().map(|stage| stage.seconds).sum();
        let mut longest: Vec<_> = self.run.stages.iter().filter(|s| s.seconds >= MENTIONED * all).collect();
        longest.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        let longest: Vec<String> =
            longest.iter().take(SPELT_OUT).map(|s| format!("{} {}", s.stage, seconds_of(s.seconds))).collect();
        let memory = self.memory.map_or_else(String::new, |bytes| format!("; {} of memory at most", bytes_of(bytes)));
        format!("{} ({}){memory}", seconds_of(all), longest.join(", "))
    }
}

fn sizes(check: &CheckReport) -> String {
    let counts = &check.counts;
    let tets = if counts.tets > 0 { format!("{} tetrahedra, ", grouped(counts.tets)) } else { String::new() };
    format!(
        "{tets}{} points, {} boundary faces, {} inlets and outlets",
        grouped(counts.points),
        grouped(counts.boundary_faces),
        counts.caps
    )
}

fn more(out: &mut fmt::Formatter, count: usize) -> fmt::Result {
    match count.saturating_sub(SPELT_OUT) {
        0 => Ok(()),
        hidden => writeln!(out, "    and {hidden} more (-v lists them)"),
    }
}

fn line(out: &mut fmt::Formatter, what: &str, text: &str) -> fmt::Result {
    writeln!(out, "{what:<8} {text}")
}

/// What a run is expected to take, on so many threads.
pub fn forecast(forecast: &Forecast, threads: usize) -> String {
    let Forecast { clusters, connectors, largest_nodes, estimate, .. } = forecast;
    let mut out = String::new();
    let rows = [
        (
            "blocks",
            format!(
                "{} clusters (largest {largest_nodes} nodes), {} connectors",
                grouped(*clusters),
                grouped(*connectors)
            ),
        ),
        ("mesh", format!("about {} tetrahedra", rounded(estimate.tets))),
        ("time", format!("about {} on {threads} threads", seconds_of(forecast.seconds(threads)))),
        ("memory", format!("about {}", bytes_of(forecast.memory(threads)))),
        (
            "disk",
            format!(
                "about {} for the mesh, {} for blocks until it is written",
                bytes_of(estimate.written_bytes),
                bytes_of(estimate.stored_bytes)
            ),
        ),
    ];
    for (what, text) in rows {
        let _ = writeln!(out, "{what:<8} {text}");
    }
    out.push_str("nothing was meshed (--dry-run)\n");
    out
}

/// Two digits of a number, and how many there are in words.
fn rounded(number: f64) -> String {
    match number {
        n if n >= 1e9 => format!("{:.1} billion", n / 1e9),
        n if n >= 1e6 => format!("{:.1} million", n / 1e6),
        n => grouped((n / 100.0).round() as usize * 100),
    }
}

/// A count with its thousands apart.
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// Bytes for people.
fn bytes_of(bytes: u64) -> String {
    match bytes as f64 {
        b if b >= 1e9 => format!("{:.1} GB", b / 1e9),
        b if b >= 1e6 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.0} kB", (b / 1e3).ceil()),
    }
}

/// A time for people.
fn seconds_of(seconds: f64) -> String {
    match seconds {
        s if s >= 7200.0 => format!("{:.1} h", s / 3600.0),
        s if s >= 120.0 => format!("{:.0} min", s / 60.0),
        s if s >= 10.0 => format!("{s:.0} s"),
        s => format!("{s:.1} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::check_tets;
    use crate::mesh::shapes::cube_lattice;
    use crate::pipeline::{Estimate, FailedBlock, StageTime};

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
        let files = [("tree.vtu".to_owned(), 1_016_155)];
        let text =
            Summary { run: &run(), check: Some(&check), fidelity: None, files: &files, memory: Some(250_000_000) }
                .to_string();
        let expected = "\
network  1,234 nodes, 1,233 edges
blocks   0 clusters, 0 connectors
mesh     48 tetrahedra, 27 points, 48 boundary faces, 0 inlets and outlets
";
        assert!(text.starts_with(expected), "{text}");
        assert!(text.contains("\nfile     tree.vtu (1.0 MB)\n"), "{text}");
        assert!(
            text.contains("\ntime     3 min (blocks 2 min, write 22 s, check 5.0 s); 250.0 MB of memory at most\n"),
            "{text}"
        );
        assert!(text.contains("\nFAIL every tetrahedron is positive: 9 found\n         tetrahedron 0 at "), "{text}");
        assert!(text.contains("\n         and 6 more (-v shows ten, --report where they are)\n"), "{text}");
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
        let text = Summary { run: &run, check: None, fidelity: None, files: &[], memory: None }.to_string();
        let expected = "\
network  1,234 nodes, 1,233 edges
blocks   0 clusters, 0 connectors, 5 FAILED
  FAILED cluster 0 (nodes [0]): no room
    its input is in d/0.json
  FAILED cluster 1 (nodes [1]): no room
    its input is in d/1.json
  FAILED cluster 2 (nodes [2]): no room
    its input is in d/2.json
    and 2 more (-v lists them)
time     3 min (blocks 2 min, write 22 s, check 5.0 s)
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
        };
        let found = forecast(&Forecast { clusters: 59_000, connectors: 58_999, largest_nodes: 12, estimate }, 2);
        let expected = "\
blocks   59,000 clusters (largest 12 nodes), 58,999 connectors
mesh     about 181.0 million tetrahedra
time     about 5 min on 2 threads
memory   about 120.0 MB
disk     about 4.2 GB for the mesh, 3.1 GB for blocks until it is written
nothing was meshed (--dry-run)
";
        assert_eq!(found, expected);
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
    }
}
