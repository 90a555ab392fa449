//! Pseudo-random numbers that depend only on seed, stream and index, for any number of threads.

/// Mixes 64 bits so that each bit of the result depends on all of them (`SplitMix64`; Steele, Lea, Flood 2014).
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Purpose of a number; each purpose has its own stream.
#[derive(Clone, Copy, Debug)]
pub enum Stream {
    /// Start of the sequence of candidate points.
    Start,
    /// Displacement of a candidate from the sequence.
    Jitter,
    /// Acceptance of a candidate in a sparse zone.
    Zone,
    /// Division of a set of terminals.
    Split,
    /// Radius of a terminal.
    Radius,
    /// Node positions and radii of a capillary bed.
    Bed,
    /// Radius of a vessel that joins a tree to the bed.
    Joint,
}

/// Source of random numbers for one seed.
#[derive(Clone, Copy, Debug)]
pub struct Random {
    seed: u64,
}

impl Random {
    pub fn new(seed: u64) -> Self {
        Self { seed: mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)) }
    }

    /// Uniform number in [0, 1) for the `index`-th use of a stream.
    pub fn unit(self, stream: Stream, index: u64) -> f64 {
        let key = index.wrapping_mul(8).wrapping_add(stream as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (mix(self.seed ^ mix(key)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Nearly normal number with mean 0 and standard deviation 1, within ±3: a sum of three uniform ones in [−1, 1).
    pub fn bell(self, stream: Stream, index: u64) -> f64 {
        (0..3).map(|i| 2.0 * self.unit(stream, 3 * index + i) - 1.0).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_spread_evenly_and_streams_differ() {
        let random = Random::new(1);
        let values: Vec<f64> = (0..10_000).map(|i| random.unit(Stream::Split, i)).collect();
        let mean = values.iter().sum::<f64>() / 1e4;
        assert!((mean - 0.5).abs() < 0.02 && values.iter().all(|x| (0.0..1.0).contains(x)), "{mean}");
        let bells: Vec<f64> = (0..10_000).map(|i| random.bell(Stream::Radius, i)).collect();
        let variance = bells.iter().map(|x| x * x).sum::<f64>() / 1e4;
        assert!((variance - 1.0).abs() < 0.05 && bells.iter().all(|x| x.abs() <= 3.0), "{variance}");
        assert_ne!(random.unit(Stream::Split, 7), random.unit(Stream::Zone, 7));
        assert_ne!(random.unit(Stream::Split, 7), Random::new(2).unit(Stream::Split, 7));
    }
}
