//! The evolution strategy that adapts its covariance (CMA-ES; Hansen, "The CMA evolution strategy: a tutorial", 2016), in the unit cube.
//!
//! The caller reports the points that were computed, which need not be the points that were asked for: points outside the cube are moved to its border, and the
//! caller may move others. Steps longer than the law would make them are shortened (Hansen, "Injecting external solutions into CMA-ES", 2011).

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::optimum::chance::Chance;

/// One descent.
pub(crate) struct Cmaes {
    /// Points of a generation.
    size: usize,
    /// Of the better half, from the best on; together 1.
    weights: Vec<f64>,
    rates: Rates,
    mean: DVector<f64>,
    /// σ.
    step: f64,
    /// C = B D² Bᵀ, with the axes B and the lengths D.
    covariance: DMatrix<f64>,
    axes: DMatrix<f64>,
    lengths: DVector<f64>,
    /// The paths of the covariance and of the step.
    path: DVector<f64>,
    step_path: DVector<f64>,
    generation: i32,
}

/// How fast it learns, by the formulas of the tutorial.
struct Rates {
    /// μ_eff.
    effective: f64,
    path: f64,
    step_path: f64,
    rank_one: f64,
    rank_mu: f64,
    damping: f64,
    /// The usual length of a standard normal vector.
    usual: f64,
}

impl Rates {
    fn new(axes: f64, weights: &[f64]) -> Self {
        let effective = 1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>();
        let rank_one = 2.0 / ((axes + 1.3).powi(2) + effective);
        let rank_mu =
            2.0 * (effective - 2.0 + 1.0 / effective) / ((axes + 2.0).powi(2) + effective);
        let step_path = (effective + 2.0) / (axes + effective + 5.0);
        let beyond = ((effective - 1.0) / (axes + 1.0)).sqrt() - 1.0;
        Self {
            effective,
            path: (4.0 + effective / axes) / (axes + 4.0 + 2.0 * effective / axes),
            step_path,
            rank_one,
            rank_mu: rank_mu.min(1.0 - rank_one),
            damping: 1.0 + 2.0 * beyond.max(0.0) + step_path,
            usual: axes.sqrt() * (1.0 - 1.0 / (4.0 * axes) + 1.0 / (21.0 * axes * axes)),
        }
    }
}

impl Cmaes {
    /// A descent from the point `from`, that first looks about as far as `step`, with `size` points in a generation.
    pub(crate) fn new(from: &[f64], step: f64, size: usize) -> Self {
        let axes = from.len();
        let better = size / 2;
        let weights =
            (1..=better).map(|i| libm::log((size as f64 + 1.0) / 2.0) - libm::log(i as f64));
        let weights: Vec<f64> = weights.collect();
        let sum: f64 = weights.iter().sum();
        let weights: Vec<f64> = weights.iter().map(|weight| weight / sum).collect();
        Self {
            size,
            rates: Rates::new(axes as f64, &weights),
            weights,
            mean: DVector::from_column_slice(from),
            step,
            covariance: DMatrix::identity(axes, axes),
            axes: DMatrix::identity(axes, axes),
            lengths: DVector::from_element(axes, 1.0),
            path: DVector::zeros(axes),
            step_path: DVector::zeros(axes),
            generation: 0,
        }
    }

    /// The points of the next generation.
    pub(crate) fn ask(&self, chance: &mut Chance) -> Vec<Vec<f64>> {
        let one = |_| {
            let drawn = DVector::from_fn(self.mean.len(), |i, _| chance.normal() * self.lengths[i]);
            let point = &self.mean + self.step * (&self.axes * drawn);
            point.iter().map(|u| u.clamp(0.0, 1.0)).collect()
        };
        (0..self.size).map(one).collect()
    }

    /// Takes the `merits` of the generation's points, which are to be small.
    pub(crate) fn tell(&mut self, points: &[Vec<f64>], merits: &[f64]) {
        let rates = &self.rates;
        let axes = self.mean.len() as f64;
        let longest = axes.sqrt() + 2.0 * axes / (axes + 2.0);
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|i, j| merits[*i].total_cmp(&merits[*j]).then(i.cmp(j)));
        let steps: Vec<DVector<f64>> = order[..self.weights.len()]
            .iter()
            .map(|i| {
                let step = (DVector::from_column_slice(&points[*i]) - &self.mean) / self.step;
                let length = self.whitened(&step).norm();
                step * (longest / length).min(1.0)
            })
            .collect();
        let mut moved = DVector::zeros(self.mean.len());
        for (weight, step) in self.weights.iter().zip(&steps) {
            moved += *weight * step;
        }
        self.mean += self.step * &moved;
        self.generation += 1;
        let kept = (rates.step_path * (2.0 - rates.step_path) * rates.effective).sqrt();
        self.step_path = (1.0 - rates.step_path) * &self.step_path + kept * self.whitened(&moved);
        let length = self.step_path.norm();
        let grown = 1.0 - (1.0 - rates.step_path).powi(2 * self.generation);
        let is_short = length / grown.sqrt() < (1.4 + 2.0 / (axes + 1.0)) * rates.usual;
        let kept = (rates.path * (2.0 - rates.path) * rates.effective).sqrt();
        self.path *= 1.0 - rates.path;
        if is_short {
            self.path += kept * &moved;
        }
        let lost = if is_short {
            0.0
        } else {
            rates.rank_one * rates.path * (2.0 - rates.path)
        };
        self.covariance *= 1.0 - rates.rank_one - rates.rank_mu + lost;
        self.covariance += rates.rank_one * &self.path * self.path.transpose();
        for (weight, step) in self.weights.iter().zip(&steps) {
            self.covariance += rates.rank_mu * *weight * step * step.transpose();
        }
        let growth = rates.step_path / rates.damping * (length / rates.usual - 1.0);
        self.step *= libm::exp(growth.min(1.0));
        self.factorize();
    }

    /// D⁻¹ Bᵀ `step`, turned back: C^(−1/2) of it.
    fn whitened(&self, step: &DVector<f64>) -> DVector<f64> {
        let within = self.axes.tr_mul(step).component_div(&self.lengths);
        &self.axes * within
    }

    fn factorize(&mut self) {
        /// No axis is shorter than so much of the longest one.
        const SHORTEST: f64 = 1e-7;
        let found = SymmetricEigen::new(self.covariance.clone());
        let longest = found.eigenvalues.max().max(f64::MIN_POSITIVE).sqrt();
        self.lengths = found
            .eigenvalues
            .map(|value| value.max(0.0).sqrt().max(SHORTEST * longest));
        self.axes = found.eigenvectors;
    }
}
