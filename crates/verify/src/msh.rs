//! Reader of Gmsh's MSH files: 4.1 in text or binary, 2.2 in text.

use crate::mesh::{Cap, Mesh, index};
use crate::numbers::{DOUBLE, INT, LONG, Numbers, Order};
use anyhow::{Context as _, Result, bail, ensure};
use bstr::ByteSlice as _;
use serde_json::Value;
use std::collections::HashMap;

const LINE: i64 = 1;
const TRIANGLE: i64 = 2;
const TETRAHEDRON: i64 = 4;
const POINT: i64 = 15;
/// Number of nodes of each kind of element.
const LENGTHS: [(i64, i64); 4] = [(POINT, 1), (LINE, 2), (TRIANGLE, 3), (TETRAHEDRON, 4)];

/// Reads a mesh.
pub fn read(bytes: &[u8]) -> Result<Mesh> {
    let head = section(bytes, "MeshFormat").context("no section $MeshFormat")?;
    let head = head.lines().next().unwrap_or_default().to_str_lossy();
    let mut words = head.split_ascii_whitespace();
    let (version, is_binary) = (words.next().unwrap_or_default(), words.next() == Some("1"));
    let mut parts = Parts::default();
    names(bytes, &mut parts.mesh)?;
    notes(bytes, &mut parts)?;
    let order = if is_binary { Order::Little } else { Order::Text };
    match version {
        "4.1" => {
            let groups = numbers(bytes, "Entities", order, groups)?;
            numbers(bytes, "Nodes", order, |nodes| parts.add_nodes_4(nodes))?;
            numbers(bytes, "Elements", order, |elements| parts.add_elements_4(elements, &groups))?;
        }
        "2.2" if !is_binary => {
            numbers(bytes, "Nodes", order, |nodes| parts.add_nodes_2(nodes))?;
            parts.add_elements_2(text(bytes, "Elements")?)?;
        }
        other => bail!("MSH {other}{} is not supported", if is_binary { " binary" } else { "" }),
    }
    Ok(parts.mesh)
}

/// Bytes of a section, without the line of its name.
fn section<'a>(bytes: &'a [u8], name: &str) -> Option<&'a [u8]> {
    let (_, rest) = bytes.split_once_str(&format!("${name}"))?;
    let (_, rest) = rest.split_once_str("\n")?;
    rest.split_once_str(&format!("$End{name}")).map(|(body, _)| body)
}

fn text<'a>(bytes: &'a [u8], name: &str) -> Result<&'a str> {
    let body = section(bytes, name).unwrap_or_default();
    body.to_str().ok().with_context(|| format!("section ${name} is not UTF-8"))
}

/// Result of a reader of numbers for a section, which may be missing.
fn numbers<T>(bytes: &[u8], name: &str, order: Order, read: impl FnOnce(Numbers) -> Result<T>) -> Result<T> {
    let numbers = Numbers { rest: section(bytes, name).unwrap_or_default(), order };
    read(numbers).with_context(|| format!("section ${name}"))
}

fn names(bytes: &[u8], mesh: &mut Mesh) -> Result<()> {
    for line in text(bytes, "PhysicalNames")?.lines().skip(1) {
        let mut numbers = Numbers::text(line);
        let head = numbers.array::<i64, 2>(LONG).ok();
        let [dimension, id] = head.with_context(|| format!("bad line '{line}' of $PhysicalNames"))?;
        if dimension == 2 {
            let name = numbers.rest.to_str_lossy();
            mesh.patches.push((id, name.trim().trim_matches('"').to_owned()));
        }
    }
    Ok(())
}

/// Section of `anastomesh` with the expectation and the caps.
fn notes(bytes: &[u8], Parts { mesh, regions, .. }: &mut Parts) -> Result<()> {
    let json = text(bytes, "Anastomesh")?;
    if json.trim().is_empty() {
        return Ok(());
    }
    let notes: Value = serde_json::from_str(json).ok().context("section $Anastomesh is not JSON")?;
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
    fn add_node(&mut self, number: i64, point: [f64; 3]) -> Result<()> {
        let known = self.numbers.insert(number, index(self.mesh.points.len() as i64));
        ensure!(known.is_none(), "node {number} is listed twice");
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

    fn add_nodes_4(&mut self, mut nodes: Numbers) -> Result<()> {
        let [blocks, ..] = nodes.array::<i64, 4>(LONG)?;
        for _ in 0..blocks {
            let [dimension, _, parametric] = nodes.array::<i64, 3>(INT)?;
            let count = nodes.next(LONG)?;
            for number in nodes.list(LONG, count)? {
                let point = nodes.array(DOUBLE)?;
                nodes.list::<f64>(DOUBLE, if parametric == 1 { dimension } else { 0 })?;
                self.add_node(number, point)?;
            }
        }
        Ok(())
    }

    fn add_elements_4(&mut self, mut elements: Numbers, groups: &HashMap<(i64, i64), i64>) -> Result<()> {
        let [blocks, ..] = elements.array::<i64, 4>(LONG)?;
        for _ in 0..blocks {
            let [dimension, tag, kind] = elements.array(INT)?;
            let length = LENGTHS.iter().find(|(known, _)| *known == kind);
            let (_, length) = length.with_context(|| format!("elements of type {kind} are not supported"))?;
            let label = groups.get(&(dimension, tag)).copied().unwrap_or(0);
            for _ in 0..elements.next(LONG)? {
                let numbers = elements.list(LONG, 1 + length)?;
                self.add_element(kind, label, &numbers[1..]);
            }
        }
        Ok(())
    }

    fn add_nodes_2(&mut self, mut nodes: Numbers) -> Result<()> {
        for _ in 0..nodes.next(LONG)? {
            let (number, point) = (nodes.next(LONG)?, nodes.array(DOUBLE)?);
            self.add_node(number, point)?;
        }
        Ok(())
    }

    fn add_elements_2(&mut self, elements: &str) -> Result<()> {
        for line in elements.lines().skip(1) {
            let numbers: Option<Vec<i64>> = line.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
            // Number, kind, number of tags, tags and nodes. The first tag is the physical group.
            let is_added = match numbers.as_deref() {
                Some(&[_, kind, tags, ref rest @ ..]) => usize::try_from(tags)
                    .ok()
                    .and_then(|tags| rest.split_at_checked(tags))
                    .is_some_and(|(tags, nodes)| self.add_element(kind, tags.first().copied().unwrap_or(0), nodes)),
                _ => false,
            };
            ensure!(is_added, "element '{line}' is damaged or not supported");
        }
        Ok(())
    }
}

/// Physical group of each entity by its dimension and tag.
fn groups(mut entities: Numbers) -> Result<HashMap<(i64, i64), i64>> {
    let mut groups = HashMap::new();
    if entities.rest.is_empty() {
        return Ok(groups);
    }
    for (dimension, count) in (0..).zip(entities.array::<i64, 4>(LONG)?) {
        for _ in 0..count {
            let tag = entities.next(INT)?;
            entities.list::<f64>(DOUBLE, if dimension == 0 { 3 } else { 6 })?;
            let count = entities.next(LONG)?;
            groups.extend(entities.list(INT, count)?.first().map(|&group| ((dimension, tag), group)));
            let bounds = if dimension == 0 { 0 } else { entities.next(LONG)? };
            entities.list::<i64>(INT, bounds)?;
        }
    }
    Ok(groups)
}
