//! Seeded random numbers that are equal on every platform.

use std::f64::consts::TAU;

/// Generator `SplitMix64` (Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Generator of a case: equal names and seeds give equal numbers.
    pub fn of_case(name: &str, seed: u64) -> Self {
        let mut random = Self(fnv(name.as_bytes()) ^ seed.wrapping_mul(0xd134_2543_de82_ef95));
        random.bits();
        random
    }

    /// Next 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Number in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Number in [low, high), evenly distributed in its logarithm. Powers of ten come from a table free of platform maths.
    pub fn scale(&mut self, low: i32, high: i32) -> f64 {
        let exponent = low + self.below((high - low) as usize) as i32;
        decade(exponent) * self.between(1.0, 10.0)
    }

    /// Integer in 0..count.
    pub fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// True with the given probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// One element of a list.
    pub fn pick<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.below(list.len())]
    }

    /// Angle in [0, 2π).
    pub fn angle(&mut self) -> f64 {
        TAU * self.unit()
    }

    /// Unit vector.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let v = [(); 3].map(|()| self.between(-1.0, 1.0));
            let norm = v.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > 0.1 && norm < 1.0 {
                return v.map(|x| x / norm);
            }
        }
    }
}

/// Power of ten, correctly rounded as a decimal literal is.
pub fn decade(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(1.0)
}

/// FNV-1a hash.
pub fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_seeds_give_equal_numbers() {
        let numbers = |name, seed| {
            let mut random = Random::of_case(name, seed);
            [random.bits(), random.bits()]
        };
        assert_eq!(numbers("a", 1), numbers("a", 1));
        assert_ne!(numbers("a", 1), numbers("a", 2));
        assert_ne!(numbers("a", 1), numbers("b", 1));
    }

    #[test]
    fn numbers_stay_in_range() {
        let mut random = Random::of_case("range", 0);
        for _ in 0..1000 {
            assert!((0.0..1.0).contains(&random.unit()));
            assert!(random.below(3) < 3);
            assert!((1e-3..1e5).contains(&random.scale(-3, 5)));
        }
        assert_eq!(decade(-30), 1e-30);
    }
}
