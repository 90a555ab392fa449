//! OFF format: counts, then one point per line, then one face per line.

use super::content::SurfaceContent;
use super::error::SurfaceFault;
use super::faces::Faces;
use crate::text::{Place, Words, shown};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::geometry::Point3;
use std::io::{self, Write};

/// Parses a file. In every variant the position comes first in a line, so colours, normals and texture coordinates
/// after it are ignored.
pub(super) fn read(bytes: &[u8]) -> Result<SurfaceContent, SurfaceFault> {
    let mut words = Words::new(bytes, true);
    read_keyword(&mut words)?;
    // "0 0 0\n"
    let points = words.count("the count of points", 6)?;
    let faces = words.count("the count of faces", 6)?;
    // Ignores the count of edges, which some programs omit.
    words.skip_line();
    let mut positions = Vec::with_capacity(points);
    for _ in 0..points {
        positions.push(words.point()?);
        words.skip_line();
    }
    let mut list = Faces::new(points, 0, faces);
    for _ in 0..faces {
        let count = words.count("a face's count of corners", 2)?;
        let place = Place::Line(words.line());
        for _ in 0..count {
            let named = words.integer("a corner of a face")?;
            list.corner(named, place)?;
        }
        list.end_face(place)?;
        words.skip_line();
    }
    words.expect_end()?;
    list.into_surface(positions)
}

/// Skips the optional keyword.
fn read_keyword(words: &mut Words) -> Result<(), SurfaceFault> {
    let first = words.peek().unwrap_or_default();
    if first.first().is_some_and(u8::is_ascii_digit) && !first.ends_with(b"OFF") {
        return Ok(());
    }
    let keyword = words.need("the keyword OFF")?;
    let place = Place::Line(words.line());
    // Case matters in the prefix: `N` announces normals, `n` another dimension.
    let kind = if keyword.eq_ignore_ascii_case(b"OFF") { Some(&b""[..]) } else { keyword.strip_suffix(b"OFF") };
    let Some(kind) = kind else {
        return Err(SurfaceFault::unexpected(keyword, "the keyword OFF", place));
    };
    let binary = words.peek() == Some(b"BINARY");
    if binary || !kind.iter().all(|b| b"STCN".contains(b)) {
        let found = if binary { "OFF BINARY".into() } else { shown(keyword) };
        return Err(SurfaceFault::Variant { found, place, instead: "plain text OFF with three coordinates a point" });
    }
    Ok(())
}

pub(super) fn write(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    writeln!(out, "OFF\n{} {} 0", mesh.points.len(), mesh.triangles.len())?;
    write_points(out, &mesh.points)?;
    write_triangles(out, &mesh.triangles)
}

/// Writes a boundary.
pub(super) fn write_boundary(out: &mut impl Write, surface: &BoundarySurface) -> io::Result<()> {
    let counts = surface.counts();
    writeln!(out, "OFF\n{} {} 0", counts.points, counts.boundary)?;
    surface.each_points(|points| write_points(out, points))?;
    surface.each_faces(|piece| write_triangles(out, &piece.faces))
}

fn write_points(out: &mut impl Write, points: &[Point3]) -> io::Result<()> {
    points.iter().try_for_each(|p| writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z))
}

fn write_triangles(out: &mut impl Write, triangles: &[[u32; 3]]) -> io::Result<()> {
    triangles.iter().try_for_each(|[a, b, c]| writeln!(out, "3 {a} {b} {c}"))
}
