//! Arrays of a network as colours.

use std::str::FromStr;

use super::exit::Failure;
use super::network::NetworkArgs;
use crate::picture::Legend;
use anastomesh_io::network::{NetworkFormat, NetworkNote};
use anastomesh_skeleton::Skeleton;
use rustc_hash::FxHashMap;

/// Smallest ratio of the largest to the smallest value of a logarithmic scale.
const WIDE: f64 = 100.0;

/// Requested array, with the unit of its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArrayName {
    pub name: String,
    pub unit: Option<String>,
}

impl FromStr for ArrayName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, unit) = match text.rsplit_once(':') {
            Some((name, unit)) => (name, Some(unit.to_owned())),
            None => (text, None),
        };
        if name.is_empty() || unit.as_ref().is_some_and(String::is_empty) {
            return Err("give the name of an array, or name and unit: Pressure:Pa".into());
        }
        Ok(Self { name: name.to_owned(), unit })
    }
}

impl ArrayName {
    /// Name with unit, for legends.
    pub fn title(&self) -> String {
        self.unit.as_ref().map_or_else(|| self.name.clone(), |unit| format!("{} in {unit}", self.name))
    }
}

/// Values of an array at both ends of each vessel, with their scale.
pub struct ArrayValues {
    pub values: Vec<[f64; 2]>,
    pub legend: Legend,
}

impl ArrayValues {
    /// Reads an array of nodes or vessels of the file from which `network` was read.
    pub fn read(args: &NetworkArgs, array: &ArrayName, network: &Skeleton) -> Result<Self, Failure> {
        let path = args.network.display();
        if let Ok(NetworkFormat::Swc) = NetworkFormat::of(&args.network) {
            return Err(Failure::usage(format!("{path}: SWC has no named arrays: give --data with a .vtp file")));
        }
        // The reader of radii takes any array of nodes or vessels.
        let plain = NetworkArgs {
            radius_array: Some(array.name.clone()),
            radius: None,
            diameters: false,
            radius_scale: None,
            scale: None,
            units: None,
            ..args.clone()
        };
        let (found, placed) = (plain.file(true)?, args.file(true)?.skeleton);
        let halved = found.notes.iter().any(|note| matches!(note, NetworkNote::Halved { .. }));
        let factor = if halved { 2.0 } else { 1.0 };
        // Cleaning renumbers nodes and edges, but keeps positions.
        let ends = |network: &Skeleton, i: usize| {
            network.edges[i].nodes.map(|n| <[f64; 3]>::from(network.node(n).position.coords).map(f64::to_bits))
        };
        let mut known: FxHashMap<[[u64; 3]; 2], [f64; 2]> = FxHashMap::default();
        for (i, edge) in found.skeleton.edges.iter().enumerate() {
            known.entry(ends(&placed, i)).or_insert(edge.radii.map(|value| value * factor));
        }
        let value = |i: usize| {
            let [a, b] = ends(network, i);
            let reversed = || known.get(&[b, a]).map(|&[x, y]| [y, x]);
            known.get(&[a, b]).copied().or_else(reversed).unwrap_or([f64::NAN; 2])
        };
        let values: Vec<[f64; 2]> = (0..network.edges.len()).map(value).collect();
        let legend = legend(&values);
        if legend.low > legend.high {
            return Err(Failure::input(format!("{path}: array '{}' has no finite value: choose another", array.name)));
        }
        Ok(Self { values, legend })
    }
}

/// Scale of the finite values: logarithmic if they are positive and span more than two orders of magnitude.
fn legend(values: &[[f64; 2]]) -> Legend {
    let finite = values.as_flattened().iter().filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
    Legend { low, high, logarithmic: low > 0.0 && high > WIDE * low }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_units() {
        let read = |text: &str| text.parse::<ArrayName>().map(|array| array.title());
        assert_eq!(read("Pressure"), Ok("Pressure".into()));
        assert_eq!(read("WallShear:Pa"), Ok("WallShear in Pa".into()));
        assert_eq!(read("a:b:c"), Ok("a:b in c".into()));
        for wrong in ["", ":Pa", "Flow:"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn wide_positive_ranges_are_logarithmic() {
        assert_eq!(legend(&[[1.0, f64::NAN], [1e3, 2.0]]), Legend { low: 1.0, high: 1e3, logarithmic: true });
        assert!(!legend(&[[0.0, 1e3]]).logarithmic && !legend(&[[1.0, 9.0]]).logarithmic);
    }
}
