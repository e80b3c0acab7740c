//! Harmonics of equal samples of a period.

use realfft::RealFftPlanner;

/// Amplitude and phase of the bins 1 … n/2 of `values`: 2|X|/n, and |X|/n at Nyquist.
pub fn harmonics(values: &[f64]) -> Vec<(f64, f64)> {
    let n = values.len();
    if n < 2 {
        return Vec::new();
    }
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    // The mean goes first, so that it does not cost the small lines their digits.
    let mean = values.iter().sum::<f64>() / n as f64;
    let mut input: Vec<f64> = values.iter().map(|value| value - mean).collect();
    let mut output = transform.make_output_vec();
    transform
        .process(&mut input, &mut output)
        .expect("the planner made both buffers for this length");
    let line = |(bin, x): (usize, &realfft::num_complex::Complex<f64>)| {
        let factor = if 2 * bin == n { 1.0 } else { 2.0 };
        (factor * x.norm() / n as f64, x.arg())
    };
    output.iter().enumerate().skip(1).map(line).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn cosines_come_back_with_their_amplitudes_and_phases() {
        let n = 200;
        let wave = |j: usize, bin: f64, phase: f64| {
            (2.0 * PI * bin * j as f64 / f64::from(n) + phase).cos()
        };
        let values: Vec<f64> = (0..n as usize)
            .map(|j| {
                5.0 + 0.5 * wave(j, 1.0, 0.3) + 0.2 * wave(j, 5.0, -2.0) + 0.1 * wave(j, 100.0, 0.0)
            })
            .collect();
        let lines = harmonics(&values);
        assert_eq!(lines.len(), 100);
        for (bin, amplitude, phase) in [(1, 0.5, 0.3), (5, 0.2, -2.0), (100, 0.1, 0.0)] {
            assert!(
                (lines[bin - 1].0 - amplitude).abs() < 1e-14
                    && (lines[bin - 1].1 - phase).abs() < 1e-12
            );
        }
    }
}
