//! Bounds on the size and shape of tetrahedra.

/// Dihedral angle of the regular tetrahedron in degrees, acos(1/3). No tetrahedron has a larger minimum, so bounds on
/// the minimum must be below.
pub const REGULAR_DIHEDRAL: f64 = 70.528_779_365_509_31;

/// Bounds for all tetrahedra of a mesh; `None` is no bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Bounds {
    /// Maximum circumradius over shortest edge.
    pub max_radius_edge: Option<f64>,
    /// Minimum dihedral angle, in degrees, below `REGULAR_DIHEDRAL`.
    pub min_dihedral: Option<f64>,
    /// Maximum volume.
    pub max_volume: Option<f64>,
}

/// One of the [`Bounds`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Bound {
    /// `max_radius_edge`.
    MaxRadiusEdge,
    /// `min_dihedral`.
    MinDihedral,
    /// `max_volume`.
    MaxVolume,
}

impl std::fmt::Display for Bound {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::MaxRadiusEdge => "max_radius_edge",
            Self::MinDihedral => "min_dihedral",
            Self::MaxVolume => "max_volume",
        })
    }
}

impl Bounds {
    /// Name and value of the first bound that no mesh can meet.
    pub fn senseless(&self) -> Option<(Bound, f64)> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let angle = |x: f64| (0.0..REGULAR_DIHEDRAL).contains(&x);
        let wrong = |name, bound: Option<f64>, good: &dyn Fn(f64) -> bool| Some((name, bound.filter(|&b| !good(b))?));
        wrong(Bound::MaxRadiusEdge, self.max_radius_edge, &positive)
            .or_else(|| wrong(Bound::MaxVolume, self.max_volume, &positive))
            .or_else(|| wrong(Bound::MinDihedral, self.min_dihedral, &angle))
    }
}
