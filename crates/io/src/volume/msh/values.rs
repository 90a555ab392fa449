//! Columns of values beside a mesh: sections of data of nodes or elements, the same in both versions, in the order in which nodes
//! and elements stand in the file, which is that of their tags.

use super::surfaces::Surfaces;
use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::MeshSource;
use std::io::{self, Write};

/// A section that is being written: tags, each with its value.
struct ValueRows<'a, W> {
    out: &'a mut W,
    /// Whether rows are bytes; what stands before them is text in any file.
    binary: bool,
    section: &'static str,
    tag: i32,
}

impl<'a, W: Write> ValueRows<'a, W> {
    /// Begins the section of a column with so many rows.
    fn begin(out: &'a mut W, binary: bool, column: &Column, rows: usize) -> io::Result<Self> {
        let section = if column.at_points { "NodeData" } else { "ElementData" };
        if i32::try_from(rows).is_err() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "data of Gmsh count to 2,147,483,647 only"));
        }
        // A text, the name; a number, the time; three whole ones: the step, how many values each has, and how many rows.
        write!(out, "${section}\n1\n\"{}\"\n1\n0.0\n3\n0\n1\n{rows}\n", column.name)?;
        Ok(Self { out, binary, section, tag: 0 })
    }

    /// Adds the values of the nodes or elements that come next.
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

/// Values of nodes and elements of version 2.2: another pass over these for each column.
///
/// # Errors
/// What the writer `out` or reading the mesh reports.
pub(super) fn write_values_2(out: &mut impl Write, mesh: &dyn MeshSource, values: &dyn Beside) -> io::Result<()> {
    let counts = mesh.counts();
    for (column, named) in values.columns().iter().enumerate() {
        let count = if named.at_points { counts.points } else { counts.boundary + counts.tets };
        let mut rows = ValueRows::begin(out, false, named, count)?;
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

/// Values of nodes and elements of version 4.1, which stand surface by surface: two passes over the points, one over faces and
/// tetrahedra for each column. `regions` are those of the volumes, in order; none is all tetrahedra.
///
/// # Errors
/// What the writer `out` or reading the mesh reports.
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
        let mut rows = ValueRows::begin(out, true, named, count)?;
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

/// Gives points, but only those that are chosen.
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
