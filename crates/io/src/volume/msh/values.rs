//! Data sections of nodes and elements, shared by both versions. Rows are in file order, which is that of the tags.

use super::surfaces::Surfaces;
use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use std::io::{self, Write};

/// Section under construction: tags with their values.
struct Rows<'a, W> {
    out: &'a mut W,
    /// True for binary rows; the section header is always text.
    binary: bool,
    section: &'static str,
    tag: i32,
}

impl<'a, W: Write> Rows<'a, W> {
    /// Starts the section of a column with this number of rows.
    fn begin(out: &'a mut W, binary: bool, column: &Column, rows: usize) -> io::Result<Self> {
        let section = if column.at_points { "NodeData" } else { "ElementData" };
        if i32::try_from(rows).is_err() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "data of Gmsh count to 2,147,483,647 only"));
        }
        // String tag: the name. Real tag: the time. Integer tags: step, number of components, number of rows.
        write!(out, "${section}\n1\n\"{}\"\n1\n0.0\n3\n0\n1\n{rows}\n", column.name)?;
        Ok(Self { out, binary, section, tag: 0 })
    }

    /// Appends the values of the next nodes or elements.
    fn add(&mut self, values: &[f64]) -> io::Result<()> {
        for value in values {
            self.tag += 1;
            if self.binary {
                self.out.write_all(&self.tag.to_le_bytes())?;
                self.out.write_all(&value.to_le_bytes())?;
            } else {
                writeln!(self.out, "{} {value:?}", self.tag)?;
            }
        }
        Ok(())
    }

    fn end(self) -> io::Result<()> {
        let line = if self.binary { "\n" } else { "" };
        writeln!(self.out, "{line}$End{}", self.section)
    }
}

/// Writes values of nodes and elements for version 2.2, with one more pass over them per column.
///
/// # Errors
/// The output `out` or the mesh source fails.
pub(super) fn write_values_2(out: &mut impl Write, mesh: &dyn MeshSource, values: &dyn Beside) -> io::Result<()> {
    let counts = mesh.counts();
    for (column, named) in values.columns().iter().enumerate() {
        let count = if named.at_points { counts.points } else { counts.boundary + counts.tets };
        let mut rows = Rows::begin(out, false, named, count)?;
        if named.at_points {
            mesh.each_points(|points| rows.add(&values.at_points(column, points)))?;
        } else {
            mesh.each_face_corners(|faces| rows.add(&values.in_faces(column, faces)))?;
            mesh.each_tet_corners(|tets| rows.add(&values.in_tets(column, tets)))?;
        }
        rows.end()?;
    }
    Ok(())
}

/// Writes values of nodes and elements for version 4.1, surface by surface. Each column takes two passes over the
/// points, and one over faces and tetrahedra. `regions` are those of the volumes, in order; `None` is all tetrahedra.
///
/// # Errors
/// The output `out` or the mesh source fails.
pub(super) fn write_values(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    values: &dyn Beside,
    surfaces: &Surfaces,
    regions: &[Option<i32>],
) -> io::Result<()> {
    let counts = mesh.counts();
    let faces: usize = surfaces.list.iter().map(|surface| surface.faces).sum();
    for (column, named) in values.columns().iter().enumerate() {
        let count = if named.at_points { counts.points } else { faces + counts.tets };
        let mut rows = Rows::begin(out, true, named, count)?;
        if named.at_points {
            let mut add = |points: &[Point3]| rows.add(&values.at_points(column, points));
            each_chosen(mesh, |v| surfaces.first.has(v), &mut add)?;
            let others = surfaces.list.iter().skip(1).flat_map(|surface| surfaces.points_of(surface.patch));
            add(&others.map(|held| held.1).collect::<Vec<_>>())?;
            each_chosen(mesh, |v| !surfaces.outer.has(v), &mut add)?;
        } else {
            let mut add = |faces: &[[u32; 3]]| rows.add(&values.in_faces(column, &mesh.corners_of(faces)?));
            if let Some(first) = surfaces.list.first().map(|surface| surface.patch) {
                mesh.each_faces(|piece| {
                    let all = piece.faces.iter().zip(&*piece.patches);
                    add(&all.filter(|(_, patch)| **patch == first).map(|(face, _)| *face).collect::<Vec<_>>())
                })?;
            }
            let others = surfaces.list.iter().skip(1).flat_map(|surface| surfaces.faces_of(surface.patch));
            add(&others.map(|held| held.corners).collect::<Vec<_>>())?;
            for region in regions {
                let Some(region) = *region else {
                    mesh.each_tet_corners(|tets| rows.add(&values.in_tets(column, tets)))?;
                    continue;
                };
                mesh.each_tets(|piece| {
                    let all = piece.tets.iter().zip(&*piece.blocks);
                    let here: Vec<[u32; 4]> = all.filter(|(_, id)| **id == region).map(|(tet, _)| *tet).collect();
                    rows.add(&values.in_tets(column, &mesh.corners_of(&here)?))
                })?;
            }
        }
        rows.end()?;
    }
    Ok(())
}

/// Calls `each` with batches of the selected points.
fn each_chosen(
    mesh: &dyn MeshSource,
    is_chosen: impl Fn(u32) -> bool,
    each: &mut impl FnMut(&[Point3]) -> io::Result<()>,
) -> io::Result<()> {
    let mut before = 0;
    mesh.each_points(|points| {
        let here = (before..).zip(points).filter(|&(v, _)| is_chosen(v));
        let some: Vec<Point3> = here.map(|(_, p)| *p).collect();
        before += points.len() as u32;
        each(&some)
    })
}
