//! Reports of the commands, as text, tables and plots; models with a text and a JSON form.

#[cfg(feature = "cli")]
pub mod advice;
#[cfg(feature = "cli")]
pub mod caps;
pub mod fidelity;
pub mod info;
pub mod inlets;
pub mod mesh;
#[cfg(feature = "cli")]
pub mod page;
#[cfg(feature = "cli")]
pub mod plot;
#[cfg(feature = "cli")]
pub mod prepare;
pub mod refine;
#[cfg(feature = "cli")]
pub mod rows;
#[cfg(feature = "cli")]
pub mod summary;
#[cfg(feature = "cli")]
pub mod tetrahedralize;
