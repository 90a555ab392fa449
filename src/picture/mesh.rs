//! Multi-pass rendering of meshes of any size.
//!
//! With a cut through tetrahedra, every tetrahedron with a corner behind the plane is kept. An exposed face has all
//! corners before the plane and belongs to a tetrahedron whose fourth corner is behind it. Each tetrahedron thus
//! determines its exposed face without its neighbours.

use super::canvas::{Canvas, Facet};
use super::colours::{Colour, INSIDE, Legend, Rgb, WALL_COLOURS, of_block, of_patch, of_quality};
use super::outline::Outline;
use super::plane::Plane;
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::{tet_ratio, triangle_ratio};
use anastomesh_mesh::source::{FacePiece, MeshSource, TetPiece};
use anastomesh_mesh::{TET_FACES, face_key};
use rustc_hash::FxHashMap;
use std::io;

/// Object that a cutting plane removes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Opening {
    /// Whole tetrahedra.
    Tets(Plane),
    /// The wall, cut exactly: the inside of the other half becomes visible.
    Wall(Plane),
}

/// Mesh to render.
pub struct MeshPicture<'a> {
    pub mesh: &'a dyn MeshSource,
    pub colour: Colour,
    /// Vessel values in the first column, with their scale, if the colour shows a vessel property.
    pub values: Option<(&'a dyn Beside, Legend)>,
}

/// Face exposed by a cutting plane.
struct Open {
    corners: [Point3; 3],
    block: i32,
    ratio: f64,
}

impl MeshPicture<'_> {
    /// Extent of a mesh.
    ///
    /// # Errors
    /// The mesh cannot be read.
    pub fn outline(mesh: &dyn MeshSource) -> io::Result<Outline> {
        let mut outline = Outline::for_points(mesh.counts().boundary);
        mesh.each_face_corners(|corners| {
            for c in corners {
                outline.add(&c[0]);
            }
            Ok(())
        })?;
        Ok(outline)
    }

    /// Renders the mesh.
    ///
    /// # Errors
    /// The mesh cannot be read.
    pub fn draw(&self, canvas: &mut Canvas, cut: Option<Opening>) -> io::Result<()> {
        canvas.cut = None;
        let plane = match cut {
            Some(Opening::Tets(plane)) => plane,
            Some(Opening::Wall(plane)) => {
                canvas.cut = Some(plane);
                return self.draw_faces(canvas, |_, _| true);
            }
            None => return self.draw_faces(canvas, |_, _| true),
        };
        let mut open = self.opened(&plane)?;
        // Before the plane, boundary faces are visible only if their tetrahedron is kept.
        self.draw_faces(canvas, |face, corners| {
            corners.iter().any(|p| plane.behind(p) >= 0.0) || open.remove(&face_key(*face)).is_some()
        })?;
        let mut inner: Vec<_> = open.into_iter().collect();
        inner.sort_unstable_by_key(|(key, _)| *key);
        for (_, open) in inner {
            let colour = self.inner_colour(&open);
            canvas.add(Facet::flat(open.corners, colour, colour));
        }
        canvas.flush();
        Ok(())
    }

    /// Faces of tetrahedra that a plane exposes, including boundary faces.
    fn opened(&self, plane: &Plane) -> io::Result<FxHashMap<[u32; 3], Open>> {
        let mut open = FxHashMap::default();
        let read = |part| {
            let TetPiece { tets, blocks } = self.mesh.tets(part)?;
            let corners = self.mesh.corners_of(&tets)?;
            let laid = corners.iter().enumerate().filter_map(|(i, p)| {
                let behind = p.map(|p| plane.behind(&p) >= 0.0);
                let apex = (0..4).find(|&apex| (0..4).all(|k| behind[k] == (k == apex)))?;
                let side = TET_FACES[apex];
                let face = Open {
                    corners: side.map(|k| p[k]),
                    block: blocks.get(i).copied().unwrap_or(0),
                    ratio: tet_ratio(p),
                };
                Some((face_key(side.map(|k| tets[i][k])), face))
            });
            Ok(laid.collect::<Vec<_>>())
        };
        self.mesh.each_part(read, |laid| {
            open.extend(laid);
            Ok(())
        })?;
        Ok(open)
    }

    /// Draws the selected faces of the boundary.
    fn draw_faces(
        &self,
        canvas: &mut Canvas,
        mut wanted: impl FnMut(&[u32; 3], &[Point3; 3]) -> bool,
    ) -> io::Result<()> {
        let read = |part| {
            let piece = self.mesh.boundary(part)?;
            let corners = self.mesh.corners_of(&piece.faces)?;
            let colours = self.colours(&piece, &corners);
            Ok((piece, corners, colours))
        };
        self.mesh.each_part(read, |(piece, corners, colours)| {
            for ((face, corners), colour) in piece.faces.iter().zip(corners).zip(colours) {
                if wanted(face, &corners) {
                    canvas.add(Facet::flat(corners, colour, seen_from_inside(colour)));
                }
            }
            Ok(())
        })?;
        canvas.flush();
        Ok(())
    }

    fn colours(&self, piece: &FacePiece, corners: &[[Point3; 3]]) -> Vec<Rgb> {
        let at = |values: &[i32], i: usize| values.get(i).copied().unwrap_or(0);
        let patches = self.mesh.patches();
        let each = |colour: &dyn Fn(usize) -> Rgb| (0..corners.len()).map(colour).collect();
        match (self.colour, &self.values) {
            (Colour::Radius | Colour::Order | Colour::Values, Some((beside, legend))) => {
                // Cells use the interpolated point values at their centres.
                let values = if beside.columns().first().is_some_and(|column| column.at_points) {
                    beside.at_points(0, &corners.iter().map(middle).collect::<Vec<_>>())
                } else {
                    beside.in_faces(0, corners)
                };
                values.into_iter().map(|value| legend.colour(value)).collect()
            }
            (Colour::Block, _) => each(&|i| of_block(at(&piece.blocks, i))),
            (Colour::Quality, _) => each(&|i| of_quality(triangle_ratio(&corners[i]))),
            (Colour::Patch, _) => each(&|i| of_patch(patches, at(&piece.patches, i))),
            _ => vec![WALL_COLOURS[0]; corners.len()],
        }
    }

    fn inner_colour(&self, open: &Open) -> Rgb {
        match (self.colour, &self.values) {
            (Colour::Block, _) => of_block(open.block),
            (Colour::Quality, _) => of_quality(open.ratio),
            (Colour::Radius | Colour::Order | Colour::Values, Some((beside, legend))) => {
                let values = if beside.columns().first().is_some_and(|column| column.at_points) {
                    beside.at_points(0, &[middle(&open.corners)])
                } else {
                    beside.in_faces(0, &[open.corners])
                };
                values.first().map_or(INSIDE, |&value| legend.colour(value))
            }
            _ => INSIDE,
        }
    }
}

/// Colour of a back face: the wall is darker inside.
fn seen_from_inside(colour: Rgb) -> Rgb {
    if colour == WALL_COLOURS[0] { WALL_COLOURS[1] } else { colour.map(|c| (u16::from(c) * 5 / 8) as u8) }
}

fn middle(corners: &[Point3; 3]) -> Point3 {
    Point3::from(corners.iter().map(|p| p.coords).sum::<Vec3>() / 3.0)
}
