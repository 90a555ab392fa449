//! Closed surface of an image of a template.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::{Kept, TetMesh};

/// Triangles by their vertices.
pub(super) type Triangles = Vec<[u32; 3]>;

/// Drops the points inside. Returns points without tetrahedra, the surface of discs and wall in this order, and the discs.
/// Remaining points keep their order.
pub(super) fn hull(points: &[Point3], discs: &[Triangles], wall: &Triangles) -> (TetMesh, Triangles, Vec<Triangles>) {
    let triangles: Triangles = discs.iter().chain([wall]).flatten().copied().collect();
    let kept = Kept::used(&triangles, points.len(), 0);
    let cells = |list: &Triangles| list.iter().map(|t| kept.cell(t)).collect();
    let mesh = TetMesh { points: kept.select(points), tets: Vec::new() };
    (mesh, cells(&triangles), discs.iter().map(cells).collect())
}
