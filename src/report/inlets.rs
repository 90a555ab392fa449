//! Selection of the terminals that become inlets.

use crate::pipeline::{Inlet, InletReason, Inlets};
use anastomesh_mesh::units::number;
use std::fmt;

impl fmt::Display for Inlet {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let at = self.position.map(number).join(" ");
        let why = match self.why {
            InletReason::Asked => "requested",
            InletReason::RootOfFile => "root in the file",
            InletReason::Widest => "widest terminal of its component; --root selects another",
        };
        write!(f, "node {} at {at}, radius {} ({why})", self.node, number(self.radius))
    }
}

impl Inlets {
    /// Text lines, limited in number.
    pub fn remarks(&self) -> Vec<String> {
        const LISTED: usize = 10;
        let mut lines: Vec<String> = self.list.iter().take(LISTED).map(|inlet| format!("inlet: {inlet}")).collect();
        if self.list.len() > LISTED {
            lines.push(format!("inlet: and {} more, one per component", self.list.len() - LISTED));
        }
        for (node, vessels) in self.inner.iter().take(LISTED) {
            lines.push(format!(
                "root node {node} of the file is not a terminal ({vessels} vessels meet there): add a vessel, or name a terminal \
                 with --root"
            ));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inlets_and_roots_inside_are_named() {
        let inlet =
            Inlet { original: 0, node: "7".into(), position: [0.0; 3], radius: 1.0, why: InletReason::RootOfFile };
        let found = Inlets { list: vec![inlet], roots: vec![0], inner: vec![("5".into(), 2)] };
        let [inlet, inner] = &found.remarks()[..] else { panic!("{:?}", found.remarks()) };
        assert!(inlet.contains("node 7 at 0 0 0, radius 1 (root in the file)"));
        assert!(inner.contains("node 5 of the file is not a terminal (2 vessels"));
    }
}
