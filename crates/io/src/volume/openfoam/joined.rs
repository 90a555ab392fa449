//! Faces of a case: triangles, and quadrilaterals between the prisms of layers.

use anastomesh_mesh::faces::PartFaces;
use anastomesh_mesh::stacks::Cells;

/// Face with three or four vertices, counter-clockwise seen from outside its owner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Polygon {
    vertices: [u32; 4],
    is_quad: bool,
}

impl Polygon {
    /// Vertices, of a triangle the last one twice.
    pub(super) fn corners(&self) -> [u32; 4] {
        self.vertices
    }

    fn triangle([a, b, c]: [u32; 3]) -> Self {
        Self { vertices: [a, b, c, c], is_quad: false }
    }

    /// Union of two triangles with a common edge; `None` if they have none.
    fn joined(one: [u32; 3], other: [u32; 3]) -> Option<Self> {
        (0..3).find_map(|i| {
            let [x, y, z] = [one[i], one[(i + 1) % 3], one[(i + 2) % 3]];
            let at = (0..3).find(|&j| [other[j], other[(j + 1) % 3]] == [y, x])?;
            Some(Self { vertices: [x, other[(at + 2) % 3], y, z], is_quad: true })
        })
    }

    pub(super) fn is_quad(&self) -> bool {
        self.is_quad
    }

    pub(super) fn vertices(&self) -> &[u32] {
        if self.is_quad { &self.vertices } else { &self.vertices[..3] }
    }
}

/// Face between two cells, its owner first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Inner {
    pub(super) cells: [u32; 2],
    pub(super) face: Polygon,
}

/// Face of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Outer {
    pub(super) patch: i32,
    pub(super) cell: u32,
    pub(super) face: Polygon,
}

/// Faces of a part of the mesh: inner ones in upper-triangular order, then those of each patch by cell.
#[derive(Default)]
pub(super) struct CellFaces {
    pub(super) inner: Vec<Inner>,
    pub(super) outer: Vec<Outer>,
}

impl CellFaces {
    /// Faces of a mesh; with `cells`, without the faces inside them.
    ///
    /// Two triangles between the same cells are one quadrilateral. If more lie between them, triangles remain: a cell
    /// may have any number of faces.
    pub(super) fn of(part: &PartFaces, cells: Option<&Cells>) -> Self {
        let Some(cells) = cells else {
            let inner =
                part.inner.iter().map(|face| Inner { cells: face.tets, face: Polygon::triangle(face.vertices) });
            let outer = part.outer.iter().map(|face| Outer {
                patch: face.patch,
                cell: face.tet,
                face: Polygon::triangle(face.vertices),
            });
            let mut faces = Self { inner: inner.collect(), outer: outer.collect() };
            faces.outer.sort_by_key(|face| face.patch);
            return faces;
        };
        let mut faces = Self::default();
        let between = part.inner.iter().map(|face| (face.tets.map(|tet| cells.of_tet(tet)), face.vertices));
        let mut between: Vec<([u32; 2], [u32; 3])> = between.filter(|([a, b], _)| a != b).collect();
        between.sort_unstable();
        for same in between.chunk_by(|a, b| a.0 == b.0) {
            let put = |face| faces.inner.push(Inner { cells: same[0].0, face });
            polygons(same.iter().map(|(_, vertices)| *vertices), put);
        }
        let mut outer: Vec<((i32, u32), [u32; 3])> =
            part.outer.iter().map(|face| ((face.patch, cells.of_tet(face.tet)), face.vertices)).collect();
        outer.sort_unstable();
        for same in outer.chunk_by(|a, b| a.0 == b.0) {
            let (patch, cell) = same[0].0;
            polygons(same.iter().map(|(_, vertices)| *vertices), |face| faces.outer.push(Outer { patch, cell, face }));
        }
        faces
    }
}

/// Passes on the polygons of triangles with the same cells on both sides.
fn polygons(mut triangles: impl ExactSizeIterator<Item = [u32; 3]>, mut put: impl FnMut(Polygon)) {
    if triangles.len() == 2
        && let (Some(one), Some(other)) = (triangles.next(), triangles.next())
    {
        match Polygon::joined(one, other) {
            Some(quad) => put(quad),
            None => [one, other].into_iter().for_each(|triangle| put(Polygon::triangle(triangle))),
        }
        return;
    }
    triangles.for_each(|triangle| put(Polygon::triangle(triangle)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_with_a_common_edge_are_a_quadrilateral() {
        let quad = Polygon::joined([4, 7, 9], [9, 7, 2]).unwrap();
        assert_eq!(quad.vertices(), [7, 2, 9, 4]);
        // Both are oriented alike, so their edges are opposite.
        assert_eq!(Polygon::joined([4, 7, 9], [7, 9, 2]), None);
        assert_eq!(Polygon::joined([4, 7, 9], [1, 2, 3]), None);
        assert_eq!(Polygon::triangle([4, 7, 9]).vertices(), [4, 7, 9]);
    }
}
