//! Mesh sources that change a part of another one.

/// Implements methods of [`MeshSource`](crate::source::MeshSource) by those of the field `mesh`. Not covered by semantic
/// versioning.
#[doc(hidden)]
#[macro_export]
macro_rules! of_mesh {
    ($first:ident, $($method:ident),+) => {
        $crate::of_mesh!($first);
        $($crate::of_mesh!($method);)+
    };
    (counts) => {
        fn counts(&self) -> $crate::source::SourceCounts {
            self.mesh.counts()
        }
    };
    (patches) => {
        fn patches(&self) -> &[$crate::Patch] {
            self.mesh.patches()
        }
    };
    (parts) => {
        fn parts(&self) -> u32 {
            self.mesh.parts()
        }
    };
    (points) => {
        fn points(&self, part: u32) -> std::io::Result<std::borrow::Cow<'_, [$crate::Point3]>> {
            self.mesh.points(part)
        }
    };
    (tets) => {
        fn tets(&self, part: u32) -> std::io::Result<$crate::source::TetPiece<'_>> {
            self.mesh.tets(part)
        }
    };
    (tet_labels) => {
        fn tet_labels(&self, part: u32) -> std::io::Result<$crate::source::LabelPiece<'_>> {
            self.mesh.tet_labels(part)
        }
    };
    (points_of) => {
        fn points_of(&self, ids: &[u32]) -> std::io::Result<Vec<$crate::Point3>> {
            self.mesh.points_of(ids)
        }
    };
}
