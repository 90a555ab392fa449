//! Selection of the terminals that become inlets.

use anastomesh_flow::{Inlet, InletReason, Inlets};
use anastomesh_mesh::units::number;

/// Maximum number of lines of each kind.
const LISTED: usize = 10;

/// Text lines, limited in number.
pub fn remarks(inlets: &Inlets) -> Vec<String> {
    let mut lines: Vec<String> = inlets.list.iter().take(LISTED).map(line).collect();
    if inlets.list.len() > LISTED {
        lines.push(format!("inlet: and {} more, one per component", inlets.list.len() - LISTED));
    }
    for (node, vessels) in inlets.inner.iter().take(LISTED) {
        lines.push(format!(
            "root node {node} of the file is not a terminal ({vessels} vessels meet there): add a vessel, or name a terminal \
             with --root"
        ));
    }
    lines
}

fn line(inlet: &Inlet) -> String {
    let at = inlet.position.map(number).join(" ");
    let why = match inlet.why {
        InletReason::Asked => "requested",
        InletReason::RootOfFile => "root in the file",
        InletReason::Widest => "widest terminal of its component; --root selects another",
    };
    format!("inlet: node {} at {at}, radius {} ({why})", inlet.node, number(inlet.radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inlets_and_roots_inside_are_named() {
        let inlet =
            Inlet { original: 0, node: "7".into(), position: [0.0; 3], radius: 1.0, why: InletReason::RootOfFile };
        let mut found = Inlets::default();
        (found.list, found.roots, found.inner) = (vec![inlet], vec![0], vec![("5".into(), 2)]);
        let [inlet, inner] = &remarks(&found)[..] else { panic!("{:?}", remarks(&found)) };
        assert!(inlet.contains("node 7 at 0 0 0, radius 1 (root in the file)"));
        assert!(inner.contains("node 5 of the file is not a terminal (2 vessels"));
    }
}
