//! Keywords of the lists.

pub(super) const VERTICES: &str = "Vertices";
pub(super) const TRIANGLES: &str = "Triangles";
pub(super) const TETRAHEDRA: &str = "Tetrahedra";
