//! Conversion of length units.

use super::content::{NetworkFile, NetworkNote, NetworkOptions};
use anastomesh_mesh::geometry::Aabb;

/// Maximum radius relative to the network extent. A larger one indicates inconsistent units.
const THICKEST: f64 = 1.0;
/// Minimum of the largest radius relative to the network extent. Real networks span at most some thousand radii.
const THINNEST: f64 = 1e-5;

/// Scales positions and radii according to the options, and adds a note.
pub(super) fn scale(network: &mut NetworkFile, options: &NetworkOptions) {
    let positions = options.scale.unwrap_or(1.0);
    let radii = positions * options.radius_scale.unwrap_or(1.0);
    if options.diameters {
        network.notes.push(NetworkNote::Diameters);
    }
    if options.scale.is_some() || options.radius_scale.is_some() {
        network.notes.push(NetworkNote::Scaled { positions, radii });
    }
    let radii = if options.diameters { 0.5 * radii } else { radii };
    for node in &mut network.skeleton.nodes {
        node.position.coords *= positions;
        node.radius *= radii;
    }
    for radius in network.skeleton.edges.iter_mut().flat_map(|edge| &mut edge.radii) {
        *radius *= radii;
    }
    network.notes.extend(out_of_proportion(network));
}

/// Note on radii and positions that may have different units.
fn out_of_proportion(network: &NetworkFile) -> Option<NetworkNote> {
    let extent = Aabb::of_points(network.skeleton.nodes.iter().map(|n| &n.position)).diagonal();
    let radii = network.skeleton.edges.iter().flat_map(|e| e.radii);
    let radius = radii.filter(|r| r.is_finite()).fold(0.0, f64::max);
    let wrong = radius > THICKEST * extent || radius < THINNEST * extent;
    (wrong && radius > 0.0 && extent > 0.0).then_some(NetworkNote::OutOfProportion { radius, extent })
}
