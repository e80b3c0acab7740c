//! Statistics of a curve over its span.

/// Mean, rms of the fluctuation and extremes of a curve over one span, between its positions too.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Statistics {
    /// The mean.
    pub mean: f64,
    /// The root mean square after the mean is removed.
    pub rms: f64,
    /// Largest less smallest value.
    pub peak_to_peak: f64,
    /// The smallest value; where the curve jumps, of both sides.
    pub smallest: f64,
    /// The mesh position at which it stands.
    pub smallest_at: f64,
    /// The largest value; where the curve jumps, of both sides.
    pub largest: f64,
    /// The mesh position at which it stands.
    pub largest_at: f64,
}

/// By how much the statistics of δ may be off because the contact is solved at some positions only, in meters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SamplingError {
    /// In the mean.
    pub mean: f64,
    /// In the peak-to-peak.
    pub peak_to_peak: f64,
}
