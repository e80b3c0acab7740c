//! Further positions, where pressures and stresses may be larger than at those that are known.
//!
//! Pressure rises steeply as a kink passes the middle of a contact, and stresses where a tooth takes up the load: the largest value may lie between two
//! positions. Beside a position at which a value is larger than at its neighbors, lines through the positions on both sides bound the values between.

use super::Span;
use crate::analysis::Case;

/// Extremes are known to this part of them.
const KNOWN_TO: f64 = 7e-3;

/// How many positions are solved further in each round at most; later rounds know better.
const ROUNDS: [usize; 5] = [2, 2, 1, 1, 1];

/// How many positions are solved further for peaks at most.
pub(in crate::analysis) const MOST_FOR_PEAKS: usize = 7;

/// A further position leaves this part of the way to its neighbors on either side, and none is looked for in a gap of less than this part of a step.
const BESIDE: f64 = 0.15;
const NARROWEST: f64 = 1.0 / 64.0;

/// Values at one position, of which some are not known: none may have a limit there.
pub(in crate::analysis) type Watched = (f64, Vec<Option<f64>>);

/// The stretch of a curve in which its peaks are looked for.
pub(in crate::analysis) struct PeakSearch {
    first: f64,
    length: f64,
    step: f64,
    /// True if the values are periodic in it.
    closes: bool,
}

/// A place between two positions, and how far the value there may lie above the largest that is known, as a part of this.
struct Doubt {
    position: f64,
    excess: f64,
}

impl PeakSearch {
    /// Peaks of the curves of `case`, whose contacts repeat after the given number of mesh periods.
    pub(in crate::analysis) fn of(case: &Case, repeats_after: u32) -> Self {
        Self::within(Span::of(case), repeats_after)
    }

    fn within(span: Span, repeats_after: u32) -> Self {
        Self {
            first: span.first,
            length: f64::from(repeats_after),
            step: span.step(),
            closes: span.closes || repeats_after < span.periods,
        }
    }

    /// Adds further positions of `solve` to `known`, until the extremes are known or the limit is reached. Returns their number.
    ///
    /// # Errors
    ///
    /// Errors of `solve`.
    pub(in crate::analysis) fn extend<E>(
        &self,
        mut known: Vec<Watched>,
        mut solve: impl FnMut(&[f64]) -> Result<Vec<Watched>, E>,
    ) -> Result<usize, E> {
        let mut solved = 0;
        for most in ROUNDS {
            let positions = self.chosen(&known, most);
            if positions.is_empty() {
                break;
            }
            solved += positions.len();
            known.extend(solve(&positions)?);
        }
        Ok(solved)
    }

    /// At most `most` positions at which the values of `known` positions may be larger than at all of these, the most doubtful first.
    fn chosen(&self, known: &[Watched], most: usize) -> Vec<f64> {
        let mut rising: Vec<(f64, &[Option<f64>])> = known
            .iter()
            .map(|(position, values)| (self.folded(*position), values.as_slice()))
            .collect();
        rising.sort_by(|a, b| a.0.total_cmp(&b.0));
        rising.dedup_by(|a, b| (a.0 - b.0).abs() < 1e-9);
        let count = rising.first().map_or(0, |(_, values)| values.len());
        let mut doubts: Vec<Doubt> = (0..count)
            .filter_map(|i| {
                let each = rising.iter();
                let values: Option<Vec<_>> = each
                    .map(|(position, values)| Some((*position, values[i]?)))
                    .collect();
                Some(self.doubts(&values?))
            })
            .flatten()
            .collect();
        doubts.sort_by(|a, b| {
            let urgent = b.excess.total_cmp(&a.excess);
            urgent.then(a.position.total_cmp(&b.position))
        });
        let mut chosen: Vec<f64> = Vec::new();
        for Doubt { position, .. } in doubts {
            let is_near = |other: &f64| (other - position).abs() < NARROWEST * self.step;
            if chosen.len() < most && !chosen.iter().any(is_near) {
                chosen.push(position);
            }
        }
        chosen.sort_by(f64::total_cmp);
        chosen
    }

    /// `position`, whole lengths earlier.
    fn folded(&self, position: f64) -> f64 {
        if self.closes {
            self.first + (position - self.first).rem_euclid(self.length)
        } else {
            position
        }
    }

    /// Where a curve through rising `values` may be larger than it is at any of them.
    fn doubts(&self, values: &[(f64, f64)]) -> Vec<Doubt> {
        let largest = values.iter().map(|value| value.1).fold(0.0, f64::max);
        let count = values.len() as isize;
        if largest <= 0.0 || count < 2 {
            return Vec::new();
        }
        // A curve that closes goes on beyond its ends.
        let at = |i: isize| {
            let (place, around) = (i.rem_euclid(count) as usize, i.div_euclid(count));
            let (position, value) = values[place];
            (self.closes || around == 0).then_some((position + around as f64 * self.length, value))
        };
        let mut doubts = Vec::new();
        for i in 0..count {
            let peak = values[i as usize];
            let beside = [at(i - 1), at(i + 1)];
            if beside.iter().flatten().any(|other| other.1 > peak.1) {
                continue;
            }
            for way in [-1, 1] {
                let Some(next) = at(i + way) else { continue };
                let gap = (next.0 - peak.0).abs();
                if gap < 2.0 * NARROWEST * self.step {
                    continue;
                }
                // How fast it rises towards the gap on this side, and how fast from the gap on to the other.
                let rise = |from: Option<(f64, f64)>, to: (f64, f64)| {
                    from.map_or(0.0, |from| (to.1 - from.1) / (to.0 - from.0).abs())
                };
                let (before, behind) = (rise(at(i - way), peak), rise(at(i + 2 * way), next));
                let meet = (next.1 - peak.1 + behind * gap) / (before + behind);
                // Else the curve falls somewhere in the gap, or jumps.
                let meet = if behind > 0.0 && meet > 0.0 {
                    meet
                } else {
                    0.5 * gap
                };
                let excess = (peak.1 + before * meet.clamp(0.0, gap)) / largest - 1.0;
                if excess > KNOWN_TO {
                    let way = way as f64 * meet.clamp(BESIDE * gap, (1.0 - BESIDE) * gap);
                    doubts.push(Doubt {
                        position: self.folded(peak.0 + way),
                        excess,
                    });
                }
            }
        }
        doubts
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;

    /// The largest value found of a curve at a given number of positions of one mesh period, and the number of further positions solved.
    fn found(curve: impl Fn(f64) -> Option<f64>, count: u32) -> (f64, usize) {
        let search = PeakSearch::within(Span::new(0.0, 1, count, true), 1);
        let watched = |x: f64| (x, vec![curve(x)]);
        let known: Vec<Watched> = (0..count)
            .map(|i| watched(f64::from(i) / f64::from(count)))
            .collect();
        let largest = |known: &[Watched]| {
            let values = known.iter().filter_map(|(_, values)| values[0]);
            values.fold(0.0, f64::max)
        };
        let mut most = largest(&known);
        let solved = search.extend(known, |positions| {
            let more: Vec<Watched> = positions.iter().copied().map(watched).collect();
            most = most.max(largest(&more));
            Ok::<_, Infallible>(more)
        });
        (most, solved.expect("nothing fails"))
    }

    #[test]
    fn a_peak_between_two_positions_is_found() {
        // A kink of 4,000 that falls by half within a twentieth of the period, on a curve that is flat else: between positions 19 and 20 of 40, and across the
        // end of the period.
        for place in [0.4879, 0.9889] {
            let curve = |x: f64| {
                let away = (x - place).abs();
                Some(2000.0 + 2000.0 * (1.0 - away.min(1.0 - away) / 0.05).max(0.0))
            };
            let (most, solved) = found(curve, 40);
            assert!((most / 4000.0 - 1.0).abs() < 1e-2, "{most}");
            assert!(solved <= MOST_FOR_PEAKS);
        }
    }

    #[test]
    fn a_curve_that_rises_until_it_jumps_is_followed_to_the_jump() {
        // By 15 % of the jump in a step of 40 positions.
        let curve = |x: f64| {
            Some(if x < 0.4879 {
                4000.0 - 24e3 * (0.4879 - x)
            } else {
                1500.0
            })
        };
        let (most, solved) = found(|x| curve(x).map(|value: f64| value.max(1500.0)), 40);
        assert!((most / 4000.0 - 1.0).abs() < 1e-2, "{most}");
        assert!(solved <= MOST_FOR_PEAKS);
    }

    #[test]
    fn where_a_value_has_no_limit_or_is_smooth_nothing_is_solved() {
        let smooth = |x: f64| Some(700.0 + 50.0 * (std::f64::consts::TAU * x).cos());
        assert_eq!(found(smooth, 40).1, 0);
        let unbounded = |x: f64| (x < 0.9).then_some(if x < 0.5 { 1.0 } else { 2.0 });
        assert_eq!(found(unbounded, 40).1, 0);
    }
}
