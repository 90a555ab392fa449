//! Text report of fidelity.

use super::Fidelity;
use std::fmt;

impl fmt::Display for Fidelity {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let (axis, wall) = (&self.axis, &self.wall);
        writeln!(
            out,
            "axis: distance from the input median {:.4} radii, 99 % {:.3}, max {:.3}; length {:.4} of {:.4}",
            axis.spread.median, axis.spread.p99, axis.spread.worst, axis.meshed_length, axis.given_length
        )?;
        writeln!(
            out,
            "wall: radius error{} median {:.2} %, 99 % {:.1} %, max {:.0} %",
            if self.is_moved() { " (vessels were moved)" } else { "" },
            100.0 * wall.median,
            100.0 * wall.p99,
            100.0 * wall.worst
        )?;
        writeln!(out, "lumen: volume {:.6e}, input {:.6e} ({:+.2} %)", self.volume, self.lumen, 100.0 * self.swelling())
    }
}
