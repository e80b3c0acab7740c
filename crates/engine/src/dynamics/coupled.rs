//! Motion over a period of gears whose bodies vibrate.
//!
//! About the static deflection under F_0 the state s = (p, p') of the common modes obeys s' = A s + B f. The matrix A has the spring of the mesh at
//! its mean stiffness k, and f = k Z·p − G(u) is the rest of the law of force: u = Z·p − w, with w the fluctuation of the static curve. In a look f is
//! linear in time, which the exponential of A takes exactly, free motion by free motion (`free`). The end of f depends on u there, by a piecewise
//! linear equation. A stiffness that is constant is met exactly; one that varies, and flanks that part, to second order.

use nalgebra::Complex;

use super::bodies::Coupled;
use super::free::{Complexes, FreeMotions};
use super::law::Laws;
use super::oscillator::PeriodExtremes;
use crate::wide::{Loops, wide};

/// Pieces of a law that are tried for the end of a look before it is taken to lie at a knot.
const MOST_PIECES: usize = 256;

/// A step of a period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// The place of its law.
    pub law: usize,
    /// w at its beginning and at its end.
    pub deflection: [f64; 2],
}

/// Coupled bodies on laws of force that change from step to step, over and over.
#[derive(Debug, Clone)]
pub struct CoupledMotion<'a> {
    laws: &'a Laws,
    bodies: &'a Coupled,
    /// F_0.
    load: f64,
    /// How long a step takes.
    pub(super) duration: f64,
    /// Looks in a step.
    pub(super) looks: u32,
    /// The steps of a period.
    pub(super) steps: Vec<Drift>,
    free: FreeMotions,
    /// e^{λ h}.
    carried: Complexes,
    /// The shares of f at the beginning and at the end of a look.
    pushed: [Complexes; 2],
}

/// A place on a law.
#[derive(Debug, Clone, Copy)]
struct Touch {
    /// f.
    rest: f64,
    /// df/d(Z·p).
    slope: f64,
    /// The force of the law.
    force: f64,
    /// The place of the piece.
    place: usize,
}

impl<'a> CoupledMotion<'a> {
    /// `steps` of `duration` with so many `looks` in each, of `bodies` on `laws` under the load `load`, while the driving gear turns by `turn` rad/s.
    pub fn new(
        (laws, load): (&'a Laws, f64),
        (bodies, turn): (&'a Coupled, f64),
        (duration, looks): (f64, u32),
        steps: Vec<Drift>,
    ) -> Self {
        let free = FreeMotions::of(bodies, turn);
        let [carried, falling, rising] = free.over(duration / f64::from(looks));
        Self {
            laws,
            bodies,
            load,
            duration,
            looks,
            steps,
            free,
            carried,
            pushed: [falling, rising],
        }
    }

    pub(super) fn bodies(&self) -> &Coupled {
        self.bodies
    }

    /// The rest of `law` where the teeth are nearer by `nearer` than at rest and w is `deflection`.
    fn touch(&self, law: usize, nearer: f64, deflection: f64, near: usize) -> Touch {
        let u = nearer - deflection;
        let place = self.laws.place(law, u, true, near);
        let piece = self.laws.piece(law, place);
        let force = piece.force(u);
        Touch {
            rest: self.bodies.stiffness * nearer - (force - self.load),
            slope: self.bodies.stiffness - piece.stiffness,
            force,
            place,
        }
    }

    /// By how much the teeth are nearer at the end of a look, at which they would be by `free` without f there, and by `share` times f with it.
    fn end(&self, law: usize, (free, share): (f64, f64), deflection: f64, near: usize) -> Touch {
        let k = self.bodies.stiffness;
        let mut place = near;
        for _ in 0..MOST_PIECES {
            let piece = self.laws.piece(law, place);
            // u = free − w + share (k (u + w) + F_0 − F(0) − κ u).
            let at_zero = piece.force(0.0);
            let u = (free - deflection + share * (k * deflection + self.load - at_zero))
                / (1.0 - share * (k - piece.stiffness));
            if u > piece.high {
                place += 1;
            } else if u < piece.low {
                place -= 1;
            } else {
                let force = piece.force(u);
                return Touch {
                    rest: k * (u + deflection) - (force - self.load),
                    slope: k - piece.stiffness,
                    force,
                    place,
                };
            }
        }
        self.touch(law, free, deflection, near)
    }

    /// Carries `state` and, where asked for, its `derivative`, whose columns are carried alike, over a period.
    pub(super) fn carry_over_period(
        &self,
        state: &mut [f64],
        derivative: Option<&mut Vec<Vec<f64>>>,
        see: &mut dyn FnMut(PeriodExtremes),
    ) {
        let [falling, rising] = &self.pushed;
        let teeth = &self.free.teeth;
        let share = rising.real_of_product(teeth);
        let mut own = self.free.own(state);
        let of_columns = derivative.iter().flat_map(|columns| columns.iter());
        let own_columns: Vec<Complexes> = of_columns.map(|column| self.free.own(column)).collect();
        let mut columns = Columns::of(&own_columns, teeth);
        // The share of f at the end of a look comes to the columns with the next one: both are in proportion to how much the teeth have come nearer.
        let later = self.carried.times(rising);
        let mut slope_before = 0.0;
        let mut nearer = own.real_of_product(teeth);
        let mut push = Complexes::zeros(2 * self.bodies.count());
        let mut place = 0;
        for (index, step) in self.steps.iter().enumerate() {
            let [from, to] = step.deflection;
            let mut touch = self.touch(step.law, nearer, from, place);
            for looked in 1..=self.looks {
                let part = f64::from(looked) / f64::from(self.looks);
                let deflection = from + part * (to - from);
                own.carry(&self.carried, touch.rest, falling);
                let free = own.real_of_product(teeth);
                let end = self.end(step.law, (free, share), deflection, touch.place);
                own.add(end.rest, rising);
                nearer = free + share * end.rest;
                if !own_columns.is_empty() {
                    push.clone_from(falling);
                    push.scale(touch.slope);
                    push.add(slope_before, &later);
                    let follows = 1.0 / (1.0 - share * end.slope);
                    wide(Carried {
                        columns: &mut columns,
                        by: &self.carried,
                        push: &push,
                        teeth,
                        follows,
                    });
                    slope_before = end.slope;
                }
                see(PeriodExtremes {
                    step: index,
                    part,
                    u: own.real_of_product(&self.free.hubs) - deflection,
                    force: end.force,
                    apart: self.laws.is_apart(touch.place.min(end.place)),
                });
                touch = end;
            }
            place = touch.place;
        }
        self.free.to_state(&own, state);
        for (j, told) in derivative.into_iter().flatten().enumerate() {
            let (mut own, nearer) = columns.get(j);
            own.add(slope_before * nearer, rising);
            self.free.to_state(&own, told);
        }
    }
}

/// Columns that one step of arithmetic takes together.
const ABREAST: usize = 8;

/// Small differences of the state, some beside each other, without the share of f at the end of the last look.
struct Columns {
    /// The free motions of each.
    count: usize,
    /// Those of the first columns, one motion after the other, then those of the next columns.
    re: Vec<[f64; ABREAST]>,
    im: Vec<[f64; ABREAST]>,
    /// By how much the teeth come nearer.
    nearer: Vec<[f64; ABREAST]>,
}

impl Columns {
    /// `columns`, in which the teeth come nearer as `teeth` says.
    fn of(columns: &[Complexes], teeth: &Complexes) -> Self {
        let count = teeth.parts().0.len();
        let groups = columns.chunks(ABREAST);
        let beside = |of: fn(&Complexes) -> &[f64]| {
            let group = |group: &'_ [Complexes]| {
                let motion = |i: usize| {
                    std::array::from_fn(|lane| group.get(lane).map_or(0.0, |one| of(one)[i]))
                };
                (0..count).map(motion).collect::<Vec<_>>()
            };
            groups.clone().flat_map(group).collect()
        };
        let nearer = |group: &[Complexes]| {
            std::array::from_fn(|lane| {
                group
                    .get(lane)
                    .map_or(0.0, |one| one.real_of_product(teeth))
            })
        };
        Self {
            count,
            re: beside(|one| one.parts().0),
            im: beside(|one| one.parts().1),
            nearer: groups.clone().map(nearer).collect(),
        }
    }

    /// Column `j`, and by how much the teeth come nearer in it.
    fn get(&self, j: usize) -> (Complexes, f64) {
        let (group, lane) = (j / ABREAST, j % ABREAST);
        let at = |i: usize| self.count * group + i;
        let motion = |i: usize| Complex::new(self.re[at(i)][lane], self.im[at(i)][lane]);
        let own = Complexes::of((0..self.count).map(motion));
        (own, self.nearer[group][lane])
    }
}

/// Small differences that are carried over a look: by e^{λ h}, and by what pushes each as far as its teeth have come nearer.
struct Carried<'a> {
    columns: &'a mut Columns,
    by: &'a Complexes,
    push: &'a Complexes,
    teeth: &'a Complexes,
    /// How much nearer the teeth come at the end for each part that they would without the force there.
    follows: f64,
}

impl Loops for Carried<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Columns {
            count,
            re,
            im,
            nearer,
        } = self.columns;
        let follows = self.follows;
        let [by, push, teeth] = [self.by, self.push, self.teeth].map(Complexes::parts);
        let groups = re.chunks_exact_mut(*count).zip(im.chunks_exact_mut(*count));
        for ((re, im), nearer) in groups.zip(nearer) {
            let (near, mut sums) = (*nearer, [0.0; ABREAST]);
            let motions = re.iter_mut().zip(im).zip(by.0.iter().zip(by.1));
            let shared = push.0.iter().zip(push.1).zip(teeth.0.iter().zip(teeth.1));
            for (((re, im), by), (push, teeth)) in motions.zip(shared) {
                // All is read before anything is written, so that each line is one of whole vectors.
                let (a, b) = (*re, *im);
                let [by, push, teeth] = [by, push, teeth].map(|(re, im)| (*re, *im));
                let x: [f64; ABREAST] =
                    std::array::from_fn(|i| by.0 * a[i] - by.1 * b[i] + push.0 * near[i]);
                let y: [f64; ABREAST] =
                    std::array::from_fn(|i| by.1 * a[i] + by.0 * b[i] + push.1 * near[i]);
                sums = std::array::from_fn(|i| sums[i] + (teeth.0 * x[i] - teeth.1 * y[i]));
                (*re, *im) = (x, y);
            }
            *nearer = sums.map(|sum| follows * sum);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bodies::{Body, BodyMode, Damping};
    use super::super::mount::Mount;
    use super::*;

    /// Two equal gears, each with one mode of this frequency, and a mesh of this stiffness.
    fn rims_on_webs(frequency: f64, stiffness: f64, damping: Damping) -> Coupled {
        let mode = BodyMode {
            frequency,
            at_mesh: 1.2,
            turn: 0.7,
        };
        let body = Body {
            inertia: 2.0,
            base_radius: 1.0,
            modes: vec![mode],
            waves: Vec::new(),
            mount: Mount::NONE,
        };
        Coupled::new(&[body.clone(), body], stiffness, damping).expect("bodies")
    }

    #[test]
    fn without_damping_a_cycle_leaves_the_energy_as_it_was() {
        // Rims on webs with a constant stiffness between them: ½ p'² + ½ Ω² p² in every mode, whatever the steps.
        let damping = Damping {
            mesh: 0.0,
            bodies: 0.0,
        };
        let bodies = rims_on_webs(3.0, 1.5, damping);
        let laws = Laws::new(vec![-3.0, 3.0], vec![-4.0 / 1.5, 2.0 / 1.5], 0);
        let drift = Drift {
            law: 0,
            deflection: [0.0; 2],
        };
        let energy = |state: &[f64]| -> f64 {
            let (p, v) = state.split_at(bodies.count());
            let each = p.iter().zip(v).zip(&bodies.frequencies);
            each.map(|((p, v), omega)| 0.5 * (v * v + (omega * p).powi(2)))
                .sum()
        };
        let motion = CoupledMotion::new((&laws, 1.0), (&bodies, 0.0), (0.13, 2), vec![drift; 64]);
        let mut state: Vec<f64> = (1..=2 * bodies.count()).map(|i| 0.1 / i as f64).collect();
        let before = energy(&state);
        motion.carry_over_period(&mut state, None, &mut |_| ());
        assert!((energy(&state) / before - 1.0).abs() < 1e-8);
    }

    #[test]
    fn the_derivative_is_that_of_the_motion_through_contact_backlash_and_the_other_flank() {
        let damping = Damping {
            mesh: 0.1,
            bodies: 0.02,
        };
        let bodies = rims_on_webs(2.0, 1.0, damping);
        let laws = Laws::new(vec![-1.0, 0.0, 0.0, 1.0], vec![-2.3, -1.3, -0.3, 0.7], 2);
        let wave = |i: usize| 2.0 * (i as f64 * 0.157).cos();
        let steps = (0..40).map(|i| Drift {
            law: 0,
            deflection: [wave(i), wave(i + 1)],
        });
        let motion = CoupledMotion::new((&laws, 0.3), (&bodies, 0.0), (0.2, 3), steps.collect());
        let size = 2 * bodies.count();
        let start: Vec<f64> = (0..size).map(|i| 0.3 * (1.0 + i as f64).sin()).collect();
        let mut derivative: Vec<Vec<f64>> = (0..size)
            .map(|i| (0..size).map(|j| f64::from(u8::from(i == j))).collect())
            .collect();
        let mut met = (false, false);
        motion.carry_over_period(&mut start.clone(), Some(&mut derivative), &mut |seen| {
            met.0 |= seen.apart;
            met.1 |= seen.force < 0.0;
        });
        assert!(met.0 && met.1, "both flanks are met");
        let h = 1e-6;
        for (column, exact) in derivative.iter().enumerate() {
            let moved = |by: f64| {
                let mut state = start.clone();
                state[column] += by;
                motion.carry_over_period(&mut state, None, &mut |_| ());
                state
            };
            let (ahead, behind) = (moved(h), moved(-h));
            for (row, exact) in exact.iter().enumerate() {
                let difference = (ahead[row] - behind[row]) / (2.0 * h);
                let error = (exact - difference).abs();
                assert!(
                    error < 1e-6 * (1.0 + exact.abs()),
                    "{row} {column}: {exact} {difference}"
                );
            }
        }
    }
}
