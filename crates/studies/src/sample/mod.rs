//! Populations: members drawn from laws, and estimates for all of them from the results of some.
//!
//! Read [`law`] (spread of a quantity), [`points`] (places of the members), then the statistics of their results: [`percentile`] with its confidence limits,
//! [`histogram`], and [`influence`], the share of an input in the variance.
//!
//! Members come in [`REPLICATES`] replicates, member n in replicate n mod 16. Of Sobol' points each replicate is scrambled by itself, so that the
//! spread between replicates says how far the whole is to be trusted. Two neighbors n and n xor 1 stand in a [`batch`]; members of a batch
//! may share a part of their inputs, batches share nothing.
//!
//! Everything is a pure function: the same seed gives the same members on every machine, because generators are specified by their bits, and
//! logarithms and error functions are a library's and not the system's.

pub mod histogram;
pub mod influence;
pub mod law;
pub mod normal;
pub mod percentile;
pub mod points;
mod student;

/// Number of replicates of a sample.
pub const REPLICATES: u32 = 16;

/// Number of batches, of two replicates each.
pub const BATCHES: usize = REPLICATES as usize / 2;

/// The batch that `member` stands in. Batches are independent of each other.
pub fn batch(member: u32) -> usize {
    (member % REPLICATES) as usize / 2
}

/// The other member of the batch of `member` that has the same place in its replicate.
pub fn partner(member: u32) -> u32 {
    member ^ 1
}

/// The mean; none of nothing.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The standard deviation about the mean, over n: as `numpy.std` has it.
pub fn standard_deviation(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    let squares = values.iter().map(|value| (value - mean).powi(2));
    Some((squares.sum::<f64>() / values.len() as f64).sqrt())
}

/// An estimate and its 95 % confidence limits; a limit is none where the sample is too small to tell one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Estimate.
    pub value: f64,
    /// With 95 % confidence it is not below this.
    pub low: Option<f64>,
    /// Nor above this.
    pub high: Option<f64>,
}

impl Estimate {
    /// `value`, whose limits follow from the same estimate made in each of several independent parts, all of one size.
    fn of_parts(value: f64, parts: &[f64]) -> Self {
        let n = parts.len();
        let half = match (mean(parts), student::quantile_975(n.saturating_sub(1))) {
            (Some(mean), Some(t)) => {
                let squares: f64 = parts.iter().map(|part| (part - mean).powi(2)).sum();
                Some(t * (squares / ((n - 1) * n) as f64).sqrt())
            }
            _ => None,
        };
        Self {
            value,
            low: half.map(|half| value - half),
            high: half.map(|half| value + half),
        }
    }
}
