//! The part of δ that repeats with every mesh period, estimated from a window of a longer true period.

use std::f64::consts::TAU;

use super::between::Sections;
use super::case::Case;
use super::load_share::LoadShare;
use super::pair_springs::PairSprings;
use crate::fourier::harmonics;

/// Places in a mesh period at which the wave is known.
const PLACES: usize = 400;

/// The mean of δ over all mesh periods of the true period at each fraction of one, estimated from a window.
///
/// Pitch deviations, runout and slopes of single teeth leak from a window into the orders of the mesh. `PairSprings` fitted to the window give their part of δ
/// in closed form, in the window and over the true period. The wave is the mean over the window of the rest of δ, and the mean over the true period of their
/// part. The former is taken with the weights 1 − cos, which hide all but the multiples of the mesh order.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshWave {
    /// In meters, at equal steps of the fraction of the mesh period.
    values: Vec<f64>,
}

impl MeshWave {
    /// Wave of the curve of `sections` of `case`, which runs over one window under `load`, with δ and the `load_shares` at its positions.
    pub(super) fn of(
        (case, load): (&Case, f64),
        sections: &Sections,
        (transmission_error, load_shares): (&[f64], &[LoadShare]),
    ) -> Self {
        let periods = case.span() as usize;
        let [mut delta, _] = sections.resampled(PLACES * periods);
        let mut wave = vec![0.0; PLACES];
        let deviations = case.pair.deviations();
        if !deviations.are_none() {
            let springs =
                PairSprings::of((case, load), &deviations, (transmission_error, load_shares));
            let own = springs.in_window();
            wave = resampled(&springs.over_true_period(), 1);
            let own = resampled(&own, periods);
            delta
                .iter_mut()
                .zip(own)
                .for_each(|(delta, own)| *delta -= own);
        }
        let weight = |i: usize| match periods {
            1 => 1.0,
            _ => 1.0 - (TAU * i as f64 / delta.len() as f64).cos(),
        };
        for (fraction, value) in wave.iter_mut().enumerate() {
            let places = (fraction..delta.len()).step_by(PLACES);
            let sums = places.map(|i| (weight(i) * delta[i], weight(i)));
            let (values, weights) = sums.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            *value += values / weights;
        }
        Self { values: wave }
    }

    /// The mean of some; `None` of none.
    pub(super) fn mean<'a>(waves: impl Iterator<Item = &'a Self>) -> Option<Self> {
        let mut count = 0;
        let mut values = vec![0.0; PLACES];
        for wave in waves {
            count += 1;
            let both = values.iter_mut().zip(&wave.values);
            both.for_each(|(sum, value)| *sum += value);
        }
        values.iter_mut().for_each(|sum| *sum /= f64::from(count));
        (count > 0).then_some(Self { values })
    }

    /// Amplitudes of the harmonics 1, 2, … of the mesh, in meters.
    pub fn amplitudes(&self) -> Vec<f64> {
        let lines = harmonics(&self.values).into_iter();
        lines.map(|(amplitude, _)| amplitude).collect()
    }

    /// The root mean square of all harmonics, in meters.
    pub fn rms(&self) -> f64 {
        let count = self.values.len() as f64;
        let mean = self.values.iter().sum::<f64>() / count;
        let squares = self.values.iter().map(|value| (value - mean).powi(2));
        (squares.sum::<f64>() / count).sqrt()
    }
}

/// `values` at equal steps over a number of mesh periods, on straight lines at the places of a wave; the last one is followed by the first.
fn resampled(values: &[f64], periods: usize) -> Vec<f64> {
    let count = PLACES * periods;
    let step = values.len() as f64 / count as f64;
    let at = |i: usize| {
        let place = i as f64 * step;
        let (before, part) = (place as usize, place.fract());
        let [from, to] = [0, 1].map(|next| values[(before + next) % values.len()]);
        from + part * (to - from)
    };
    (0..count).map(at).collect()
}
