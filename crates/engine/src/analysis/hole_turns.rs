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

use faer::c64;

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
        let amplitude = terms.amplitudes();
        let turn = best(&amplitude);
        let mirrored = case.mirror_image_of_gears();
        let mirrored = Setup {
            case: &mirrored,
            ..setup
        };
        let other = Terms::of(self, mirrored)?.corrected(self, mirrored)?;
        let other_turn = best(other.amplitudes());
        let over_turn = (0..=TURNS).map(|i| {
            let place = f64::from(i) / f64::from(TURNS);
            let curve = terms.first_order.curve(place);
            let [low, high] = [f64::min, f64::max].map(|pick| curve.iter().copied().reduce(pick));
            AtTurn {
                turn: place * hole_pitch,
                amplitude: amplitude(place),
                peak_to_peak: high.unwrap_or(0.0) - low.unwrap_or(0.0),
            }
        });
        Ok(Some(HolePhase {
            output_torque: self.output_torque,
            order: case.pair.driven().hole_repeats(),
            turn_of_driving: turn * hole_pitch,
            amplitude: amplitude(turn),
            amplitude_now,
            // The mirror shows a turn the other way round.
            other_flanks_turn: (1.0 - other_turn).fract() * hole_pitch,
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
    fn beyond(&self, terms: &Terms, place: f64, setup: Setup<'_>) -> Result<c64, AnalysisError> {
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
        let exact = pair.transmission_errors(load, &positions, setup.run)?;
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
    /// Harmonics of T_1 over a hole pitch at each fraction of the mesh period: c_k from k = 1 on, T_1 = Re Σ c_k e^(2πi k u).
    driving: Vec<Vec<c64>>,
}

impl Terms {
    /// Terms of the pair of `setup` under the torque of `plan`.
    fn of(plan: &PhasePlan, setup: Setup<'_>) -> Result<Self, AnalysisError> {
        let Setup { case, run, .. } = setup;
        let ([p, q], turns) = (plan.ratio, plan.turns());
        let [pair, round] = TurnedPair::with_round(setup)?;
        let per_period = plan.per_period[0];
        let fractions: Vec<f64> = (0..per_period)
            .map(|i| f64::from(i) / f64::from(per_period))
            .collect();
        let load = case.pair.load(plan.output_torque);
        let solved = round.with_loads(load, &fractions, run)?;
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
                let mean = round.yielded(Member::Driving, loads, 0);
                for n in 0..q {
                    let place = turn + turns * (n * p % q);
                    let own = turned.yielded(Member::Driving, loads, n);
                    values[place as usize] = own - mean;
                }
            }
        }
        let driven = |loads: &[PairLoads], n: u32| {
            pair.yielded(Member::Driven, loads, n) - round.yielded(Member::Driven, loads, 0)
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
                    let lines = harmonics(values).into_iter().take(HARMONICS);
                    lines
                        .map(|(amplitude, phase)| c64::from_polar(amplitude, phase))
                        .collect()
                })
                .collect(),
        })
    }

    /// δ over q mesh periods with the driving blank turned by `place` hole pitches.
    fn curve(&self, place: f64) -> Vec<f64> {
        let [p, q] = self.ratio.map(f64::from);
        let per_period = self.driving.len();
        let periods = self.still.chunks(per_period).zip(0_u32..);
        let moved = periods.flat_map(|(still, n)| {
            let around = c64::from_polar(1.0, TAU * (place + f64::from(n) * p / q));
            let each = still.iter().zip(&self.driving);
            each.map(move |(still, lines)| {
                let next = |sum: c64, line: &c64| (sum + line) * around;
                still + lines.iter().rev().fold(c64::ZERO, next).re
            })
        });
        moved.collect()
    }

    /// The line of this curve at the order of the holes, place by place.
    ///
    /// Its value is Σ δ e^(−2πi p x/q) over its positions x = n + f. Over n the part of c_k adds up only where k ± 1 is a multiple of q.
    fn lines(&self) -> impl Fn(f64) -> c64 + use<> {
        let [p, q] = self.ratio;
        let per_period = self.driving.len();
        let step = TAU * f64::from(p) / (f64::from(q) * per_period as f64);
        let still = line(&self.still, p);
        let most = self.driving.iter().map(Vec::len).max().unwrap_or(0);
        let parts = (1..=most as u32).map(|k| {
            let [forwards, backwards] =
                [k.abs_diff(1), k + 1].map(|beside| f64::from(beside.is_multiple_of(q)));
            let each = self.driving.iter().enumerate();
            let [one, other] = each.fold([c64::ZERO; 2], |[one, other], (i, lines)| {
                let c = lines.get(k as usize - 1).copied().unwrap_or(c64::ZERO);
                let weight = c64::from_polar(1.0 / per_period as f64, -step * i as f64);
                [one + c * weight, other + c.conj() * weight]
            });
            [one * forwards, other * backwards]
        });
        let parts: Vec<[c64; 2]> = parts.collect();
        move |place| {
            let around = c64::from_polar(1.0, TAU * place);
            let sum = |around: c64, of: usize| {
                let parts = parts.iter().rev();
                parts.fold(c64::ZERO, |sum, part| (sum + part[of]) * around)
            };
            still + sum(around, 0) + sum(around.conj(), 1)
        }
    }

    /// These with what full solutions say of both parts, under the torque of `plan`.
    fn corrected(self, plan: &PhasePlan, setup: Setup<'_>) -> Result<Corrected, AnalysisError> {
        let lines = self.lines();
        let at = best(|place| lines(place).norm());
        let here = plan.beyond(&self, at, setup)?;
        let opposite = plan.beyond(&self, (at + 0.5).fract(), setup)?;
        Ok(Corrected {
            at,
            still: (here + opposite) / 2.0,
            moving: (here - opposite) / 2.0,
            first_order: self,
        })
    }
}

/// Terms of first order, with what is beyond it at the order of the holes: a part that stands still, and one that turns with the driving blank.
struct Corrected {
    first_order: Terms,
    still: c64,
    /// Where the driving blank is turned by `at` hole pitches.
    moving: c64,
    at: f64,
}

impl Corrected {
    /// The amplitude at the order of the holes, by the hole pitches by which the driving blank is turned.
    fn amplitudes(&self) -> impl Fn(f64) -> f64 {
        let lines = self.first_order.lines();
        move |place| {
            let moved = self.moving * c64::from_polar(1.0, TAU * (place - self.at));
            (lines(place) + self.still + moved).norm()
        }
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

/// The line of `values`, at equal steps over a period, that repeats `times` in it: its amplitude and phase.
fn line(values: &[f64], times: u32) -> c64 {
    let turn = -TAU * f64::from(times) / values.len() as f64;
    let share = 2.0 / values.len() as f64;
    let each = values.iter().enumerate();
    each.map(|(i, value)| c64::from_polar(share * value, turn * i as f64))
        .sum()
}
