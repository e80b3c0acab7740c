//! Functions along an axis: polynomials over a width, or pieces of them that join at given heights.
//!
//! A rim that is wider than its web bends sharply where the web's faces meet it; pieces of degree 4 that join there are as good as one polynomial of degree 16.

use faer::Mat;

use super::dense::Cholesky;
use crate::quadrature::{gauss_legendre, legendre};

/// Orthonormal functions over a width: ∫ f_p f_q dz = δ_pq. Heights are in meters.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialBasis {
    breaks: Vec<f64>,
    degree: usize,
    /// The orthonormal functions by the plain ones, a column each.
    mixing: Mat<f64>,
}

/// Integrals of a basis over its width: C_pq = ∫ f_p f_q' dz and D_pq = ∫ f_p' f_q' dz; ∫ f_p f_q dz is the identity.
#[derive(Debug, Clone)]
pub struct AxialMatrices {
    /// The identity.
    pub same: Mat<f64>,
    /// C.
    pub slope: Mat<f64>,
    /// Cᵀ.
    pub back: Mat<f64>,
    /// D.
    pub slopes: Mat<f64>,
}

impl AxialMatrices {
    /// Those of the functions `rows` with the functions `columns`.
    pub fn between(&self, rows: &[usize], columns: &[usize]) -> Self {
        let part = |of: &Mat<f64>| {
            Mat::from_fn(rows.len(), columns.len(), |i, j| of[(rows[i], columns[j])])
        };
        Self {
            same: part(&self.same),
            slope: part(&self.slope),
            back: part(&self.back),
            slopes: part(&self.slopes),
        }
    }

    /// Fills `to` with a column of the sum of I, C, Cᵀ and D, of each so much.
    pub fn fill(&self, shares: [f64; 4], column: usize, to: &mut [f64]) {
        let all = [&self.same, &self.slope, &self.back, &self.slopes];
        let [same, slope, back, slopes] = all.map(|of| of.col_as_slice(column));
        let values = same.iter().zip(slope).zip(back.iter().zip(slopes));
        for (to, ((same, slope), (back, slopes))) in to.iter_mut().zip(values) {
            *to = shares[0] * same + shares[1] * slope + shares[2] * back + shares[3] * slopes;
        }
    }
}

impl AxialBasis {
    /// Polynomials up to `degree` between the first and the last of `breaks`, which rise, continuous at those between.
    ///
    /// # Panics
    ///
    /// If there are fewer than two breaks, or pieces of degree 0, which cannot join.
    pub fn new(breaks: &[f64], degree: usize) -> Self {
        assert!(breaks.len() > 1 && (breaks.len() == 2 || degree > 0));
        let mut basis = Self {
            breaks: breaks.to_vec(),
            degree,
            mixing: Mat::zeros(0, 0),
        };
        let count = basis.len();
        basis.mixing = Mat::identity(count, count);
        let products = basis.integrals(&basis, |_| 1.0);
        // M = L Lᵀ, and L⁻¹ M L⁻ᵀ = I: the functions by L⁻ᵀ.
        let mut mixing = Mat::<f64>::identity(count, count);
        if let Some(factor) = Cholesky::new(products) {
            factor.other_half_solve_in_place(mixing.as_mut());
        }
        basis.mixing = mixing;
        basis
    }

    /// The number of functions.
    pub fn len(&self) -> usize {
        (self.breaks.len() - 1) * self.degree + 1
    }

    /// Never: a basis has at least the constant.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The degree of its pieces.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Where it begins and ends.
    pub fn heights(&self) -> [f64; 2] {
        [self.breaks[0], self.breaks[self.breaks.len() - 1]]
    }

    /// True if its functions are even and odd in turn about its middle, as those of one polynomial are.
    pub fn alternates(&self) -> bool {
        self.breaks.len() == 2
    }

    /// Where its pieces begin and end.
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// The values of all functions at the height `z`; beyond the ends those of the last pieces go on.
    pub fn values(&self, z: f64) -> Vec<f64> {
        self.mixed(&self.plain(z).0)
    }

    /// Their derivatives at the height `z`.
    pub fn slopes(&self, z: f64) -> Vec<f64> {
        self.mixed(&self.plain(z).1)
    }

    /// A rule over the width with the given number of points a piece: heights and weights.
    pub fn rule(&self, count: usize) -> Vec<(f64, f64)> {
        rule(&self.breaks, count)
    }

    /// ∫ f_p dz.
    pub fn even(&self) -> Vec<f64> {
        let mut even = vec![0.0; self.len()];
        for (z, w) in self.rule(self.degree + 1) {
            for (even, f) in even.iter_mut().zip(self.values(z)) {
                *even += w * f;
            }
        }
        even
    }

    /// C and D.
    pub fn matrices(&self) -> AxialMatrices {
        let count = self.len();
        let [mut slope, mut slopes] = [(); 2].map(|()| Mat::zeros(count, count));
        for (z, w) in self.rule(self.degree + 1) {
            let (f, g) = (self.values(z), self.slopes(z));
            for q in 0..count {
                for p in 0..count {
                    slope[(p, q)] += w * f[p] * g[q];
                    slopes[(p, q)] += w * g[p] * g[q];
                }
            }
        }
        AxialMatrices {
            same: Mat::identity(count, count),
            back: slope.transpose().to_owned(),
            slope,
            slopes,
        }
    }

    /// ∫ f_p g_q `weight` dz over this width, f of this basis and g of `other`.
    pub fn integrals(&self, other: &Self, weight: impl Fn(f64) -> f64) -> Mat<f64> {
        let mut integrals = Mat::zeros(self.len(), other.len());
        let [low, high] = self.heights();
        let within = other.breaks.iter().filter(|z| **z > low && **z < high);
        let mut ends: Vec<f64> = self.breaks.iter().chain(within).copied().collect();
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        // As many points as resolve a weight that turns once or twice over the width.
        for (z, w) in rule(&ends, self.degree.max(other.degree) + 8) {
            let (f, g) = (self.values(z), other.values(z));
            let w = w * weight(z);
            for (q, g) in g.iter().enumerate() {
                for (p, f) in f.iter().enumerate() {
                    integrals[(p, q)] += w * f * g;
                }
            }
        }
        integrals
    }

    /// The plain functions and their derivatives at `z`: polynomials of Legendre on one piece; on several, hats on the breaks
    /// and within each piece integrals of those polynomials, which vanish at its ends.
    fn plain(&self, z: f64) -> (Vec<f64>, Vec<f64>) {
        let pieces = self.breaks.len() - 1;
        let piece = self.breaks[1..pieces].partition_point(|end| *end <= z);
        let (from, to) = (self.breaks[piece], self.breaks[piece + 1]);
        let per_length = 2.0 / (to - from);
        let t = (z - from) * per_length - 1.0;
        let (mut of, mut slope) = (vec![0.0; self.degree + 1], vec![0.0; self.degree + 1]);
        legendre(t, &mut of, &mut slope);
        if pieces == 1 {
            slope.iter_mut().for_each(|s| *s *= per_length);
            return (of, slope);
        }
        let (mut values, mut slopes) = (vec![0.0; self.len()], vec![0.0; self.len()]);
        (values[piece], values[piece + 1]) = ((1.0 - t) / 2.0, (1.0 + t) / 2.0);
        (slopes[piece], slopes[piece + 1]) = (-per_length / 2.0, per_length / 2.0);
        let inner = pieces + 1 + piece * (self.degree - 1);
        for q in 2..=self.degree {
            values[inner + q - 2] = of[q] - of[q - 2];
            slopes[inner + q - 2] = (slope[q] - slope[q - 2]) * per_length;
        }
        (values, slopes)
    }

    fn mixed(&self, plain: &[f64]) -> Vec<f64> {
        let columns = self.mixing.col_iter();
        columns
            .map(|column| column.iter().zip(plain).map(|(m, f)| m * f).sum())
            .collect()
    }
}

/// A rule with the given number of points between each two of `ends`: places and weights.
fn rule(ends: &[f64], count: usize) -> Vec<(f64, f64)> {
    let rule = gauss_legendre(count);
    let pieces = ends.windows(2);
    pieces
        .flat_map(|ends| {
            let (middle, half) = (f64::midpoint(ends[0], ends[1]), (ends[1] - ends[0]) / 2.0);
            rule.iter().map(move |(x, w)| (middle + half * x, half * w))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bases() -> [AxialBasis; 3] {
        [
            AxialBasis::new(&[-10e-3, 10e-3], 8),
            AxialBasis::new(&[-10e-3, -5e-3, 10e-3], 4),
            AxialBasis::new(&[-10e-3, -2.5e-3, 2.5e-3, 10e-3], 4),
        ]
    }

    #[test]
    fn functions_are_orthonormal_and_hold_every_polynomial_of_their_degree() {
        for basis in bases() {
            let products = basis.integrals(&basis, |_| 1.0);
            let identity = Mat::<f64>::identity(basis.len(), basis.len());
            assert!((products - identity).norm_max() < 1e-12);
            for degree in 0..=4 {
                let of = |z: f64| (z / 10e-3).powi(degree);
                let shares: Vec<f64> = (0..basis.len())
                    .map(|p| {
                        let rule = basis.rule(12);
                        rule.iter()
                            .map(|(z, w)| w * of(*z) * basis.values(*z)[p])
                            .sum()
                    })
                    .collect();
                for z in [-10e-3, -6.1e-3, -2.5e-3, 0.3e-3, 5e-3, 10e-3] {
                    let found: f64 = basis
                        .values(z)
                        .iter()
                        .zip(&shares)
                        .map(|(f, s)| f * s)
                        .sum();
                    assert!((found - of(z)).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn slopes_are_those_of_the_values_and_values_do_not_jump() {
        for basis in bases() {
            let step = 1e-9;
            for z in [-9e-3, -3e-3, 1e-3, 7e-3] {
                let (up, down) = (basis.values(z + step), basis.values(z - step));
                for (slope, (up, down)) in basis.slopes(z).iter().zip(up.iter().zip(&down)) {
                    let difference = (up - down) / (2.0 * step);
                    assert!((slope - difference).abs() < 1e-5 * (1.0 + slope.abs()) + 1e-2);
                }
            }
            for &z in basis.breaks() {
                let (up, down) = (basis.values(z + 1e-15), basis.values(z - 1e-15));
                assert!(up.iter().zip(&down).all(|(a, b)| (a - b).abs() < 1e-7));
            }
        }
    }

    #[test]
    fn parts_integrate_by_parts() {
        // C + Cᵀ are the products at the ends.
        for basis in bases() {
            let AxialMatrices { slope, .. } = basis.matrices();
            let [low, high] = basis.heights().map(|z| basis.values(z));
            for p in 0..basis.len() {
                for q in 0..basis.len() {
                    let ends = high[p] * high[q] - low[p] * low[q];
                    let sum = slope[(p, q)] + slope[(q, p)];
                    assert!((sum - ends).abs() < 1e-9 * high[p].abs().max(1.0).powi(2) * 10.0);
                }
            }
        }
    }
}
