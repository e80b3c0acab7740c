//! The standard normal distribution.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Φ(x): the probability of a value below x.
pub fn distribution(x: f64) -> f64 {
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

/// Φ⁻¹(p): the value that is not reached with the probability p, 0 < p < 1.
///
/// A rational start (Abramowitz and Stegun 26.2.23, within 0.00045) and three of Halley's steps, each of which triples the digits.
pub fn quantile(p: f64) -> f64 {
    // In the lower tail, where nothing cancels.
    let tail = p.min(1.0 - p).max(f64::MIN_POSITIVE);
    let t = (-2.0 * libm::log(tail)).sqrt();
    let numerator = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let denominator = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    let mut x = numerator / denominator - t;
    for _ in 0..3 {
        let density = libm::exp(-0.5 * x * x) / TAU.sqrt();
        let step = (distribution(x) - tail) / density;
        x -= step / (1.0 + 0.5 * x * step);
    }
    if p < 0.5 { x } else { -x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        // To twelve digits, from the tables of the normal distribution.
        for (p, x) in [
            (0.5, 0.0),
            (0.975, 1.959_963_984_540_054),
            (0.841_344_746_068_543, 1.0),
            (0.001, -3.090_232_306_167_813),
            (1e-9, -5.997_807_015_007_69),
            (0.3, -0.524_400_512_708_041),
        ] {
            let found = quantile(p);
            assert!((found - x).abs() < 1e-12, "{p}: {found}");
        }
    }

    #[test]
    fn the_quantile_undoes_the_distribution() {
        for i in -80..=80 {
            let x = f64::from(i) / 10.0;
            let p = distribution(x);
            // Where p is close to 1, its last digit is worth more than the tolerance.
            let lost = 1e-15 / (libm::exp(-0.5 * x * x) / TAU.sqrt());
            if p < 1.0 {
                assert!(
                    (quantile(p) - x).abs() < 1e-13 + lost,
                    "{x}: {}",
                    quantile(p)
                );
            }
        }
    }
}
