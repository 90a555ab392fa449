//! Boundary layer options, shared by commands that make volume meshes.

use super::exit::Failure;
use super::numbers::number;
use anastomesh_tet::Layers;

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Layers")]
pub struct LayerArgs {
    /// Number of boundary layers: thin tetrahedra along the wall
    #[arg(long, value_name = "N")]
    pub layers: Option<u32>,
    /// Ratio of the thickness of each layer to that of the previous one, from the wall inwards
    #[arg(long, value_name = "G", default_value_t = Layers::default().growth, value_parser = number, requires = "layers", allow_negative_numbers = true)]
    pub layer_growth: f64,
    /// Total thickness of all layers as a fraction of the vessel radius; for other surfaces, of the local half width
    #[arg(long, value_name = "T", default_value_t = Layers::default().thickness, value_parser = number, requires = "layers", allow_negative_numbers = true)]
    pub layer_thickness: f64,
}

impl LayerArgs {
    /// Options as command-line text.
    pub fn typed(&self) -> String {
        let with = |n| {
            format!(" --layers {n} --layer-growth {} --layer-thickness {}", self.layer_growth, self.layer_thickness)
        };
        self.layers.map_or_else(String::new, with)
    }

    /// Requested layers.
    pub fn asked(&self) -> Result<Option<Layers>, Failure> {
        let Some(count) = self.layers else { return Ok(None) };
        let layers = Layers::default().count(count).growth(self.layer_growth).thickness(self.layer_thickness);
        layers.check().map_err(|e| Failure::usage(e.to_string()))?;
        Ok(Some(layers))
    }
}
