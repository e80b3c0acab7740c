//! Results of single-flank testing from a transmission error, by the terms of ISO/TR 10064-1.

use std::collections::VecDeque;

use super::between::Sections;
use super::long_wave::LongWave;

/// Places in a mesh period, at least, between which δ is taken as straight.
const TRACED: usize = 400;

/// Parts of δ by their wavelength, in meters. Parts that the span does not contain are `None`: all but the first need whole true periods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SingleFlank {
    /// f_i′, the largest range in any stretch of one mesh period.
    pub tooth_to_tooth: f64,
    /// f_l′, the peak-to-peak of the part with fewer than half a cycle in a mesh period.
    pub long_wave: Option<f64>,
    /// f_k′, the peak-to-peak of the rest.
    pub short_wave: Option<f64>,
    /// The root mean square of the harmonics of the mesh.
    pub mesh_harmonics_rms: Option<f64>,
}

impl SingleFlank {
    /// Parts of the curve of `sections`; `resampled` is δ at equal steps over it, as many in each mesh period, where it is whole true periods.
    pub(super) fn of(sections: &Sections, resampled: Option<&[f64]>) -> Self {
        let traced = sections.traced(TRACED);
        let periods = sections.periods();
        let [long_wave, short_wave, mesh_harmonics_rms] = match resampled {
            None => [None; 3],
            Some(delta) => {
                let long = LongWave::of(delta, traced[0].0, periods as u32);
                let short = traced.iter().map(|&(x, value)| value - long.at(x));
                let short = range(short);
                [long.range(), short, repeating_rms(delta, periods as usize)].map(Some)
            }
        };
        Self {
            tooth_to_tooth: range_within_a_period(&traced, resampled.map(|_| periods)),
            long_wave,
            short_wave,
            mesh_harmonics_rms,
        }
    }
}

/// The largest less the smallest.
fn range(values: impl Iterator<Item = f64>) -> f64 {
    let ends = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    ends.1 - ends.0
}

/// The root mean square of the part of `values` that repeats with each of their `periods`: all harmonics of the mesh together.
fn repeating_rms(values: &[f64], periods: usize) -> f64 {
    let each = values.len() / periods;
    let means: Vec<f64> = (0..each)
        .map(|i| values[i..].iter().step_by(each).sum::<f64>() / periods as f64)
        .collect();
    let mean = means.iter().sum::<f64>() / each as f64;
    let square = means
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / each as f64;
    square.sqrt()
}

/// The largest range of the rising places and values `traced` in any stretch of one mesh period; the curve may repeat after `repeats` of them.
fn range_within_a_period(traced: &[(f64, f64)], repeats: Option<f64>) -> f64 {
    /// Loss in the digits of a place.
    const ROUNDING: f64 = 1e-9;
    let first = traced.first().map_or(0.0, |first| first.0);
    let again = repeats.into_iter().flat_map(|periods| {
        let head = traced.iter().take_while(move |(x, _)| *x <= first + 1.0);
        head.map(move |&(x, value)| (x + periods, value))
    });
    // Of the stretch that ends at a place, the values that no later one hides: the least and the largest of them come first.
    let mut hidden: [VecDeque<(f64, f64)>; 2] = Default::default();
    let mut largest: f64 = 0.0;
    for (x, value) in traced.iter().copied().chain(again) {
        for (known, sign) in hidden.iter_mut().zip([1.0, -1.0]) {
            while known
                .back()
                .is_some_and(|back| sign * back.1 >= sign * value)
            {
                known.pop_back();
            }
            known.push_back((x, value));
            while known
                .front()
                .is_some_and(|front| front.0 < x - 1.0 - ROUNDING)
            {
                known.pop_front();
            }
        }
        if let [Some(low), Some(high)] = [hidden[0].front(), hidden[1].front()] {
            largest = largest.max(high.1 - low.1);
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::analysis::between::{PairState, Sample, Span};

    /// Single-flank test of `curve` over `periods` mesh periods, after which it repeats or not.
    fn single_flank(curve: impl Fn(f64) -> f64, periods: u32, closes: bool) -> SingleFlank {
        const PER_PERIOD: u32 = 200;
        let span = Span::new(0.0, periods, PER_PERIOD, closes);
        let samples: Vec<Sample> = (0..periods * PER_PERIOD)
            .map(|i| {
                let position = f64::from(i) / f64::from(PER_PERIOD);
                // Two pairs carry, each up to a mesh period from the pitch point.
                let pair = |n: f64| PairState {
                    pair: n as i64,
                    share: 1.0 - (position - n).abs(),
                    clearance: None,
                };
                Sample {
                    position,
                    transmission_error: curve(position),
                    stiffness: 1.0,
                    driving_load: 1.0,
                    pairs: [position.floor(), position.floor() + 1.0]
                        .map(pair)
                        .to_vec(),
                }
            })
            .collect();
        let sections = Sections::new(span, &samples);
        let resampled = closes.then(|| {
            let [delta, _] = sections.resampled(TRACED * periods as usize);
            delta
        });
        SingleFlank::of(&sections, resampled.as_deref())
    }

    fn assert_near(value: impl Into<Option<f64>>, expected: f64, what: &str) {
        let value = value.into().expect(what);
        // Where pairs change, sections through 200 positions in a period err by up to a twentieth of the change of the curve in a step, and lines between 400
        // places in a period by less.
        assert!(
            (value - expected).abs() < 1e-3,
            "{what}: {value}, not {expected}"
        );
    }

    #[test]
    fn a_runout_and_a_wave_of_the_mesh_are_told_apart() {
        // Ten mesh periods: A once in all of them, B in each.
        let (a, b) = (3.0, 0.5);
        let found = single_flank(
            |x| 7.0 + a * (TAU * x / 10.0).sin() + b * (TAU * x).cos(),
            10,
            true,
        );
        assert_near(found.long_wave, 2.0 * a, "long wave");
        assert_near(found.short_wave, 2.0 * b, "short wave");
        assert_near(found.mesh_harmonics_rms, b / 2_f64.sqrt(), "harmonics");
    }

    #[test]
    fn a_runout_alone_changes_from_tooth_to_tooth_by_its_chord() {
        // sin over a stretch of s about its steepest place: 2 A sin(π s/P).
        let found = single_flank(|x| 3.0 * (TAU * x / 10.0).sin(), 10, true);
        let chord = 6.0 * (TAU / 20.0).sin();
        assert_near(found.tooth_to_tooth, chord, "tooth to tooth");
        assert_near(found.short_wave, 0.0, "short wave");
        assert_near(found.mesh_harmonics_rms, 0.0, "harmonics");
        // The steepest place of this one is where the curve begins and ends.
        let steep = single_flank(|x| 3.0 * (TAU * (x + 0.25) / 10.0).sin(), 10, true);
        assert_near(steep.tooth_to_tooth, chord, "over the end");
    }

    #[test]
    fn a_wave_of_half_a_cycle_a_mesh_period_is_a_short_one_and_the_next_slower_is_long() {
        let half = single_flank(|x| (TAU * x / 2.0).sin(), 10, true);
        assert_near(half.long_wave, 0.0, "half a cycle");
        assert_near(half.short_wave, 2.0, "half a cycle");
        assert_near(half.tooth_to_tooth, 2.0, "from crest to trough in a period");
        let slower = single_flank(|x| (TAU * 4.0 * x / 10.0).sin(), 10, true);
        assert_near(slower.long_wave, 2.0, "four tenths");
        assert_near(slower.short_wave, 0.0, "four tenths");
        assert_near(slower.mesh_harmonics_rms, 0.0, "four tenths");
    }

    #[test]
    fn a_curve_that_repeats_with_the_mesh_is_short_and_all_of_it_is_tooth_to_tooth() {
        let found = single_flank(|x| (TAU * x).sin() + 0.25 * (2.0 * TAU * x).cos(), 1, true);
        // Crests where cos x (1 − sin x) = 0: from −1.25 at 3π/2 to 0.75 at π/2.
        assert_near(found.tooth_to_tooth, 2.0, "tooth to tooth");
        assert_eq!(found.long_wave, Some(0.0));
        assert_near(found.short_wave, 2.0, "short wave");
        let rms = (0.5 + 0.25_f64.powi(2) / 2.0).sqrt();
        assert_near(found.mesh_harmonics_rms, rms, "harmonics");
    }

    #[test]
    fn a_part_of_a_true_period_tells_ranges_within_a_mesh_period_alone() {
        let found = single_flank(|x| 3.0 * (TAU * (x + 2.0) / 10.0).sin(), 3, false);
        // From 2 to 5: the steepest stretch is the last, about the zero at 5, of which half is beyond the end.
        let part = |x: f64| 3.0 * (TAU * x / 10.0).sin();
        let last = 5.0 - 1.0 / 200.0;
        assert_near(
            found.tooth_to_tooth,
            part(last - 1.0) - part(last),
            "tooth to tooth",
        );
        assert_eq!(
            [found.long_wave, found.short_wave, found.mesh_harmonics_rms],
            [None; 3]
        );
    }
}
