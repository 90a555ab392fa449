//! Default resolution of vessel meshes.

/// Resolution ρ: voxels across the thinnest vessel of a cluster.
pub const RHO: f64 = 3.0;

/// Width κ of the convolution kernel, σ = κ r. Wide enough for smooth walls at forks, narrow enough for short crotches.
/// Parallel vessels stay apart from 1.07 sums of their radii on.
pub const KAPPA: f64 = 0.33;

/// Exponent of the growth of edges with the radius of wider vessels; 1 is proportional.
pub const FOLLOW: f64 = 1.0;

/// Maximum growth of the target edge length per unit of distance: edges that share a vertex differ by a fifth.
pub const GROWTH: f64 = 0.25;
