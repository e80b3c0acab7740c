//! The method of the paper: an augmented Lagrangian (eq. 7), in compliance form.
//!
//! Eq. (7) has the force f = kappa g + lambda with the penetration g. Our gap is positive where open, so
//! p_j = max(0, lambda_j - kappa g_j): the multipliers lambda are forces, and kappa is a spring at each point. With
//! lambda held, the springs and the bodies balance the load:
//!
//! ```text
//! p = max(0, lambda - kappa (H p + g_0 - delta w)),   w^T p = F
//! ```
//!
//! On the set B where the right side is positive this is linear, (H_B + 1/kappa) p_B = lambda_B / kappa - g_B + delta
//! w_B, and Newton's method moves B. Then lambda becomes p, until the gaps under the forces, which are
//! (lambda - p) / kappa, are below the tolerance.
//!
//! Newton's steps are safe: the balance minimizes the convex function
//!
//! ```text
//! Phi(s, delta) = 1/2 s^T H s - F delta + |max(0, lambda - kappa (H s + g_0 - delta w))|^2 / (2 kappa)
//! ```
//!
//! of the forces s that deform the bodies and of delta; where plain steps do not settle, steps along the same
//! directions to the least Phi do. The update of lambda is the proximal point method and converges for every kappa > 0;
//! a soft spring only makes it slow.

use nalgebra::{DMatrix, DVector};

use super::problem::{ContactError, ContactProblem, ContactSolution, Equilibrium, check_load};
use crate::gear::{GearPair, Member};
use crate::run::Run;

/// Newton steps of full length for one set of multipliers; after them steps go to the least Phi.
const FULL_STEP_LIMIT: u32 = 30;

/// Newton steps for one set of multipliers, in all.
const STEP_LIMIT: u32 = 500;

/// Bisections that find the least Phi along a line; an f64 has no more digits.
const BISECTIONS: u32 = 60;

/// Gap that counts as none, relative to the delta of the load alone: rounding in H p.
const ROUNDING: f64 = 1e-13;

/// Penalty, tolerance and limit of the augmented Lagrangian.
///
/// The paper has kappa = 1e17 and epsilon = 1e-2 without units. With N/m and um, its penalty is so stiff that the first
/// multipliers are exact to 1e-13 m, and the tolerance does not matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AugmentedLagrangian {
    /// The penalty stiffness kappa of each point, in N/m.
    pub penalty: f64,
    /// The gap tolerance epsilon, in m: neither a penetration nor a gap under a force may exceed it.
    pub gap_tolerance: f64,
    /// The most updates of the multipliers.
    pub max_iterations: u32,
}

/// The penalty that every pair can have: 100 E b, of the softer gear and the common face width, in N/m.
///
/// An update leaves 1/(1 + kappa h) of an error that gives way by h of its force. That is least for the shortest wave that cells
/// resolve, with 2/(pi E b) from each gear whatever the width of a cell: each update leaves about a hundredth of the error.
pub fn default_penalty(pair: &GearPair) -> f64 {
    let moduli = Member::BOTH.map(|member| pair.gear(member).material().youngs_modulus);
    100.0 * moduli[0].min(moduli[1]) * pair.common_face_width()
}

/// Solves the contact under `load` (N, positive) by the augmented Lagrangian, starting without multipliers.
///
/// Every force, and delta, is inexact by the effect of a gap of [`AugmentedLagrangian::gap_tolerance`]. The tangent is that of rigid contact on the final set,
/// without the springs.
///
/// # Errors
///
/// [`ContactError::LoadNotPositive`], [`ContactError::SettingsNotPositive`], [`ContactError::NotPositiveDefinite`] if
/// the compliance is not, [`ContactError::NotConverged`] if the gaps are not below the tolerance in time, [`ContactError::Stopped`]:
/// `run` is asked before each update of the multipliers.
pub fn solve_augmented_lagrangian(
    problem: &ContactProblem,
    load: f64,
    settings: &AugmentedLagrangian,
    run: &Run,
) -> Result<ContactSolution, ContactError> {
    check_load(load)?;
    let &AugmentedLagrangian {
        penalty,
        gap_tolerance,
        max_iterations,
    } = settings;
    let is_positive = |value: f64| value.is_finite() && value > 0.0;
    if !is_positive(penalty) || !is_positive(gap_tolerance) {
        return Err(ContactError::SettingsNotPositive {
            penalty,
            gap_tolerance,
        });
    }
    let springs = Springs::new(problem, load, penalty);
    let mut multipliers = DVector::zeros(problem.point_count());
    let mut pressed = vec![true; problem.point_count()];
    let mut iterations = 0;
    let mut gap_error = f64::INFINITY;
    for update in 1..=max_iterations {
        run.check()?;
        let balance = springs.balance(&multipliers, &pressed, FULL_STEP_LIMIT, iterations)?;
        iterations = balance.iterations;
        gap_error = springs.gap_error(&balance);
        if gap_error < gap_tolerance {
            return Ok(springs
                .release(balance, update)?
                .into_solution(problem, load));
        }
        multipliers = balance.forces;
        pressed = balance.pressed;
    }
    Err(ContactError::NotConverged {
        iterations,
        gap: gap_error,
        pull: 0.0,
    })
}

/// The bodies with a spring of stiffness kappa at each point, under the load.
struct Springs {
    compliance: DMatrix<f64>,
    /// Gaps less those of the first touch: g_0 - delta_0 w.
    gaps_at_touch: DVector<f64>,
    arms: DVector<f64>,
    load: f64,
    penalty: f64,
    /// A push below this does not close a spring that is open.
    push_tolerance: f64,
}

/// Forces, delta and pressed springs that balance the load for given multipliers.
struct Balance {
    forces: DVector<f64>,
    delta_beyond_touch: f64,
    pressed: Vec<bool>,
    /// The linear systems solved so far, those before this balance included.
    iterations: u32,
}

impl Springs {
    fn new(problem: &ContactProblem, load: f64, penalty: f64) -> Self {
        let points = problem.point_count();
        let compliance = DMatrix::from_fn(points, points, |row, column| {
            problem.compliance()[(row, column)]
        });
        let (first, first_touch) = problem.first_touch();
        let arms = DVector::from_column_slice(problem.arms());
        let gaps_at_touch = DVector::from_column_slice(problem.gaps()) - first_touch * &arms;
        let largest_delta = load * compliance[(first, first)] / arms[first].powi(2);
        let push_tolerance = ROUNDING * (load + penalty * largest_delta);
        Self {
            compliance,
            gaps_at_touch,
            arms,
            load,
            penalty,
            push_tolerance,
        }
    }

    /// H s + g_0 - delta w, in m.
    fn gaps(&self, forces: &DVector<f64>, delta: f64) -> DVector<f64> {
        &self.compliance * forces + &self.gaps_at_touch - delta * &self.arms
    }

    /// Force of each spring if it could pull as well: lambda - kappa g, in N.
    fn pushes(&self, multipliers: &DVector<f64>, gaps: &DVector<f64>) -> DVector<f64> {
        multipliers - self.penalty * gaps
    }

    /// The largest of the penetrations and of the gaps under a force, in m.
    fn gap_error(&self, balance: &Balance) -> f64 {
        let gaps = self.gaps(&balance.forces, balance.delta_beyond_touch);
        let errors = gaps
            .iter()
            .zip(&balance.pressed)
            .map(|(&gap, &pressed)| if pressed { gap.abs() } else { -gap });
        errors.fold(0.0, f64::max)
    }

    /// Balances the load with the multipliers held, from the springs that are `pressed` at first.
    fn balance(
        &self,
        multipliers: &DVector<f64>,
        pressed: &[bool],
        full_step_limit: u32,
        iterations_before: u32,
    ) -> Result<Balance, ContactError> {
        let mut pressed = pressed.to_vec();
        let mut point: Option<(DVector<f64>, f64)> = None;
        let mut gap = f64::INFINITY;
        let mut step = 0;
        while step < STEP_LIMIT {
            step += 1;
            let (forces, delta) = self.newton_point(multipliers, &pressed)?;
            let gaps = self.gaps(&forces, delta);
            if !gaps.iter().all(|gap| gap.is_finite()) {
                break;
            }
            let pushes = self.pushes(multipliers, &gaps);
            let is_pressed = |j: usize| {
                if pressed[j] {
                    forces[j] > 0.0
                } else {
                    pushes[j] > self.push_tolerance
                }
            };
            let next: Vec<bool> = (0..pressed.len()).map(is_pressed).collect();
            if next == pressed {
                return Ok(Balance {
                    forces,
                    delta_beyond_touch: delta,
                    pressed,
                    iterations: iterations_before + step,
                });
            }
            gap = gaps.iter().fold(0.0, |deepest: f64, gap| deepest.max(-gap));
            if step < full_step_limit && next.contains(&true) {
                pressed = next;
                point = Some((forces, delta));
            } else {
                let (start, start_delta) = point.unwrap_or_else(|| (multipliers.clone(), 0.0));
                let reached =
                    self.least_energy(multipliers, (&start, start_delta), (&forces, delta));
                let (balanced, now_pressed) = self.balance_delta(multipliers, &reached);
                pressed = now_pressed;
                point = Some((reached, balanced));
            }
        }
        Err(ContactError::NotConverged {
            iterations: iterations_before + step,
            gap,
            pull: 0.0,
        })
    }

    /// Forces and delta that balance the load if exactly the `pressed` springs act, pulling where they must.
    #[expect(non_snake_case, reason = "the compliance keeps its letter")]
    fn newton_point(
        &self,
        multipliers: &DVector<f64>,
        pressed: &[bool],
    ) -> Result<(DVector<f64>, f64), ContactError> {
        let set: Vec<usize> = (0..pressed.len()).filter(|&point| pressed[point]).collect();
        let size = set.len();
        let (H, kappa) = (&self.compliance, self.penalty);
        let soft = |row: usize, column: usize| {
            H[(set[row], set[column])] + if row == column { kappa.recip() } else { 0.0 }
        };
        let factor = DMatrix::from_fn(size, size, soft)
            .cholesky()
            .ok_or(ContactError::NotPositiveDefinite { points: size })?;
        let w = DVector::from_fn(size, |row, _| self.arms[set[row]]);
        let preload = DVector::from_fn(size, |row, _| {
            multipliers[set[row]] / kappa - self.gaps_at_touch[set[row]]
        });

        let (x, y) = (factor.solve(&w), factor.solve(&preload));
        let delta = (self.load - w.dot(&y)) / w.dot(&x);
        let p = y + delta * x;

        let mut forces = DVector::zeros(pressed.len());
        set.iter()
            .zip(p.iter())
            .for_each(|(&point, &p)| forces[point] = p);
        Ok((forces, delta))
    }

    /// The deforming forces at the least Phi on the way from one (s, delta) to another, found by the sign of its slope.
    fn least_energy(
        &self,
        multipliers: &DVector<f64>,
        (start, start_delta): (&DVector<f64>, f64),
        (end, end_delta): (&DVector<f64>, f64),
    ) -> DVector<f64> {
        let (d, e) = (end - start, end_delta - start_delta);
        let opening = &self.compliance * &d - e * &self.arms;
        let first_push = self.pushes(multipliers, &self.gaps(start, start_delta));
        let (d_h_s, d_h_d) = (
            d.dot(&(&self.compliance * start)),
            d.dot(&(&self.compliance * &d)),
        );
        // dPhi/dt = d^T H (s + t d) - e F - sum of max(0, push) (H d - e w), which grows with t.
        let slope = |t: f64| {
            let work: f64 = first_push
                .iter()
                .zip(opening.iter())
                .map(|(r, o)| (r - self.penalty * t * o).max(0.0) * o)
                .sum();
            d_h_s + t * d_h_d - e * self.load - work
        };
        let (mut low, mut high) = (0.0, 1.0);
        if slope(high) <= 0.0 {
            low = 1.0;
        } else {
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                if slope(middle) <= 0.0 {
                    low = middle
                } else {
                    high = middle
                }
            }
        }
        start + low * d
    }

    /// Delta at which the springs carry the load on bodies deformed by `forces`, and the springs then pressed.
    ///
    /// Minimizes Phi over delta, and leaves at least one spring pressed.
    fn balance_delta(&self, multipliers: &DVector<f64>, forces: &DVector<f64>) -> (f64, Vec<bool>) {
        let pushes = self.pushes(multipliers, &self.gaps(forces, 0.0));
        let (w, kappa) = (&self.arms, self.penalty);
        // Spring j pushes with r_j + kappa delta w_j from delta = -r_j / (kappa w_j) on.
        let closing = |j: usize| -pushes[j] / (kappa * w[j]);
        let mut order: Vec<usize> = (0..pushes.len()).collect();
        order.sort_by(|&one, &other| closing(one).total_cmp(&closing(other)));

        let (mut carried, mut stiffness, mut delta) = (0.0, 0.0, 0.0);
        let mut pressed = vec![false; pushes.len()];
        for (place, &j) in order.iter().enumerate() {
            carried += w[j] * pushes[j];
            stiffness += kappa * w[j] * w[j];
            pressed[j] = true;
            delta = (self.load - carried) / stiffness;
            if order
                .get(place + 1)
                .is_none_or(|&next| delta <= closing(next))
            {
                break;
            }
        }
        (delta, pressed)
    }

    /// Takes the springs away from the pressed points and adds the tangent of rigid contact there.
    #[expect(non_snake_case, reason = "matrices keep their letters")]
    fn release(
        &self,
        balance: Balance,
        multiplier_updates: u32,
    ) -> Result<Equilibrium, ContactError> {
        let Balance {
            forces,
            delta_beyond_touch,
            pressed,
            iterations,
        } = balance;
        let set: Vec<usize> = (0..pressed.len()).filter(|&point| pressed[point]).collect();
        let H_A = DMatrix::from_fn(set.len(), set.len(), |row, column| {
            self.compliance[(set[row], set[column])]
        });
        let w_A = DVector::from_fn(set.len(), |row, _| self.arms[set[row]]);
        let factor = H_A
            .cholesky()
            .ok_or(ContactError::NotPositiveDefinite { points: set.len() })?;
        let response = factor.solve(&w_A);
        let stiffness = w_A.dot(&response);

        let mut load_derivative = vec![0.0; pressed.len()];
        set.iter()
            .zip(response.iter())
            .for_each(|(&point, x)| load_derivative[point] = x / stiffness);
        Ok(Equilibrium {
            forces: forces.iter().copied().collect(),
            delta_beyond_touch,
            active: pressed,
            load_derivative,
            stiffness,
            iterations,
            multiplier_updates,
        })
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::run::Stopped;

    const SETTINGS: AugmentedLagrangian = AugmentedLagrangian {
        penalty: 1e12,
        gap_tolerance: 1e-14,
        max_iterations: 100,
    };

    fn springs(compliances: &[f64], gaps: &[f64]) -> ContactProblem {
        let points = compliances.len();
        let compliance = Mat::from_fn(points, points, |row, column| {
            if row == column { compliances[row] } else { 0.0 }
        });
        ContactProblem::new(compliance, gaps.to_vec(), vec![1.0; points]).expect("a sound problem")
    }

    #[test]
    fn the_first_multipliers_leave_a_penetration_of_force_over_penalty_and_the_second_none() {
        let (h, load, penalty) = (4e-9, 300.0, 1e10);
        let problem = springs(&[h], &[0.0]);
        let once = AugmentedLagrangian {
            penalty,
            gap_tolerance: 1e-6,
            max_iterations: 1,
        };
        let soft = solve_augmented_lagrangian(&problem, load, &once, &Run::unattended())
            .expect("a sound problem");
        // The body and the spring in series: delta = F (h + 1/kappa).
        assert!((soft.transmission_error - load * (h + 1.0 / penalty)).abs() <= 1e-20);
        assert!((soft.penetration - load / penalty).abs() <= 1e-20);

        let twice = AugmentedLagrangian {
            penalty,
            gap_tolerance: 1e-12,
            max_iterations: 100,
        };
        let hard = solve_augmented_lagrangian(&problem, load, &twice, &Run::unattended())
            .expect("a sound problem");
        assert_eq!((hard.multiplier_updates, hard.iterations), (2, 2));
        assert!((hard.transmission_error - load * h).abs() <= 1e-20);
    }

    #[test]
    fn the_farther_of_two_springs_helps_once_the_nearer_has_closed_its_gap() {
        let (h_1, h_2, gap) = (2e-9, 5e-9, 1e-6);
        let problem = springs(&[h_1, h_2], &[0.0, gap]);
        let alone = solve_augmented_lagrangian(&problem, 499.0, &SETTINGS, &Run::unattended())
            .expect("a sound problem");
        assert_eq!(alone.active, [true, false]);
        assert!((alone.transmission_error - 499.0 * h_1).abs() <= 1e-14);

        // In parallel: k = 1/h_1 + 1/h_2, F = delta / h_1 + (delta - gap) / h_2; delta is off by the gap tolerance.
        let both = solve_augmented_lagrangian(&problem, 1500.0, &SETTINGS, &Run::unattended())
            .expect("a sound problem");
        let stiffness = h_1.recip() + h_2.recip();
        assert!((both.stiffness - stiffness).abs() <= 1e-12 * stiffness);
        assert!((both.transmission_error - (1500.0 + gap / h_2) / stiffness).abs() <= 1e-14);
        assert!((both.load_derivative[0] - h_1.recip() / stiffness).abs() <= 1e-12);
    }

    /// Random positive definite compliances with entries of both signs, much wilder than those of gears.
    fn wild_problem(state: &mut u64) -> ContactProblem {
        let mut number = || {
            *state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        let points = 8;
        let root = DMatrix::from_fn(points, points, |_, _| number());
        let h = 1e-9 * (&root * root.transpose() + 1e-3 * DMatrix::<f64>::identity(points, points));
        let gaps = (0..points).map(|_| 1e-6 * number()).collect();
        ContactProblem::new(
            Mat::from_fn(points, points, |row, column| h[(row, column)]),
            gaps,
            vec![1.0; points],
        )
        .expect("a sound problem")
    }

    #[test]
    fn steps_to_the_least_energy_reach_the_same_balance_from_anywhere() {
        let mut state = 1;
        let mut cycles = 0;
        for _ in 0..2000 {
            let problem = wild_problem(&mut state);
            let springs = Springs::new(&problem, 1000.0, 1e12);
            let multipliers = DVector::zeros(8);
            let usual = springs
                .balance(&multipliers, &[true; 8], FULL_STEP_LIMIT, 0)
                .expect("a sound problem");
            let careful = springs
                .balance(&multipliers, &[true; 8], 0, 0)
                .expect("a sound problem");
            assert_eq!(usual.pressed, careful.pressed);
            assert!((usual.forces - careful.forces).amax() <= 1e-9 * 1000.0);
            cycles += u32::from(usual.iterations > FULL_STEP_LIMIT);
        }
        assert!(
            cycles > 0,
            "no problem made full steps cycle, so nothing shows that a cycle is left"
        );
    }

    #[test]
    fn what_cannot_be_solved_ends_in_an_error() {
        let problem = springs(&[1e-9, 1e-9], &[0.0, 0.0]);
        for load in [0.0, -5.0, f64::NAN, f64::INFINITY] {
            let refused = solve_augmented_lagrangian(&problem, load, &SETTINGS, &Run::unattended())
                .expect_err("a refusal");
            assert!(matches!(refused, ContactError::LoadNotPositive { .. }));
        }
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let refused = solve_augmented_lagrangian(
                &problem,
                1.0,
                &AugmentedLagrangian {
                    penalty: wrong,
                    ..SETTINGS
                },
                &Run::unattended(),
            );
            assert!(matches!(
                refused,
                Err(ContactError::SettingsNotPositive { .. })
            ));
            let refused = solve_augmented_lagrangian(
                &problem,
                1.0,
                &AugmentedLagrangian {
                    gap_tolerance: wrong,
                    ..SETTINGS
                },
                &Run::unattended(),
            );
            assert!(matches!(
                refused,
                Err(ContactError::SettingsNotPositive { .. })
            ));
        }
        let hopeless = AugmentedLagrangian {
            penalty: 1e3,
            gap_tolerance: 1e-15,
            max_iterations: 5,
        };
        let two = springs(&[1e-9, 3e-9], &[0.0, 1e-7]);
        assert!(matches!(
            solve_augmented_lagrangian(&two, 1000.0, &hopeless, &Run::unattended()),
            Err(ContactError::NotConverged {
                iterations: 5..,
                ..
            })
        ));
        let stop = Arc::new(AtomicBool::new(true));
        assert_eq!(
            solve_augmented_lagrangian(&two, 1000.0, &hopeless, &Run::new(stop, |_, _| ())),
            Err(ContactError::Stopped(Stopped))
        );
        let never = AugmentedLagrangian {
            max_iterations: 0,
            ..SETTINGS
        };
        assert!(matches!(
            solve_augmented_lagrangian(&two, 1000.0, &never, &Run::unattended()),
            Err(ContactError::NotConverged { iterations: 0, .. })
        ));
        for (load, penalty) in [(1e300, 1e300), (1e300, 1e12), (1e300, 1e-300)] {
            let settings = AugmentedLagrangian {
                penalty,
                ..SETTINGS
            };
            let result = solve_augmented_lagrangian(
                &springs(&[1e100, 1e100], &[0.0, 1e250]),
                load,
                &settings,
                &Run::unattended(),
            );
            assert!(matches!(result, Err(ContactError::NotConverged { .. })));
        }
        let compliance = Mat::from_fn(2, 2, |row, column| if row == column { 1e-9 } else { 2e-9 });
        let problem =
            ContactProblem::new(compliance, vec![0.0; 2], vec![1.0; 2]).expect("a sound problem");
        let refused = solve_augmented_lagrangian(&problem, 1.0, &SETTINGS, &Run::unattended())
            .expect_err("a refusal");
        assert_eq!(refused, ContactError::NotPositiveDefinite { points: 2 });
    }
}
