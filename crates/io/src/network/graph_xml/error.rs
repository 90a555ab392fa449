//! Errors of XML graphs.

use crate::network::graph::GraphFault;
use crate::xml::XmlFault;

/// Errors of a GraphML or GXL file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GraphXmlError {
    /// The file is no XML.
    #[error(transparent)]
    Xml(#[from] XmlFault),
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

        /// Element.
        element: &'static str,

        /// Attribute.
        attribute: &'static str,
    },
    /// The file ends inside an element.
    #[error("the file ends inside <{element}>: it is truncated; copy it again")]
    CutShort {
        /// Innermost open element.
        element: String,
    },
    /// The graph is not a valid network.
    #[error(transparent)]
    Graph(#[from] GraphFault),
}
