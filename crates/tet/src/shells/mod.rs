//! Shells: layers of prisms on the outside of a closed surface, for instance a vessel's wall around its lumen.
//!
//! Each wall vertex has one outer position per shell on a straight line. Each wall triangle spans prisms between these,
//! which are cut into tetrahedra as those of inner layers are (`layers`). At flat caps the shells end in flat rings. All
//! prisms are positive by the exact predicate, and the outer surface does not intersect itself. A map without inversions
//! that is one to one on the boundary is one to one inside. So the shells and a mesh of the inside form one valid mesh.
//!
//! Where the outside is too narrow, or the surface is so curved that prisms would invert, the shells become thinner
//! (`heights`, `settle`). They never end. Poor prisms get other outer positions (`improve`).

mod directions;
mod heights;
mod improve;
mod outside;
mod settle;
mod shell;
#[cfg(test)]
mod tests;

use crate::error::{InputArray, TetError};
use crate::input;
use crate::layers::Numbers;
use crate::plc::InputKind;
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::Progress;
use settle::{Settled, settle};
pub use shell::Shell;
use shell::{Given, first_layers, of_caps};
use std::ops::Range;

/// Fraction of the thickness asked for below which shells count as thin.
const THIN: f64 = 0.5;

/// Shells around a surface. Points are numbered after those of the surface: index `surface.points.len() + i` is `points[i]`.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Shells {
    /// Points outside the surface.
    pub points: Vec<Point3>,
    /// Positive tetrahedra.
    pub tets: Vec<[u32; 4]>,
    /// Shell of each tetrahedron; 0 is the innermost.
    pub shell_of: Vec<u32>,
    /// Outer side of each shell: images of the wall's triangles in their order, oriented outwards.
    pub sides: Vec<Vec<[u32; 3]>>,
    /// Flat ends of the shells at caps.
    pub rings: Vec<Ring>,
    /// Total thickness at each point of the surface, relative to the thickness wanted. 1 for points off the wall.
    pub shares: Vec<f64>,
}

/// Flat end of a shell at a cap.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Ring {
    /// Number of the cap.
    pub cap: u32,
    /// Shell; 0 is the innermost.
    pub shell: u32,
    /// Triangles, oriented as those of the cap.
    pub triangles: Vec<[u32; 3]>,
}

impl Shells {
    /// Grows shells around a closed surface, which must be oriented outwards.
    ///
    /// `caps` has the cap of each triangle: flat, connected parts without shells. `None` is the wall. `around` is a closed surface
    /// outside, which the shells do not touch.
    ///
    /// ```
    /// use anastomesh_tet::{Shell, Shells};
    ///
    /// let ball = anastomesh_mesh::shapes::sphere_surface(2);
    /// let caps = vec![None; ball.triangles.len()];
    /// let wall = Shell::new(vec![0.2; ball.points.len()]);
    /// let made = Shells::around(&ball, &caps, &[wall], None, &())?;
    /// assert_eq!(made.tets.len(), 6 * ball.triangles.len());
    /// assert!(made.shares.iter().all(|&share| share == 1.0));
    /// # Ok::<(), anastomesh_tet::TetError>(())
    /// ```
    ///
    /// # Errors
    /// [`TetError::WrongLength`], [`TetError::BadSize`] and [`TetError::Layers`] for invalid shells.
    /// [`TetError::Open`] and [`TetError::SelfIntersection`] for surfaces that are not closed or intersect.
    /// [`TetError::Stuck`] at a triangle where no shell fits. [`TetError::Cancelled`].
    pub fn around(
        surface: &TriMesh,
        caps: &[Option<u32>],
        shells: &[Shell],
        around: Option<&TriMesh>,
        progress: &dyn Progress,
    ) -> Result<Self, TetError> {
        let (mut made, prisms) = Self::grown(surface, caps, shells, around, progress)?;
        (made.tets, made.shell_of) = prisms.tets(0..prisms.len()).unzip();
        Ok(made)
    }

    /// As [`Shells::around`]. The tetrahedra are not made yet: they are those of the prisms.
    ///
    /// # Errors
    /// See [`Shells::around`].
    pub fn grown(
        surface: &TriMesh,
        caps: &[Option<u32>],
        shells: &[Shell],
        around: Option<&TriMesh>,
        progress: &dyn Progress,
    ) -> Result<(Self, Prisms), TetError> {
        let watch = Watch::asking(progress);
        check(surface, caps, shells)?;
        input::validate(surface, &[], InputKind::Closed)?;
        let seen_from_inside = |(t, cap): (&[u32; 3], &Option<u32>)| cap.is_none().then_some([t[0], t[2], t[1]]);
        let wall: Vec<[u32; 3]> = surface.triangles.iter().zip(caps).filter_map(seen_from_inside).collect();
        let given = Given { surface, wall: &wall, caps, shells, around };
        let (made, numbers) = settle(&given, &watch)?.shells(&given);
        Ok((made, Prisms { numbers, first: first_layers(shells), wall }))
    }

    /// Number of points with less than half of the thickness wanted.
    pub fn thin(&self) -> usize {
        self.shares.iter().filter(|share| **share < THIN).count()
    }

    /// Point with the least share of its thickness, and that share; `None` if all are complete.
    pub fn thinnest(&self) -> Option<(u32, f64)> {
        let less = (0..).zip(self.shares.iter().copied()).filter(|(_, share)| *share < 1.0 - 1e-9);
        less.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Checks lengths and values.
fn check(surface: &TriMesh, caps: &[Option<u32>], shells: &[Shell]) -> Result<(), TetError> {
    let expect = |array, found, expected| {
        if found == expected { Ok(()) } else { Err(TetError::WrongLength { array, found, expected }) }
    };
    expect(InputArray::Caps, caps.len(), surface.triangles.len())?;
    for shell in shells {
        expect(InputArray::Thicknesses, shell.thickness.len(), surface.points.len())?;
        shell.spacing().check()?;
        if let Some(&value) = shell.thickness.iter().find(|t| !(**t > 0.0 && t.is_finite())) {
            return Err(TetError::BadSize { value });
        }
    }
    Ok(())
}

/// Prisms between a wall and the outer side of its shells, cut into tetrahedra on demand.
#[derive(Clone, Debug, Default)]
pub struct Prisms {
    numbers: Numbers,
    /// First layer of each shell, and the number of all.
    first: Vec<u32>,
    /// Triangles of the wall, seen from inside.
    wall: Vec<[u32; 3]>,
}

impl Prisms {
    /// Number of triangles of the wall.
    pub fn len(&self) -> usize {
        self.wall.len()
    }

    /// True without shells.
    pub fn is_empty(&self) -> bool {
        self.wall.is_empty()
    }

    /// Number of tetrahedra at a triangle.
    pub fn tets_per_triangle(&self) -> usize {
        3 * self.numbers.layers() as usize
    }

    /// Tetrahedra at some triangles of the wall, with their shells.
    pub fn tets(&self, triangles: Range<usize>) -> impl Iterator<Item = ([u32; 4], u32)> {
        let shell_of = |layer: u32| shell_of_layer(&self.first, layer);
        let at = move |t: &[u32; 3]| self.numbers.tets_at(*t).zip((0..).flat_map(|layer| [layer; 3]));
        self.wall[triangles].iter().flat_map(at).map(move |(tet, layer)| (tet, shell_of(layer)))
    }
}

fn shell_of_layer(first: &[u32], layer: u32) -> u32 {
    first.partition_point(|&start| start <= layer) as u32 - 1
}

impl Settled {
    /// Result of the growth without tetrahedra, and the numbers of its points.
    fn shells(self, given: &Given) -> (Shells, Numbers) {
        let Self { numbers, mut points, shares } = self;
        let first = first_layers(given.shells);
        let mut made = Shells { shares, ..Shells::default() };
        // The prisms see the wall from inside.
        let outward = |[a, b, c]: [u32; 3], layer| [a, c, b].map(|v| numbers.copy(v, layer));
        made.sides = first[1..].iter().map(|&layer| given.wall.iter().map(|t| outward(*t, layer)).collect()).collect();
        for (cap, triangles) in of_caps(given.surface, given.caps) {
            let ring = numbers.ring(&triangles);
            for shell in 0..given.shells.len() as u32 {
                let own = ring.iter().filter(|(layer, _)| shell_of_layer(&first, *layer) == shell);
                made.rings.push(Ring { cap, shell, triangles: own.map(|(_, triangle)| *triangle).collect() });
            }
        }
        made.points = points.split_off(given.surface.points.len());
        (made, numbers)
    }
}
