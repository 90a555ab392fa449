//! Text report of a mesh's fidelity to its network.

use std::fmt::{self, Write as _};

use crate::fidelity::{Displaced, Fidelity};

/// Maximum number of listed places.
const LISTED: usize = 10;

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

/// Message on places beyond the displacement limit; `None` if there are none.
#[cfg(feature = "cli")]
pub fn displaced(far: &[Displaced], bound: f64) -> Option<String> {
    if far.is_empty() {
        return None;
    }
    let mut out = format!(
        "the meshed axis is more than {bound} radii from the given one at {} edges (--max-displacement, --allow-displaced); the \
         furthest:\n",
        far.len()
    );
    for d in far.iter().take(LISTED) {
        let [x, y, z] = d.place;
        // Writing to a string cannot fail.
        let _ = writeln!(out, "  at {}-{} ({x:.4} {y:.4} {z:.4}): {:.3} radii", d.given[0], d.given[1], d.radii);
    }
    Some(out)
}
