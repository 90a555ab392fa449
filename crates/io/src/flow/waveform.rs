//! Periodic flow rate.

use anastomesh_mesh::units::counted;

/// Periodic flow rate, linear between samples.
///
/// The last sample is the first of the next period.
#[derive(Clone, Debug, PartialEq)]
pub struct Waveform {
    times: Vec<f64>,
    rates: Vec<f64>,
}

/// Reason why samples are not a waveform. Samples are numbered from 1.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WaveformFault {
    /// Fewer than two samples, or another number of times than of rates.
    #[error("{} and {}; give at least two samples", counted(*times, "time"), counted(*rates, "rate"))]
    TooFew {
        /// Number of times.
        times: usize,
        /// Number of rates.
        rates: usize,
    },
    /// A time or rate is infinite or NaN.
    #[error("sample {sample} is not finite; correct it")]
    NotFinite {
        /// Number of the sample.
        sample: usize,
    },
    /// Times do not increase.
    #[error("time {time} of sample {sample} does not follow {before}; sort the samples by time")]
    NotIncreasing {
        /// Number of the sample.
        sample: usize,
        /// Its time.
        time: f64,
        /// Time of the sample before it.
        before: f64,
    },
    /// The first time is not 0.
    #[error("the first time is {time}; begin a period at time 0")]
    StartsLate {
        /// First time.
        time: f64,
    },
    /// The last rate differs from the first.
    #[error("the period ends with rate {last} and begins with {first}; end it with a sample equal to the first")]
    NotPeriodic {
        /// First rate.
        first: f64,
        /// Last rate.
        last: f64,
    },
}

/// Maximum difference of the first and last rate, relative to the largest rate.
const PERIODIC: f64 = 1e-6;

impl Waveform {
    /// Waveform with these samples. Times are in seconds, rates in volume per second.
    ///
    /// # Errors
    /// [`WaveformFault`] if the samples are not one period that starts at time 0.
    pub fn new(times: Vec<f64>, mut rates: Vec<f64>) -> Result<Self, WaveformFault> {
        let count = times.len();
        let (Some(&start), Some(&first), Some(&last)) = (times.first(), rates.first(), rates.last()) else {
            return Err(WaveformFault::TooFew { times: count, rates: rates.len() });
        };
        if count < 2 || rates.len() != count {
            return Err(WaveformFault::TooFew { times: count, rates: rates.len() });
        }
        if let Some(at) = times.iter().zip(&rates).position(|(time, rate)| !time.is_finite() || !rate.is_finite()) {
            return Err(WaveformFault::NotFinite { sample: at + 1 });
        }
        if start != 0.0 {
            return Err(WaveformFault::StartsLate { time: start });
        }
        if let Some(at) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
            return Err(WaveformFault::NotIncreasing { sample: at + 2, time: times[at + 1], before: times[at] });
        }
        let largest = rates.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()));
        if (last - first).abs() > PERIODIC * largest {
            return Err(WaveformFault::NotPeriodic { first, last });
        }
        rates[count - 1] = first;
        Ok(Self { times, rates })
    }

    /// Times of the samples, from 0 to the period.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Rates of the samples.
    #[must_use]
    pub fn rates(&self) -> &[f64] {
        &self.rates
    }

    /// Duration of a period.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Mean rate over a period.
    #[must_use]
    pub fn mean(&self) -> f64 {
        let steps = self.times.windows(2).zip(self.rates.windows(2));
        let volume: f64 = steps.map(|(time, rate)| (time[1] - time[0]) * f64::midpoint(rate[0], rate[1])).sum();
        volume / self.period()
    }

    /// Largest absolute rate.
    #[must_use]
    pub fn peak(&self) -> f64 {
        self.rates.iter().fold(0.0, |most: f64, rate| most.max(rate.abs()))
    }

    /// Rate at a time; the waveform repeats before 0 and after the period.
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        let time = time.rem_euclid(self.period());
        let next = self.times.partition_point(|&sample| sample <= time).clamp(1, self.times.len() - 1);
        let [from, to] = [self.times[next - 1], self.times[next]];
        let share = (time - from) / (to - from);
        self.rates[next - 1] + share * (self.rates[next] - self.rates[next - 1])
    }

    /// Waveform with all rates multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { times: self.times.clone(), rates: self.rates.iter().map(|rate| factor * rate).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_linear_between_samples_and_repeat() {
        let pulse = Waveform::new(vec![0.0, 0.2, 1.0], vec![1.0, 5.0, 1.0]).unwrap();
        assert_eq!(
            [0.0, 0.1, 0.2, 0.6, 1.0, -0.9, 7.1].map(|t| (pulse.at(t) * 1e9).round() / 1e9),
            [1.0, 3.0, 5.0, 3.0, 1.0, 3.0, 3.0]
        );
        assert!((pulse.mean() - 3.0).abs() < 1e-12);
        assert_eq!((pulse.period(), pulse.peak()), (1.0, 5.0));
        assert!((pulse.scaled(2.0).mean() - 6.0).abs() < 1e-12);
    }

    #[test]
    fn faults_are_named() {
        let fault = |times: &[f64], rates: &[f64]| Waveform::new(times.to_vec(), rates.to_vec()).unwrap_err();
        assert_eq!(fault(&[0.0], &[1.0]), WaveformFault::TooFew { times: 1, rates: 1 });
        assert_eq!(fault(&[0.0, 1.0], &[1.0]), WaveformFault::TooFew { times: 2, rates: 1 });
        assert_eq!(fault(&[0.0, 1.0], &[1.0, f64::NAN]), WaveformFault::NotFinite { sample: 2 });
        assert_eq!(fault(&[0.5, 1.0], &[1.0, 1.0]), WaveformFault::StartsLate { time: 0.5 });
        let back = WaveformFault::NotIncreasing { sample: 3, time: 0.1, before: 0.2 };
        assert_eq!(fault(&[0.0, 0.2, 0.1], &[1.0; 3]), back);
        assert_eq!(fault(&[0.0, 1.0], &[1.0, 2.0]), WaveformFault::NotPeriodic { first: 1.0, last: 2.0 });
    }
}
