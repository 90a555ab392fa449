//! Functions shared by readers of XML files.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::borrow::Cow;

/// Why bytes are no XML.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum XmlFault {
    /// The bytes are not UTF-8 text.
    #[error("not XML: byte {byte} is not text; is it a {expected}?")]
    NotText {
        /// Position of the first byte that is not text.
        byte: usize,
        /// The kind of file that was expected.
        expected: &'static str,
    },
    /// The XML parser gave up.
    #[error("invalid XML at byte {byte}: {source}; correct the file, or copy it again if it is truncated")]
    Syntax {
        /// Position in the file.
        byte: u64,
        /// The parser's error.
        source: quick_xml::Error,
    },
    /// A tag's attributes cannot be read.
    #[error("invalid attributes of the tag before byte {byte}: write them as name=\"value\"")]
    BadAttribute {
        /// Position behind the tag.
        byte: u64,
    },
}

/// Takes bytes as text.
pub(crate) fn text<'a>(bytes: &'a [u8], expected: &'static str) -> Result<&'a str, XmlFault> {
    std::str::from_utf8(bytes).map_err(|e| XmlFault::NotText { byte: e.valid_up_to(), expected })
}

/// Reads the next tag or text.
pub(crate) fn next_event<'a>(reader: &mut Reader<&'a [u8]>) -> Result<Event<'a>, XmlFault> {
    reader.read_event().map_err(|source| XmlFault::Syntax { byte: reader.error_position(), source })
}

/// Names and values of the attributes of a tag that ends before a byte.
pub(crate) fn attributes<'a>(
    tag: &'a BytesStart,
    byte: u64,
) -> impl Iterator<Item = Result<(Cow<'a, str>, Cow<'a, str>), XmlFault>> {
    let mut attributes = tag.attributes();
    attributes.with_checks(false);
    attributes.map(move |attribute| {
        let attribute = attribute.map_err(|_| XmlFault::BadAttribute { byte })?;
        let value = quick_xml::escape::unescape(&attribute.value).map_err(|_| XmlFault::BadAttribute { byte })?;
        Ok((attribute.key.into_inner().to_owned().into(), value.into_owned().into()))
    })
}
