//! Velocity profiles on a round cap: Poiseuille's, and Womersley's of pulsatile flow.
//!
//! J. R. Womersley, Method for the calculation of velocity, rate of flow and viscous drag in arteries when the pressure
//! gradient is known, J. Physiol. 127 (1955).

use super::Waveform;
use anastomesh_mesh::nalgebra::Complex;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Number of harmonics of a waveform. The rest has the mean's profile; of a linear waveform it is below 1 %.
const HARMONICS: u32 = 24;
/// Argument from which the Bessel function is its asymptote. Above it the power series loses its digits.
const LARGE: f64 = 40.0;
/// Maximum number of terms of the power series; 80 are needed at the argument `LARGE`.
const TERMS: u32 = 200;

/// A harmonic of a waveform: its frequency in radians per second, and its complex amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Harmonic {
    pub(crate) frequency: f64,
    pub(crate) amplitude: Complex<f64>,
}

impl Harmonic {
    /// First harmonics of a waveform, by the exact integrals of its straight pieces.
    pub(crate) fn of(waveform: &Waveform) -> Vec<Self> {
        let (times, rates) = (waveform.times(), waveform.rates());
        let first = TAU / waveform.period();
        let harmonic = |n: u32| {
            let frequency = f64::from(n) * first;
            let turn = |time: f64| turned(-frequency * time);
            let pieces = times.windows(2).zip(rates.windows(2));
            let sum: Complex<f64> =
                pieces.map(|(t, q)| (turn(t[1]) - turn(t[0])) * ((q[1] - q[0]) / (t[1] - t[0]))).sum();
            Self { frequency, amplitude: sum * (2.0 / (waveform.period() * frequency * frequency)) }
        };
        (1..=HARMONICS).map(harmonic).collect()
    }

    /// Complex value at a time; the real part is the harmonic.
    pub(crate) fn at(&self, time: f64) -> Complex<f64> {
        self.amplitude * turned(self.frequency * time)
    }
}

/// Poiseuille's profile at a fraction of the radius, 1 on the axis.
pub(crate) fn poiseuille(share: f64) -> f64 {
    (1.0 - share * share).max(0.0)
}

/// Womersley's profile of a harmonic at a fraction of the radius, for the Womersley number of the harmonic.
pub(crate) fn womersley(alpha: f64, share: f64) -> Complex<f64> {
    if share >= 1.0 {
        return Complex::new(0.0, 0.0);
    }
    let ratio = if alpha <= LARGE {
        bessel(alpha * share) / bessel(alpha)
    } else if alpha * share > 1.0 {
        let root = Complex::new(FRAC_1_SQRT_2, FRAC_1_SQRT_2);
        let power = root * (alpha * (share - 1.0));
        turned(power.im) * (libm::exp(power.re) / share.sqrt())
    } else {
        Complex::new(0.0, 0.0)
    };
    Complex::new(1.0, 0.0) - ratio
}

/// Bessel function J0 of i^(3/2) x, by its power series.
fn bessel(x: f64) -> Complex<f64> {
    let step = Complex::new(0.0, x * x / 4.0);
    let (mut term, mut sum) = (Complex::new(1.0, 0.0), Complex::new(1.0, 0.0));
    for k in 1..=TERMS {
        term *= step / (f64::from(k) * f64::from(k));
        sum += term;
        if term.norm() < f64::EPSILON * sum.norm() {
            break;
        }
    }
    sum
}

/// Complex number of magnitude 1 and this angle.
fn turned(angle: f64) -> Complex<f64> {
    let (sine, cosine) = libm::sincos(angle);
    Complex::new(cosine, sine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_add_up_to_the_waveform() {
        let count = 100;
        let times: Vec<f64> = (0..=count).map(|i| 0.8 * f64::from(i) / f64::from(count)).collect();
        let rates =
            times.iter().map(|t| 5.0 + 2.0 * libm::cos(TAU * t / 0.8) + libm::sin(3.0 * TAU * t / 0.8)).collect();
        let waveform = Waveform::new(times, rates).unwrap();
        let harmonics = Harmonic::of(&waveform);
        assert!((harmonics[0].amplitude - Complex::new(2.0, 0.0)).norm() < 2e-3, "{harmonics:?}");
        assert!((harmonics[2].amplitude - Complex::new(0.0, -1.0)).norm() < 5e-3);
        for time in [0.0, 0.13, 0.5, 0.79] {
            let sum: f64 = harmonics.iter().map(|harmonic| harmonic.at(time).re).sum();
            assert!((waveform.mean() + sum - waveform.at(time)).abs() < 5e-3, "{time}");
        }
    }

    #[test]
    fn bessel_function_has_its_tabulated_values() {
        // Abramowitz and Stegun, table 9.12: ber and bei of 1 and 5.
        for (x, ber, bei) in [(1.0, 0.984_381_781_2, 0.249_566_040_0), (5.0, -6.230_082_478_7, 0.116_034_381_6)] {
            assert!((bessel(x) - Complex::new(ber, bei)).norm() < 1e-9, "{x} {}", bessel(x));
        }
    }

    #[test]
    fn slow_flow_is_a_parabola_and_fast_flow_a_plug() {
        // For small numbers the profile is (1 - x^2) i alpha^2 / 4.
        let slow = womersley(0.05, 0.6) / womersley(0.05, 0.0);
        assert!((slow.re - poiseuille(0.6)).abs() < 1e-4 && slow.im.abs() < 1e-3);
        assert!((womersley(80.0, 0.5) - 1.0).norm() < 1e-9);
        // Both forms agree where they meet.
        for share in [0.7, 0.9, 0.99] {
            assert!((womersley(39.99, share) - womersley(40.01, share)).norm() < 5e-3, "{share}");
        }
        assert_eq!(womersley(3.0, 1.0), Complex::new(0.0, 0.0));
    }
}
