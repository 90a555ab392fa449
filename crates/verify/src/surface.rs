//! Readers of triangle surfaces (OFF, STL, PLY in text or binary), and the condition that a mesh keeps one.

use crate::faces::{Boundary, key};
use crate::mesh::{Mesh, Read, fail, next, next_n};
use crate::report::{Condition, Report};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Triangles as positions of their corners.
pub type Soup = Vec<[[f64; 3]; 3]>;

/// Reads a surface; the extension selects the format.
pub fn read(path: &Path, bytes: &[u8]) -> Read<Soup> {
    match path.extension().and_then(|e| e.to_str()).unwrap_or_default() {
        "off" => off(&String::from_utf8_lossy(bytes)),
        "stl" => stl(bytes),
        "ply" => ply(bytes),
        other => fail(format!("surfaces '.{other}' are not supported; use .off, .stl or .ply")),
    }
}

/// Adds the condition that each triangle is a boundary face, or a labelled face between two tetrahedra.
pub fn check(surface: &Soup, mesh: &Mesh, boundary: &Boundary, report: &mut Report) {
    // Adding zero makes both zeros equal.
    let place = |p: &[f64; 3]| p.map(|x| (x + 0.0).to_bits());
    let numbers: HashMap<_, u32> = mesh.points.iter().map(place).zip(0..).collect();
    let faces: HashSet<[u32; 3]> = boundary.faces.iter().chain(&boundary.labelled_inside).map(|&f| key(f)).collect();
    let is_kept = |t: &[[f64; 3]; 3]| {
        let vertices = t.each_ref().map(|p| numbers.get(&place(p)).copied());
        matches!(vertices, [Some(a), Some(b), Some(c)] if faces.contains(&key([a, b, c])))
    };
    report.add(Condition::SurfaceKept, (0..surface.len()).filter(|&i| !is_kept(&surface[i])));
}

/// Triangles of polygons with vertices in a list of points. Polygons of more vertices are an error.
fn soup(points: &[[f64; 3]], polygons: &[Vec<usize>]) -> Read<Soup> {
    let corner = |&v: &usize| points.get(v).copied();
    let triangle = |polygon: &Vec<usize>| match polygon.iter().map(corner).collect::<Option<Vec<_>>>()?[..] {
        [a, b, c] => Some([a, b, c]),
        _ => None,
    };
    let soup: Option<Soup> = polygons.iter().map(triangle).collect();
    soup.map_or_else(|| fail("a face is no triangle of points of the file"), Ok)
}

fn off(text: &str) -> Read<Soup> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default());
    let mut words = lines.flat_map(str::split_ascii_whitespace).skip_while(|&word| word == "OFF");
    let counts: Option<[usize; 3]> = next_n(&mut words);
    let Some([points, faces, _]) = counts else { return fail("no numbers of points and faces") };
    let points: Option<Vec<[f64; 3]>> = (0..points).map(|_| next_n(&mut words)).collect();
    let polygons: Option<Vec<Vec<usize>>> = (0..faces)
        .map(|_| next(&mut words).and_then(|corners: usize| (0..corners).map(|_| next(&mut words)).collect()))
        .collect();
    match (points, polygons) {
        (Some(points), Some(polygons)) => soup(&points, &polygons),
        _ => fail("the file ends early or has a word that is not a number"),
    }
}

fn stl(bytes: &[u8]) -> Read<Soup> {
    let count = bytes.get(80..84).and_then(|b| b.try_into().ok()).map_or(0, u32::from_le_bytes) as usize;
    if bytes.len() == 84 + 50 * count {
        let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let corner = |b: &[u8]| [number(b), number(&b[4..]), number(&b[8..])];
        let triangle = |b: &[u8]| [corner(&b[12..]), corner(&b[24..]), corner(&b[36..])];
        return Ok(bytes[84..].chunks_exact(50).map(triangle).collect());
    }
    let text = String::from_utf8_lossy(bytes);
    let corners = text.lines().filter_map(|line| line.trim().strip_prefix("vertex "));
    // Readers of STL use 32-bit numbers; the text may have more digits.
    let corner = |line: &str| next_n(&mut line.split_ascii_whitespace());
    match corners.map(corner).collect::<Option<Vec<[f64; 3]>>>() {
        Some(corners) if !corners.is_empty() && corners.len().is_multiple_of(3) => Ok(corners.as_chunks().0.to_vec()),
        _ => fail("no triangles, or a damaged one"),
    }
}

/// Element of a PLY file: name, number, and properties with the type of their list length (if any) and value.
type Element<'a> = (&'a str, usize, Vec<(Option<&'a str>, &'a str, &'a str)>);

fn ply(bytes: &[u8]) -> Read<Soup> {
    let mark = b"end_header";
    let Some(end) = bytes.windows(mark.len()).position(|window| window == mark) else { return fail("no end_header") };
    let body = end + bytes[end..].iter().position(|&b| b == b'\n').map_or(mark.len(), |newline| newline + 1);
    let head = String::from_utf8_lossy(&bytes[..end]).into_owned();
    let (mut elements, mut format): (Vec<Element>, &str) = (Vec::new(), "");
    for line in head.lines() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        let property = match words[..] {
            ["format", name, _] => {
                format = name;
                continue;
            }
            ["element", name, count] => {
                elements.push((name, count.parse().unwrap_or(0), Vec::new()));
                continue;
            }
            ["property", "list", length, kind, name] => (Some(length), kind, name),
            ["property", kind, name] => (None, kind, name),
            _ => continue,
        };
        if let Some((_, _, properties)) = elements.last_mut() {
            properties.push(property);
        }
    }
    let mut values = Values { rest: &bytes[body..], format };
    let (mut points, mut polygons) = (Vec::new(), Vec::new());
    for (name, count, properties) in elements {
        // Elements without properties take no bytes.
        for _ in 0..if properties.is_empty() { 0 } else { count } {
            let mut point = [0.0; 3];
            for &(length, kind, property) in &properties {
                let count = length.map_or(Ok(1.0), |length| values.next(length))? as usize;
                let list = (0..count).map(|_| values.next(kind)).collect::<Read<Vec<f64>>>()?;
                match (length, ["x", "y", "z"].iter().position(|&axis| axis == property)) {
                    (None, Some(axis)) => point[axis] = list[0],
                    (Some(_), _) if name == "face" && property.starts_with("vert") => {
                        polygons.push(list.iter().map(|&v| v as usize).collect());
                    }
                    _ => {}
                }
            }
            if name == "vertex" {
                points.push(point);
            }
        }
    }
    soup(&points, &polygons)
}

/// Numbers after the header of a PLY file.
struct Values<'a> {
    rest: &'a [u8],
    format: &'a str,
}

impl Values<'_> {
    fn next(&mut self, kind: &str) -> Read<f64> {
        if self.format == "ascii" {
            let text = self.rest.trim_ascii_start();
            let length = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
            self.rest = &text[length..];
            let number = std::str::from_utf8(&text[..length]).ok().and_then(|word| word.parse().ok());
            return number.map_or_else(|| fail("the file ends early or has a word that is not a number"), Ok);
        }
        let width = match kind {
            "char" | "int8" | "uchar" | "uint8" => 1,
            "short" | "int16" | "ushort" | "uint16" => 2,
            "int" | "int32" | "uint" | "uint32" | "float" | "float32" => 4,
            "double" | "float64" => 8,
            other => return fail(format!("type '{other}' is not supported")),
        };
        let Some((bytes, rest)) = self.rest.split_at_checked(width) else { return fail("the file ends early") };
        self.rest = rest;
        let fold = |n: u64, &b: &u8| n << 8 | u64::from(b);
        let is_big = self.format == "binary_big_endian";
        let n = if is_big { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) };
        Ok(match kind {
            "double" | "float64" => f64::from_bits(n),
            "float" | "float32" => f64::from(f32::from_bits(n as u32)),
            kind if kind.starts_with('u') => n as f64,
            _ => (((n << (64 - 8 * width)) as i64) >> (64 - 8 * width)) as f64,
        })
    }
}
