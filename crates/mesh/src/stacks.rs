//! Prisms and pyramids of boundary layers, found in the tetrahedra of a mesh.
//!
//! A layered mesh lists the tetrahedra of each wall triangle's stack one after the other, from the wall inwards. Three
//! of them are a prism, and two are a pyramid, where one vertex has no offset. Readers and writers keep the order of
//! tetrahedra and of their vertices. So the cells of layers are found again in any file, without a label. A stack begins
//! with a tetrahedron at a wall triangle, and each layer begins where the previous one ends.
//!
//! ```
//! use anastomesh_mesh::stacks::Cells;
//! use anastomesh_mesh::{Point3, TetMesh, VolumeMesh};
//!
//! let mesh = TetMesh { points: vec![Point3::origin(); 4], tets: vec![[0, 1, 2, 3]] };
//! // A mesh without layers.
//! assert!(Cells::of(&VolumeMesh { mesh, ..VolumeMesh::default() })?.is_none());
//! # Ok::<(), std::io::Error>(())
//! ```

mod mixed;
mod split;

use crate::source::{FacePiece, MeshSource};
use crate::{WALL, face_key};
use rustc_hash::FxHashSet;
use std::io;

pub use mixed::{MixedCell, MixedFace, MixedMesh};
pub use split::Polyhedra;

/// Minimum fraction of the wall triangles in the first parts that begin a stack. A mesh with layers has nearly all, a
/// mesh without layers has none: its tetrahedra would have to be in this order by chance.
const LAYERED: f64 = 0.5;
/// Number of wall triangles after which the first parts are decisive.
const DECISIVE: usize = 64;

/// Cells of a mesh with layers: consecutive tetrahedra that form a prism or a pyramid, and single tetrahedra.
///
/// Needs 1.5 bits per tetrahedron.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cells {
    /// One bit per tetrahedron: it belongs to the cell of the tetrahedron before it.
    joined: Vec<u64>,
    /// Bits set before each word.
    before: Vec<u32>,
    /// Number of cells.
    count: usize,
}

/// Cell of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerCell {
    /// Number of tetrahedra: three in a prism, two in a pyramid.
    pub tets: usize,
    /// Outer triangle.
    pub base: [u32; 3],
    /// Inner triangle, with the copy of each vertex of `base`; a pyramid has its apex in both.
    pub top: [u32; 3],
}

impl LayerCell {
    /// Apex of a pyramid.
    fn apex(&self) -> Option<u32> {
        (0..3).find(|&i| self.base[i] == self.top[i]).map(|i| self.base[i])
    }

    /// Vertices of a pyramid: its quadrilateral in order, then the apex. `None` for a prism.
    pub fn pyramid(&self) -> Option<[u32; 5]> {
        let i = (0..3).find(|&i| self.base[i] == self.top[i])?;
        let [j, k] = [(i + 1) % 3, (i + 2) % 3];
        Some([self.base[j], self.base[k], self.top[k], self.top[j], self.base[i]])
    }
}

impl Cells {
    /// Finds the cells of layers. `None` if the mesh has no layers. Reads the boundary and the tetrahedra once.
    ///
    /// # Errors
    /// Errors of reading the mesh.
    pub fn of(mesh: &dyn MeshSource) -> io::Result<Option<Self>> {
        if !is_layered(mesh)? {
            return Ok(None);
        }
        let mut joined = vec![0_u64; mesh.counts().tets.div_ceil(64)];
        let mut first = 0;
        mesh.each_part(
            |part| {
                let tets = mesh.tets(part)?.tets;
                let (cells, _) = in_part(&tets, &mesh.boundary(part)?);
                Ok((tets.len(), cells.into_iter().map(|(at, cell)| (at, cell.tets)).collect::<Vec<_>>()))
            },
            |(count, cells)| {
                for (at, tets) in cells {
                    for tet in first + at + 1..first + at + tets {
                        *joined.get_mut(tet / 64).ok_or_else(crate::source::miscounted)? |= 1 << (tet % 64);
                    }
                }
                first += count;
                Ok(())
            },
        )?;
        let mut sum = 0;
        let mut before = Vec::with_capacity(joined.len());
        for word in &joined {
            before.push(sum);
            sum += word.count_ones();
        }
        Ok(Some(Self { joined, before, count: mesh.counts().tets - sum as usize }))
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.count
    }

    /// True if there are no cells.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Number of the cell of a tetrahedron.
    #[must_use]
    pub fn of_tet(&self, tet: u32) -> u32 {
        let (word, bit) = (tet as usize / 64, tet % 64);
        let here = self.joined[word] & (u64::MAX >> (63 - bit));
        tet - self.before[word] - here.count_ones()
    }
}

/// Passes on the layer of each tetrahedron of a mesh with layers, part by part: see [`layers_in`].
///
/// # Errors
/// Errors of reading the mesh, and of `each`.
pub fn each_layers(mesh: &dyn MeshSource, mut each: impl FnMut(&[i32]) -> io::Result<()>) -> io::Result<()> {
    mesh.each_part(|part| Ok(layers_in(&mesh.tets(part)?.tets, &mesh.boundary(part)?)), |layers| each(&layers))
}

/// Layer of each tetrahedron of a part: 1 at the wall, 0 for those in no prism or pyramid.
#[must_use]
pub fn layers_in(tets: &[[u32; 4]], boundary: &FacePiece) -> Vec<i32> {
    let mut layers = vec![0; tets.len()];
    let mut outer: Option<(usize, LayerCell)> = None;
    for (at, cell) in in_part(tets, boundary).0 {
        let inside = outer.filter(|(end, outer)| *end == at && face_key(outer.top) == face_key(cell.base));
        let layer = 1 + inside.map_or(0, |_| layers[at - 1]);
        layers[at..at + cell.tets].fill(layer);
        outer = Some((at + cell.tets, cell));
    }
    layers
}

/// True if the wall triangles of the first parts begin stacks.
///
/// # Errors
/// Errors of reading the mesh.
pub fn is_layered(mesh: &dyn MeshSource) -> io::Result<bool> {
    let (mut walls, mut begun) = (0, 0);
    for part in 0..mesh.parts() {
        let boundary = mesh.boundary(part)?;
        let wall = wall_of(&boundary).count();
        if wall == 0 {
            continue;
        }
        walls += wall;
        begun += in_part(&mesh.tets(part)?.tets, &boundary).1;
        if walls >= DECISIVE {
            break;
        }
    }
    Ok(begun > 0 && begun as f64 >= LAYERED * walls as f64)
}

/// Wall triangles of a part; all of its boundary if it has no labels.
fn wall_of<'a>(boundary: &'a FacePiece) -> impl Iterator<Item = [u32; 3]> + 'a {
    let is_wall = |i: usize| boundary.patches.get(i).is_none_or(|&patch| patch == WALL);
    boundary.faces.iter().enumerate().filter(move |(i, _)| is_wall(*i)).map(|(_, face)| *face)
}

/// Cells of layers in a part, by the number of their first tetrahedron, and the number of stacks.
///
/// Consecutive parts can be joined to one, but a part that begins within a stack loses it.
pub fn in_part(tets: &[[u32; 4]], boundary: &FacePiece) -> (Vec<(usize, LayerCell)>, usize) {
    let wall: FxHashSet<[u32; 3]> = wall_of(boundary).map(face_key).collect();
    let mut cells = Vec::new();
    let (mut at, mut stacks) = (0, 0);
    while at < tets.len() {
        let start = cells.len();
        let mut base: Option<LayerCell> = None;
        while let Some(cell) = layer_at(&tets[at..], &wall, base.as_ref()) {
            cells.push((at, cell));
            at += cell.tets;
            base = Some(cell);
        }
        stacks += usize::from(cells.len() > start);
        at += usize::from(cells.len() == start);
    }
    (cells, stacks)
}

/// Layer that begins with the first of these tetrahedra: at the wall, or inside the layer `outer`.
fn layer_at(tets: &[[u32; 4]], wall: &FxHashSet<[u32; 3]>, outer: Option<&LayerCell>) -> Option<LayerCell> {
    let fits = |cell: &LayerCell| match outer {
        Some(outer) => {
            outer.tets == cell.tets && face_key(outer.top) == face_key(cell.base) && outer.apex() == cell.apex()
        }
        None => wall.contains(&face_key(cell.base)),
    };
    if let Some(cell) = [false, true].into_iter().find_map(|turned| prism(tets, turned)).filter(fits) {
        return Some(cell);
    }
    // The two tetrahedra of a pyramid do not show which vertex is the apex. Only the next layer does.
    let continues = |cell: &LayerCell| {
        let inner = &tets[2..];
        outer.is_some()
            || pyramids(inner).any(|next| face_key(next.base) == face_key(cell.top) && next.apex() == cell.apex())
    };
    pyramids(tets).find(|cell| fits(cell) && continues(cell))
}

/// Tetrahedron of a prism that is seen from outside as its sorted vertices, or turned.
fn plain([p, q, r, s]: [u32; 4], turned: bool) -> [u32; 4] {
    if turned { [q, p, r, s] } else { [p, q, r, s] }
}

/// Prism of the first three tetrahedra.
fn prism(tets: &[[u32; 4]], turned: bool) -> Option<LayerCell> {
    let [x, y, z] = tets.get(..3)?.try_into().map(|three: [[u32; 4]; 3]| three.map(|tet| plain(tet, turned))).ok()?;
    let [b, a, c, c1] = x;
    let (b1, a1) = (y[2], z[0]);
    let is_prism = y == [a, b, b1, c1] && z == [a1, a, b1, c1];
    is_prism.then_some(LayerCell { tets: 3, base: [a, b, c], top: [a1, b1, c1] })
}

/// Pyramids that the first two tetrahedra can be.
fn pyramids(tets: &[[u32; 4]]) -> impl Iterator<Item = LayerCell> {
    let two: Option<[[u32; 4]; 2]> = tets.get(..2).and_then(|two| two.try_into().ok());
    let turned = |turned: bool| two.map(|two| two.map(|tet| plain(tet, turned)));
    [turned(false), turned(true)].into_iter().flatten().flat_map(|[x, y]| {
        let [b, a, c, c1] = x;
        let without_a = (y == [a, b, y[2], c1]).then_some(([a, b, c], [a, y[2], c1]));
        let without_b = (y == [y[0], a, b, c1]).then_some(([a, b, c], [y[0], b, c1]));
        let [a, b, b1, c] = x;
        let without_c = (y == [y[0], a, b1, c]).then_some(([a, b, c], [y[0], b1, c]));
        let all = [without_a, without_b, without_c].into_iter().flatten();
        all.map(|(base, top)| LayerCell { tets: 2, base, top })
    })
}

#[cfg(test)]
mod tests;
