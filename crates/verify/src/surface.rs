//! Readers of triangle surfaces (OFF, STL, PLY in text or binary), and the condition that a mesh keeps one.

use crate::faces::Boundary;
use crate::mesh::Mesh;
use crate::numbers::{DOUBLE, Kind, LONG, Numbers, Order};
use crate::report::{Condition, Report};
use crate::sides::key;
use crate::space::Point;
use anyhow::{Context as _, Result, bail, ensure};
use bstr::ByteSlice as _;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Triangles as positions of their corners.
pub type Soup = Vec<[Point; 3]>;

/// Reads a surface; the extension selects the format.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Soup> {
    match path.extension().and_then(|e| e.to_str()).unwrap_or_default() {
        "off" => off(&String::from_utf8_lossy(bytes)),
        "stl" => stl(bytes),
        "ply" => ply(bytes),
        other => bail!("surfaces '.{other}' are not supported; use .off, .stl or .ply"),
    }
}

/// Adds the condition that each triangle is a boundary face, or a labelled face between two tetrahedra.
pub fn check(surface: &Soup, mesh: &Mesh, boundary: &Boundary, report: &mut Report) {
    // Adding zero makes both zeros equal.
    let place = |p: &[f64; 3]| p.map(|x| (x + 0.0).to_bits());
    let numbers: HashMap<_, u32> = mesh.points.iter().map(place).zip(0..).collect();
    let faces: HashSet<[u32; 3]> = boundary.faces.iter().chain(&boundary.labelled_inside).map(|&f| key(f)).collect();
    let is_kept = |t: &[Point; 3]| {
        let vertices = t.each_ref().map(|p| numbers.get(&place(p)).copied());
        matches!(vertices, [Some(a), Some(b), Some(c)] if faces.contains(&key([a, b, c])))
    };
    report.add(Condition::SurfaceKept, (0..surface.len()).filter(|&i| !is_kept(&surface[i])));
}

/// Triangles of polygons with vertices in a list of points. Polygons of more vertices are an error.
fn soup(points: &[[f64; 3]], polygons: &[Vec<i64>]) -> Result<Soup> {
    let corner = |&v: &i64| points.get(usize::try_from(v).ok()?).copied();
    let triangle = |polygon: &Vec<i64>| polygon.iter().map(corner).collect::<Option<Vec<_>>>()?.try_into().ok();
    let soup: Option<Soup> = polygons.iter().map(triangle).collect();
    soup.context("a face is no triangle of points of the file")
}

fn off(text: &str) -> Result<Soup> {
    let lines: Vec<&str> = text.lines().map(|line| line.split('#').next().unwrap_or_default()).collect();
    let text = lines.join("\n");
    let mut numbers = Numbers::text(text.trim_start().trim_start_matches("OFF"));
    let counts = numbers.array::<i64, 3>(LONG).ok().context("no numbers of points and faces")?;
    let [points, faces, _] = counts;
    let points = (0..points).map(|_| numbers.array(DOUBLE)).collect::<Result<Vec<_>>>()?;
    let polygon = |_| {
        let corners = numbers.next(LONG)?;
        numbers.list(LONG, corners)
    };
    soup(&points, &(0..faces).map(polygon).collect::<Result<Vec<_>>>()?)
}

fn stl(bytes: &[u8]) -> Result<Soup> {
    let count = bytes.get(80..84).and_then(|b| b.try_into().ok()).map_or(0, u32::from_le_bytes) as usize;
    if bytes.len() == 84 + 50 * count {
        // A normal, three corners and two further bytes.
        let triangle = |bytes| {
            let mut numbers = Numbers { rest: bytes, order: Order::Little };
            numbers.array::<f64, 12>(Kind::Real(4)).map(|numbers| [1, 2, 3].map(|i| numbers.as_chunks().0[i]))
        };
        return bytes[84..].chunks_exact(50).map(triangle).collect();
    }
    let text = String::from_utf8_lossy(bytes);
    let corners = text.lines().filter_map(|line| line.trim().strip_prefix("vertex "));
    // Readers of STL use 32-bit numbers; the text may have more digits.
    let corners: Result<Vec<[f64; 3]>> = corners.map(|corner| Numbers::text(corner).array(DOUBLE)).collect();
    let corners = corners.unwrap_or_default();
    let (triangles, rest) = corners.as_chunks();
    ensure!(!triangles.is_empty() && rest.is_empty(), "no triangles, or a damaged one");
    Ok(triangles.to_vec())
}

/// Element of a PLY file: name, number, and types and name of each property.
type Element<'a> = (&'a str, i64, Vec<(Vec<&'a str>, &'a str)>);

/// Elements and format of a PLY file.
fn header(head: &str) -> (Vec<Element<'_>>, Order) {
    let (mut elements, mut order): (Vec<Element>, _) = (Vec::new(), Order::Little);
    for line in head.lines() {
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match (&words[..], elements.last_mut()) {
            (["format", "ascii", _], _) => order = Order::Text,
            (["format", "binary_big_endian", _], _) => order = Order::Big,
            (["element", name, count], _) => elements.push((name, count.parse().unwrap_or(0), Vec::new())),
            (["property", kinds @ .., name], Some((.., properties))) => properties.push((kinds.to_vec(), name)),
            _ => {}
        }
    }
    (elements, order)
}

fn ply(bytes: &[u8]) -> Result<Soup> {
    let (head, body) = bytes.split_once_str("end_header").context("no end_header")?;
    let head = String::from_utf8_lossy(head);
    let (elements, order) = header(&head);
    let mut numbers = Numbers { rest: body.split_once_str("\n").map_or(body, |(_, rest)| rest), order };
    let kind = |name| if order == Order::Text { Ok(DOUBLE) } else { Kind::named(name) };
    let (mut points, mut polygons) = (Vec::new(), Vec::new());
    for (element, count, properties) in elements {
        // Elements without properties take no bytes.
        for _ in 0..if properties.is_empty() { 0 } else { count } {
            let mut point = [0.0; 3];
            for (kinds, property) in &properties {
                match (&kinds[..], *property) {
                    (["list", length, of], name) => {
                        let count = numbers.next::<f64>(kind(length)?)?;
                        let list: Vec<f64> = numbers.list(kind(of)?, count as i64)?;
                        if element == "face" && name.starts_with("vert") {
                            polygons.push(list.iter().map(|&v| v as i64).collect());
                        }
                    }
                    ([of], "x") => point[0] = numbers.next(kind(of)?)?,
                    ([of], "y") => point[1] = numbers.next(kind(of)?)?,
                    ([of], "z") => point[2] = numbers.next(kind(of)?)?,
                    ([of], _) => drop(numbers.next::<f64>(kind(of)?)?),
                    (_, name) => bail!("the property '{name}' has no type"),
                }
            }
            if element == "vertex" {
                points.push(point);
            }
        }
    }
    soup(&points, &polygons)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soup_of(name: &str, bytes: impl AsRef<[u8]>) -> Result<Soup, String> {
        read(Path::new(name), bytes.as_ref()).map_err(|e| format!("{e:#}"))
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
