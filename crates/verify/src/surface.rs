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
        let fold = |n: u64, &b: &u8| n * 256 + u64::from(b);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn soup_of(name: &str, bytes: impl AsRef<[u8]>) -> Result<Soup, String> {
        read(Path::new(name), bytes.as_ref()).map_err(|e| e.to_string())
    }

    /// Two triangles of the points that the files of these tests have.
    fn two() -> Soup {
        let [a, b, c, d] = [[1., 2., 3.], [-4., 5., 6.], [7., -8., 9.], [0.5, 0., -1.]];
        vec![[a, b, c], [d, c, b]]
    }

    #[test]
    fn off_files_have_comments() {
        let text = "OFF # two\n4 2 0 # counts\n\n1 2 3\n-4 5 6\n7 -8 9\n0.5 0 -1 # last\n3 0 1 2\n3 3 2 1\n";
        assert_eq!(soup_of("s.off", text), Ok(two()));
        let damaged = |from: &str, to: &str| soup_of("s.off", text.replace(from, to)).expect_err("damaged");
        assert_eq!(damaged("4 2 0", "four 2 0"), "no numbers of points and faces");
        let reason = "a face is no triangle of points of the file";
        assert_eq!(damaged("3 3 2 1", "3 3 2 4"), reason);
        assert_eq!(damaged("3 3 2 1", "4 3 2 1 0"), reason);
        assert_eq!(damaged("3 3 2 1", "2 3 2"), reason);
        assert_eq!(damaged("3 3 2 1", "3 3 2"), "the file ends early or has a word that is not a number");
        assert_eq!(soup_of("s.obj", text), Err("surfaces '.obj' are not supported; use .off, .stl or .ply".into()));
    }

    #[test]
    fn stl_files_have_text_or_bytes() {
        let soup = two();
        let vertex = |p: &[f64; 3]| format!("  vertex {} {} {}\n", p[0], p[1], p[2]);
        let facet = |t: &[[f64; 3]; 3]| format!(" facet\n{}\n endfacet\n", t.iter().map(vertex).collect::<String>());
        let text = format!("solid s\n{}endsolid\n", soup.iter().map(facet).collect::<String>());
        assert_eq!(soup_of("s.stl", &text), Ok(two()));
        let reason = Err("no triangles, or a damaged one".to_owned());
        assert_eq!(soup_of("s.stl", "solid s\n"), reason);
        assert_eq!(soup_of("s.stl", text.replace("vertex 0.5 0 -1", "")), reason);
        assert_eq!(soup_of("s.stl", text.replace("0.5 0 -1", "0.5 0 ?")), reason);
        let mut bytes = [&[b'x'; 80][..], &2_u32.to_le_bytes()].concat();
        for t in &soup {
            let numbers = [[9.0; 3], t[0], t[1], t[2]];
            bytes.extend(numbers.as_flattened().iter().flat_map(|&x| (x as f32).to_le_bytes()));
            bytes.extend([7; 2]);
        }
        assert_eq!(soup_of("s.stl", &bytes), Ok(two()));
        assert_eq!(soup_of("s.stl", &bytes[..bytes.len() - 1]), reason);
    }

    /// Types of a vertex and of a list of faces, in bytes.
    fn ply_of(kinds: [&str; 2], format: &str) -> Vec<u8> {
        let [real, whole] = kinds;
        let head = format!(
            "ply\nformat {format} 1.0\ncomment element\nelement nothing 9\nelement vertex 4\nproperty {whole} id\n\
             property {real} z\nproperty {real} y\nproperty {real} x\nelement face 2\nproperty {whole} id\n\
             property list {whole} {real} texture\nproperty list {whole} {whole} vertex_index\nend_header\n"
        );
        let mut out = head.into_bytes();
        let mut put = |kind: &str, x: f64| {
            let width = match kind {
                "char" | "int8" | "uchar" | "uint8" => 1,
                "short" | "int16" | "ushort" | "uint16" => 2,
                _ => 4,
            };
            let bytes = match kind {
                "double" | "float64" => x.to_le_bytes().to_vec(),
                "float" | "float32" => (x as f32).to_le_bytes().to_vec(),
                _ => (x as i64).to_le_bytes()[..width].to_vec(),
            };
            match format {
                "ascii" => out.extend(format!("{x}\n").bytes()),
                "binary_big_endian" => out.extend(bytes.iter().rev()),
                _ => out.extend(bytes),
            }
        };
        for [x, y, z] in [[1., 2., 3.], [-4., 5., 6.], [7., -8., 9.], [0.5, 0., -1.]] {
            for (kind, x) in [(whole, 100.), (real, z), (real, y), (real, x)] {
                put(kind, x);
            }
        }
        for face in [[0., 1., 2.], [3., 2., 1.]] {
            let [a, b, c] = face.map(|v| (whole, v));
            for (kind, x) in [(whole, 50.), (whole, 1.), (real, 60.), (whole, 3.), a, b, c] {
                put(kind, x);
            }
        }
        out
    }

    #[test]
    fn ply_files_have_all_types_in_both_orders() {
        let reals = ["float", "float32", "double", "float64"];
        let wholes =
            ["char", "int8", "uchar", "uint8", "short", "int16", "ushort", "uint16", "int", "int32", "uint", "uint32"];
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            for kinds in reals.iter().flat_map(|real| wholes.map(|whole| [real, whole])) {
                assert_eq!(soup_of("s.ply", ply_of(kinds, format)), Ok(two()), "{format} {kinds:?}");
            }
        }
        let file = ply_of(["double", "int"], "binary_little_endian");
        assert_eq!(soup_of("s.ply", &file[..file.len() - 1]), Err("the file ends early".into()));
        assert_eq!(soup_of("s.ply", "ply\n"), Err("no end_header".into()));
        let unknown = "type 'half' is not supported";
        assert_eq!(soup_of("s.ply", ply_of(["half", "int"], "binary_little_endian")), Err(unknown.into()));
    }

    /// Signed integers have a sign in binary files, unsigned ones have none.
    #[test]
    fn coordinates_of_ply_files_may_be_integers() {
        for (kind, bytes, expected) in [
            ("char", &[255][..], -1.0),
            ("uchar", &[255], 255.0),
            ("short", &[254, 255], -2.0),
            ("ushort", &[1, 255], 65281.0),
            ("int", &[0, 0, 0, 128], -2_147_483_648.0),
            ("uint", &[0, 0, 0, 128], 2_147_483_648.0),
        ] {
            let head = format!(
                "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty {kind} x\nelement face 1\n\
                 property list uchar uchar vertex_indices\nend_header\n"
            );
            let file = [head.as_bytes(), bytes, &[3, 0, 0, 0]].concat();
            assert_eq!(soup_of("s.ply", file), Ok(vec![[[expected, 0.0, 0.0]; 3]]), "{kind}");
        }
    }

    #[test]
    fn zeros_of_both_signs_are_the_same_place() {
        let points = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
        let mesh = Mesh { points, tets: vec![[0, 1, 2, 3]], ..Mesh::default() };
        let mut report = Report::default();
        let boundary = crate::faces::check(&mesh, &mut report).expect("a boundary");
        let kept = vec![[[-0., 0., 0.], [0., 1., 0.], [1., -0., -0.]]];
        let outside = vec![[[0., 0., 0.], [0., 1., 0.], [0., 1., 0.]]];
        check(&[kept, outside].concat(), &mesh, &boundary, &mut report);
        let outcome = report.outcomes.last().expect("a condition");
        assert_eq!((outcome.condition, outcome.first.join(" ").as_str()), (Condition::SurfaceKept, "1"));
    }
}
