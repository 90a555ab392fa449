//! Keywords of the lists, and comments with names.

/// Beginning of the comment with the name of a reference of tetrahedra.
pub(super) const REGION: &str = "# region ";
/// Beginning of the comment with the name of a reference of triangles.
pub(super) const PATCH: &str = "# patch ";

pub(super) const VERTICES: &str = "Vertices";
pub(super) const TRIANGLES: &str = "Triangles";
pub(super) const TETRAHEDRA: &str = "Tetrahedra";
