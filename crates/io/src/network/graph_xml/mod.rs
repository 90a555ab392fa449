//! XML graph formats: GraphML, and GXL as written by OpenCCO.

mod error;
mod read;

pub use error::GraphXmlError;
pub(super) use read::read;
