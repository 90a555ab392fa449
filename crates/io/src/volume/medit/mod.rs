//! Medit text format `.mesh`: lists of vertices, triangles and tetrahedra, each with references. In a mesh with regions,
//! comments after the dimension name the references: `# region 1 lumen`, `# patch 3 outlet_0`.

mod error;
mod names;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::MeditFault;
pub(super) use read::read;
pub(super) use write::write;
