//! The keywords of the lists that are read and written.

pub(super) const VERTICES: &str = "Vertices";
pub(super) const TRIANGLES: &str = "Triangles";
pub(super) const TETRAHEDRA: &str = "Tetrahedra";
