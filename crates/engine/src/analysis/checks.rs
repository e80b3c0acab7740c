//! Where a projection is compared with exact solutions.

use super::case::Case;

/// Where the projection is held to exact solutions: fractions of the mesh period, and mesh periods for each of them, at most.
///
/// The term is exact while the same cells touch. It leaves out that holes let a pair touch earlier or later: at the fractions at which the stiffness of round
/// blanks changes most, in some periods and not in others. On the paper's cases, and on a polymer gear with five large holes, these positions contain 0.7 to
/// all of the largest difference; positions at which the term itself is largest contain nothing of it.
const CHECKED: [usize; 2] = [4, 6];

/// The same where teeth that deviate are solved on the slices of the drawn pair: an exact solution takes as long as a hundred of these.
const CHECKED_AS_DRAWN: [usize; 2] = [2, 3];

/// Exact solutions to which the projection is held: how many are known before where.
#[derive(Clone, Copy)]
pub(super) struct Checks {
    fractions: usize,
    periods: usize,
}

impl Checks {
    pub(super) const NONE: Self = Self {
        fractions: 0,
        periods: 0,
    };

    /// Checks of `case`: none where nothing is projected.
    pub(super) fn of(case: &Case) -> Self {
        let [most_fractions, most_periods] = match case.is_solved_as_drawn() {
            true => CHECKED_AS_DRAWN,
            false if case.holed().is_empty() => return Self::NONE,
            false => CHECKED,
        };
        let fractions = case.resolution.positions_per_mesh_period as usize;
        Self {
            fractions: fractions.min(most_fractions),
            periods: (case.span() as usize).min(most_periods),
        }
    }

    pub(super) fn solutions(self) -> u64 {
        (self.fractions * self.periods) as u64
    }

    /// Number of positions that are the first at their fraction of the mesh period.
    pub(super) fn first_solutions(self) -> u64 {
        self.fractions as u64
    }

    /// Their places in the curve of `case`, with this stiffness on `round` blanks at its repeating positions.
    pub(super) fn places(self, case: &Case, round: &[f64]) -> Vec<usize> {
        let per_period = case.resolution.positions_per_mesh_period as usize;
        let (span, count) = (case.span() as usize, round.len());
        let stiffness = |i: usize| round[i % count];
        let change = |i: usize| {
            let after = stiffness(i + 1) / stiffness(i);
            let before = stiffness(i + count - 1) / stiffness(i);
            after.ln().abs().max(before.ln().abs())
        };
        let mut fractions: Vec<usize> = (0..per_period).collect();
        fractions.sort_by(|&a, &b| change(b).total_cmp(&change(a)));
        fractions.truncate(self.fractions);
        let periods = self.periods;
        let of_fraction =
            |fraction| (0..periods).map(move |j| j * span / periods * per_period + fraction);
        fractions.into_iter().flat_map(of_fraction).collect()
    }
}
