//! Floor 3: the tetrahedralizer. A closed surface goes in, a tetrahedral mesh that keeps every triangle of it comes out.
//! Knows nothing of vessels.

pub mod complex;
pub mod flips;
pub mod optimize;
pub mod star;

pub use complex::Complex;
