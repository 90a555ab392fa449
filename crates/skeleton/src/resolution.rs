//! How finely vessels are meshed unless something else is asked for.

/// Resolution ρ: voxels across the thinnest vessel of a cluster.
pub const RHO: f64 = 3.0;

/// Width κ of the convolution kernel, σ = κ r: wide enough that walls blend smoothly at forks, narrow enough that crotches
/// take little of the lengths of vessels, and that parallel vessels stay apart from 1.07 sums of their radii on.
pub const KAPPA: f64 = 0.33;

/// How far edges follow the radius of wider vessels: they grow with it to this power. 1: in proportion.
pub const FOLLOW: f64 = 1.0;
