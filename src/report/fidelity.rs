//! Text report of a mesh's fidelity to its network.

use std::fmt::Write as _;

use crate::fidelity::Displaced;

/// Maximum number of listed places.
const LISTED: usize = 10;

/// Text on places that are further off than a bound.
pub fn displaced(far: &[Displaced], bound: f64) -> String {
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
    out
}
