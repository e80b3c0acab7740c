//! Periodic motions: Newton's method on the state after a period, stability by multipliers, and where a motion settles.

use super::oscillator::{Monodromy, Oscillator, State};

/// Newton steps before there is taken to be no periodic motion near.
const MOST_STEPS: u32 = 16;

/// What a periodic motion may miss its beginning by, over the scale of the motion.
const CLOSED: f64 = 1e-11;

/// So many periods a motion may take to repeat.
const MOST_PERIODS: u32 = 8;

/// Time constants of free motion after which it has died away, at first and where that was not enough.
const SETTLED: [f64; 2] = [30.0, 200.0];

/// Time constants over which a motion that does not repeat is looked at.
const WATCHED: f64 = 60.0;

/// Looks that one of these may take, so that a mesh far above its natural frequency, or hardly damped, keeps nobody waiting.
const MOST_LOOKS: f64 = 1e6;

/// How far, over the scale of the motion, a periodic motion may stand from where the last one stood to be its continuation.
const NEAR: f64 = 0.1;

/// Farther from where the last one stood a search for it has gone astray, as Newton's method may step over a motion by a few times its distance.
const ASTRAY: f64 = 3.0 * NEAR;

/// A motion that is so many times the scale has run away: the mesh pumps it more than damping takes from it.
const RUN_AWAY: f64 = 1e3;

/// Where a motion has come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// The state at the beginning of a period.
    pub state: State,
    /// The periods after which the motion repeats; `None` where it was not found to.
    pub repeats: Option<u32>,
    /// The periods to look at.
    pub periods: u32,
    /// The modulus of the largest multiplier; infinite where the motion was not found to repeat.
    pub multiplier: f64,
    /// Whether the motion grows without bound.
    pub runs_away: bool,
}

impl Orbit {
    /// At rest.
    pub const REST: Self = Self {
        state: State { u: 0.0, v: 0.0 },
        repeats: Some(1),
        periods: 1,
        multiplier: 0.0,
        runs_away: false,
    };
}

/// What is large: of displacements and of velocities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Of u.
    pub u: f64,
    /// Of u'.
    pub v: f64,
}

impl Scale {
    /// Whether a motion that comes to `u` has run away.
    pub fn is_left_by(&self, u: f64) -> bool {
        u.is_nan() || u.abs() > RUN_AWAY * self.u
    }

    fn distance(&self, a: State, b: State) -> f64 {
        ((a.u - b.u) / self.u)
            .abs()
            .max(((a.v - b.v) / self.v).abs())
    }
}

/// The moduli of the multipliers of a derivative, the larger first.
pub fn multipliers(m: &Monodromy) -> [f64; 2] {
    let (trace, determinant) = (m[0][0] + m[1][1], m[0][0] * m[1][1] - m[0][1] * m[1][0]);
    let under = trace * trace / 4.0 - determinant;
    if under < 0.0 {
        return [determinant.sqrt(); 2];
    }
    let large = trace.abs() / 2.0 + under.sqrt();
    let small = if large > 0.0 {
        determinant.abs() / large
    } else {
        0.0
    };
    [large, small]
}

impl Oscillator<'_> {
    /// The state `periods` after `state`, and its derivative to it.
    fn after(&self, state: State, periods: u32) -> (State, Monodromy) {
        let mut state = state;
        let mut all = [[1.0, 0.0], [0.0, 1.0]];
        for _ in 0..periods {
            let (next, m) = self.after_period(state, |_| ());
            state = next;
            all = [0, 1].map(|i| [0, 1].map(|j| m[i][0] * all[0][j] + m[i][1] * all[1][j]));
        }
        (state, all)
    }

    /// The motion near `start` that repeats after `repeats` periods, stable or not.
    pub fn periodic(&self, start: State, repeats: u32, scale: Scale) -> Option<Orbit> {
        self.periodic_within(f64::INFINITY, start, repeats, scale)
    }

    /// The same if it is found within `reach` of `start`.
    fn periodic_within(
        &self,
        reach: f64,
        start: State,
        repeats: u32,
        scale: Scale,
    ) -> Option<Orbit> {
        let mut state = start;
        for _ in 0..MOST_STEPS {
            let (end, m) = self.after(state, repeats);
            let missed = State {
                u: end.u - state.u,
                v: end.v - state.v,
            };
            // (1 − M) step = what is missed.
            let (a, b, c, d) = (1.0 - m[0][0], -m[0][1], -m[1][0], 1.0 - m[1][1]);
            let determinant = a * d - b * c;
            let step = State {
                u: (d * missed.u - b * missed.v) / determinant,
                v: (a * missed.v - c * missed.u) / determinant,
            };
            if !(step.u.is_finite() && step.v.is_finite()) {
                return None;
            }
            if scale.distance(step, State { u: 0.0, v: 0.0 }) < CLOSED {
                return Some(Orbit {
                    state,
                    repeats: Some(repeats),
                    periods: repeats,
                    multiplier: multipliers(&m)[0],
                    runs_away: false,
                });
            }
            state = State {
                u: state.u + step.u,
                v: state.v + step.v,
            };
            if scale.distance(state, start) > reach {
                return None;
            }
        }
        None
    }

    /// Where a motion that is at `from` settles: the stable periodic motion that continues `from` if there is one, else what it comes to in
    /// time.
    pub fn settled(&self, from: Orbit, scale: Scale) -> Orbit {
        let continues = |near: State, repeats: u32| {
            let orbit = self.periodic_within(ASTRAY, near, repeats, scale)?;
            (orbit.multiplier < 1.0 && scale.distance(orbit.state, near) < NEAR).then_some(orbit)
        };
        if let Some(orbit) = continues(from.state, from.repeats.unwrap_or(1)) {
            return orbit;
        }
        let mut state = from.state;
        // One that goes on from a motion that does not repeat has nothing old to forget.
        let settled = match from.repeats {
            Some(_) => &SETTLED[..],
            None => &SETTLED[..1],
        };
        for &constants in settled {
            for _ in 0..self.periods_of(constants) {
                let (next, _) = self.after(state, 1);
                if scale.is_left_by(next.u) {
                    return Orbit {
                        state,
                        repeats: None,
                        multiplier: f64::INFINITY,
                        runs_away: true,
                        ..Orbit::REST
                    };
                }
                state = next;
            }
            let most = MOST_PERIODS.min(self.periods_in_looks(MOST_LOOKS / 16.0));
            let mut later = state;
            for repeats in 1..=most {
                (later, _) = self.after(later, 1);
                // What has settled comes back to where it was, and what has not is not looked for in vain.
                if scale.distance(later, state) > ASTRAY {
                    continue;
                }
                if let Some(orbit) = continues(state, repeats) {
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
        }
    }

    /// Periods in so many time constants 2m/c of free motion.
    fn periods_of(&self, constants: f64) -> u32 {
        let period = self.duration * self.steps.len() as f64;
        let periods = constants * 2.0 * self.mass / self.damping / period;
        (periods.ceil().max(1.0) as u32).min(self.periods_in_looks(MOST_LOOKS))
    }

    /// Whole periods in so many looks, one at least.
    fn periods_in_looks(&self, looks: f64) -> u32 {
        let period = self.steps.len() as f64 * f64::from(self.looks);
        (looks / period).max(1.0) as u32
    }
}
