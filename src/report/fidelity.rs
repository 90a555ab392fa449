//! Text report of a mesh's fidelity to its network.

use std::fmt::Write as _;

use crate::fidelity::Displaced;
use anastomesh_mesh::units::counted;
use anastomesh_network::NameOf;

/// Maximum number of listed places.
const LISTED: usize = 10;

/// Text on places where the axis is displaced by more than a bound.
pub fn displaced(far: &[Displaced], bound: f64, name: NameOf) -> String {
    let mut out = format!(
        "the axis differs from the input by more than {bound} radii at {} (--max-displacement, --allow-displaced); \
         largest displacements:\n",
        counted(far.len(), "edge")
    );
    for d in far.iter().take(LISTED) {
        let ([x, y, z], [a, b]) = (d.place, d.given.map(name));
        // Writing to a string cannot fail.
        let _ = writeln!(out, "  edge {a}-{b} at {x:.4} {y:.4} {z:.4}: {:.3} radii", d.radii);
    }
    out
}

/// Text on the furthest place beyond the limit, if listed changes require it.
pub fn required(place: &Displaced, name: NameOf) -> String {
    let radii = place.radii;
    format!(
        "axis displaced by {radii:.3} radii near node {}, as an overlap or a listed repair requires",
        name(place.node)
    )
}
