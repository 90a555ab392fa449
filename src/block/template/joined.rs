//! Topology of a tube of several templates.

use super::canonical::Template;
use crate::block::topology::{FinishedJoint, Topology};
use anastomesh_mesh::check::parts::chained;

/// Joins templates at their discs. Vertices of the outer discs have the same numbers in the tube and in the templates.
pub fn joined<'a>(templates: impl Iterator<Item = &'a Template> + Clone) -> Topology {
    let mut out = Topology::default();
    let mut base = 0;
    for Template { topology, tets, .. } in templates.clone() {
        let moved = |face: &u32| face + base;
        out.wall.extend(topology.wall.iter().map(moved));
        if out.discs.is_empty() {
            out.discs.push(topology.discs[0].clone());
        }
        out.discs.truncate(1);
        let FinishedJoint { vertices, faces } = &topology.discs[1];
        out.discs.push(FinishedJoint { vertices: vertices.clone(), faces: faces.iter().map(moved).collect() });
        base += 4 * tets.len() as u32;
    }
    let links: Option<Vec<_>> = templates.map(|template| template.link.as_ref()).collect();
    if let Some(certificate) = links.and_then(chained) {
        out.certificate = certificate.into();
    }
    out
}
