//! Element tree of a VTK XML file.
//!
//! Binary data after `<AppendedData encoding="raw">` is not XML and is separated before parsing.

use super::error::VtkError;
use quick_xml::events::{BytesStart, Event};
use std::borrow::Cow;

/// Maximum nesting depth; VTK's own files have 5 levels.
const DEEPEST: usize = 64;

/// Index of an element in its document.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ElementId(usize);

#[derive(Debug, Default)]
struct Element<'a> {
    name: String,
    attributes: Vec<(String, String)>,
    text: Cow<'a, str>,
    children: Vec<ElementId>,
}

/// Binary data layout of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub big_endian: bool,
    /// True if lengths have 8 bytes instead of 4.
    pub wide_header: bool,
    pub zlib: bool,
}

/// Data at the end of the file, to which arrays refer by offsets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Appended<'a> {
    pub bytes: &'a [u8],
    /// Start in the file.
    start: usize,
    pub base64: bool,
}

/// A parsed VTK XML file that borrows the file's bytes.
#[derive(Debug)]
pub struct VtkXml<'a> {
    elements: Vec<Element<'a>>,
    layout: Layout,
    appended: Option<Appended<'a>>,
}

impl<'a> VtkXml<'a> {
    /// Root element `VTKFile`.
    pub const ROOT: ElementId = ElementId(0);

    /// Parses a file of the given type (`PolyData`, `UnstructuredGrid`).
    ///
    /// # Errors
    /// The bytes are not such a file, or are truncated.
    pub fn parse(bytes: &'a [u8], file_type: &'static str) -> Result<Self, VtkError> {
        let (head, tail) = split_appended(bytes);
        let head = std::str::from_utf8(head).map_err(|e| VtkError::NotText { byte: e.valid_up_to() })?;
        let elements = parse_elements(head, tail.is_some())?;
        let mut document =
            Self { elements, layout: Layout { big_endian: false, wide_header: false, zlib: false }, appended: None };
        document.check_root(file_type)?;
        document.layout = document.read_layout()?;
        if let Some(tail) = tail {
            document.appended = Some(parse_appended(tail, head.len())?);
        }
        Ok(document)
    }

    /// Checks the root element and the file type.
    fn check_root(&self, file_type: &'static str) -> Result<(), VtkError> {
        let Some(root) = self.elements.first() else {
            return Err(VtkError::Empty);
        };
        if root.name != "VTKFile" {
            return Err(VtkError::NotVtk { root: root.name.clone() });
        }
        match self.attribute(Self::ROOT, "type") {
            Some(found) if found == file_type => Ok(()),
            found => Err(VtkError::WrongFileType { found: found.unwrap_or_default().to_owned(), wanted: file_type }),
        }
    }

    fn read_layout(&self) -> Result<Layout, VtkError> {
        let value = |name: &'static str| self.attribute(Self::ROOT, name).unwrap_or_default();
        let unknown =
            |attribute: &'static str| VtkError::UnknownLayout { attribute, value: value(attribute).to_owned() };
        Ok(Layout {
            big_endian: match value("byte_order") {
                "" | "LittleEndian" => false,
                "BigEndian" => true,
                _ => return Err(unknown("byte_order")),
            },
            wide_header: match value("header_type") {
                "" | "UInt32" => false,
                "UInt64" => true,
                _ => return Err(unknown("header_type")),
            },
            zlib: match value("compressor") {
                "" => false,
                "vtkZLibDataCompressor" => true,
                _ => return Err(unknown("compressor")),
            },
        })
    }

    /// Start of the appended data and its zlib flag. `None` unless it is raw and little-endian with 8-byte lengths,
    /// which permits blockwise reads.
    pub fn packed_data(&self) -> Option<(usize, bool)> {
        let Layout { big_endian, wide_header, zlib } = self.layout;
        let appended = self.appended.filter(|appended| !appended.base64 && !big_endian && wide_header);
        appended.map(|appended| (appended.start, zlib))
    }

    /// Name of an element.
    pub fn name(&self, element: ElementId) -> &str {
        &self.elements[element.0].name
    }

    /// Value of an attribute.
    pub fn attribute(&self, element: ElementId, name: &str) -> Option<&str> {
        let attributes = &self.elements[element.0].attributes;
        attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// Count in an attribute; 0 if it is missing.
    ///
    /// # Errors
    /// The value is not a count.
    pub fn count(&self, element: ElementId, name: &'static str) -> Result<usize, VtkError> {
        match self.attribute(element, name) {
            None => Ok(0),
            Some(text) => text
                .trim()
                .parse()
                .map_err(|_| VtkError::BadCount { attribute: name, value: text.chars().take(40).collect() }),
        }
    }

    /// Children of an element with this name.
    pub fn children(&self, element: ElementId, name: &str) -> impl Iterator<Item = ElementId> {
        self.elements[element.0].children.iter().copied().filter(move |&c| self.name(c) == name)
    }

    /// First child of an element with this name.
    pub fn child(&self, element: ElementId, name: &str) -> Option<ElementId> {
        self.children(element, name).next()
    }

    /// `DataArray` children of an element, with their names; empty if unnamed.
    pub fn arrays(&self, element: ElementId) -> impl Iterator<Item = (&str, ElementId)> {
        self.children(element, "DataArray")
            .chain(self.children(element, "Array"))
            .map(|c| (self.attribute(c, "Name").unwrap_or_default(), c))
    }

    pub(super) fn text(&self, element: ElementId) -> &str {
        &self.elements[element.0].text
    }

    /// Binary data layout.
    pub(super) fn layout(&self) -> Layout {
        self.layout
    }

    /// Appended data at the end of the file.
    pub(super) fn appended(&self) -> Option<Appended<'a>> {
        self.appended
    }
}

/// Splits the file at `<AppendedData`, if present.
fn split_appended(bytes: &[u8]) -> (&[u8], Option<&[u8]>) {
    const TAG: &[u8] = b"<AppendedData";
    match bytes.windows(TAG.len()).position(|w| w == TAG) {
        Some(at) => (&bytes[..at], Some(&bytes[at..])),
        None => (bytes, None),
    }
}

/// Parses appended data. `tail` starts with `<AppendedData` at byte `at` of the file; the data follow an underscore.
fn parse_appended(tail: &[u8], at: usize) -> Result<Appended<'_>, VtkError> {
    let end = tail.iter().position(|&b| b == b'>').ok_or(VtkError::CutShort)?;
    let tag = std::str::from_utf8(&tail[..end]).map_err(|_| VtkError::BadAppendedData)?;
    let base64 = tag.contains("base64");
    if !base64 && !tag.contains("raw") {
        return Err(VtkError::BadAppendedData);
    }
    let after = tail[end + 1..].trim_ascii_start();
    match after.first() {
        Some(b'_') => Ok(Appended { bytes: &after[1..], start: at + tail.len() - after.len() + 1, base64 }),
        // A missing underscore is legal if no array refers to the data.
        _ => Ok(Appended { bytes: &[], start: at + tail.len(), base64 }),
    }
}

/// Builds the tree. With `open_end`, the text ends inside elements because the rest was separated.
fn parse_elements(text: &str, open_end: bool) -> Result<Vec<Element<'_>>, VtkError> {
    let mut reader = quick_xml::Reader::from_str(text);
    let mut elements: Vec<Element> = Vec::new();
    let mut open: Vec<ElementId> = Vec::new();
    loop {
        let event = reader.read_event().map_err(|source| VtkError::Xml { byte: reader.error_position(), source })?;
        match event {
            Event::Start(tag) => {
                let id = add_element(&mut elements, &open, reader.buffer_position(), &tag)?;
                open.push(id);
            }
            Event::Empty(tag) => {
                add_element(&mut elements, &open, reader.buffer_position(), &tag)?;
            }
            Event::End(_) => {
                open.pop();
            }
            Event::Text(content) => {
                if let Some(top) = open.last() {
                    append_text(&mut elements[top.0].text, content.into_inner());
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    if open.is_empty() || open_end { Ok(elements) } else { Err(VtkError::CutShort) }
}

fn append_text<'a>(text: &mut Cow<'a, str>, more: Cow<'a, str>) {
    if text.trim_ascii().is_empty() {
        *text = more;
    } else {
        text.to_mut().push_str(&more);
    }
}

fn add_element(
    elements: &mut Vec<Element>,
    open: &[ElementId],
    byte: u64,
    tag: &BytesStart,
) -> Result<ElementId, VtkError> {
    let id = ElementId(elements.len());
    if open.len() >= DEEPEST {
        return Err(VtkError::TooDeep);
    }
    let mut element = Element { name: tag.name().into_inner().to_owned(), ..Element::default() };
    for attribute in tag.attributes().with_checks(false) {
        let attribute = attribute.map_err(|_| VtkError::BadAttribute { byte })?;
        let value = quick_xml::escape::unescape(&attribute.value).map_err(|_| VtkError::BadAttribute { byte })?;
        element.attributes.push((attribute.key.into_inner().to_owned(), value.into_owned()));
    }
    elements.push(element);
    if let Some(parent) = open.last() {
        elements[parent.0].children.push(id);
    }
    Ok(id)
}
