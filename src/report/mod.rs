//! Reports of the commands, as text, tables and plots; models with a text and a JSON form.

pub mod advice;
pub mod caps;
pub mod embed;
pub mod fidelity;
pub mod flow;
pub mod info;
pub mod inlets;
pub mod page;
pub mod plot;
pub mod prepare;
pub mod refine;
pub mod rows;
pub mod second_order;
pub mod summary;
pub mod tetrahedralize;
pub mod verdict;
