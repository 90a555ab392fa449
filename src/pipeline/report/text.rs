//! Text report of a meshing run.

use super::{FusedBlock, RunReport, ThinBlock};
use crate::block::ThinLayers;
use anastomesh_mesh::units::{counted, grouped, tetrahedra};
use anastomesh_network::NameOf;
use std::fmt::{self, Write as _};

/// Text report; nodes are named by their index in the file.
impl fmt::Display for RunReport {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.text(&|node| node.to_string()))
    }
}

/// Names of nodes, with blanks between them.
pub fn named(nodes: &[u32], name: NameOf) -> String {
    nodes.iter().map(|&node| name(node)).collect::<Vec<_>>().join(" ")
}

impl RunReport {
    /// Text report: blocks, retries, failures, sizes and times. `name` names a node, given by its index in the file.
    pub fn text(&self, name: NameOf) -> String {
        let mut out = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(name, &mut out);
        out
    }

    fn write(&self, name: NameOf, out: &mut String) -> fmt::Result {
        let (b, m) = (&self.blocks, &self.mesh);
        writeln!(
            out,
            "{} (largest {}), {}, {} retried, {} failed",
            counted(b.clusters, "cluster"),
            counted(b.largest_cluster_nodes, "node"),
            counted(b.connectors, "connector"),
            counted(self.retries.len(), "block"),
            grouped(self.failed.len())
        )?;
        for retry in &self.retries {
            writeln!(
                out,
                "  retried {} (nodes {}): {}; {}",
                retry.block,
                named(&retry.nodes, name),
                retry.reason,
                retry.remedy
            )?;
        }
        for f in &self.fused {
            let nodes = named(&f.nodes, name);
            writeln!(out, "  overlapping vessels in {} (nodes {nodes}): {}", f.block, f.difference(name))?;
            if let Some(at) = f.astray.outside {
                writeln!(out, "    a vessel axis lies outside the wall at {:.4} {:.4} {:.4}", at.x, at.y, at.z)?;
            }
            if let Some([p, q]) = f.astray.fused {
                writeln!(
                    out,
                    "    distant vessels share one lumen from {:.4} {:.4} {:.4} to {:.4} {:.4} {:.4}",
                    p.x, p.y, p.z, q.x, q.y, q.z
                )?;
            }
        }
        if self.anastomoses > 0 {
            writeln!(out, "  {} additional loops formed by fused vessels", self.anastomoses)?;
        }
        for f in &self.filled {
            writeln!(
                out,
                "  {} filled by the lumen in {} (nodes {}): counted as closed",
                counted(f.loops.unsigned_abs() as usize, "loop"),
                f.block,
                named(&f.nodes, name)
            )?;
        }
        for gaps in &self.closed_gaps {
            let (count, nodes) = (counted(gaps.places.len(), "narrow gap"), named(&gaps.nodes, name));
            writeln!(out, "  {count} between vessels that touch closed in {} (nodes {nodes}):", gaps.block)?;
            for [x, y, z] in &gaps.places {
                writeln!(out, "    at {x:.4} {y:.4} {z:.4}")?;
            }
        }
        self.write_thin_layers(name, out)?;
        for failed in &self.failed {
            let nodes = named(&failed.nodes, name);
            writeln!(out, "  FAILED {} (nodes {nodes}): {}", failed.block, failed.reason)?;
            if let Some(dump) = &failed.dump {
                writeln!(out, "    input written to {dump}")?;
            }
        }
        if m.tets > 0 {
            write!(out, "{}, ", tetrahedra(m.tets))?;
        }
        let [points, wall, caps] = [m.points, m.wall_triangles, m.cap_triangles].map(grouped);
        writeln!(out, "{points} points, {wall} wall triangles, {caps} cap triangles")?;
        let times: Vec<String> = self.stages.iter().map(|s| format!("{} {:.2} s", s.stage, s.seconds)).collect();
        writeln!(out, "{}", times.join(", "))
    }
}

impl FusedBlock {
    /// Difference between the wall of the block and its skeleton.
    pub(crate) fn difference(&self, name: NameOf) -> String {
        let mut parts = Vec::new();
        if self.handles != self.loops {
            let count = |n: i64, what| counted(n.unsigned_abs() as usize, what);
            parts.push(format!("expected {}, found {}", count(self.loops, "loop"), count(self.handles, "handle")));
        }
        if !self.uncapped.is_empty() {
            parts.push(format!("terminals without a cap: {}", named(&self.uncapped, name)));
        }
        if parts.is_empty() { "the genus is as expected".into() } else { parts.join("; ") }
    }
}

impl RunReport {
    /// Maximum number of listed blocks with thin layers.
    const THIN: usize = 3;

    fn write_thin_layers(&self, name: NameOf, out: &mut String) -> fmt::Result {
        let all = &self.thin_layers;
        if all.is_empty() {
            return Ok(());
        }
        let sum = |of: fn(&ThinLayers) -> u32| all.iter().map(|thin| u64::from(of(&thin.layers))).sum::<u64>();
        writeln!(
            out,
            "  layers thinner than half of the request: {} wall points in {}; no layers at {} points",
            sum(|thin| thin.points),
            counted(all.len(), "block"),
            sum(|thin| thin.without)
        )?;
        for ThinBlock { block, nodes, layers } in all.iter().take(Self::THIN) {
            let [x, y, z] = layers.at;
            let share = 100.0 * layers.share;
            let nodes = named(nodes, name);
            writeln!(out, "    {block} (nodes {nodes}): {share:.1} % at {x:.4} {y:.4} {z:.4}")?;
        }
        Ok(())
    }
}
