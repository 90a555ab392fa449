//! Options of layers along a wall.

/// Options of layers of thin tetrahedra along a wall.
///
/// ```
/// use anastomesh_tet::Layers;
///
/// let layers = Layers::default().count(3).growth(2.0).thickness(0.35);
/// assert_eq!(layers.depths(), [1.0 / 7.0, 3.0 / 7.0, 1.0]);
/// assert!(layers.growth(0.0).check().is_err());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Layers {
    /// Number of layers.
    pub count: u32,
    /// Ratio of the thickness of each layer to that of the previous one, from the wall inwards.
    pub growth: f64,
    /// Total thickness of all layers, as a fraction of the vessel radius. For other surfaces, of the local half width.
    pub thickness: f64,
}

anastomesh_mesh::setters!(Layers { count: u32, growth: f64, thickness: f64 });

/// Invalid parameters of layers.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayersError {
    /// The number of layers is out of range.
    #[error("invalid number of layers {0}: give 1 to {most}", most = Layers::MOST)]
    Count(u32),
    /// The growth is out of range.
    #[error("layer growth {0} is out of range: give {least} to {most}", least = Layers::GROWTH[0], most = Layers::GROWTH[1])]
    Growth(f64),
    /// The total thickness is zero, or too large for the vessel.
    #[error(
        "total layer thickness {0} (fraction of the radius) is out of range: give {least} to {most}",
        least = Layers::THICKNESS[0], most = Layers::THICKNESS[1]
    )]
    Thickness(f64),
    /// The thinnest of them is too thin.
    #[error(
        "number of layers {count}: the thinnest would have {thinnest:.1e} of the radius, at least {} is required: give fewer or thicker layers, \
         or a growth closer to 1",
        Layers::THINNEST
    )]
    Thin {
        /// Number of layers.
        count: u32,
        /// The thinnest, as a share of the radius.
        thinnest: f64,
    },
}

impl Default for Layers {
    /// Three, so thin at the wall that wall shear comes out within some percents with linear elements.
    fn default() -> Self {
        Self { count: 3, growth: 2.5, thickness: 0.12 }
    }
}

impl Layers {
    /// Maximum number of layers.
    pub const MOST: u32 = 30;
    /// Limits of the growth.
    pub const GROWTH: [f64; 2] = [0.2, 5.0];
    /// Limits of the thickness.
    pub const THICKNESS: [f64; 2] = [1e-3, 0.8];
    /// The thinnest layer, as a share of the radius.
    pub const THINNEST: f64 = 1e-4;

    /// Depth of each layer from the wall, as a share of the total thickness.
    pub fn depths(&self) -> Vec<f64> {
        let sizes = (0..self.count as i32).map(|i| self.growth.powi(i));
        let all: f64 = sizes.clone().sum();
        let mut depths: Vec<f64> =
            sizes.scan(0.0, |sum, size| Some(std::mem::replace(sum, *sum + size) + size)).collect();
        for depth in &mut depths {
            *depth /= all;
        }
        // The last one is the whole, whatever rounding makes of the sum.
        depths.pop();
        depths.push(1.0);
        depths
    }

    /// Checks the ranges of the options.
    ///
    /// # Errors
    /// The first thing that is out of its limits, with these.
    pub fn check(&self) -> Result<(), LayersError> {
        let within = |[least, most]: [f64; 2], x: f64| (least..=most).contains(&x);
        if !(1..=Self::MOST).contains(&self.count) {
            return Err(LayersError::Count(self.count));
        }
        if !within(Self::GROWTH, self.growth) {
            return Err(LayersError::Growth(self.growth));
        }
        if !within(Self::THICKNESS, self.thickness) {
            return Err(LayersError::Thickness(self.thickness));
        }
        let depths = self.depths();
        let steps = depths.iter().scan(0.0, |before, &depth| Some(depth - std::mem::replace(before, depth)));
        let thinnest = self.thickness * steps.fold(f64::INFINITY, f64::min);
        if thinnest < Self::THINNEST {
            return Err(LayersError::Thin { count: self.count, thinnest });
        }
        Ok(())
    }
}
