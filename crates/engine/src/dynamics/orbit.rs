//! Periodic motions: Newton's method on the state after a period, stability by multipliers, and where a motion settles.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Dyn, LU, Schur};

use super::coupled::CoupledMotion;
use super::oscillator::{Oscillator, PeriodExtremes, State};

/// Newton steps before there is taken to be no periodic motion near.
const MOST_STEPS: u32 = 16;

/// Displacements and velocities of a system whose derivative costs little beside its motion.
const FEW: usize = 2;

/// The part of its last step by which a derivative has to shorten the next one to serve again.
const SERVES: f64 = 0.2;

/// A derivative that was taken with a step of this size left, over the scale of the motion, is that of the periodic motion.
const ALIKE: f64 = 1e-6;

/// After a step below this the next one is below [`ALIKE`], as a rule.
const NEARLY_ALIKE: f64 = 10.0 * ALIKE;

/// Largest difference between the end and the beginning of a periodic motion, over the scale of the motion.
const CLOSED: f64 = 1e-11;

/// Maximum number of periods after which a motion repeats.
const MOST_PERIODS: u32 = 8;

/// Time constants of free motion after which it has died away, at first and where that was not enough.
pub(super) const SETTLED: [f64; 2] = [30.0, 200.0];

/// Time constants over which a motion that does not repeat is looked at.
pub(super) const WATCHED: f64 = 60.0;

/// Looks that one of these may take, so that a mesh far above its natural frequency, or hardly damped, keeps nobody waiting.
pub(super) const MOST_LOOKS: f64 = 1e6;

/// How far, over the scale of the motion, a periodic motion may stand from where the last one stood to be its continuation.
const NEAR: f64 = 0.1;

/// Farther from where the last one stood a search for it has gone astray, as Newton's method may step over a motion by a few times its distance.
const ASTRAY: f64 = 3.0 * NEAR;

/// A motion that is so many times the scale has run away: the mesh gives it more energy than damping takes.
const RUN_AWAY: f64 = 1e3;

/// Steps of the search for the multipliers of a system of several masses.
const MOST_SCHUR_STEPS: usize = 1000;

/// Where a motion has come to.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    /// The state at the beginning of a period; an empty one is at rest.
    pub state: Vec<f64>,
    /// The periods after which the motion repeats; `None` where it was not found to.
    pub repeats: Option<u32>,
    /// The periods to look at.
    pub periods: u32,
    /// The modulus of the largest multiplier; infinite where the motion was not found to repeat.
    pub multiplier: f64,
    /// True if the motion grows without bound.
    pub runs_away: bool,
    /// The derivative of the state after it repeats to that before, where it was found to.
    pub derivative: Option<Arc<Derivative>>,
}

impl Orbit {
    /// At rest.
    pub const REST: Self = Self {
        state: Vec::new(),
        repeats: Some(1),
        periods: 1,
        multiplier: 0.0,
        runs_away: false,
        derivative: None,
    };
}

/// Scales of displacements and of velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Of u.
    pub u: f64,
    /// Of u'.
    pub v: f64,
}

impl Scale {
    /// True if a motion that reaches `u` has run away.
    pub fn is_left_by(&self, u: f64) -> bool {
        u.is_nan() || u.abs() > RUN_AWAY * self.u
    }
}

/// The derivative of a state to an earlier one, column by column.
pub type Derivative = Vec<Vec<f64>>;

/// The modulus of the largest multiplier of a derivative.
pub fn multiplier(derivative: &Derivative) -> f64 {
    let size = derivative.len();
    if size > 2 {
        let matrix = DMatrix::from_fn(size, size, |i, j| derivative[j][i]);
        let schur = Schur::try_new(matrix, f64::EPSILON, MOST_SCHUR_STEPS);
        return schur.map_or(f64::INFINITY, |schur| {
            let all = schur.complex_eigenvalues();
            all.iter().map(|value| value.norm()).fold(0.0, f64::max)
        });
    }
    let m = derivative;
    let (trace, determinant) = (m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]);
    let under = trace * trace / 4.0 - determinant;
    if under < 0.0 {
        determinant.sqrt()
    } else {
        trace.abs() / 2.0 + under.sqrt()
    }
}

/// Something that moves by laws which repeat after a period.
pub trait Repeating {
    /// The number of its displacements and velocities.
    fn size(&self) -> usize;

    /// How large each of them is where the approach of the gears and its velocity are as large as `scale`.
    fn scales(&self, scale: Scale) -> Vec<f64>;

    /// The time in s in which free motion falls by a factor e.
    fn decay(&self) -> f64;

    /// The number of steps in a period, the duration of each in s, and the looks in each.
    fn steps(&self) -> (usize, f64, u32);

    /// The period in s, and the looks in it.
    fn period(&self) -> (f64, f64) {
        let (count, duration, looks) = self.steps();
        (duration * count as f64, f64::from(looks) * count as f64)
    }

    /// Carries `state` over a period, and each column of `derivative` as a small difference of it; `see` gets the states on the way.
    fn over_period(
        &self,
        state: &mut Vec<f64>,
        derivative: Option<&mut Derivative>,
        see: &mut dyn FnMut(PeriodExtremes),
    );

    /// The motion near `start` that repeats after `repeats` periods, stable or not.
    fn periodic(&self, start: &[f64], repeats: u32, scale: Scale) -> Option<Orbit> {
        self.periodic_within(f64::INFINITY, (start, None), repeats, scale)
    }

    /// The same if it is found within `reach` of `start`. The derivative of a motion nearby stands in for that of `start`, where there is one.
    fn periodic_within(
        &self,
        reach: f64,
        (start, nearby): (&[f64], Option<&Derivative>),
        repeats: u32,
        scale: Scale,
    ) -> Option<Orbit> {
        let size = self.size();
        let scales = self.scales(scale);
        let mut state = start.to_vec();
        let mut known = nearby.map(Known::of_nearby);
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let mut end = state.clone();
            let mut derivative = known.is_none().then(|| identity(size));
            for _ in 0..repeats {
                self.over_period(&mut end, derivative.as_mut(), &mut |_| ());
            }
            let missed = DVector::from_fn(size, |i, _| end[i] - state[i]);
            let is_new = derivative.is_some();
            let mut tried = match derivative {
                Some(derivative) => Known::of(derivative),
                None => known.take()?,
            };
            let step = tried.factor.solve(&missed)?;
            if !step.iter().all(|value| value.is_finite()) {
                return None;
            }
            let size_of_step = farthest(step.iter().copied(), &scales);
            if is_new {
                tried.left = size_of_step;
            }
            let is_alike = tried.left <= ALIKE;
            if size_of_step < CLOSED && is_alike {
                let derivative = tried.own?;
                return Some(Orbit {
                    state,
                    repeats: Some(repeats),
                    periods: repeats,
                    multiplier: multiplier(&derivative),
                    runs_away: false,
                    derivative: Some(Arc::new(derivative)),
                });
            }
            for (value, step) in state.iter_mut().zip(&step) {
                *value += step;
            }
            if distance(&state, start, &scales) > reach {
                return None;
            }
            // A derivative takes as long as the motion of as many systems. It serves again while it brings the end of a period much nearer to its beginning, until
            // the motion is so near that its own is as good as that of the periodic one.
            let shortens = size_of_step < SERVES * before;
            let serves = size > FEW && shortens && (is_alike || size_of_step > NEARLY_ALIKE);
            known = serves.then_some(tried);
            before = if serves { size_of_step } else { f64::INFINITY };
        }
        None
    }

    /// The limit of a motion at `from`: the stable periodic motion that continues `from` if there is one, otherwise its state after a long time.
    fn settled(&self, from: &Orbit, scale: Scale) -> Orbit {
        let scales = self.scales(scale);
        let mut state = from.state.clone();
        state.resize(self.size(), 0.0);
        let continues = |near: &[f64], nearby: Option<&Derivative>, repeats: u32| {
            let orbit = self.periodic_within(ASTRAY, (near, nearby), repeats, scale)?;
            let is_near = distance(&orbit.state, near, &scales) < NEAR;
            (orbit.multiplier < 1.0 && is_near).then_some(orbit)
        };
        let repeats = from.repeats.unwrap_or(1);
        let nearby = from.derivative.as_deref().filter(|_| self.size() > FEW);
        let found = nearby.and_then(|_| continues(&state, nearby, repeats));
        if let Some(orbit) = found.or_else(|| continues(&state, None, repeats)) {
            return orbit;
        }
        // One that goes on from a motion that does not repeat has nothing old to forget.
        let settled = match from.repeats {
            Some(_) => &SETTLED[..],
            None => &SETTLED[..1],
        };
        for &constants in settled {
            for _ in 0..self.periods_of(constants) {
                let before = state.clone();
                let mut last = 0.0;
                self.over_period(&mut state, None, &mut |seen| last = seen.u);
                if scale.is_left_by(last) {
                    return Orbit {
                        state: before,
                        repeats: None,
                        multiplier: f64::INFINITY,
                        runs_away: true,
                        ..Orbit::REST
                    };
                }
            }
            let most = MOST_PERIODS.min(self.periods_in_looks(MOST_LOOKS / 16.0));
            let mut later = state.clone();
            for repeats in 1..=most {
                self.over_period(&mut later, None, &mut |_| ());
                // A settled motion comes back to its state; one that has not settled is not searched in vain.
                if distance(&later, &state, &scales) > ASTRAY {
                    continue;
                }
                if let Some(orbit) = continues(&state, None, repeats) {
                    return orbit;
                }
            }
        }
        Orbit {
            state,
            repeats: None,
            periods: self.periods_of(WATCHED),
            multiplier: f64::INFINITY,
            runs_away: false,
            derivative: None,
        }
    }

    /// Periods in so many time constants of free motion.
    fn periods_of(&self, constants: f64) -> u32 {
        let periods = constants * self.decay() / self.period().0;
        (periods.ceil().max(1.0) as u32).min(self.periods_in_looks(MOST_LOOKS))
    }

    /// Whole periods in so many looks, one at least.
    fn periods_in_looks(&self, looks: f64) -> u32 {
        (looks / self.period().1).max(1.0) as u32
    }
}

/// A derivative by which Newton's method steps.
struct Known {
    /// 1 − M of the derivative M, factorized: (1 − M) step = the difference between the end and the beginning.
    factor: LU<f64, Dyn, Dyn>,
    /// M, unless it is that of a motion nearby.
    own: Option<Derivative>,
    /// The step over the scale of the motion that was left where M was taken.
    left: f64,
}

impl Known {
    fn of(derivative: Derivative) -> Self {
        let of_nearby = Self::of_nearby(&derivative);
        Self {
            own: Some(derivative),
            ..of_nearby
        }
    }

    fn of_nearby(derivative: &Derivative) -> Self {
        let size = derivative.len();
        let at = |i: usize, j: usize| f64::from(u8::from(i == j)) - derivative[j][i];
        Self {
            factor: DMatrix::from_fn(size, size, at).lu(),
            own: None,
            left: f64::INFINITY,
        }
    }
}

fn identity(size: usize) -> Derivative {
    let column = |i: usize| {
        let mut column = vec![0.0; size];
        column[i] = 1.0;
        column
    };
    (0..size).map(column).collect()
}

/// The largest of `values`, each over its scale.
fn farthest(values: impl Iterator<Item = f64>, scales: &[f64]) -> f64 {
    let each = values
        .zip(scales)
        .map(|(value, scale)| (value / scale).abs());
    each.fold(0.0, f64::max)
}

fn distance(a: &[f64], b: &[f64], scales: &[f64]) -> f64 {
    farthest(a.iter().zip(b).map(|(a, b)| a - b), scales)
}

impl Repeating for Oscillator<'_> {
    fn size(&self) -> usize {
        2
    }

    fn scales(&self, scale: Scale) -> Vec<f64> {
        vec![scale.u, scale.v]
    }

    fn decay(&self) -> f64 {
        2.0 * self.mass / self.damping
    }

    fn steps(&self) -> (usize, f64, u32) {
        (self.steps.len(), self.duration, self.looks)
    }

    fn over_period(
        &self,
        state: &mut Vec<f64>,
        derivative: Option<&mut Derivative>,
        see: &mut dyn FnMut(PeriodExtremes),
    ) {
        let begin = State {
            u: state[0],
            v: state[1],
        };
        let (end, m) = self.after_period(begin, see);
        (state[0], state[1]) = (end.u, end.v);
        for column in derivative.into_iter().flatten() {
            let [a, b] = [column[0], column[1]];
            *column = m.iter().map(|row| row[0] * a + row[1] * b).collect();
        }
    }
}

impl Repeating for CoupledMotion<'_> {
    fn size(&self) -> usize {
        2 * self.bodies().count()
    }

    fn scales(&self, scale: Scale) -> Vec<f64> {
        self.bodies().scales(scale.u)
    }

    fn decay(&self) -> f64 {
        self.bodies().decay()
    }

    fn steps(&self) -> (usize, f64, u32) {
        (self.steps.len(), self.duration, self.looks)
    }

    fn over_period(
        &self,
        state: &mut Vec<f64>,
        derivative: Option<&mut Derivative>,
        see: &mut dyn FnMut(PeriodExtremes),
    ) {
        self.carry_over_period(state, derivative, see);
    }
}
