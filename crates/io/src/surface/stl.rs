//! STL format: triangles with individual corners; equal corners are merged to points.

use super::content::{SurfaceContent, SurfaceNote};
use super::error::SurfaceFault;
use super::groups::Groups;
use crate::text::Place;
use crate::text::{TextFault, Words};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rustc_hash::FxHashMap;
use std::io::{self, Write};

/// Header size of a binary file: 80 arbitrary bytes and a count.
const HEAD: usize = 84;
/// Bytes per triangle: normal, three corners and two arbitrary bytes.
const RECORD: usize = 50;

/// Parses a text or binary file.
pub(super) fn read(bytes: &[u8]) -> Result<SurfaceContent, SurfaceFault> {
    // Binary files may start with the keyword of text files; a matching length or a zero byte identifies them.
    let announced = announced_length(bytes);
    let begins_as_text = bytes.trim_ascii_start().get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"));
    if announced == Some(bytes.len() as u64) || !begins_as_text || bytes[..bytes.len().min(HEAD)].contains(&0) {
        read_binary(bytes, announced)
    } else {
        read_text(bytes)
    }
}

/// Length of a binary file according to its count.
fn announced_length(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEAD)?.try_into().map(u32::from_le_bytes).ok()?;
    Some(HEAD as u64 + RECORD as u64 * u64::from(count))
}

/// Merges equal corners.
#[derive(Default)]
struct Joiner {
    mesh: TriMesh,
    /// First corner at each point.
    corner_of: Vec<u32>,
    known: FxHashMap<[u64; 3], u32>,
}

impl Joiner {
    /// Index of the point at a corner of the next triangle. Only equal coordinates are merged (−0 equals 0).
    fn index(&mut self, p: Point3, corner: usize) -> u32 {
        let p = p.map(|x| x + 0.0);
        let Self { mesh: TriMesh { points, triangles }, corner_of, known } = self;
        *known.entry([p.x.to_bits(), p.y.to_bits(), p.z.to_bits()]).or_insert_with(|| {
            points.push(p);
            corner_of.push((3 * triangles.len() + corner) as u32);
            (points.len() - 1) as u32
        })
    }

    fn into_content(self) -> SurfaceContent {
        SurfaceContent { corner_of: self.corner_of, ..self.mesh.into() }
    }
}

fn read_binary(bytes: &[u8], announced: Option<u64>) -> Result<SurfaceContent, SurfaceFault> {
    let (announced, found) = (announced.unwrap_or(HEAD as u64), bytes.len() as u64);
    let surplus = found.checked_sub(announced);
    // No triangles but further data: the count was never written. Three corners per triangle must fit into u32 ids.
    let none = announced == HEAD as u64 && surplus != Some(0);
    let Some(surplus) = surplus.filter(|_| !none && announced / RECORD as u64 <= u64::from(u32::MAX / 3)) else {
        return Err(SurfaceFault::Length { announced, found });
    };
    let (records, _) = bytes[HEAD..announced as usize].as_chunks::<RECORD>();
    let mut joiner = Joiner::default();
    joiner.mesh.triangles.reserve_exact(records.len());
    for (face, record) in records.iter().enumerate() {
        let mut triangle = [0; 3];
        for (i, corner) in triangle.iter_mut().enumerate() {
            let at = 12 * (i + 1);
            let (floats, _) = record[at..at + 12].as_chunks::<4>();
            let [x, y, z] = [floats[0], floats[1], floats[2]].map(|f| f64::from(f32::from_le_bytes(f)));
            if !(x.is_finite() && y.is_finite() && z.is_finite()) {
                return Err(SurfaceFault::NotFinite { point: 3 * face + i, byte: HEAD + RECORD * face + at });
            }
            *corner = joiner.index(Point3::new(x, y, z), i);
        }
        joiner.mesh.triangles.push(triangle);
    }
    let notes =
        if surplus == 0 { Vec::new() } else { vec![SurfaceNote::Surplus { bytes: surplus, triangles: records.len() }] };
    Ok(SurfaceContent { notes, ..joiner.into_content() })
}

/// Reads text, in which every line starts with a keyword. Normals are ignored: they are redundant, and some programs
/// write `nan`.
fn read_text(bytes: &[u8]) -> Result<SurfaceContent, SurfaceFault> {
    let mut words = Words::new(bytes, false);
    let mut joiner = Joiner::default();
    let mut solids = Groups::default();
    let mut triangle = [0; 3];
    // Corners of the open loop.
    let mut corners: Option<usize> = None;
    let mut open = false;
    while let Some(word) = words.word() {
        let place = Place::Line(words.line());
        let unexpected = |expected| SurfaceFault::unexpected(word, expected, place);
        match word.to_ascii_lowercase().as_slice() {
            b"solid" if corners.is_none() => {
                solids.begin(words.rest_of_line());
                open = true;
            }
            b"endsolid" if corners.is_none() => open = false,
            b"outer" if open && corners.is_none() => corners = Some(0),
            b"vertex" => {
                let count = corners.as_mut().ok_or_else(|| unexpected("'outer loop'"))?;
                let point = words.point_here()?;
                if let Some(corner) = triangle.get_mut(*count) {
                    *corner = joiner.index(point, *count);
                }
                *count += 1;
            }
            b"endloop" => {
                let face = joiner.mesh.triangles.len();
                match corners.take().ok_or_else(|| unexpected("'outer loop'"))? {
                    3 if face < (u32::MAX / 3) as usize => {
                        joiner.mesh.triangles.push(triangle);
                        solids.add_face();
                    }
                    count => return Err(SurfaceFault::NotATriangle { face, corners: count as i64, place }),
                }
            }
            b"facet" | b"endfacet" if open && corners.is_none() => {}
            _ => return Err(unexpected("a keyword of the format (facet, outer loop, vertex, endloop, endfacet)")),
        }
        words.skip_line();
    }
    if open {
        return Err(TextFault::CutShort { line: words.line(), missing: "'endsolid'" }.into());
    }
    let (of_faces, names) = solids.parts();
    Ok(joiner.into_content().grouped(of_faces, names))
}

/// Writes binary if all coordinates are exact in 32 bits, otherwise text.
pub(super) fn write(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    let exact = |x: &f64| f64::from(*x as f32) == *x;
    let few = u32::try_from(mesh.triangles.len()).is_ok();
    if few && mesh.points.iter().all(|p| p.iter().all(exact)) { write_binary(out, mesh) } else { write_text(out, mesh) }
}

/// Unit normal of a triangle; zero if degenerate.
fn normal([a, b, c]: [Point3; 3]) -> Vec3 {
    let cross = (b - a).cross(&(c - a));
    let length = cross.norm();
    if length > 0.0 && length.is_finite() { cross / length } else { Vec3::zeros() }
}

fn write_binary(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    out.write_all(&head(mesh.triangles.len() as u32))?;
    for triangle in &mesh.triangles {
        out.write_all(&record(triangle.map(|v| mesh.points[v as usize])))?;
    }
    Ok(())
}

/// Writes a boundary in binary, with coordinates rounded to 32 bits.
pub(super) fn write_boundary(out: &mut impl Write, surface: &BoundarySurface) -> io::Result<()> {
    let Ok(count) = u32::try_from(surface.counts().boundary) else {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "the number of triangles exceeds the 32-bit count of STL; write PLY",
        ));
    };
    out.write_all(&head(count))?;
    surface.each_corners(|triangles| {
        out.write_all(triangles.iter().map(|corners| record(*corners)).collect::<Vec<_>>().as_flattened())
    })
}

/// Header of a binary file.
fn head(count: u32) -> [u8; HEAD] {
    let mut head = [b' '; HEAD];
    head[..10].copy_from_slice(b"anastomesh");
    head[80..].copy_from_slice(&count.to_le_bytes());
    head
}

/// Record of a triangle in a binary file.
fn record(corners: [Point3; 3]) -> [u8; RECORD] {
    let mut record = [0; RECORD];
    let (floats, _) = record.as_chunks_mut::<4>();
    let normal = normal(corners);
    let values = normal.iter().chain(corners.iter().flat_map(Point3::iter));
    for (slot, &value) in floats.iter_mut().zip(values) {
        *slot = (value as f32).to_le_bytes();
    }
    record
}

fn write_text(out: &mut impl Write, mesh: &TriMesh) -> io::Result<()> {
    writeln!(out, "solid anastomesh")?;
    for triangle in &mesh.triangles {
        let points = triangle.map(|v| mesh.points[v as usize]);
        let n = normal(points);
        writeln!(out, "facet normal {:?} {:?} {:?}\n outer loop", n.x as f32, n.y as f32, n.z as f32)?;
        for p in points {
            writeln!(out, "  vertex {:?} {:?} {:?}", p.x, p.y, p.z)?;
        }
        writeln!(out, " endloop\nendfacet")?;
    }
    writeln!(out, "endsolid anastomesh")
}
