//! What a run of the mesher did, for people.

use crate::pipeline::RunReport;
use std::fmt::Write as _;

/// The report as lines for people.
pub fn text(run: &RunReport) -> String {
    let mut out = String::new();
    let (b, m) = (&run.blocks, &run.mesh);
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "{} clusters (largest {} nodes), {} connectors, {} blocks retried, {} failed",
        b.clusters,
        b.largest_cluster_nodes,
        b.connectors,
        run.retries.len(),
        run.failed.len()
    );
    for retry in &run.retries {
        let _ =
            writeln!(out, "  retried {} (nodes {:?}): {}; {}", retry.block, retry.nodes, retry.reason, retry.remedy);
    }
    for f in &run.fused {
        let _ = writeln!(
            out,
            "  overlapping vessels in {} (nodes {:?}): {} handles for {} loops, terminals without a cap {:?}",
            f.block, f.nodes, f.handles, f.loops, f.uncapped
        );
    }
    for failed in &run.failed {
        let _ = writeln!(out, "  FAILED {} (nodes {:?}): {}", failed.block, failed.nodes, failed.reason);
        if let Some(dump) = &failed.dump {
            let _ = writeln!(out, "    its input is in {dump}");
        }
    }
    let _ = writeln!(
        out,
        "{} tetrahedra, {} points, {} wall triangles, {} cap triangles",
        m.tets, m.points, m.wall_triangles, m.cap_triangles
    );
    let times: Vec<String> = run.stages.iter().map(|s| format!("{} {:.2} s", s.stage, s.seconds)).collect();
    let _ = writeln!(out, "{}", times.join(", "));
    out
}
