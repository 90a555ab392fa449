//! Order in which missing parts are recovered. Parts that earlier starts left missing come first, while nothing is in
//! their way.

use super::exact::Missing;
use rustc_hash::FxHashSet;

/// Edges and triangles that earlier starts left missing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Priority {
    edges: FxHashSet<[u32; 2]>,
    triangles: FxHashSet<u32>,
}

impl Priority {
    /// Gives priority to edges and triangles. Edges have their smaller vertex first.
    pub(crate) fn add(&mut self, missing: Missing) {
        self.edges.extend(missing.edges);
        self.triangles.extend(missing.triangles);
    }

    /// Moves the parts with priority to the front. The order is otherwise kept.
    pub(super) fn sort(&self, edges: &mut [[u32; 2]], triangles: &mut [u32]) {
        edges.sort_by_key(|edge| !self.edges.contains(edge));
        triangles.sort_by_key(|triangle| !self.triangles.contains(triangle));
    }
}
