//! Structured tree of small vessels beyond an outlet (Olufsen, Am. J. Physiol. 276, H257, 1999).

use super::OutletModel;
use std::f64::consts::PI;

/// Asymmetric tree of straight vessels, down to a minimum radius.
///
/// A vessel of radius r divides into vessels of radii `radius_ratios` · r, until a vessel is thinner than
/// `minimum_radius`. The pressure beyond the last vessels is the distal pressure of the outlet.
///
/// ```
/// use anastomesh_io::flow::StructuredTree;
///
/// let tree = StructuredTree::new(3e-5);
/// let outlet = tree.outlet(1e-3, 1060.0, 3.5e-3, 0.0);
/// // Thinner roots have fewer vessels beyond them, and a larger resistance.
/// assert!(outlet.resistance() < tree.outlet(5e-4, 1060.0, 3.5e-3, 0.0).resistance());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct StructuredTree {
    /// Radius at which vessels end.
    pub minimum_radius: f64,
    /// Radii of the two daughters, relative to their parent.
    pub radius_ratios: [f64; 2],
    /// Length of a vessel, relative to its radius.
    pub length_ratio: f64,
    /// Stiffness of the wall, E h / r (Young's modulus, wall thickness, radius), as a pressure; `None` for rigid vessels.
    pub stiffness: Option<f64>,
}

/// Largest radius ratio: a tree has at most a few thousand generations.
const LARGEST_RATIO: f64 = 0.99;
/// Smallest minimum radius, relative to the root.
const SMALLEST: f64 = 1e-9;

/// Resistance of a tree, and the first moment of its impedance: Z(ω) ≈ resistance − iω · moment.
#[derive(Clone, Copy, Default)]
struct Load {
    resistance: f64,
    moment: f64,
}

impl Load {
    fn beside(self, other: Self) -> Self {
        let resistance = 1.0 / (1.0 / self.resistance + 1.0 / other.resistance);
        let part = |load: Self| load.moment / (load.resistance * load.resistance);
        Self { resistance, moment: resistance * resistance * (part(self) + part(other)) }
    }

    /// Adds a vessel in front, whose capacitance is uniform along its length.
    fn behind(self, resistance: f64, capacitance: f64) -> Self {
        let all = self.resistance + resistance;
        // ∫ R(x)² dx, with R(x) the resistance downstream of x.
        let square = (all * all + all * self.resistance + self.resistance * self.resistance) / 3.0;
        Self { resistance: all, moment: self.moment + capacitance * square }
    }
}

impl StructuredTree {
    /// Rigid tree of Olufsen: radius ratios 0.9 and 0.6, vessels of 50 radii.
    #[must_use]
    pub fn new(minimum_radius: f64) -> Self {
        Self { minimum_radius, radius_ratios: [0.9, 0.6], length_ratio: 50.0, stiffness: None }
    }

    /// True if all parameters are in range: ratios above 0 and at most 0.99, other numbers finite and above 0.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        self.radius_ratios.iter().all(|&ratio| ratio > 0.0 && ratio <= LARGEST_RATIO)
            && [self.minimum_radius, self.length_ratio].into_iter().all(positive)
            && self.stiffness.is_none_or(positive)
    }

    /// Outlet model with the steady resistance of the tree below an outlet of this radius.
    ///
    /// Elastic trees give an RCR model with the same impedance at low frequency, to first order. Its proximal resistance
    /// is the characteristic impedance of the first vessel.
    #[must_use]
    pub fn outlet(&self, radius: f64, density: f64, viscosity: f64, distal_pressure: f64) -> OutletModel {
        let Load { resistance, moment } = self.load(radius, viscosity);
        let Some(stiffness) = self.stiffness else { return OutletModel::Resistance { resistance, distal_pressure } };
        // Wave speed c of a thin wall, c² = 2 E h / (3 ρ r), and impedance ρ c / A.
        let speed = (2.0 * stiffness / (3.0 * density)).sqrt();
        let proximal = (density * speed / (PI * radius * radius)).min(0.5 * resistance);
        let distal = resistance - proximal;
        OutletModel::Rcr { proximal, capacitance: moment / (distal * distal), distal, distal_pressure }
    }

    fn load(&self, radius: f64, viscosity: f64) -> Load {
        let end = self.minimum_radius.max(SMALLEST * radius);
        let counts = self.radius_ratios.map(|ratio| {
            let generations = libm::log(end / radius) / libm::log(ratio);
            generations.max(0.0).ceil() as usize + 1
        });
        // Vessels of i divisions to the wider and j to the thinner side are equal.
        let mut next = vec![Load::default(); counts[1] + 1];
        for i in (0..=counts[0]).rev() {
            let mut row = vec![Load::default(); counts[1] + 1];
            for j in (0..=counts[1]).rev() {
                let own = radius * self.radius_ratios[0].powi(i as i32) * self.radius_ratios[1].powi(j as i32);
                let is_last = own < end || i == counts[0] || j == counts[1];
                let beyond = if is_last { Load::default() } else { next[j].beside(row[j + 1]) };
                let length = self.length_ratio * own;
                let capacitance = self.stiffness.map_or(0.0, |stiffness| 1.5 * PI * own * own * length / stiffness);
                row[j] = beyond.behind(8.0 * viscosity * length / (PI * own.powi(4)), capacitance);
            }
            next = row;
        }
        next[0]
    }
}

anastomesh_mesh::setters!(StructuredTree { radius_ratios: [f64; 2], length_ratio: f64, stiffness: Option<f64> });

#[cfg(test)]
mod tests {
    use super::*;

    /// Plain recursion over every vessel of a tree.
    fn recursive(tree: &StructuredTree, radius: f64, viscosity: f64) -> f64 {
        let own = 8.0 * viscosity * tree.length_ratio / (PI * radius.powi(3));
        if radius < tree.minimum_radius {
            return own;
        }
        let [a, b] = tree.radius_ratios.map(|ratio| recursive(tree, ratio * radius, viscosity));
        own + 1.0 / (1.0 / a + 1.0 / b)
    }

    #[test]
    fn equal_vessels_are_computed_once() {
        for minimum in [0.3, 0.05, 2.0] {
            let tree = StructuredTree::new(minimum);
            let [found, expected] = [tree.outlet(1.0, 1.0, 2.0, 0.0).resistance(), recursive(&tree, 1.0, 2.0)];
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }

    /// Impedance of a tree of tubes with resistance and capacitance, each cut into short pieces.
    fn impedance(tree: &StructuredTree, radius: f64, viscosity: f64, omega: f64) -> [f64; 2] {
        const PIECES: i32 = 200;
        let inverse = |[a, b]: [f64; 2]| [a / (a * a + b * b), -b / (a * a + b * b)];
        let mut load = [0.0; 2];
        if radius >= tree.minimum_radius {
            let [a, b] = tree.radius_ratios.map(|ratio| inverse(impedance(tree, ratio * radius, viscosity, omega)));
            load = inverse([a[0] + b[0], a[1] + b[1]]);
        }
        let length = tree.length_ratio * radius / f64::from(PIECES);
        let resistance = 8.0 * viscosity * length / (PI * radius.powi(4));
        let capacitance = 1.5 * PI * radius * radius * length / tree.stiffness.unwrap();
        for _ in 0..PIECES {
            let middle = inverse([load[0] + 0.5 * resistance, load[1]]);
            let behind = inverse([middle[0], middle[1] + omega * capacitance]);
            load = [behind[0] + 0.5 * resistance, behind[1]];
        }
        load
    }

    #[test]
    fn elastic_trees_have_the_impedance_of_their_rcr_model_at_low_frequency() {
        let tree = StructuredTree::new(0.4).stiffness(Some(1e5));
        let model = tree.outlet(1.0, 1.0, 2.0, 7.0);
        let OutletModel::Rcr { proximal, capacitance, distal, distal_pressure } = model else { panic!("{model:?}") };
        assert_eq!(distal_pressure, 7.0);
        assert!((proximal / ((2e5_f64 / 3.0).sqrt() / PI) - 1.0).abs() < 1e-12, "{proximal}");
        let omega = 1e-3 / (distal * capacitance);
        let [real, imaginary] = impedance(&tree, 1.0, 2.0, omega);
        assert!((real / (proximal + distal) - 1.0).abs() < 1e-4);
        assert!((imaginary / (-omega * capacitance * distal * distal) - 1.0).abs() < 1e-3, "{imaginary}");
    }

    #[test]
    fn parameters_have_ranges() {
        let tree = StructuredTree::new(1.0);
        assert!(tree.is_sound() && !StructuredTree::new(0.0).is_sound());
        assert!(!tree.radius_ratios([1.0, 0.6]).is_sound() && !tree.stiffness(Some(f64::NAN)).is_sound());
    }
}
