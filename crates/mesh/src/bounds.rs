//! Bounds on the size and shape of tetrahedra: what can be asked of a mesh.

/// The dihedral angle of the regular tetrahedron in degrees, acos(1/3): no tetrahedron's smallest is larger, so that bounds on
/// the smallest have to be below.
pub const REGULAR_DIHEDRAL: f64 = 70.528_779_365_509_31;

/// Bounds that all tetrahedra of a mesh are to keep; those that are none hold nothing back.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Bounds {
    /// Bound on the circumradius over the shortest edge.
    pub max_radius_edge: Option<f64>,
    /// Bound on the smallest dihedral angle, in degrees, below `REGULAR_DIHEDRAL`.
    pub min_dihedral: Option<f64>,
    /// Bound on the volume.
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
    /// Returns the first bound that no mesh satisfies, and its value.
    pub fn senseless(&self) -> Option<(Bound, f64)> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let angle = |x: f64| (0.0..REGULAR_DIHEDRAL).contains(&x);
        let wrong = |name, bound: Option<f64>, good: &dyn Fn(f64) -> bool| Some((name, bound.filter(|&b| !good(b))?));
        wrong(Bound::MaxRadiusEdge, self.max_radius_edge, &positive)
            .or_else(|| wrong(Bound::MaxVolume, self.max_volume, &positive))
            .or_else(|| wrong(Bound::MinDihedral, self.min_dihedral, &angle))
    }
}
