//! The contact problem at one position of the mesh, and the form of its solution.

use std::fmt;
use std::sync::Arc;

use faer::{Mat, MatRef};

use super::compliances::CachedCompliance;
use super::factor::{Core, Factor, core_of};
use crate::run::Stopped;
use crate::wide::{Loops, wide};

/// Entries of the compliance that mirror each other may differ by this much, relative to the diagonal.
///
/// A condensed compliance is symmetric to about 1e-12; more than this is a fault in its making and not rounding.
const SYMMETRY_TOLERANCE: f64 = 1e-6;

/// Candidate points of contact with their compliance, their gaps before loading and their arms.
///
/// A value of this type has at least one point, finite entries, a symmetric compliance with a positive diagonal, and
/// positive arms. That the compliance is positive definite is found out by the solver.
#[derive(Clone, Debug)]
pub struct ContactProblem {
    compliance: Arc<Mat<f64>>,
    /// The same, if its factors are kept.
    known: Option<CachedCompliance>,
    gaps: Vec<f64>,
    arms: Vec<f64>,
}

impl ContactProblem {
    /// States the problem with the `compliance` H of both bodies (m/N), the `gaps` g_0 (m) and the `arms` w (-).
    ///
    /// H_ij is how much the gap at point i opens under a unit force at point j, delta held. A positive gap is open.
    /// w_j is the arm of force j about the driven center over the base radius, 1 on the line of action. The two
    /// triangles of H are replaced by their mean.
    ///
    /// # Errors
    ///
    /// [`ContactError::NoPoints`], [`ContactError::SizesDiffer`], [`ContactError::NotFinite`],
    /// [`ContactError::NotSymmetric`], [`ContactError::ArmNotPositive`], or [`ContactError::NotPositiveDefinite`] for a
    /// diagonal entry that is not positive.
    pub fn new(
        mut compliance: Mat<f64>,
        gaps: Vec<f64>,
        arms: Vec<f64>,
    ) -> Result<Self, ContactError> {
        if compliance.nrows() == compliance.ncols() {
            symmetrize(&mut compliance)?;
        }
        Self::checked(compliance, gaps, arms)
    }

    fn checked(compliance: Mat<f64>, gaps: Vec<f64>, arms: Vec<f64>) -> Result<Self, ContactError> {
        let (rows, columns) = (compliance.nrows(), compliance.ncols());
        if rows == 0 && columns == 0 && gaps.is_empty() && arms.is_empty() {
            return Err(ContactError::NoPoints);
        }
        check_points(rows, columns, &gaps, &arms)?;
        for column in 0..columns {
            all_finite(ContactQuantity::Compliance, compliance.col_as_slice(column))?;
        }
        if (0..rows).any(|point| compliance[(point, point)] <= 0.0) {
            return Err(ContactError::NotPositiveDefinite { points: 1 });
        }
        Ok(Self {
            compliance: Arc::new(compliance),
            known: None,
            gaps,
            arms,
        })
    }

    /// As [`ContactProblem::new`], with an H that is `known`.
    pub(super) fn of_known(
        known: &CachedCompliance,
        gaps: Vec<f64>,
        arms: Vec<f64>,
    ) -> Result<Self, ContactError> {
        let points = known.compliance.nrows();
        check_points(points, points, &gaps, &arms)?;
        Ok(Self {
            compliance: Arc::clone(&known.compliance),
            known: Some(known.clone()),
            gaps,
            arms,
        })
    }

    /// The number of candidate points.
    pub fn point_count(&self) -> usize {
        self.gaps.len()
    }

    /// The compliance H of both bodies, in m/N, symmetric.
    pub fn compliance(&self) -> MatRef<'_, f64> {
        Mat::as_ref(&self.compliance)
    }

    /// Column `point` of H: change of every gap by a unit force at that point, in m/N.
    pub(super) fn compliance_column(&self, point: usize) -> &[f64] {
        self.compliance.col_as_slice(point)
    }

    /// The factor of the compliance of the rising points `set`; `None` where that is not positive definite.
    pub(super) fn factor(&self, set: &[usize]) -> Option<Factor> {
        match &self.known {
            Some(known) => known.factor(set),
            None => {
                let core = Core::new(&self.compliance, &core_of(set));
                Factor::new(&self.compliance, set, Arc::new(core))
            }
        }
    }

    /// Adds the openings of `forces` at their points to `gaps`, four at a time.
    pub(super) fn open(&self, gaps: &mut [f64], forces: impl Iterator<Item = (usize, f64)>) {
        let problem = self;
        wide(Opening {
            problem,
            gaps,
            forces,
        });
    }

    /// The gaps g_0 before loading, in m, positive where open.
    pub fn gaps(&self) -> &[f64] {
        &self.gaps
    }

    /// The arms w, each about the driven center over the base radius.
    pub fn arms(&self) -> &[f64] {
        &self.arms
    }

    /// The point that touches first, and the delta = min_j g_0j / w_j at which it does, in m.
    pub fn first_touch(&self) -> (usize, f64) {
        first_of(self.gaps.iter().zip(&self.arms).map(|(gap, arm)| gap / arm))
    }
}

/// The first of the least of `touches`, and which it is.
pub(super) fn first_of(touches: impl Iterator<Item = f64>) -> (usize, f64) {
    touches.enumerate().fold((0, f64::INFINITY), |first, next| {
        if next.1 < first.1 { next } else { first }
    })
}

struct Opening<'a, F> {
    problem: &'a ContactProblem,
    gaps: &'a mut [f64],
    forces: F,
}

impl<F: Iterator<Item = (usize, f64)>> Loops for Opening<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        while let Some(first) = self.forces.next() {
            let mut four = [first; 4];
            for each in &mut four[1..] {
                *each = self.forces.next().unwrap_or((first.0, 0.0));
            }
            let [a, b, c, d] = four.map(|(point, _)| self.problem.compliance_column(point));
            let [p_a, p_b, p_c, p_d] = four.map(|(_, force)| force);
            let columns = a.iter().zip(b).zip(c.iter().zip(d));
            for (gap, ((a, b), (c, d))) in self.gaps.iter_mut().zip(columns) {
                *gap += (a * p_a + b * p_b) + (c * p_c + d * p_d);
            }
        }
    }
}

/// Checks that `gaps` and `arms` have this number of points.
fn check_points(
    rows: usize,
    columns: usize,
    gaps: &[f64],
    arms: &[f64],
) -> Result<(), ContactError> {
    if columns != rows || gaps.len() != rows || arms.len() != rows {
        return Err(ContactError::SizesDiffer {
            rows,
            columns,
            gaps: gaps.len(),
            arms: arms.len(),
        });
    }
    all_finite(ContactQuantity::Gap, gaps)?;
    all_finite(ContactQuantity::Arm, arms)?;
    match arms.iter().position(|&arm| arm <= 0.0) {
        Some(point) => Err(ContactError::ArmNotPositive {
            point,
            arm: arms[point],
        }),
        None => Ok(()),
    }
}

fn all_finite(quantity: ContactQuantity, values: &[f64]) -> Result<(), ContactError> {
    // Without an early end the test runs over several values at once; that there is none is the rule.
    if values
        .iter()
        .fold(true, |finite, value| finite & value.is_finite())
    {
        return Ok(());
    }
    let point = values
        .iter()
        .position(|value| !value.is_finite())
        .unwrap_or_default();
    Err(ContactError::NotFinite {
        quantity,
        point,
        value: values[point],
    })
}

fn symmetrize(compliance: &mut Mat<f64>) -> Result<(), ContactError> {
    for column in 0..compliance.ncols() {
        for row in column + 1..compliance.nrows() {
            let (below, above) = (compliance[(row, column)], compliance[(column, row)]);
            let scale = compliance[(row, row)].max(compliance[(column, column)]);
            if (below - above).abs() > SYMMETRY_TOLERANCE * scale {
                return Err(ContactError::NotSymmetric {
                    row,
                    column,
                    below,
                    above,
                });
            }
            // Half of each, so that entries near the largest number do not overflow in the sum.
            let mean = 0.5 * below + 0.5 * above;
            compliance[(row, column)] = mean;
            compliance[(column, row)] = mean;
        }
    }
    Ok(())
}

/// Contact under a load: who carries it, how far the driven gear lags, how stiff the contact is, and how exact that is.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSolution {
    /// The force p at each point, in N; never negative, zero off the active set.
    pub forces: Vec<f64>,
    /// The gap g = H p + g_0 - delta w left at each point, in m, positive where open.
    pub gaps: Vec<f64>,
    /// The transmission error delta, in m, positive when the load makes the driven gear lag.
    pub transmission_error: f64,
    /// True for each point in contact.
    pub active: Vec<bool>,
    /// The derivative q = dp/dF = H_A^-1 w_A / k of each force to the load, zero off the active set A; and that of delta to each gap, dδ/dg.
    pub load_derivative: Vec<f64>,
    /// The tangent stiffness k = dF/d delta = w_A^T H_A^-1 w_A (eq. 3), in N/m, with the active set A held.
    pub stiffness: f64,
    /// The linear systems solved to find the active set and the forces.
    pub iterations: u32,
    /// The updates of the multipliers; 0 for a solver that has none.
    pub multiplier_updates: u32,
    /// The largest |p_j g_j| over F (delta - delta_0), with the delta_0 of first touch.
    pub complementarity: f64,
    /// The largest penetration, in m: the most negative gap with its sign turned, or 0.
    pub penetration: f64,
    /// The imbalance |w^T p - F| / F.
    pub load_residual: f64,
}

/// Result of a solver before its residuals are computed.
pub(super) struct Equilibrium {
    pub(super) forces: Vec<f64>,
    /// The transmission error beyond first touch, delta - delta_0, in m.
    ///
    /// Positive, whatever the gaps; residuals are taken with it so that a large common gap costs them no digits.
    pub(super) delta_beyond_touch: f64,
    pub(super) active: Vec<bool>,
    pub(super) load_derivative: Vec<f64>,
    pub(super) stiffness: f64,
    pub(super) iterations: u32,
    pub(super) multiplier_updates: u32,
}

impl Equilibrium {
    /// Computes the residuals from the problem itself, not from the solver's state.
    pub(super) fn into_solution(self, problem: &ContactProblem, load: f64) -> ContactSolution {
        let (_, first_touch) = problem.first_touch();
        let (w, g_0, delta) = (problem.arms(), problem.gaps(), self.delta_beyond_touch);

        let mut gaps: Vec<f64> = g_0
            .iter()
            .zip(w)
            .map(|(g_0, w)| (g_0 - first_touch * w) - delta * w)
            .collect();
        let forces = self.forces.iter().copied().enumerate();
        problem.open(&mut gaps, forces.filter(|(_, force)| *force != 0.0));
        // Scaled before they are multiplied, so that tiny loads do not underflow.
        let products = self
            .forces
            .iter()
            .zip(&gaps)
            .map(|(p, g)| ((p / load) * (g / delta)).abs());
        let complementarity = products.fold(0.0, f64::max);
        let penetration = gaps.iter().fold(0.0, |deepest: f64, gap| deepest.max(-gap));
        let carried: f64 = w.iter().zip(&self.forces).map(|(w, p)| w * p).sum();

        ContactSolution {
            complementarity,
            penetration,
            load_residual: (carried - load).abs() / load,
            gaps,
            forces: self.forces,
            transmission_error: first_touch + delta,
            active: self.active,
            load_derivative: self.load_derivative,
            stiffness: self.stiffness,
            iterations: self.iterations,
            multiplier_updates: self.multiplier_updates,
        }
    }
}

/// A quantity of a contact problem that a message can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactQuantity {
    /// An entry of the compliance, in m/N.
    Compliance,
    /// A gap before loading, in m.
    Gap,
    /// An arm over the base radius.
    Arm,
}

impl fmt::Display for ContactQuantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Compliance => "compliance",
            Self::Gap => "gap",
            Self::Arm => "arm",
        })
    }
}

/// Why a contact problem could not be stated or solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContactError {
    /// The caller stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// There is no candidate point.
    #[error("no point where the bodies could touch")]
    NoPoints,
    /// Compliance, gaps and arms are not of one size.
    #[error("a compliance of {rows} by {columns} with {gaps} gaps and {arms} arms")]
    SizesDiffer {
        /// Rows of the compliance.
        rows: usize,
        /// Columns of the compliance.
        columns: usize,
        /// The number of gaps.
        gaps: usize,
        /// The number of arms.
        arms: usize,
    },
    /// An infinity or no number at all.
    #[error("the {quantity} at point {point} is {value}")]
    NotFinite {
        /// Quantity.
        quantity: ContactQuantity,
        /// Where it is; for the compliance, the row.
        point: usize,
        /// Value there.
        value: f64,
    },
    /// Two entries of the compliance that should be equal are not.
    #[error(
        "the compliance is not symmetric: {below} and {above} m/N between points {row} and {column}"
    )]
    NotSymmetric {
        /// Row of the entry below the diagonal.
        row: usize,
        /// Its column.
        column: usize,
        /// The entry below the diagonal, in m/N.
        below: f64,
        /// The entry above the diagonal, in m/N.
        above: f64,
    },
    /// An arm that is zero or negative: the force would drive the wrong way.
    #[error("the arm at point {point} is {arm}, not positive")]
    ArmNotPositive {
        /// Where it is.
        point: usize,
        /// The arm over the base radius.
        arm: f64,
    },
    /// A load that presses nothing together.
    #[error("the load is {load} N, not a positive number")]
    LoadNotPositive {
        /// The load, in N.
        load: f64,
    },
    /// A warm start for another number of points.
    #[error("a warm start of {given} points for a problem of {points}")]
    WarmStartSize {
        /// The points of the problem.
        points: usize,
        /// The points of the warm start.
        given: usize,
    },
    /// A penalty or a gap tolerance that is not a positive number.
    #[error(
        "a penalty of {penalty} N/m and a gap tolerance of {gap_tolerance} m, not both positive numbers"
    )]
    SettingsNotPositive {
        /// The penalty stiffness, in N/m.
        penalty: f64,
        /// The gap tolerance, in m.
        gap_tolerance: f64,
    },
    /// The compliance of the points in contact would give energy away.
    #[error("the compliance of {points} touching points is not positive definite")]
    NotPositiveDefinite {
        /// The number of points in contact.
        points: usize,
    },
    /// The solver came to its limit.
    #[error(
        "no contact found in {iterations} iterations: a gap is {gap} m off and a point pulls with {pull} N"
    )]
    NotConverged {
        /// The linear systems solved.
        iterations: u32,
        /// The largest penetration, or the largest gap under a force, in m.
        gap: f64,
        /// The largest pulling force, in N.
        pull: f64,
    },
}

/// Refuses a load that is zero, negative or not a number.
pub(super) fn check_load(load: f64) -> Result<(), ContactError> {
    if load.is_finite() && load > 0.0 {
        Ok(())
    } else {
        Err(ContactError::LoadNotPositive { load })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity(size: usize) -> Mat<f64> {
        Mat::from_fn(
            size,
            size,
            |row, column| if row == column { 1e-9 } else { 0.0 },
        )
    }

    #[test]
    fn a_problem_without_points_is_refused() {
        assert_eq!(
            ContactProblem::new(Mat::new(), vec![], vec![]).expect_err("a refusal"),
            ContactError::NoPoints
        );
    }

    #[test]
    fn sizes_that_differ_are_refused() {
        let refused =
            ContactProblem::new(identity(2), vec![0.0; 3], vec![1.0; 2]).expect_err("a refusal");
        assert_eq!(
            refused,
            ContactError::SizesDiffer {
                rows: 2,
                columns: 2,
                gaps: 3,
                arms: 2
            }
        );
        assert!(ContactProblem::new(Mat::zeros(2, 1), vec![0.0; 2], vec![1.0; 2]).is_err());
        assert!(ContactProblem::new(Mat::zeros(0, 3), vec![], vec![]).is_err());
    }

    #[test]
    fn what_is_no_number_is_refused_with_its_place() {
        let mut compliance = identity(2);
        compliance[(1, 0)] = f64::NAN;
        let refused =
            ContactProblem::new(compliance, vec![0.0; 2], vec![1.0; 2]).expect_err("a refusal");
        assert!(matches!(
            refused,
            ContactError::NotFinite {
                quantity: ContactQuantity::Compliance,
                point: 1,
                ..
            }
        ));
        let refused = ContactProblem::new(identity(2), vec![f64::INFINITY, 0.0], vec![1.0; 2])
            .expect_err("a refusal");
        assert!(matches!(
            refused,
            ContactError::NotFinite {
                quantity: ContactQuantity::Gap,
                point: 0,
                ..
            }
        ));
        let refused = ContactProblem::new(identity(2), vec![0.0; 2], vec![1.0, f64::NAN])
            .expect_err("a refusal");
        assert!(matches!(
            refused,
            ContactError::NotFinite {
                quantity: ContactQuantity::Arm,
                point: 1,
                ..
            }
        ));
    }

    #[test]
    fn an_arm_that_does_not_drive_is_refused() {
        let refused =
            ContactProblem::new(identity(2), vec![0.0; 2], vec![1.0, 0.0]).expect_err("a refusal");
        assert_eq!(refused, ContactError::ArmNotPositive { point: 1, arm: 0.0 });
    }

    #[test]
    fn a_compliance_that_is_not_symmetric_is_refused_and_rounding_is_evened_out() {
        let mut compliance = identity(2);
        compliance[(1, 0)] = 1e-12;
        assert!(matches!(
            ContactProblem::new(compliance.clone(), vec![0.0; 2], vec![1.0; 2]),
            Err(ContactError::NotSymmetric {
                row: 1,
                column: 0,
                ..
            })
        ));
        compliance[(1, 0)] = 4e-21;
        let problem =
            ContactProblem::new(compliance, vec![0.0; 2], vec![1.0; 2]).expect("a sound problem");
        assert_eq!(
            (problem.compliance()[(1, 0)], problem.compliance()[(0, 1)]),
            (2e-21, 2e-21)
        );
    }

    #[test]
    fn the_point_of_least_gap_over_arm_touches_first() {
        let problem =
            ContactProblem::new(identity(3), vec![3e-6, 1e-6, 1.1e-6], vec![1.0, 0.5, 1.0])
                .expect("a sound problem");
        let (point, delta) = problem.first_touch();
        assert_eq!(point, 2);
        // 1.1 um over 1 is less than 1 um over one half.
        assert_eq!(delta, 1.1e-6);
    }
}
