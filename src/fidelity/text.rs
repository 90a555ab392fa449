//! Fidelity as text for people.

use super::Fidelity;
use std::fmt;

impl fmt::Display for Fidelity {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        let (axis, wall) = (&self.axis, &self.wall);
        writeln!(
            out,
            "axis: {:.4} radii from the given one in the median, 99 % {:.3}, at most {:.3}; length {:.4} of {:.4}",
            axis.spread.median, axis.spread.p99, axis.spread.worst, axis.meshed_length, axis.given_length
        )?;
        writeln!(
            out,
            "wall: {:.2} % of the radius from the given tubes{} in the median, 99 % {:.1} %, at most {:.0} %",
            100.0 * wall.median,
            if self.is_moved() { " (whose vessels were moved)" } else { "" },
            100.0 * wall.p99,
            100.0 * wall.worst
        )?;
        writeln!(out, "lumen: {:.6e} of {:.6e} given ({:+.2} %)", self.volume, self.lumen, 100.0 * self.swelling())
    }
}
