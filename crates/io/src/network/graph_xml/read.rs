//! Streaming reader of nodes, edges and their attributes.

use super::error::GraphXmlError;
use crate::network::columns::Value;
use crate::network::content::{NetworkFile, NetworkOptions};
use crate::network::graph::{Graph, GraphPlace};
use quick_xml::events::{BytesStart, Event};
use rustc_hash::FxHashMap;

/// Owner of the nested elements.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Owner {
    Node(u32),
    Edge(u32),
}

/// Parser state: open elements and the graph so far.
#[derive(Default)]
struct Reading {
    graph: Graph,
    /// Names of the open elements.
    open: Vec<String>,
    owner: Option<(usize, Owner)>,
    /// Open attribute: depth, name and text.
    value: Option<(usize, String, String)>,
    /// Names of GraphML keys.
    keys: FxHashMap<String, String>,
}

pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, GraphXmlError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|e| GraphXmlError::NotText { byte: e.valid_up_to() })?;
    let mut reader = quick_xml::Reader::from_str(text);
    let mut reading = Reading::default();
    loop {
        let event =
            reader.read_event().map_err(|source| GraphXmlError::Xml { byte: reader.error_position(), source })?;
        let byte = reader.buffer_position() as usize;
        match event {
            Event::Start(tag) => reading.start(&tag, byte)?,
            Event::Empty(tag) => {
                reading.start(&tag, byte)?;
                reading.end();
            }
            Event::End(_) => reading.end(),
            Event::Text(text) => reading.text(&text.into_inner()),
            Event::CData(text) => reading.text(&text.into_inner()),
            Event::Eof => break,
            _ => {}
        }
    }
    match reading.open.pop() {
        Some(element) => Err(GraphXmlError::CutShort { element: element.chars().take(40).collect() }),
        None => Ok(reading.graph.into_network(options)?),
    }
}

impl Reading {
    fn start(&mut self, tag: &BytesStart, byte: usize) -> Result<(), GraphXmlError> {
        let name = tag.local_name().into_inner().to_owned();
        if self.open.is_empty() && !matches!(name.as_str(), "graphml" | "gxl") {
            return Err(GraphXmlError::NotAGraph { root: name.chars().take(40).collect() });
        }
        let place = GraphPlace::Byte(byte);
        match name.as_str() {
            "key" => {
                let id = needed(tag, byte, "key", "id")?;
                let called = attribute(tag, byte, "attr.name")?.unwrap_or_else(|| id.clone());
                self.keys.insert(id, called);
            }
            "node" => {
                let row = self.graph.node(&needed(tag, byte, "node", "id")?, place)?;
                self.owner = Some((self.open.len(), Owner::Node(row)));
            }
            "edge" => {
                let [from, to] = [["source", "from"], ["target", "to"]].map(|names| either(tag, byte, names));
                let row = self.graph.edge([&from?, &to?], place)?;
                self.owner = Some((self.open.len(), Owner::Edge(row)));
            }
            "data" => {
                let key = needed(tag, byte, "data", "key")?;
                let called = self.keys.get(&key).cloned().unwrap_or(key);
                self.value = Some((self.open.len(), called, String::new()));
            }
            "attr" => self.value = Some((self.open.len(), needed(tag, byte, "attr", "name")?, String::new())),
            _ => {}
        }
        self.open.push(name);
        Ok(())
    }

    fn text(&mut self, text: &str) {
        if let Some((_, _, whole)) = &mut self.value {
            // List items are separate elements.
            whole.push(' ');
            whole.push_str(text.trim());
        }
    }

    fn end(&mut self) {
        self.open.pop();
        let depth = self.open.len();
        if let Some((_, name, text)) = self.value.take_if(|(at, ..)| *at == depth)
            && let Some((_, owner)) = self.owner
        {
            match owner {
                Owner::Node(row) => self.graph.nodes.set(row, &name, Value::of(&text)),
                Owner::Edge(row) => self.graph.edges.set(row, &name, Value::of(&text)),
            }
        }
        self.owner.take_if(|(at, _)| *at == depth);
    }
}

/// Trimmed attribute of a tag, if present.
fn attribute(tag: &BytesStart, byte: usize, name: &str) -> Result<Option<String>, GraphXmlError> {
    for attribute in tag.attributes().with_checks(false) {
        let attribute = attribute.map_err(|_| GraphXmlError::BadAttribute { byte })?;
        if attribute.key.into_inner() == name {
            let value = quick_xml::escape::unescape(&attribute.value);
            let value = value.map_err(|_| GraphXmlError::BadAttribute { byte })?;
            return Ok(Some(value.trim().to_owned()));
        }
    }
    Ok(None)
}

fn needed(tag: &BytesStart, byte: usize, element: &'static str, name: &'static str) -> Result<String, GraphXmlError> {
    attribute(tag, byte, name)?.ok_or(GraphXmlError::NoAttribute { byte, element, attribute: name })
}

/// Attribute of an edge under its GraphML name, else under its GXL name.
fn either(tag: &BytesStart, byte: usize, [graphml, gxl]: [&'static str; 2]) -> Result<String, GraphXmlError> {
    match attribute(tag, byte, graphml)? {
        Some(value) => Ok(value),
        None => needed(tag, byte, "edge", gxl),
    }
}
