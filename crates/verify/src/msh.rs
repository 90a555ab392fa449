//! Reader of Gmsh's MSH files: 4.1 in text or binary, 2.2 in text.

use crate::mesh::{Cap, Mesh, Read, fail, index, next, next_n};
use serde_json::Value;
use std::collections::HashMap;

const LINE: i64 = 1;
const TRIANGLE: i64 = 2;
const TETRAHEDRON: i64 = 4;
const POINT: i64 = 15;

/// Reads a mesh.
pub fn read(bytes: &[u8]) -> Read<Mesh> {
    let Some(head) = section(bytes, "MeshFormat") else { return fail("no section $MeshFormat") };
    let head = String::from_utf8_lossy(&head[..head.len().min(30)]).into_owned();
    let mut words = head.split_ascii_whitespace();
    let (version, is_binary) = (words.next().unwrap_or_default(), words.next() == Some("1"));
    let mut parts = Parts::default();
    names(bytes, &mut parts.mesh)?;
    notes(bytes, &mut parts)?;
    match version {
        "4.1" => {
            let body = |name| Cursor { rest: section(bytes, name).unwrap_or_default(), is_binary };
            parts.read_4(body("Entities"), body("Nodes"), body("Elements"))
        }
        "2.2" if !is_binary => parts.read_2(bytes),
        other => fail(format!("MSH {other}{} is not supported", if is_binary { " binary" } else { "" })),
    }
}

/// Bytes of a section, without the line of its name.
fn section<'a>(bytes: &'a [u8], name: &str) -> Option<&'a [u8]> {
    let find = |text: String, from: usize| {
        bytes[from..].windows(text.len()).position(|window| window == text.as_bytes()).map(|at| from + at)
    };
    let start = find(format!("${name}"), 0)?;
    let start = start + bytes[start..].iter().position(|&b| b == b'\n')? + 1;
    Some(&bytes[start..find(format!("$End{name}"), start)?])
}

fn text<'a>(bytes: &'a [u8], name: &str) -> Read<&'a str> {
    let body = section(bytes, name).unwrap_or_default();
    std::str::from_utf8(body).or_else(|_| fail(format!("section ${name} is not UTF-8")))
}

fn names(bytes: &[u8], mesh: &mut Mesh) -> Read<()> {
    for line in text(bytes, "PhysicalNames")?.lines().skip(1) {
        let mut parts = line.splitn(3, ' ');
        let (Some(dimension), Some(id)) = (next::<i64>(&mut parts), next(&mut parts)) else {
            return fail(format!("bad line '{line}' of $PhysicalNames"));
        };
        let name = parts.next().unwrap_or_default().trim().trim_matches('"');
        if dimension == 2 {
            mesh.patches.push((id, name.to_owned()));
        }
    }
    Ok(())
}

/// Section of `anastomesh` with the expectation and the caps.
fn notes(bytes: &[u8], Parts { mesh, regions, .. }: &mut Parts) -> Read<()> {
    let json = text(bytes, "Anastomesh")?;
    if json.trim().is_empty() {
        return Ok(());
    }
    let Ok(notes) = serde_json::from_str::<Value>(json) else { return fail("section $Anastomesh is not JSON") };
    let list = |name: &str| notes[name].as_array().map(|list| list.iter().filter_map(Value::as_i64).collect());
    (mesh.expected_loops, mesh.expected_terminals) = (list("loops"), list("terminals"));
    let pairs = notes["groups"].as_array().into_iter().flatten();
    regions.extend(pairs.filter_map(|pair| Some((pair[1].as_i64()?, pair[0].as_i64()?))));
    for region in notes["regions"].as_array().into_iter().flatten() {
        let name = region["name"].as_str().unwrap_or_default();
        mesh.regions.push((region["id"].as_i64().unwrap_or(-1), name.to_owned()));
    }
    let triple = |value: &Value| [0, 1, 2].map(|i| value[i].as_f64().unwrap_or(f64::NAN));
    for cap in notes["caps"].as_array().into_iter().flatten() {
        mesh.caps.push(Cap {
            patch: cap["patch"].as_i64().unwrap_or(-1),
            node: cap["node"].as_i64().unwrap_or(-1),
            center: triple(&cap["center"]),
            normal: triple(&cap["normal"]),
            radius: cap["radius"].as_f64().unwrap_or(f64::NAN),
        });
    }
    Ok(())
}

/// Mesh under construction.
#[derive(Default)]
struct Parts {
    mesh: Mesh,
    /// Index of each node by its number in the file.
    numbers: HashMap<i64, u32>,
    /// Region of each physical group that is not its number.
    regions: HashMap<i64, i64>,
}

impl Parts {
    fn add_node(&mut self, number: i64, point: [f64; 3]) -> Read<()> {
        if self.numbers.insert(number, index(self.mesh.points.len() as i64)).is_some() {
            return fail(format!("node {number} is listed twice"));
        }
        self.mesh.points.push(point);
        Ok(())
    }

    /// Adds an element; false if its kind is unknown.
    fn add_element(&mut self, kind: i64, label: i64, nodes: &[i64]) -> bool {
        let vertex = |node| self.numbers.get(&node).copied().unwrap_or(u32::MAX);
        match (kind, nodes) {
            (TETRAHEDRON, &[a, b, c, d]) => {
                self.mesh.tets.push([a, b, c, d].map(vertex));
                if !self.mesh.regions.is_empty() {
                    self.mesh.tet_regions.push(self.regions.get(&label).copied().unwrap_or(label));
                }
            }
            (TRIANGLE, &[a, b, c]) => {
                self.mesh.triangles.push([a, b, c].map(vertex));
                self.mesh.labels.push(label);
            }
            _ => return matches!(kind, LINE | POINT),
        }
        true
    }

    fn read_4(mut self, mut entities: Cursor, mut nodes: Cursor, mut elements: Cursor) -> Read<Mesh> {
        let mut labels = HashMap::new();
        if !entities.rest.is_empty() {
            let counts = [entities.size()?, entities.size()?, entities.size()?, entities.size()?];
            for (dimension, &count) in counts.iter().enumerate() {
                for _ in 0..count {
                    let tag = entities.int()?;
                    (0..if dimension == 0 { 3 } else { 6 }).try_for_each(|_| entities.real().map(drop))?;
                    for i in 0..entities.size()? {
                        let label = entities.int()?;
                        if i == 0 {
                            labels.insert((dimension as i64, tag), label);
                        }
                    }
                    let bounds = if dimension == 0 { 0 } else { entities.size()? };
                    (0..bounds).try_for_each(|_| entities.int().map(drop))?;
                }
            }
        }
        let [blocks, _, _, _] = [nodes.size()?, nodes.size()?, nodes.size()?, nodes.size()?];
        for _ in 0..blocks {
            let [dimension, _, parametric] = [nodes.int()?, nodes.int()?, nodes.int()?];
            let count = nodes.size()?;
            let numbers = (0..count).map(|_| nodes.size()).collect::<Read<Vec<_>>>()?;
            for number in numbers {
                let point = [nodes.real()?, nodes.real()?, nodes.real()?];
                (0..if parametric == 1 { dimension } else { 0 }).try_for_each(|_| nodes.real().map(drop))?;
                self.add_node(number, point)?;
            }
        }
        let [blocks, _, _, _] = [elements.size()?, elements.size()?, elements.size()?, elements.size()?];
        for _ in 0..blocks {
            let [dimension, tag, kind] = [elements.int()?, elements.int()?, elements.int()?];
            let Some(length) = [(POINT, 1), (LINE, 2), (TRIANGLE, 3), (TETRAHEDRON, 4)].iter().find(|k| k.0 == kind)
            else {
                return fail(format!("elements of type {kind} are not supported"));
            };
            let label = labels.get(&(dimension, tag)).copied().unwrap_or(0);
            for _ in 0..elements.size()? {
                elements.size()?;
                let nodes = (0..length.1).map(|_| elements.size()).collect::<Read<Vec<_>>>()?;
                self.add_element(kind, label, &nodes);
            }
        }
        Ok(self.mesh)
    }

    fn read_2(mut self, bytes: &[u8]) -> Read<Mesh> {
        let mut words = text(bytes, "Nodes")?.split_ascii_whitespace();
        for _ in 0..next::<usize>(&mut words).unwrap_or(0) {
            let (Some(number), Some(point)) = (next(&mut words), next_n(&mut words)) else {
                return fail("section $Nodes ends early or has a word that is not a number");
            };
            self.add_node(number, point)?;
        }
        let mut lines = text(bytes, "Elements")?.lines().skip(1);
        lines.try_for_each(|line| {
            let numbers: Option<Vec<i64>> = line.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
            let numbers = numbers.unwrap_or_default();
            let tags = numbers.get(2).map_or(0, |&n| usize::try_from(n).unwrap_or(usize::MAX));
            let nodes = tags.checked_add(3).and_then(|first| numbers.get(first..));
            let label = if tags > 0 { numbers.get(3).copied().unwrap_or(0) } else { 0 };
            match nodes {
                Some(nodes) if self.add_element(numbers[1], label, nodes) => Ok(()),
                _ => fail(format!("element '{line}' is damaged or not supported")),
            }
        })?;
        Ok(self.mesh)
    }
}

/// Numbers of a section of MSH 4.1.
struct Cursor<'a> {
    rest: &'a [u8],
    is_binary: bool,
}

impl Cursor<'_> {
    fn bytes<const N: usize>(&mut self) -> Read<[u8; N]> {
        let Some((first, rest)) = self.rest.split_first_chunk() else { return fail("a section ends early") };
        self.rest = rest;
        Ok(*first)
    }

    fn word<T: std::str::FromStr>(&mut self) -> Read<T> {
        let text = self.rest.trim_ascii_start();
        let length = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
        self.rest = &text[length..];
        let word = std::str::from_utf8(&text[..length]).ok().and_then(|word| word.parse().ok());
        word.map_or_else(|| fail("a section ends early or has a word that is not a number"), Ok)
    }

    fn int(&mut self) -> Read<i64> {
        if self.is_binary { Ok(i32::from_le_bytes(self.bytes()?).into()) } else { self.word() }
    }

    fn size(&mut self) -> Read<i64> {
        if self.is_binary { Ok(i64::from_le_bytes(self.bytes()?)) } else { self.word() }
    }

    fn real(&mut self) -> Read<f64> {
        if self.is_binary { Ok(f64::from_le_bytes(self.bytes()?)) } else { self.word() }
    }
}
