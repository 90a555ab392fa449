//! What can be wrong with a graph in XML.

use crate::network::graph::GraphFault;

/// Why a GraphML or GXL file is no usable network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GraphXmlError {
    /// The bytes are not text.
    #[error("no XML: byte {byte} is not text; is it a graph (.graphml, .gxl)?")]
    NotText {
        /// Where.
        byte: usize,
    },
    /// The XML parser gave up.
    #[error("no well-formed XML at byte {byte}: {source}; correct the file, or copy it again if it was cut short")]
    Xml {
        /// Where.
        byte: u64,
        /// Why.
        source: quick_xml::Error,
    },
    /// A tag's attributes cannot be read.
    #[error("byte {byte}: the attributes of the tag before it cannot be read: write them as name=\"value\"")]
    BadAttribute {
        /// Where.
        byte: usize,
    },
    /// The outermost element is none of a graph.
    #[error("the outermost XML element is <{root}>, not <graphml> or <gxl>: give the file the extension of its format")]
    NotAGraph {
        /// The outermost element.
        root: String,
    },
    /// An element lacks an attribute.
    #[error("byte {byte}: <{element}> has no attribute '{attribute}': complete it")]
    NoAttribute {
        /// Where.
        byte: usize,

        /// Element.
        element: &'static str,

        /// Attribute.
        attribute: &'static str,
    },
    /// The file ends inside an element.
    #[error("the file ends inside <{element}>: it was not written or copied completely; write or copy it again")]
    CutShort {
        /// The innermost element that is open.
        element: String,
    },
    /// The graph is no network.
    #[error(transparent)]
    Graph(#[from] GraphFault),
}
