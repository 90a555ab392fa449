//! Legends of pictures: colour bars and swatches.

use super::escape::escaped;
use super::figures::{LengthUnit, figure};
use crate::picture::{Legend as Scale, PATCH_COLOURS, Rgb, of_quality};
use std::fmt::Write as _;

/// Colour samples along a bar.
const SAMPLES: usize = 9;

/// Legend of a picture.
#[derive(Clone, Debug)]
pub enum Legend {
    /// Bar with a title, colours at equal distances, and tick labels.
    Bar { title: String, colours: Vec<Rgb>, ticks: Vec<String> },
    /// Named colours.
    Swatches(Vec<(Rgb, &'static str)>),
}

impl Legend {
    /// Radius ratios, from 0 to 1.
    pub fn quality() -> Self {
        let colours = (0..SAMPLES).map(|i| of_quality(i as f64 / (SAMPLES - 1) as f64)).collect();
        let ticks = ["0", "0.25", "0.5", "0.75", "1"].map(Into::into).to_vec();
        Self::Bar { title: "Radius ratio (1: regular)".into(), colours, ticks }
    }

    /// Vessel radii on a logarithmic scale.
    pub fn radius(scale: &Scale, unit: LengthUnit) -> Self {
        let at = |share: f64| scale.low * libm::pow(scale.high / scale.low, share);
        let colours = (0..SAMPLES).map(|i| scale.colour(at(i as f64 / (SAMPLES - 1) as f64))).collect();
        let ticks = [0.0, 0.5, 1.0].map(|share| figure(at(share))).to_vec();
        Self::Bar { title: format!("{}, logarithmic", unit.title("Vessel radius", "")), colours, ticks }
    }

    /// Boundary patches.
    pub fn patches() -> Self {
        Self::Swatches(PATCH_COLOURS.to_vec())
    }

    /// Returns the HTML element.
    pub fn html(&self) -> String {
        let css = |[r, g, b]: &Rgb| format!("rgb({r},{g},{b})");
        let mut out = String::from("<div class=\"legend\">");
        // Writing to a string cannot fail.
        let _ = match self {
            Self::Bar { title, colours, ticks } => {
                let stops: Vec<String> = colours.iter().map(css).collect();
                let ticks: String = ticks.iter().map(|tick| format!("<span>{}</span>", escaped(tick))).collect();
                write!(
                    out,
                    "<p>{}</p><div class=\"bar\" style=\"background:linear-gradient(to right,{})\"></div>\
                     <div class=\"ticks\">{ticks}</div>",
                    escaped(title),
                    stops.join(",")
                )
            }
            Self::Swatches(named) => named.iter().try_for_each(|(colour, name)| {
                write!(out, "<span><i style=\"background:{}\"></i>{}</span> ", css(colour), escaped(name))
            }),
        };
        out.push_str("</div>");
        out
    }
}
