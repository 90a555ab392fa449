//! Layers along walls: arguments of every verb that makes them.

use super::exit::Failure;
use anastomesh_tet::Layers;

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Layers")]
pub struct LayerArgs {
    /// Layers of thin tetrahedra along the wall, where wall shear and what is carried change fast
    #[arg(long, value_name = "N")]
    pub layers: Option<u32>,
    /// How much thicker each layer is than the one before it, from the wall on
    #[arg(long, value_name = "G", default_value_t = Layers::default().growth, requires = "layers", allow_negative_numbers = true)]
    pub layer_growth: f64,
    /// Thickness of all layers together, as a share of the radius (of surfaces that are no vessels: of half the way across)
    #[arg(long, value_name = "T", default_value_t = Layers::default().thickness, requires = "layers", allow_negative_numbers = true)]
    pub layer_thickness: f64,
}

impl LayerArgs {
    /// What is asked for, as it is typed.
    pub fn typed(&self) -> String {
        let with = |n| {
            format!(" --layers {n} --layer-growth {} --layer-thickness {}", self.layer_growth, self.layer_thickness)
        };
        self.layers.map_or_else(String::new, with)
    }

    /// What is asked for.
    pub fn asked(&self) -> Result<Option<Layers>, Failure> {
        let Some(count) = self.layers else { return Ok(None) };
        let layers = Layers::default().count(count).growth(self.layer_growth).thickness(self.layer_thickness);
        layers.check().map_err(|e| Failure::usage(e.to_string()))?;
        Ok(Some(layers))
    }
}
