//! One tetrahedron of a complex.

/// Tetrahedron: its vertices, and the mate of the face opposite each vertex. Half a cache line, aligned like its vertices
/// (see [`Complex::into_mesh`](super::Complex::into_mesh)).
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct Cell {
    pub(crate) verts: [u32; 4],
    pub(crate) mates: [u32; 4],
}

impl Cell {
    /// No tetrahedron.
    pub(crate) const EMPTY: Self = Self { verts: [u32::MAX; 4], mates: [u32::MAX; 4] };
}
