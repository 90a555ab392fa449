//! Parts of the tetrahedralizer that the vascular mesher assembles itself. Not covered by semantic versioning.

pub use crate::builder::{fill_around, fill_outward, fill_spaced, remesh_closed};
pub use crate::complex::Complex;
pub use crate::corner_tets::split_corner_tets;
pub use crate::delaunay::delaunay;
pub use crate::layers::{Directions, Inset, Numbers, Places, inset, is_open, openness, rims, toward};
pub use crate::names::Names;
pub use crate::optimize::{OptimizeOptions, optimize};
pub use crate::pieces::{Piece, Pieces, fill_in_pieces};
pub use crate::progress::{Counter, Watch};
pub use crate::shells::Prisms;
pub use crate::sized::ensure_countable;
