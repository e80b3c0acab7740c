//! Computation of the best turn of the driving gear's holes.
//!
//! Where both blanks repeat at one order, N_1/z_1 = N_2/z_2, they excite one line of the spectrum together, and a turn of the driving blank under its teeth
//! moves one of its two parts. Both parts are first-order terms ([`super::first_order`]), so that no turn has to be solved:
//!
//! ```text
//! δ(η, x) = δ_0(f) + T_1(f, N_1 x/2π + n ν) + T_2(η),   ν = N_1/z_1 = p/q,   η = n + f
//! ```
//!
//! T_1(f, u) is the addition of the driving holes at the fraction f of the mesh period where a hole has moved on by u hole pitches under the tooth. Its q teeth
//! are q places of u, and a blank turned by a part of their distance gives as many between them. Full solutions at the turn that is the best by these terms,
//! and half a hole pitch from it, tell what both parts are beyond the first order.

use std::f64::consts::TAU;

use super::AnalysisError;
use super::case::Case;
use super::curve::Curve;
use super::hole_phase::{AtTurn, HolePhase, PhasePlan};
use super::setup::Setup;
use super::turned_pair::TurnedPair;
use crate::contact::PairLoads;
use crate::fourier::harmonics;
use crate::gear::Member;

/// Harmonics of the hole order, at most, that are followed between these places.
const HARMONICS: usize = 24;

/// Turns over a hole pitch at which amplitude and peak-to-peak are given, and among which the best is looked for.
const TURNS: u32 = 36;

/// Steps of the golden section after which the turn is known to 1e-8 of a hole pitch.
const STEPS: u32 = 36;

impl PhasePlan {
    /// The best turn of the pair of `setup`, whose `curves` are known.
    pub(super) fn solve(
        &self,
        setup: Setup<'_>,
        curves: &[Curve],
    ) -> Result<Option<HolePhase>, AnalysisError> {
        let case = setup.case;
        let Some(amplitude_now) = self.amplitude_of(curves, case.span()) else {
            return Ok(None);
        };
        let hole_pitch = TAU / f64::from(case.pair.driving().hole_repeats());
        let terms = Terms::of(self, setup)?.corrected(self, setup)?;
        let best = terms.best();
        let mirrored = case.mirror_image_of_gears();
        let mirrored = Setup {
            case: &mirrored,
            ..setup
        };
        let other = Terms::of(self, mirrored)?.corrected(self, mirrored)?.best();
        let over_turn = (0..=TURNS).map(|i| {
            let place = f64::from(i) / f64::from(TURNS);
            let curve = terms.first_order.curve(place);
            let [low, high] = [f64::min, f64::max].map(|pick| curve.iter().copied().reduce(pick));
            AtTurn {
                turn: place * hole_pitch,
                amplitude: terms.amplitude(place),
                peak_to_peak: high.unwrap_or(0.0) - low.unwrap_or(0.0),
            }
        });
        Ok(Some(HolePhase {
            output_torque: self.output_torque,
            order: case.pair.driven().hole_repeats(),
            turn_of_driving: best * hole_pitch,
            amplitude: terms.amplitude(best),
            amplitude_now,
            // The mirror shows a turn the other way round.
            other_flanks_turn: (1.0 - other).fract() * hole_pitch,
            over_turn: over_turn.collect(),
        }))
    }

    /// The amplitude at the order of the holes of the curve under its torque, of `curves` over `span` mesh periods.
    fn amplitude_of(&self, curves: &[Curve], span: u32) -> Option<f64> {
        let mut curves = curves.iter();
        let curve = curves.find(|curve| curve.output_torque == self.output_torque)?;
        let [p, q] = self.ratio;
        let lines = &curve.spectrum.as_ref()?.transmission_error;
        lines.get((p * span / q) as usize - 1).copied()
    }

    /// By how much the line at the order of the holes is beyond the first order of `terms` with the driving blank turned by `place` hole pitches, by a full
    /// solution: the difference has no kinks of the mesh, so that few positions are enough.
    fn beyond(
        &self,
        terms: &Terms,
        place: f64,
        setup: Setup<'_>,
    ) -> Result<[f64; 2], AnalysisError> {
        let case = turned(setup.case, place);
        let pair = TurnedPair::new(Setup {
            case: &case,
            ..setup
        })?;
        let [first_order, full] = self.per_period;
        let positions: Vec<f64> = (0..self.ratio[1] * full)
            .map(|i| f64::from(i) / f64::from(full))
            .collect();
        let load = case.pair.load(self.output_torque);
        let exact = pair.on_blanks(load, &positions, setup.run)?;
        let curve = terms.curve(place);
        let known = curve.iter().step_by((first_order / full) as usize);
        let beyond: Vec<f64> = exact
            .iter()
            .zip(known)
            .map(|(exact, known)| exact - known)
            .collect();
        Ok(line(&beyond, self.ratio[0]))
    }
}

/// `case` with its driving blank turned by `place` hole pitches.
fn turned(case: &Case, place: f64) -> Case {
    let hole_pitch = TAU / f64::from(case.pair.driving().hole_repeats());
    case.with_driving_blank_turned(place * hole_pitch)
}

/// The transmission error of a pair at first order, whatever the turn of its driving blank.
struct Terms {
    ratio: [u32; 2],
    /// Values with the driven blank as it stands, and the mean addition of the driving one: period after period.
    still: Vec<f64>,
    /// Harmonics of T_1 over a hole pitch at each fraction of the mesh period: amplitudes and phases.
    driving: Vec<Vec<(f64, f64)>>,
}

impl Terms {
    /// Terms of the pair of `setup` under the torque of `plan`.
    fn of(plan: &PhasePlan, setup: Setup<'_>) -> Result<Self, AnalysisError> {
        let Setup { case, run, .. } = setup;
        let ([p, q], turns) = (plan.ratio, plan.turns());
        let pair = TurnedPair::new(setup)?;
        let per_period = plan.per_period[0];
        let fractions: Vec<f64> = (0..per_period)
            .map(|i| f64::from(i) / f64::from(per_period))
            .collect();
        let load = case.pair.load(plan.output_torque);
        let solved = pair.on_round_blanks(load, &fractions, run)?;
        let places = (q * turns) as usize;
        // T_1 at u = j/(q turns) hole pitches: the tooth n stands n ν on from tooth 0, a turned blank by less than 1/q.
        let mut driving = vec![vec![0.0; places]; solved.len()];
        for turn in 0..turns {
            let of_turn;
            let turned = if turn == 0 {
                &pair
            } else {
                let case = turned(case, f64::from(turn) / places as f64);
                of_turn = TurnedPair::new(Setup {
                    case: &case,
                    ..setup
                })?;
                &of_turn
            };
            for ((_, loads), values) in solved.iter().zip(&mut driving) {
                let alike = pair.added_round(Member::Driving, loads);
                for n in 0..q {
                    let place = turn + turns * (n * p % q);
                    let own = turned.added(Member::Driving, loads, n);
                    values[place as usize] = own - alike;
                }
            }
        }
        let driven = |loads: &[PairLoads], n: u32| {
            pair.added(Member::Driven, loads, n) - pair.added_round(Member::Driven, loads)
        };
        let means: Vec<f64> = driving
            .iter()
            .map(|values| values.iter().sum::<f64>() / places as f64)
            .collect();
        let still = (0..q).flat_map(|n| {
            solved
                .iter()
                .zip(&means)
                .map(move |((delta, loads), mean)| delta + mean + driven(loads, n))
        });
        Ok(Self {
            ratio: plan.ratio,
            still: still.collect(),
            driving: driving
                .iter()
                .map(|values| {
                    let mut lines = harmonics(values);
                    lines.truncate(HARMONICS);
                    lines
                })
                .collect(),
        })
    }

    /// δ over q mesh periods with the driving blank turned by `place` hole pitches.
    fn curve(&self, place: f64) -> Vec<f64> {
        let [p, q] = self.ratio.map(f64::from);
        let per_period = self.driving.len();
        let at = |(i, still): (usize, &f64)| {
            let n = (i / per_period) as f64;
            let u = place + n * p / q;
            let lines = self.driving[i % per_period].iter().zip(1_u32..);
            let moved = lines
                .map(|((amplitude, phase), k)| amplitude * (TAU * f64::from(k) * u + phase).cos());
            still + moved.sum::<f64>()
        };
        self.still.iter().enumerate().map(at).collect()
    }

    /// Cosine and sine of this curve at the order of the holes.
    fn line(&self, place: f64) -> [f64; 2] {
        line(&self.curve(place), self.ratio[0])
    }

    /// These with what full solutions say of both parts, under the torque of `plan`.
    fn corrected(self, plan: &PhasePlan, setup: Setup<'_>) -> Result<Corrected, AnalysisError> {
        let at = best(|place| size(self.line(place)));
        let here = plan.beyond(&self, at, setup)?;
        let opposite = plan.beyond(&self, (at + 0.5).fract(), setup)?;
        Ok(Corrected {
            at,
            still: [0, 1].map(|i| f64::midpoint(here[i], opposite[i])),
            moving: [0, 1].map(|i| (here[i] - opposite[i]) / 2.0),
            first_order: self,
        })
    }
}

/// Terms of first order, with what is beyond it at the order of the holes: a part that stands still, and one that turns with the driving blank.
struct Corrected {
    first_order: Terms,
    still: [f64; 2],
    /// Where the driving blank is turned by `at` hole pitches.
    moving: [f64; 2],
    at: f64,
}

impl Corrected {
    /// The amplitude at the order of the holes with the driving blank turned by `place` hole pitches.
    fn amplitude(&self, place: f64) -> f64 {
        let [x, y] = self.first_order.line(place);
        // cos(θ + φ) of a further turn φ has the cosine cos φ and the sine −sin φ.
        let (sin, cos) = (TAU * (place - self.at)).sin_cos();
        let [a, b] = self.moving;
        size([
            x + self.still[0] + a * cos + b * sin,
            y + self.still[1] + b * cos - a * sin,
        ])
    }

    /// The place of a hole pitch, from 0 to 1, at which the amplitude is least.
    fn best(&self) -> f64 {
        best(|place| self.amplitude(place))
    }
}

/// The place of a hole pitch, from 0 to 1, at which the `amplitude` is least.
fn best(amplitude: impl Fn(f64) -> f64) -> f64 {
    let step = 1.0 / f64::from(TURNS);
    let places = (0..TURNS).map(|i| f64::from(i) * step);
    let known = places.map(|place| (place, amplitude(place)));
    let (middle, _) = known
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((0.0, 0.0));
    let golden = (5_f64.sqrt() - 1.0) / 2.0;
    let [mut low, mut high] = [middle - step, middle + step];
    for _ in 0..STEPS {
        let part = golden * (high - low);
        if amplitude(high - part) < amplitude(low + part) {
            high = low + part;
        } else {
            low = high - part;
        }
    }
    ((low + high) / 2.0).rem_euclid(1.0)
}

/// The amplitude of a line by its cosine and sine.
fn size([cosine, sine]: [f64; 2]) -> f64 {
    cosine.hypot(sine)
}

/// Cosine and sine of `values`, at equal steps over a period, that repeat `times` in it.
fn line(values: &[f64], times: u32) -> [f64; 2] {
    let turn = TAU * f64::from(times) / values.len() as f64;
    let share = 2.0 / values.len() as f64;
    let part = |of: fn(f64) -> f64| -> f64 {
        let each = values.iter().enumerate();
        each.map(|(i, value)| share * value * of(turn * i as f64))
            .sum()
    };
    [part(f64::cos), part(f64::sin)]
}
