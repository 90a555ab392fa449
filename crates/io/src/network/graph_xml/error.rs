//! What can be wrong with a graph in XML.

use crate::network::graph::GraphFault;
use crate::xml::XmlFault;

/// Why a GraphML or GXL file is no usable network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GraphXmlError {
    /// The file is no XML.
    #[error(transparent)]
    Xml(#[from] XmlFault),
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
        element: &'static str,
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
