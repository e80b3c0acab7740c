//! Motion over a period, piece by piece, and its derivative to the state at the beginning.

use super::law::{Laws, Piece, Response};

/// Knots that are crossed in one look before the motion is taken to graze one.
const MOST_CROSSINGS: u32 = 64;

/// Steps of the search for a crossing; each but the first few doubles the digits.
const MOST_STEPS: u32 = 60;

/// A displacement and its velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// u.
    pub u: f64,
    /// u'.
    pub v: f64,
}

/// The derivative of a state to an earlier one, row by row.
pub type Monodromy = [[f64; 2]; 2];

/// A step of a period, of the same duration as the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// The place of its law.
    pub law: usize,
    /// The force that acts during it.
    pub force: f64,
    /// Jump of the velocity at its beginning.
    pub kick: f64,
}

/// m u'' + c u' + G(u) = f, with a law G and a force f that change from step to step, over and over.
#[derive(Debug, Clone)]
pub struct Oscillator<'a> {
    /// The laws of force.
    pub laws: &'a Laws,
    /// m.
    pub mass: f64,
    /// c.
    pub damping: f64,
    /// How long a step takes.
    pub duration: f64,
    /// How often the motion is looked at in a step: often enough for it not to turn back twice between two looks.
    pub looks: u32,
    /// The steps of a period.
    pub steps: Vec<Step>,
}

/// State at the end of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeriodExtremes {
    /// The step.
    pub step: usize,
    /// How much of it has passed.
    pub part: f64,
    /// u.
    pub u: f64,
    /// G(u).
    pub force: f64,
    /// True if the loaded flanks have separated since the last step.
    pub apart: bool,
}

impl Oscillator<'_> {
    /// The state a period after `state`, and its derivative to it; `see` gets the states on the way.
    pub fn after_period(
        &self,
        state: State,
        mut see: impl FnMut(PeriodExtremes),
    ) -> (State, Monodromy) {
        let State { mut u, mut v } = state;
        let mut derivative = [[1.0, 0.0], [0.0, 1.0]];
        let mut place = 0;
        let look = self.duration / f64::from(self.looks);
        for (index, step) in self.steps.iter().enumerate() {
            v += step.kick;
            place = self.laws.place(step.law, u, v > 0.0, place);
            let mut whole = None;
            for looked in 1..=self.looks {
                let mut moving = Moving {
                    oscillator: self,
                    step,
                    u,
                    v,
                    place,
                    lowest: place,
                };
                moving.advance(look, &mut whole, &mut derivative);
                (u, v, place) = (moving.u, moving.v, moving.place);
                see(PeriodExtremes {
                    step: index,
                    part: f64::from(looked) / f64::from(self.looks),
                    u,
                    force: self.laws.piece(step.law, place).force(u),
                    apart: self.laws.is_apart(moving.lowest),
                });
            }
        }
        (State { u, v }, derivative)
    }
}

/// A motion inside a step.
struct Moving<'a> {
    oscillator: &'a Oscillator<'a>,
    step: &'a Step,
    u: f64,
    v: f64,
    /// The piece in which it is.
    place: usize,
    /// The lowest in which it has been.
    lowest: usize,
}

impl Moving<'_> {
    /// Moves on for a `look`. Of the looks of a step most pass in one piece: `whole` is how that of a place answers after one of them.
    fn advance(
        &mut self,
        look: f64,
        whole: &mut Option<(usize, Response)>,
        derivative: &mut Monodromy,
    ) {
        let mut left = look;
        for crossed in 0..=MOST_CROSSINGS {
            let piece = self.oscillator.laws.piece(self.step.law, self.place);
            let response = match *whole {
                Some((place, known)) if place == self.place && left == look => known,
                _ => self.response(&piece, left),
            };
            if left == look {
                *whole = Some((self.place, response));
            }
            let end = self.moved(&piece, response);
            let crossing = if crossed < MOST_CROSSINGS {
                self.crossing(&piece, left, end)
            } else {
                None
            };
            let Some((time, up)) = crossing else {
                self.carry(&piece, response, derivative);
                (self.u, self.v) = end;
                return;
            };
            let response = self.response(&piece, time);
            self.carry(&piece, response, derivative);
            (_, self.v) = self.moved(&piece, response);
            self.u = if up { piece.high } else { piece.low };
            self.place = if up { self.place + 1 } else { self.place - 1 };
            self.lowest = self.lowest.min(self.place);
            left -= time;
        }
    }

    /// How `piece` answers after `t`.
    fn response(&self, piece: &Piece, t: f64) -> Response {
        let Oscillator { mass, damping, .. } = self.oscillator;
        Response::new(damping / (2.0 * mass), piece.stiffness / mass, t)
    }

    /// The state to which `piece` moves it with this `response`.
    fn moved(&self, piece: &Piece, response: Response) -> (f64, f64) {
        let pull = (self.step.force - piece.force(self.u)) / self.oscillator.mass;
        (
            self.u + self.v * response.g + pull * response.integral,
            self.v * response.rate + pull * response.g,
        )
    }

    /// The state after `t` in `piece`.
    fn after(&self, piece: &Piece, t: f64) -> (f64, f64) {
        self.moved(piece, self.response(piece, t))
    }

    /// Carries the derivative on. Laws are continuous, so that the time of a crossing leaves no trace in it.
    fn carry(&self, piece: &Piece, response: Response, derivative: &mut Monodromy) {
        let square = piece.stiffness / self.oscillator.mass;
        let a = [
            [1.0 - square * response.integral, response.g],
            [-square * response.g, response.rate],
        ];
        let m = *derivative;
        for (row, a) in derivative.iter_mut().zip(a) {
            for (column, value) in row.iter_mut().enumerate() {
                *value = a[0] * m[0][column] + a[1] * m[1][column];
            }
        }
    }

    /// When the motion leaves `piece` within `left`, after which it comes to the state (`u`, `v`) there, and whether upwards.
    fn crossing(&self, piece: &Piece, left: f64, (u, v): (f64, f64)) -> Option<(f64, bool)> {
        let beyond = |u: f64| {
            if u > piece.high {
                Some(true)
            } else if u < piece.low {
                Some(false)
            } else {
                None
            }
        };
        let mut from = 0.0;
        if self.v * v < 0.0 {
            let turn = self.root(piece, (0.0, left), |_, v| v, |acceleration, _| acceleration);
            let (at_turn, _) = self.after(piece, turn);
            if let Some(up) = beyond(at_turn) {
                return Some((self.reaches(piece, up, (0.0, turn)), up));
            }
            from = turn;
        }
        let up = beyond(u)?;
        Some((self.reaches(piece, up, (from, left)), up))
    }

    fn reaches(&self, piece: &Piece, up: bool, within: (f64, f64)) -> f64 {
        let bound = if up { piece.high } else { piece.low };
        self.root(piece, within, |u, _| u - bound, |_, v| v)
    }

    /// Where `value` of (u, v), whose rate is `rate` of (u'', v), changes its sign: Newton's method inside a bracket.
    fn root(
        &self,
        piece: &Piece,
        (mut low, mut high): (f64, f64),
        value: impl Fn(f64, f64) -> f64,
        rate: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let Oscillator { mass, damping, .. } = self.oscillator;
        let at = |t: f64| {
            let (u, v) = self.after(piece, t);
            let acceleration = (self.step.force - damping * v - piece.force(u)) / mass;
            (value(u, v), rate(acceleration, v))
        };
        let end = at(high).0;
        let precision = 1e-14 * high;
        let mut t = f64::midpoint(low, high);
        for _ in 0..MOST_STEPS {
            let (y, slope) = at(t);
            if y * end > 0.0 {
                high = t;
            } else {
                low = t;
            }
            let newton = t - y / slope;
            let next = if newton > low && newton < high {
                newton
            } else {
                f64::midpoint(low, high)
            };
            let moved = (next - t).abs();
            t = next;
            if moved <= precision || high - low <= precision {
                break;
            }
        }
        t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A backlash of 2 about 0, and a spring of stiffness 1 to either side.
    fn backlash() -> Laws {
        Laws::new(vec![-1.0, 0.0, 0.0, 1.0], vec![-2.0, -1.0, 1.0, 2.0], 2)
    }

    #[test]
    fn the_derivative_is_that_of_the_motion_through_contact_backlash_and_the_other_flank() {
        let laws = backlash();
        let steps = (0..40)
            .map(|i| Step {
                law: 0,
                force: 0.1 + 2.0 * (f64::from(i) * 0.157).cos(),
                kick: 0.01 * (f64::from(i) * 0.3).sin(),
            })
            .collect();
        let oscillator = Oscillator {
            laws: &laws,
            mass: 1.3,
            damping: 0.1,
            duration: 0.2,
            looks: 2,
            steps,
        };
        let start = State { u: 0.4, v: -1.2 };
        let mut parted = (false, false);
        let (_, derivative) = oscillator.after_period(start, |seen| {
            parted.0 |= seen.apart;
            parted.1 |= seen.force < 0.0;
        });
        assert!(parted.0 && parted.1, "both flanks are met");
        let h = 1e-6;
        let moved = |du: f64, dv: f64| {
            let start = State {
                u: start.u + du,
                v: start.v + dv,
            };
            oscillator.after_period(start, |_| ()).0
        };
        for (column, (du, dv)) in [(h, 0.0), (0.0, h)].into_iter().enumerate() {
            let (ahead, behind) = (moved(du, dv), moved(-du, -dv));
            let difference = [
                (ahead.u - behind.u) / (2.0 * h),
                (ahead.v - behind.v) / (2.0 * h),
            ];
            for row in 0..2 {
                let exact = derivative[row][column];
                assert!(
                    (exact - difference[row]).abs() < 1e-6 * (1.0 + exact.abs()),
                    "{row} {column}: {exact} {}",
                    difference[row]
                );
            }
        }
    }

    #[test]
    fn a_free_flight_between_two_springs_takes_the_time_of_its_closed_form() {
        // Without damping: half an oscillation in each spring takes pi, each flight across 2 at speed v takes 2/v.
        let laws = backlash();
        let v = 0.37;
        let period = 2.0 * std::f64::consts::PI + 4.0 / v;
        let oscillator = Oscillator {
            laws: &laws,
            mass: 1.0,
            damping: 0.0,
            duration: period / 64.0,
            looks: 4,
            steps: vec![
                Step {
                    law: 0,
                    force: 0.0,
                    kick: 0.0
                };
                64
            ],
        };
        let (end, _) = oscillator.after_period(State { u: 0.0, v }, |_| ());
        assert!(end.u.abs() < 1e-12 && (end.v - v).abs() < 1e-12, "{end:?}");
    }

    #[test]
    fn steps_of_any_length_are_exact_under_constant_stiffness() {
        let laws = Laws::new(vec![-3.0, 3.0], vec![-1.0, 1.0], 0);
        let of = |count: u32| {
            let oscillator = Oscillator {
                laws: &laws,
                mass: 2.0,
                damping: 0.3,
                duration: 1.0 / f64::from(count),
                looks: 1,
                steps: vec![
                    Step {
                        law: 0,
                        force: 0.7,
                        kick: 0.0
                    };
                    count as usize
                ],
            };
            oscillator.after_period(State { u: 0.5, v: 0.2 }, |_| ()).0
        };
        let (one, many) = (of(1), of(1000));
        assert!((one.u - many.u).abs() < 1e-12 && (one.v - many.v).abs() < 1e-12);
    }
}
