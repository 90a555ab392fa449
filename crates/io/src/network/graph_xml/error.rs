//! Errors of XML graphs.

use crate::network::graph::GraphFault;

/// Errors of a GraphML or GXL file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GraphXmlError {
    /// The bytes are not text.
    #[error("no XML: byte {byte} is not text; is it a graph (.graphml, .gxl)?")]
    NotText {
        /// Byte offset.
        byte: usize,
    },
    /// The XML parser failed.
    #[error("no well-formed XML at byte {byte}: {source}; correct the file, or copy it again if it was cut short")]
    Xml {
        /// Byte offset.
        byte: u64,
        /// Error of the parser.
        source: quick_xml::Error,
    },
    /// The attributes of a tag are malformed.
    #[error("byte {byte}: the attributes of the tag before it cannot be read: write them as name=\"value\"")]
    BadAttribute {
        /// Byte offset.
        byte: usize,
    },
    /// The root element is not a graph.
    #[error("the outermost XML element is <{root}>, not <graphml> or <gxl>: give the file the extension of its format")]
    NotAGraph {
        /// Name of the root element.
        root: String,
    },
    /// An element lacks an attribute.
    #[error("byte {byte}: <{element}> has no attribute '{attribute}': complete it")]
    NoAttribute {
        /// Byte offset.
        byte: usize,
        element: &'static str,
        attribute: &'static str,
    },
    /// The file ends inside an element.
    #[error("the file ends inside <{element}>: it was not written or copied completely; write or copy it again")]
    CutShort {
        /// Innermost open element.
        element: String,
    },
    /// The graph is not a valid network.
    #[error(transparent)]
    Graph(#[from] GraphFault),
}
