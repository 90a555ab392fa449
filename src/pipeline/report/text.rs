//! Text report of a meshing run.

use super::{RunReport, ThinBlock};
use crate::block::ThinLayers;
use anastomesh_mesh::units::grouped;
use std::fmt;

/// Text report: blocks, retries, failures, sizes and times.
impl fmt::Display for RunReport {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let (b, m) = (&self.blocks, &self.mesh);
        writeln!(
            out,
            "{} clusters (largest {} nodes), {} connectors, {} blocks retried, {} failed",
            grouped(b.clusters),
            grouped(b.largest_cluster_nodes),
            grouped(b.connectors),
            grouped(self.retries.len()),
            grouped(self.failed.len())
        )?;
        for retry in &self.retries {
            writeln!(out, "  retried {} (nodes {:?}): {}; {}", retry.block, retry.nodes, retry.reason, retry.remedy)?;
        }
        for f in &self.fused {
            writeln!(
                out,
                "  overlapping vessels in {} (nodes {:?}): {} handles for {} loops, terminals without a cap {:?}",
                f.block, f.nodes, f.handles, f.loops, f.uncapped
            )?;
            if let Some(at) = f.astray.outside {
                writeln!(out, "    an axis is not within the wall at {:.4} {:.4} {:.4}", at.x, at.y, at.z)?;
            }
            if let Some([p, q]) = f.astray.fused {
                writeln!(
                    out,
                    "    one lumen from {:.4} {:.4} {:.4} to {:.4} {:.4} {:.4}, far from each other along the vessels",
                    p.x, p.y, p.z, q.x, q.y, q.z
                )?;
            }
        }
        if self.anastomoses > 0 {
            writeln!(out, "  {} anastomoses: loops that vessels make which fused", self.anastomoses)?;
        }
        for f in &self.filled {
            writeln!(
                out,
                "  {} loops filled by their own lumen in {} (nodes {:?}): counted as closed",
                f.loops, f.block, f.nodes
            )?;
        }
        self.write_thin_layers(out)?;
        for failed in &self.failed {
            writeln!(out, "  FAILED {} (nodes {:?}): {}", failed.block, failed.nodes, failed.reason)?;
            if let Some(dump) = &failed.dump {
                writeln!(out, "    its input is in {dump}")?;
            }
        }
        if m.tets > 0 {
            write!(out, "{} tetrahedra, ", grouped(m.tets))?;
        }
        let [points, wall, caps] = [m.points, m.wall_triangles, m.cap_triangles].map(grouped);
        writeln!(out, "{points} points, {wall} wall triangles, {caps} cap triangles")?;
        let times: Vec<String> = self.stages.iter().map(|s| format!("{} {:.2} s", s.stage, s.seconds)).collect();
        writeln!(out, "{}", times.join(", "))
    }
}

impl RunReport {
    /// Maximum number of listed blocks with thin layers.
    const THIN: usize = 3;

    fn write_thin_layers(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let all = &self.thin_layers;
        if all.is_empty() {
            return Ok(());
        }
        let sum = |of: fn(&ThinLayers) -> u32| all.iter().map(|thin| u64::from(of(&thin.layers))).sum::<u64>();
        writeln!(
            out,
            "  layers less than half as thick as asked for, for want of room: at {} points of the wall in {} blocks; \
             none at {} points",
            sum(|thin| thin.points),
            all.len(),
            sum(|thin| thin.without)
        )?;
        for ThinBlock { block, nodes, layers } in all.iter().take(Self::THIN) {
            let [x, y, z] = layers.at;
            let share = 100.0 * layers.share;
            writeln!(out, "    {block} (nodes {nodes:?}): {share:.1} % at {x:.4} {y:.4} {z:.4}")?;
        }
        Ok(())
    }
}
