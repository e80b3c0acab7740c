//! The exact solver: a primal-dual active set, which is Newton's method on the Signorini conditions.
//!
//! With the set A of touching points held, the contact is linear: H_A p_A = delta w_A - g_A and w_A^T p_A = F, that is
//! one factorization of H_A with the right sides w_A and g_A. A point that would pull leaves A, a point that would
//! penetrate enters it, all at once; when nobody moves, the solution is exact. From a set that is right, one
//! factorization is enough.
//!
//! Moving all at once ends nearly always in a few steps but could in principle go round in a circle. After a number of
//! steps that only a circle needs, points are exchanged one by one instead, which lowers the energy each time and so
//! must end.

use super::problem::{ContactError, ContactProblem, ContactSolution, Equilibrium, check_load};

/// Newton steps before points are exchanged one by one; from a cold start the 500 random problems of the
/// tests take 8 in the median and 14 at most.
const NEWTON_STEP_LIMIT: u32 = 30;

/// Single exchanges allowed for each candidate point: far more than a walk that adds each point once and drops it again.
const EXCHANGES_PER_POINT: usize = 20;

/// Newton steps whose ends may leap; after them single points are wrong.
const LEAPS: u32 = 4;

/// Gap that counts as none, relative to the delta of the load alone.
///
/// Rounding in H p leaves some 1e-15 of it.
const RELATIVE_GAP_TOLERANCE: f64 = 1e-12;

/// Solves the contact under `load` (N, positive) exactly, starting from the points touching in `warm_start`.
///
/// The result comes from a factorization of the final set alone, so the warm start changes `iterations` and nothing
/// else. Without a warm start, or with one in which nothing touches, all points start in contact.
///
/// # Errors
///
/// [`ContactError::LoadNotPositive`], [`ContactError::WarmStartSize`], [`ContactError::NotPositiveDefinite`] if the
/// compliance is not, [`ContactError::NotConverged`] if numbers overflow or no set is found.
pub fn solve_active_set(
    problem: &ContactProblem,
    load: f64,
    warm_start: Option<&[bool]>,
) -> Result<ContactSolution, ContactError> {
    check_load(load)?;
    let first_set = first_set(problem, warm_start)?;
    let mut trial = Trial::new(problem, load);
    newton(&mut trial, first_set)?;
    if !trial.is_contact() {
        exchange(&mut trial)?;
    }
    Ok(trial.into_equilibrium().into_solution(problem, load))
}

fn first_set(
    problem: &ContactProblem,
    warm_start: Option<&[bool]>,
) -> Result<Vec<usize>, ContactError> {
    let points = problem.point_count();
    let Some(warm_start) = warm_start else {
        return Ok((0..points).collect());
    };
    if warm_start.len() != points {
        return Err(ContactError::WarmStartSize {
            points,
            given: warm_start.len(),
        });
    }
    let touching: Vec<usize> = (0..points).filter(|&point| warm_start[point]).collect();
    Ok(if touching.is_empty() {
        (0..points).collect()
    } else {
        touching
    })
}

/// Moves all wrong points at once, until there are none or the limit is reached.
fn newton(trial: &mut Trial<'_>, first_set: Vec<usize>) -> Result<(), ContactError> {
    trial.hold(first_set)?;
    for step in 1..NEWTON_STEP_LIMIT {
        if trial.is_contact() {
            break;
        }
        let leapt = (step <= LEAPS).then(|| trial.leapt_set());
        let set = leapt.filter(|set| !set.is_empty() && *set != trial.set);
        trial.hold(set.unwrap_or_else(|| trial.corrected_set()))?;
    }
    Ok(())
}

/// Walks from one touching point to the solution by single exchanges.
///
/// The forces walked through never pull and always carry the load, and the energy 1/2 p^T H p + g_0^T p falls from each
/// set to the next. No set returns, so the walk ends.
fn exchange(trial: &mut Trial<'_>) -> Result<(), ContactError> {
    let points = trial.problem.point_count();
    let (first, _) = trial.problem.first_touch();

    let mut reached = vec![0.0; points];
    reached[first] = trial.load / trial.problem.arms()[first];
    let mut set = vec![first];
    for _ in 0..EXCHANGES_PER_POINT * points {
        trial.hold(set.clone())?;
        let steps: Vec<f64> = set
            .iter()
            .map(|&point| trial.step_until_it_pulls(point, reached[point]))
            .collect();
        let step = steps.iter().copied().fold(1.0, f64::min);
        let blocked = steps.iter().any(|&until| until.is_finite());
        for &point in &set {
            reached[point] += step * (trial.forces[point] - reached[point]);
        }
        if blocked {
            let leaving: Vec<usize> = (0..set.len())
                .filter(|&place| steps[place] <= step)
                .map(|place| set[place])
                .collect();
            leaving.iter().for_each(|&point| reached[point] = 0.0);
            set.retain(|point| !leaving.contains(point));
        } else if let Some(entering) = trial.deepest_penetration() {
            set.insert(set.partition_point(|&point| point < entering), entering);
        } else {
            return Ok(());
        }
    }
    Err(trial.not_converged())
}

/// Forces and gaps that balance the load with a given set of points held in contact.
struct Trial<'a> {
    problem: &'a ContactProblem,
    load: f64,
    /// Gaps less those of the first touch: g_0 - delta_0 w, so that far bodies cost no digits.
    gaps_at_touch: Vec<f64>,
    gap_tolerance: f64,
    /// Largest force that counts as none; its absence would leave a gap within the tolerance.
    force_tolerances: Vec<f64>,
    set: Vec<usize>,
    active: Vec<bool>,
    forces: Vec<f64>,
    gaps: Vec<f64>,
    /// H_A^-1 w_A at the points of the set.
    response: Vec<f64>,
    stiffness: f64,
    delta_beyond_touch: f64,
    /// The linear systems solved so far.
    iterations: u32,
}

impl<'a> Trial<'a> {
    #[expect(non_snake_case, reason = "the compliance keeps its letter")]
    fn new(problem: &'a ContactProblem, load: f64) -> Self {
        let (first, first_touch) = problem.first_touch();
        let points = problem.point_count();
        let (g_0, w, H) = (problem.gaps(), problem.arms(), problem.compliance());

        // The whole load on the point that touches first gives the largest delta that is possible at all, since more
        // points can only carry it with less energy.
        let largest_delta = load * H[(first, first)] / w[first].powi(2);
        let gap_tolerance = RELATIVE_GAP_TOLERANCE * largest_delta;
        // Where point j lets go of p_j and any other point m takes it over, the gap at j closes by at most
        // p_j w_j^2 (sqrt(H_jj)/w_j + sqrt(H_mm)/w_m)^2 <= 4 p_j w_j^2 r. With half the gap tolerance a point thrown out
        // for a small force is not taken in again for a small penetration. No point may lose its fair share of the load,
        // or all could be thrown out.
        let r = (0..points)
            .map(|j| H[(j, j)] / w[j].powi(2))
            .fold(0.0, f64::max);
        let force_tolerance = |j: usize| {
            let of_gap = 0.5 * gap_tolerance / (4.0 * w[j].powi(2) * r);
            of_gap.min(RELATIVE_GAP_TOLERANCE * load / (w[j] * points as f64))
        };
        Self {
            problem,
            load,
            gaps_at_touch: g_0
                .iter()
                .zip(w)
                .map(|(g_0, w)| g_0 - first_touch * w)
                .collect(),
            gap_tolerance,
            force_tolerances: (0..points).map(force_tolerance).collect(),
            set: Vec::new(),
            active: vec![false; points],
            forces: vec![0.0; points],
            gaps: vec![0.0; points],
            response: Vec::new(),
            stiffness: 0.0,
            delta_beyond_touch: 0.0,
            iterations: 0,
        }
    }

    /// Balances the load with the points of `set` in contact and no others: forces may pull, gaps may be negative.
    fn hold(&mut self, set: Vec<usize>) -> Result<(), ContactError> {
        let w = self.problem.arms();
        // [x y] = H_A^-1 [w_A g_A], delta = (F + w^T y) / (w^T x), p = delta x - y.
        self.iterations += 1;
        let factor = self.problem.factor(&set);
        let factor = factor.ok_or(ContactError::NotPositiveDefinite { points: set.len() })?;
        let mut x: Vec<f64> = set.iter().map(|&j| w[j]).collect();
        let mut y: Vec<f64> = set.iter().map(|&j| self.gaps_at_touch[j]).collect();
        factor.solve([&mut x, &mut y]);
        let k: f64 = set.iter().zip(&x).map(|(&j, x)| w[j] * x).sum();
        let carried_by_gaps: f64 = set.iter().zip(&y).map(|(&j, y)| w[j] * y).sum();
        let delta = (self.load + carried_by_gaps) / k;

        self.active.fill(false);
        self.forces.fill(0.0);
        for ((&j, x), y) in set.iter().zip(&x).zip(&y) {
            self.active[j] = true;
            self.forces[j] = delta * x - y;
        }
        self.stiffness = k;
        self.delta_beyond_touch = delta;
        self.response = x;
        self.set = set;
        self.take_gaps();
        if delta.is_finite()
            && self
                .forces
                .iter()
                .chain(&self.gaps)
                .all(|value| value.is_finite())
        {
            Ok(())
        } else {
            Err(self.not_converged())
        }
    }

    fn take_gaps(&mut self) {
        let delta = self.delta_beyond_touch;
        for ((gap, g), w) in self
            .gaps
            .iter_mut()
            .zip(&self.gaps_at_touch)
            .zip(self.problem.arms())
        {
            *gap = g - delta * w;
        }
        let pressing = self.set.iter().map(|&j| (j, self.forces[j]));
        self.problem.open(&mut self.gaps, pressing);
    }

    /// True if `point` belongs to the set, judged by its force if it is held and by its gap if it is free.
    fn should_touch(&self, point: usize) -> bool {
        if self.active[point] {
            self.forces[point] > self.force_tolerances[point]
        } else {
            self.gaps[point] < -self.gap_tolerance
        }
    }

    fn corrected_set(&self) -> Vec<usize> {
        (0..self.active.len())
            .filter(|&point| self.should_touch(point))
            .collect()
    }

    /// The corrected set, with the ends of each row of touching points where they would be were it the contact of a parabola.
    fn leapt_set(&self) -> Vec<usize> {
        let points = self.active.len();
        let mut touching: Vec<bool> = (0..points).map(|point| self.should_touch(point)).collect();
        let mut to = 0;
        while let Some(skipped) = self.active[to..].iter().position(|active| *active) {
            let from = to + skipped;
            let row = self.active[from..].iter().take_while(|active| **active);
            to = from + row.count();
            self.leap(to - from, |k| (to - 1).checked_add_signed(k), &mut touching);
            self.leap(to - from, |k| from.checked_add_signed(-k), &mut touching);
        }
        (0..points).filter(|&point| touching[point]).collect()
    }

    /// Moves one end of a row of a given number of touching points by a larger step; `point(k)` is the one k outward from the last of the row.
    ///
    /// Held over a half width b where it would be a, the contact of a parabola presses as (a² + b² − 2 x²)/√(b² − x²): it pulls beyond the x_0 at
    /// which that changes sign, and if b is too small bodies penetrate deepest there. Newton's own end would halve the way to a, or leap too far.
    fn leap(&self, count: usize, point: impl Fn(isize) -> Option<usize>, touching: &mut [bool]) {
        let inside = |k: isize| k > -(count as isize);
        let known = |k: isize| point(k).filter(|&point| point < self.active.len());
        let wrong = |k: &isize| {
            known(*k).is_some_and(|point| self.should_touch(point) != self.active[point])
        };
        let pulling = (0..)
            .map(|k: isize| -k)
            .take_while(|k| inside(*k) && wrong(k))
            .count() as isize;
        let entering = |k: &isize| wrong(k) && known(*k).is_some_and(|point| !self.active[point]);
        let penetrating = (1..).take_while(entering).count() as isize;
        let middle = 0.5 * (count - 1) as f64;
        let square = |k: f64| (k + middle).powi(2);
        let half_square = 0.25 * (count as f64).powi(2);
        let turn = if pulling > 0 {
            let pressed = |k: isize| {
                let force = known(k).map_or(0.0, |point| self.forces[point]);
                force * (half_square - square(k as f64)).sqrt()
            };
            let (last, next) = (-pulling as f64, 1.0 - pulling as f64);
            let part = 1.0 / (1.0 - pressed(1 - pulling) / pressed(-pulling));
            square(last) + part * (square(next) - square(last))
        } else {
            let gap = |k: isize| known(k).map_or(0.0, |point| self.gaps[point]);
            let deepest = (1..=penetrating).min_by(|&one, &other| gap(one).total_cmp(&gap(other)));
            let Some(deepest) = deepest else { return };
            let [before, here, after] = [-1, 0, 1].map(|beside| gap(deepest + beside));
            square(deepest as f64 + 0.5 * (before - after) / (before - 2.0 * here + after))
        };
        let reach = (2.0 * turn - half_square).sqrt();
        // Nothing where the row is no such contact.
        if !(inside(-pulling) && reach.is_finite()) {
            return;
        }
        let last = (reach - middle).ceil() as isize - 1;
        for k in (1 - count as isize).max(last.min(-pulling))..=penetrating {
            if let Some(point) = known(k).filter(|_| k > last || k > -pulling) {
                touching[point] = k <= last;
            }
        }
    }

    /// True if nothing pulls and nothing penetrates: the Signorini conditions hold.
    fn is_contact(&self) -> bool {
        (0..self.active.len()).all(|point| self.should_touch(point) == self.active[point])
    }

    /// The part of the way from the force `reached` to the one held at which `point` ceases to press; infinite if never.
    fn step_until_it_pulls(&self, point: usize, reached: f64) -> f64 {
        let held = self.forces[point];
        if held > self.force_tolerances[point] {
            f64::INFINITY
        } else if reached > held.max(0.0) {
            (reached / (reached - held)).min(1.0)
        } else {
            0.0
        }
    }

    /// The free point that penetrates most, if any does by more than the tolerance.
    fn deepest_penetration(&self) -> Option<usize> {
        let penetrating =
            (0..self.gaps.len()).filter(|&point| !self.active[point] && self.should_touch(point));
        penetrating.min_by(|&one, &other| self.gaps[one].total_cmp(&self.gaps[other]))
    }

    fn not_converged(&self) -> ContactError {
        let largest = |values: &[f64]| {
            values
                .iter()
                .fold(0.0, |largest: f64, value| largest.max(-value))
        };
        ContactError::NotConverged {
            iterations: self.iterations,
            gap: largest(&self.gaps),
            pull: largest(&self.forces),
        }
    }

    fn into_equilibrium(self) -> Equilibrium {
        let mut load_derivative = vec![0.0; self.forces.len()];
        for (&point, x) in self.set.iter().zip(&self.response) {
            load_derivative[point] = x / self.stiffness;
        }
        Equilibrium {
            forces: self.forces,
            delta_beyond_touch: self.delta_beyond_touch,
            active: self.active,
            load_derivative,
            stiffness: self.stiffness,
            iterations: self.iterations,
            multiplier_updates: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    fn springs(compliances: [f64; 2], gaps: [f64; 2]) -> ContactProblem {
        let compliance = Mat::from_fn(
            2,
            2,
            |row, column| if row == column { compliances[row] } else { 0.0 },
        );
        ContactProblem::new(compliance, gaps.to_vec(), vec![1.0; 2]).expect("a sound problem")
    }

    fn assert_close(value: f64, expected: f64) {
        // Some roundings in a few operations.
        assert!(
            (value - expected).abs() <= 1e-13 * expected.abs(),
            "{value} is not {expected}"
        );
    }

    #[test]
    fn the_farther_of_two_springs_helps_once_the_nearer_has_closed_its_gap() {
        let (h_1, h_2, gap) = (2e-9, 5e-9, 1e-6);
        let problem = springs([h_1, h_2], [0.0, gap]);

        // The second spring is reached at F = gap / h_1 = 500 N.
        let alone = solve_active_set(&problem, 499.0, None).expect("a sound problem");
        assert_eq!(alone.active, [true, false]);
        assert_close(alone.transmission_error, 499.0 * h_1);
        assert_close(alone.stiffness, h_1.recip());
        assert_eq!(alone.load_derivative, [1.0, 0.0]);

        // In parallel: k = 1/h_1 + 1/h_2, F = delta / h_1 + (delta - gap) / h_2.
        let both = solve_active_set(&problem, 1500.0, None).expect("a sound problem");
        let stiffness = h_1.recip() + h_2.recip();
        assert_eq!(both.active, [true, true]);
        assert_close(both.stiffness, stiffness);
        assert_close(both.transmission_error, (1500.0 + gap / h_2) / stiffness);
        assert_close(both.forces[1], (both.transmission_error - gap) / h_2);
        assert_close(both.load_derivative[0], h_1.recip() / stiffness);
    }

    #[test]
    fn a_parabola_is_found_in_few_steps_from_any_set() {
        // Cells of width 1 on a half plane: the displacement of one by another falls with the logarithm of their distance, whose integral is x ln|x| − x.
        let points = 80;
        let opened = |x: f64| {
            let integral = |x: f64| x * x.abs().ln() - x;
            10.0 - (integral(x + 0.5) - integral(x - 0.5))
        };
        let compliance = Mat::from_fn(points, points, |i, j| 1e-9 * opened(i as f64 - j as f64));
        let gaps: Vec<f64> = (0..points)
            .map(|i| 1e-8 * (i as f64 - 37.3).powi(2))
            .collect();
        let problem =
            ContactProblem::new(compliance, gaps, vec![1.0; points]).expect("a sound problem");
        let exact = solve_active_set(&problem, 5000.0, None).expect("a sound problem");
        let touching: Vec<usize> = (0..points).filter(|&point| exact.active[point]).collect();
        let (from, to) = (touching[0], touching[touching.len() - 1]);
        assert!(touching.len() > 30 && to - from + 1 == touching.len());
        assert!(exact.iterations <= 4, "{}", exact.iterations);
        for wider in -12..=12_isize {
            for moved in [-5, 0, 3] {
                let ends = [from as isize + moved - wider, to as isize + moved + wider];
                let warm: Vec<bool> = (0..points as isize)
                    .map(|point| (ends[0]..=ends[1]).contains(&point))
                    .collect();
                let found = solve_active_set(&problem, 5000.0, Some(&warm)).expect("a solution");
                assert_eq!(found.forces, exact.forces);
                assert!(
                    found.iterations <= 5,
                    "{wider}, {moved}: {}",
                    found.iterations
                );
            }
        }
    }

    #[test]
    fn a_gap_that_all_points_have_moves_delta_and_nothing_else() {
        let near = solve_active_set(&springs([2e-9, 5e-9], [0.0, 1e-6]), 1500.0, None)
            .expect("a sound problem");
        let far = solve_active_set(&springs([2e-9, 5e-9], [1e-3, 1.001e-3]), 1500.0, None)
            .expect("a sound problem");
        assert_close(far.transmission_error, near.transmission_error + 1e-3);
        // 1e-3 m has digits down to 1e-19 m, which is 1e-10 N here.
        assert!((far.forces[1] - near.forces[1]).abs() < 1e-9);
    }

    #[test]
    fn an_arm_multiplies_the_force_in_the_load_and_delta_in_the_gap() {
        let compliance = Mat::from_fn(1, 1, |_, _| 4e-9);
        let problem =
            ContactProblem::new(compliance, vec![1e-6], vec![0.5]).expect("a sound problem");
        // w p = F, H p + g_0 = delta w.
        let solution = solve_active_set(&problem, 100.0, None).expect("a sound problem");
        assert_close(solution.forces[0], 200.0);
        assert_close(solution.transmission_error, (4e-9 * 200.0 + 1e-6) / 0.5);
        assert_close(solution.stiffness, 0.25 / 4e-9);
    }

    #[test]
    fn a_flat_punch_on_an_exponential_foundation_presses_with_its_edges() {
        // H_ij = h r^|i-j| has the tridiagonal inverse [1 + r^2 or 1 at the ends, -r beside] / (h (1 - r^2)), so that
        // H^-1 1 is (1 - r) / (h (1 + r)) inside and 1 / (h (1 + r)) at both ends.
        let (h, r, points, load) = (3e-9, 0.9_f64, 40, 800.0);
        let distance =
            |row: usize, column: usize| i32::try_from(row.abs_diff(column)).expect("40 points");
        let compliance = Mat::from_fn(points, points, |row, column| {
            h * r.powi(distance(row, column))
        });
        let problem = ContactProblem::new(compliance, vec![0.0; points], vec![1.0; points])
            .expect("a sound problem");
        let solution = solve_active_set(&problem, load, None).expect("a sound problem");

        let stiffness = (2.0 + (points - 2) as f64 * (1.0 - r)) / (h * (1.0 + r));
        let close =
            |value: f64, expected: f64| assert!((value - expected).abs() <= 1e-11 * expected);
        close(solution.stiffness, stiffness);
        close(solution.transmission_error, load / stiffness);
        close(solution.forces[0], load / (stiffness * h * (1.0 + r)));
        close(
            solution.forces[20],
            load * (1.0 - r) / (stiffness * h * (1.0 + r)),
        );
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
        let root: Vec<f64> = (0..points * points).map(|_| number()).collect();
        let product = |row: usize, column: usize| -> f64 {
            (0..points)
                .map(|k| root[row * points + k] * root[column * points + k])
                .sum()
        };
        let ridge = |row: usize, column: usize| if row == column { 1e-3 } else { 0.0 };
        let compliance = Mat::from_fn(points, points, |row, column| {
            1e-9 * (product(row, column) + ridge(row, column))
        });
        let gaps = (0..points).map(|_| 1e-6 * number()).collect();
        ContactProblem::new(compliance, gaps, vec![1.0; points]).expect("a sound problem")
    }

    #[test]
    fn single_exchanges_reach_what_newton_reaches_and_the_cycles_too() {
        let mut state = 1;
        let mut cycles = 0;
        for _ in 0..20_000 {
            let problem = wild_problem(&mut state);
            let solution = solve_active_set(&problem, 1000.0, None).expect("a sound problem");
            // 1e-11 of the gaps of 1 um.
            assert!(
                solution.penetration <= 1e-17 && solution.forces.iter().all(|&force| force >= 0.0)
            );

            let mut walk = Trial::new(&problem, 1000.0);
            exchange(&mut walk).expect("a sound problem");
            assert_eq!(walk.forces, solution.forces);
            cycles += u32::from(solution.iterations > NEWTON_STEP_LIMIT);
        }
        assert!(
            cycles > 0,
            "no problem made Newton's method cycle, so nothing shows that a cycle is left"
        );
    }

    #[test]
    fn a_load_that_presses_nothing_is_refused() {
        let problem = springs([1e-9, 1e-9], [0.0, 0.0]);
        for load in [0.0, -0.0, -5.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(
                solve_active_set(&problem, load, None),
                Err(ContactError::LoadNotPositive { .. })
            ));
        }
    }

    #[test]
    fn a_warm_start_of_another_size_is_refused() {
        let refused = solve_active_set(&springs([1e-9, 1e-9], [0.0, 0.0]), 1.0, Some(&[true]))
            .expect_err("a refusal");
        assert_eq!(
            refused,
            ContactError::WarmStartSize {
                points: 2,
                given: 1
            }
        );
    }

    #[test]
    fn a_compliance_that_gives_energy_away_is_refused() {
        let compliance = Mat::from_fn(2, 2, |row, column| if row == column { 1e-9 } else { 2e-9 });
        let problem =
            ContactProblem::new(compliance, vec![0.0; 2], vec![1.0; 2]).expect("a sound problem");
        let refused = solve_active_set(&problem, 1.0, None).expect_err("a refusal");
        assert_eq!(refused, ContactError::NotPositiveDefinite { points: 2 });
    }

    #[test]
    fn numbers_that_overflow_end_in_an_error() {
        let refused = solve_active_set(&springs([1e300, 1e300], [0.0, 0.0]), 1e300, None)
            .expect_err("a refusal");
        assert!(matches!(
            refused,
            ContactError::NotConverged { iterations: 1, .. }
        ));
        let refused = solve_active_set(&springs([1e-9, 1e-9], [-1e308, 1e308]), 1.0, None)
            .expect_err("a refusal");
        assert!(matches!(
            refused,
            ContactError::NotConverged { iterations: 1, .. }
        ));
    }

    #[test]
    fn tiny_numbers_are_numbers() {
        let solution = solve_active_set(&springs([1e-100, 1e-100], [0.0, 0.0]), 1e-200, None)
            .expect("a sound problem");
        solution
            .forces
            .iter()
            .for_each(|&force| assert_close(force, 5e-201));
        assert!(solution.complementarity <= 1e-15);
    }
}
