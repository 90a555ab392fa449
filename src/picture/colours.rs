//! Colours of displayed quantities.

use anastomesh_mesh::{Patch, WALL};

/// sRGB colour: red, green, blue.
pub type Rgb = [u8; 3];

/// Quantity shown by colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Colour {
    /// No quantity.
    Plain,
    /// Boundary patch: wall, inlet or outlet.
    Patch,
    /// Block index.
    Block,
    /// Vessel radius.
    Radius,
    /// Strahler order of the vessel.
    Order,
    /// Quality of the cells, from bad to good.
    Quality,
    /// Values of an array of the network.
    #[cfg_attr(feature = "cli", value(skip))]
    Values,
}

/// Background of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    #[default]
    Light,
    Dark,
    /// Transparent.
    None,
}

impl Background {
    /// Background colour, into which distant samples fade.
    pub(super) fn colour(self) -> Rgb {
        match self {
            Self::Light | Self::None => [255, 255, 255],
            Self::Dark => [16, 19, 24],
        }
    }
}

/// Vessel wall, seen from outside and from inside.
pub(super) const WALL_COLOURS: [Rgb; 2] = [[206, 122, 110], [128, 62, 58]];
/// Inner faces of tetrahedra.
pub(super) const INSIDE: Rgb = [238, 224, 198];
/// Highlighted objects.
pub(super) const MARKED: Rgb = [226, 40, 40];
const INLET: Rgb = [38, 101, 178];
const OUTLET: Rgb = [236, 180, 64];
/// Colours of the boundary patches of a network's mesh.
pub const PATCH_COLOURS: [(Rgb, &str); 3] = [(WALL_COLOURS[0], "wall"), (INLET, "inlet"), (OUTLET, "outlet")];
/// Patches without a known role.
const OTHERS: [Rgb; 6] =
    [[38, 101, 178], [236, 180, 64], [62, 150, 110], [150, 96, 170], [90, 170, 205], [140, 140, 140]];
/// Cells of bad to good quality.
const QUALITY: [Rgb; 5] = [[165, 0, 38], [244, 109, 67], [254, 224, 139], [102, 189, 160], [40, 110, 170]];
/// Places without a value.
const UNKNOWN: Rgb = [150, 150, 150];
/// Viridis colour map, in steps of an eighth.
const VIRIDIS: [Rgb; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// Colour of the patch with this id.
pub(super) fn of_patch(patches: &[Patch], id: i32) -> Rgb {
    let named = patches.binary_search_by_key(&id, |p| p.id).ok().map(|i| &patches[i]);
    match named {
        _ if id == WALL || patches.is_empty() => WALL_COLOURS[0],
        Some(patch) if patch.is_inlet() => INLET,
        Some(patch) if patch.is_outlet() => OUTLET,
        _ => OTHERS[id.unsigned_abs() as usize % OTHERS.len()],
    }
}

/// Colour of a block; consecutive blocks differ.
pub(super) fn of_block(block: i32) -> Rgb {
    // Hue steps of the golden ratio never repeat.
    let turn = (f64::from(block) * 0.618_033_988_749_895).rem_euclid(1.0);
    let value = 0.78 + 0.14 * (f64::from(block) * 0.754_877_666).rem_euclid(1.0);
    hue(turn, 0.42, value)
}

fn hue(turn: f64, saturation: f64, value: f64) -> Rgb {
    [5.0, 3.0, 1.0].map(|shift| {
        let k = (shift + 6.0 * turn).rem_euclid(6.0);
        (255.0 * value * (1.0 - saturation * k.min(4.0 - k).clamp(0.0, 1.0))).round() as u8
    })
}

/// Colour of a radius ratio.
pub fn of_quality(ratio: f64) -> Rgb {
    between(&QUALITY, ratio)
}

/// Interpolated colour at a position on a colour map, 0 to 1.
fn between(scale: &[Rgb], share: f64) -> Rgb {
    let at = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 } * (scale.len() - 1) as f64;
    let i = (at as usize).min(scale.len() - 2);
    let t = at - i as f64;
    [0, 1, 2].map(|c| (f64::from(scale[i][c]) * (1.0 - t) + f64::from(scale[i + 1][c]) * t).round() as u8)
}

/// Colour scale of values, with its limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Legend {
    pub low: f64,
    pub high: f64,
    /// True for a logarithmic scale.
    pub logarithmic: bool,
}

impl Legend {
    /// Scale that covers the finite values.
    pub fn of(values: impl Iterator<Item = f64>, logarithmic: bool) -> Self {
        let usable = values.filter(|v| v.is_finite() && (!logarithmic || *v > 0.0));
        let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low <= high { Self { low, high, logarithmic } } else { Self { low: 1.0, high: 1.0, logarithmic } }
    }

    /// The colour of a value.
    pub fn colour(&self, value: f64) -> Rgb {
        if value.is_nan() {
            return UNKNOWN;
        }
        let place = |x: f64| if self.logarithmic { libm::log(x.max(f64::MIN_POSITIVE)) } else { x };
        let (low, high) = (place(self.low), place(self.high));
        let share = if high > low { (place(value) - low) / (high - low) } else { 0.5 };
        // The extremes of the map contrast badly with the backgrounds.
        between(&VIRIDIS, 0.06 + 0.86 * share.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_hold_their_ends_and_odd_values_have_colours() {
        let legend = Legend::of([3.0, f64::NAN, 300.0, -1.0, 0.0].into_iter(), true);
        assert_eq!((legend.low, legend.high), (3.0, 300.0));
        assert_eq!(legend.colour(-1.0), legend.colour(3.0));
        assert_ne!(legend.colour(30.0), legend.colour(300.0));
        assert_eq!(legend.colour(f64::NAN), UNKNOWN);
        assert_eq!(Legend::of(std::iter::empty(), false).colour(7.0), Legend::of([2.0].into_iter(), false).colour(2.0));
        assert_eq!([of_quality(f64::NAN), of_quality(-1.0), of_quality(2.0)], [QUALITY[0], QUALITY[0], QUALITY[4]]);
        assert_ne!(of_block(0), of_block(1));
    }
}
