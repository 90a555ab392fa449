//! Graphs in XML: GraphML, and GXL as OpenCCO writes it.

mod error;
mod read;

pub use error::GraphXmlError;
pub(super) use read::read;
