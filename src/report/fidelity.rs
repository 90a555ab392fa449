//! Text report of a mesh's fidelity to its network.

use std::fmt::Write as _;

use crate::fidelity::Displaced;
use anastomesh_mesh::units::counted;

/// Maximum number of listed places.
const LISTED: usize = 10;

/// Text on places where the axis is displaced by more than a bound.
pub fn displaced(far: &[Displaced], bound: f64) -> String {
    let mut out = format!(
        "the meshed axis differs from the input by more than {bound} radii at {} (--max-displacement, \
         --allow-displaced); largest displacements:\n",
        counted(far.len(), "edge")
    );
    for d in far.iter().take(LISTED) {
        let [x, y, z] = d.place;
        // Writing to a string cannot fail.
        let _ = writeln!(out, "  edge {}-{} at {x:.4} {y:.4} {z:.4}: {:.3} radii", d.given[0], d.given[1], d.radii);
    }
    out
}
