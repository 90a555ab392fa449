//! One shell, and the layers and caps of several.

use crate::layer::Layers;
use anastomesh_mesh::TriMesh;

/// One shell. Lengths are in the unit of the surface.
///
/// ```
/// use anastomesh_tet::Shell;
///
/// let wall = Shell::new(vec![0.1; 42]).layers(3).growth(1.5);
/// assert_eq!(wall.layers, 3);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shell {
    /// Thickness wanted at each point of the surface, above 0.
    pub thickness: Vec<f64>,
    /// Number of layers of prisms, at least 1.
    pub layers: u32,
    /// Ratio of the thickness of each layer to that of the previous one, outwards.
    pub growth: f64,
}

anastomesh_mesh::setters!(Shell { layers: u32, growth: f64 });

impl Shell {
    /// Shell of two equal layers.
    pub fn new(thickness: Vec<f64>) -> Self {
        Self { thickness, layers: 2, growth: 1.0 }
    }

    /// Layers of this shell, without a thickness.
    pub(super) fn spacing(&self) -> Layers {
        Layers::default().count(self.layers).growth(self.growth)
    }
}

/// Surface with its wall and the shells wanted.
#[derive(Clone, Copy)]
pub(super) struct Given<'a> {
    pub surface: &'a TriMesh,
    /// Triangles of the wall, seen from inside.
    pub wall: &'a [[u32; 3]],
    pub caps: &'a [Option<u32>],
    pub shells: &'a [Shell],
    pub around: Option<&'a TriMesh>,
}

/// Fraction of the distance to the outer position at which each copy of a point lies, shell by shell.
pub(super) fn depths(shells: &[Shell], v: usize) -> Vec<f64> {
    let total: f64 = shells.iter().map(|shell| shell.thickness[v]).sum();
    let mut before = 0.0;
    let mut all = Vec::new();
    for shell in shells {
        let own = shell.thickness[v] / total;
        all.extend(shell.spacing().depths().into_iter().map(|depth| before + own * depth));
        before += own;
    }
    // The last one is the outer position, whatever rounding makes of the sum.
    all.pop();
    all.push(1.0);
    all
}

/// First layer of each shell, and the number of all layers.
pub(super) fn first_layers(shells: &[Shell]) -> Vec<u32> {
    let ends = shells.iter().scan(0, |sum, shell| {
        *sum += shell.layers;
        Some(*sum)
    });
    std::iter::once(0).chain(ends).collect()
}

/// Triangles of each cap, by cap.
pub(super) fn of_caps(surface: &TriMesh, caps: &[Option<u32>]) -> Vec<(u32, Vec<[u32; 3]>)> {
    let mut all: Vec<(u32, [u32; 3])> =
        caps.iter().zip(&surface.triangles).filter_map(|(cap, t)| cap.map(|cap| (cap, *t))).collect();
    all.sort_by_key(|(cap, _)| *cap);
    all.chunk_by(|a, b| a.0 == b.0).map(|same| (same[0].0, same.iter().map(|(_, t)| *t).collect())).collect()
}
