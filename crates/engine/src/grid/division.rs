//! Divisions of a line into elements: a smooth size function, or equal parts.
//!
//! A division is a list of fractions from 0 to 1 on the doubled lattice: corner, midside, corner, and so on, so that an
//! edge of n elements has 2 n + 1 of them. Midsides lie halfway between their corners.

use super::GridLevel;

/// n equal elements.
pub(super) fn uniform(count: usize) -> Vec<f64> {
    let last = 2 * count;
    (0..=last).map(|i| i as f64 / last as f64).collect()
}

/// The fractions read from the other end.
pub(super) fn reversed(fractions: &[f64]) -> Vec<f64> {
    fractions.iter().rev().map(|f| 1.0 - f).collect()
}

/// The corners given, with a midside halfway between each two.
pub(super) fn with_midsides(corners: &[f64]) -> Vec<f64> {
    let mut fractions = Vec::with_capacity(2 * corners.len());
    for pair in corners.windows(2) {
        fractions.push(pair[0]);
        fractions.push(f64::midpoint(pair[0], pair[1]));
    }
    fractions.extend(corners.last());
    fractions
}

/// Element sizes on a line: h grows from either end and levels off between,
/// 1/h⁴ = 1/(h_0² + (g x)²)² + 1/(h_1² + (g (L − x))²)² + 1/h_max⁴.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grading {
    /// The length L of the line.
    pub(super) length: f64,
    /// The size h_0 at the start.
    pub(super) first: f64,
    /// The size h_1 at the end; infinite where the end asks for none.
    pub(super) last: f64,
    /// The growth g of the size per length.
    pub(super) growth: f64,
    /// The size h_max far away.
    pub(super) largest: f64,
}

impl Grading {
    /// The element size at the distance `x` from the start.
    pub(super) fn size(&self, x: f64) -> f64 {
        let grown = |h: f64, x: f64| (h.powi(2) + (self.growth * x).powi(2)).powi(-2);
        let sum = grown(self.first, x) + grown(self.last, self.length - x) + self.largest.powi(-4);
        sum.powf(-0.25)
    }

    /// The position after the fraction `step` of an element from `x`, by a Runge-Kutta step of dx/di = h(x).
    fn advance(&self, x: f64, step: f64) -> f64 {
        let k_1 = step * self.size(x);
        let k_2 = step * self.size(x + k_1 / 2.0);
        let k_3 = step * self.size(x + k_2 / 2.0);
        let k_4 = step * self.size(x + k_3);
        x + (k_1 + 2.0 * k_2 + 2.0 * k_3 + k_4) / 6.0
    }

    /// The number ∫ dx/h of elements of these sizes on the line.
    pub(super) fn count(&self) -> f64 {
        const STEP: f64 = 1.0 / 16.0;
        let (mut x, mut count) = (0.0, 0.0);
        loop {
            let next = self.advance(x, STEP);
            // A length that is not a number ends the loop as well.
            if next >= self.length || next.is_nan() || self.length.is_nan() {
                return count + (self.length - x) / self.size(f64::midpoint(x, self.length));
            }
            (x, count) = (next, count + STEP);
        }
    }

    /// The number of elements that `level` puts on the line, at least `least` at the standard level.
    pub(super) fn count_at(&self, least: usize, level: GridLevel) -> usize {
        level.count(self.count().max(least as f64))
    }

    /// The division of the line into `count` elements whose sizes are proportional to h.
    ///
    /// The index is a smooth function of the position, so that a division into twice as many elements halves every one
    /// of them.
    pub(super) fn divide(&self, count: usize) -> Vec<f64> {
        const STEPS: usize = 16;
        let step = self.count() / (count * STEPS) as f64;
        let mut corners = vec![0.0];
        let mut x = 0.0;
        for _ in 0..count {
            x = (0..STEPS).fold(x, |x, _| self.advance(x, step));
            corners.push(x);
        }
        // The error of the integration is spread over all elements.
        for corner in &mut corners {
            *corner /= x;
        }
        corners[count] = 1.0;
        with_midsides(&corners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRADING: Grading = Grading {
        length: 2.1,
        first: 0.005,
        last: f64::INFINITY,
        growth: 0.15,
        largest: 0.06,
    };

    #[test]
    fn twice_as_many_elements_share_every_other_corner() {
        let (coarse, fine) = (GRADING.divide(20), GRADING.divide(40));
        for (i, fraction) in coarse.iter().enumerate().step_by(2) {
            // The fourth-order integration leaves 1e-5 of the length.
            assert!((fraction - fine[2 * i]).abs() < 1e-5);
        }
    }

    #[test]
    fn sizes_follow_the_size_function() {
        let count = GRADING.count().round();
        let corners = GRADING.divide(count as usize);
        for pair in corners.windows(3).step_by(2) {
            let (size, middle) = (2.1 * (pair[2] - pair[0]), 2.1 * pair[1]);
            // The rounding of the count and the width of an element shift a size by a few percent.
            assert!((size / GRADING.size(middle) - 1.0).abs() < 0.05);
        }
    }
}
