//! OBJ format: lines `v x y z` and `f v/vt/vn …`; negative indices count back from the last vertex so far. Groups (`g`)
//! are markers of faces, or else objects (`o`) or materials (`usemtl`).

use super::content::SurfaceContent;
use super::error::SurfaceFault;
use super::faces::Faces;
use super::groups::Groups;
use crate::text::Place;
use crate::text::{TextFault, Words};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::geometry::Point3;
use std::io::{self, Write};

/// Parses a file.
pub(super) fn read(bytes: &[u8]) -> Result<SurfaceContent, SurfaceFault> {
    let mut words = Words::new(bytes, true);
    // Vertices may follow the faces that refer to them, so corners are checked at the end.
    let faces = Faces::new(u32::MAX as usize - 1, 1, 0);
    let mut reader = Reader { points: Vec::new(), faces, groups: Default::default(), ahead: None };
    while let Some(keyword) = words.word() {
        match keyword {
            b"v" => {
                if reader.points.len() >= u32::MAX as usize - 1 {
                    let value = reader.points.len() as i64;
                    let line = words.line();
                    return Err(TextFault::OutOfRange { line, what: "the count of points", value }.into());
                }
                // A weight or a colour may follow.
                reader.points.push(words.point_here()?);
            }
            b"f" => reader.read_face(&mut words)?,
            b"g" => reader.groups[0].begin(words.rest_of_line()),
            b"o" => reader.groups[1].begin(words.rest_of_line()),
            b"usemtl" => reader.groups[2].begin(words.rest_of_line()),
            _ => {}
        }
        words.skip_line();
    }
    reader.finish()
}

/// Face with a reference to a later vertex.
struct Ahead {
    index: i64,
    face: usize,
    line: usize,
}

struct Reader {
    points: Vec<Point3>,
    faces: Faces,
    /// Groups, objects and materials.
    groups: [Groups; 3],
    /// Face with the reference to the highest later vertex.
    ahead: Option<Ahead>,
}

impl Reader {
    fn read_face(&mut self, words: &mut Words) -> Result<(), SurfaceFault> {
        let line = words.line();
        while let Some(word) = words.word_here() {
            // A backslash continues the line.
            if word == b"\\" {
                words.skip_line();
                continue;
            }
            let named = word.split(|&b| b == b'/').next().unwrap_or_default();
            let named = words.as_integer(named, "a corner of a face")?;
            self.corner(named, line)?;
        }
        self.groups.iter_mut().for_each(Groups::add_face);
        self.faces.end_face(Place::Line(line))
    }

    fn corner(&mut self, named: i64, line: usize) -> Result<(), SurfaceFault> {
        let points = self.points.len() as i64;
        let index = if named < 0 { points.saturating_add(named).saturating_add(1) } else { named };
        if index < 1 || index >= i64::from(u32::MAX) {
            return Err(self.bad_index(&Ahead { index: named, face: self.faces.number(), line }));
        }
        if index > points && self.ahead.as_ref().is_none_or(|ahead| ahead.index < named) {
            self.ahead = Some(Ahead { index: named, face: self.faces.number(), line });
        }
        self.faces.corner(index, Place::Line(line))
    }

    fn bad_index(&self, &Ahead { index, face, line }: &Ahead) -> SurfaceFault {
        SurfaceFault::BadIndex { face, index, points: self.points.len(), first: 1, place: Place::Line(line) }
    }

    fn finish(self) -> Result<SurfaceContent, SurfaceFault> {
        match &self.ahead {
            Some(ahead) if ahead.index > self.points.len() as i64 => Err(self.bad_index(ahead)),
            _ => {
                let content = self.faces.into_surface(self.points)?;
                let Some(groups) = self.groups.iter().find(|groups| groups.are_several()) else { return Ok(content) };
                let (of_faces, names) = groups.parts();
                Ok(content.grouped(of_faces, names))
            }
        }
    }
}

pub(super) fn write(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    write_points(out, &mesh.points)?;
    write_triangles(out, &mesh.triangles)
}

/// Writes a boundary.
pub(super) fn write_boundary(out: &mut impl Write, surface: &BoundarySurface) -> io::Result<()> {
    surface.each_points(|points| write_points(out, points))?;
    surface.each_faces(|piece| write_triangles(out, &piece.faces))
}

fn write_points(out: &mut impl Write, points: &[Point3]) -> io::Result<()> {
    points.iter().try_for_each(|p| writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z))
}

fn write_triangles(out: &mut impl Write, triangles: &[[u32; 3]]) -> io::Result<()> {
    triangles.iter().try_for_each(|triangle| {
        let [a, b, c] = triangle.map(|v| u64::from(v) + 1);
        writeln!(out, "f {a} {b} {c}")
    })
}
