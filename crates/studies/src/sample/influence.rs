//! Influences: the part of a result's variance that an input makes, of first order (Sobol').
//!
//! The share of x is Var(E[y | x])/Var(y): the part of the variance that would vanish on average if x were known. Both estimators use the members as they are,
//! without further ones.

use crate::sample::{BATCHES, Estimate, REPLICATES};

/// Number of neighbors to each side: more of them settle the average, and lie farther off.
const MOST_NEIGHBORS: usize = 16;

/// Members in the order of a number that is an input of theirs.
///
/// Its share is found by ranks. Members that stand next to each other here have nearly the same input and nothing else in common. So the
/// covariance of their results is the variance of E[y | x] (Gamboa, Gremaud, Klein and Lagnoux 2022, averaged over some neighbors).
#[derive(Debug, Clone)]
pub struct Ranked {
    /// Number and place of each member, by rising input.
    order: Vec<(u32, usize)>,
}

impl Ranked {
    /// The members of these numbers, in the order of their inputs.
    pub fn new(members: &[u32], inputs: &[f64]) -> Self {
        let numbered = members.iter().copied().zip(0..);
        let mut order: Vec<(u32, usize)> = numbered.collect();
        order.sort_by(|a, b| inputs[a.1].total_cmp(&inputs[b.1]).then(a.cmp(b)));
        Self { order }
    }

    /// The share of the input in the variance of `results`, those that are no number left out. Limits follow from the same estimate in each
    /// batch. None where nothing varies.
    pub fn share(&self, results: &[f64]) -> Option<Estimate> {
        // A few members say nothing of how far the estimate is off.
        const FEWEST: usize = 8;
        let sorted: Vec<(u32, f64)> = self
            .order
            .iter()
            .map(|(member, place)| (*member, results[*place]))
            .filter(|(_, result)| !result.is_nan())
            .collect();
        let value = share_of(&sorted)?;
        let mut batches: [Vec<(u32, f64)>; BATCHES] = Default::default();
        for one in &sorted {
            batches[crate::sample::batch(one.0)].push(*one);
        }
        let parts: Option<Vec<f64>> = batches
            .iter()
            .map(|batch| share_of(batch).filter(|_| batch.len() >= FEWEST))
            .collect();
        let parts = parts.unwrap_or_default();
        let limits = Estimate::of_parts(value, &parts);
        // Fewer members lie farther apart; the effect on the estimate bounds the same effect in the whole. A third of the way to each limit is added because
        // shares of batches are not normal.
        let half = limits.high.map_or(0.0, |high| high - value);
        let apart =
            half / 3.0 + crate::sample::mean(&parts).map_or(0.0, |mean| (mean - value).abs());
        Some(bounded(Estimate {
            value,
            low: limits.low.map(|low| low - apart),
            high: limits.high.map(|high| high + apart),
        }))
    }
}

/// The share of the input by which these members are sorted, each with its result.
fn share_of(sorted: &[(u32, f64)]) -> Option<f64> {
    let n = sorted.len();
    let mean = sorted.iter().map(|(_, y)| y).sum::<f64>() / n as f64;
    let variance = sorted.iter().map(|(_, y)| (y - mean).powi(2)).sum::<f64>() / n as f64;
    if n < 2 || is_nothing(variance, mean) {
        return None;
    }
    let neighbors = (libm::cbrt(n as f64).ceil() as usize).min(MOST_NEIGHBORS);
    // Each member counts alike, those at the ends too, which have neighbors on one side only.
    let (mut sum, mut count) = (0.0, 0_u64);
    for (i, (member, y)) in sorted.iter().enumerate() {
        // Neighbors of one replicate of Sobol' points are not independent: their other coordinates are kept apart from each other.
        let of_another = |other: &&(u32, f64)| other.0 % REPLICATES != member % REPLICATES;
        let behind = sorted[i + 1..].iter().filter(of_another).take(neighbors);
        let before = sorted[..i].iter().rev().filter(of_another).take(neighbors);
        let (total, met) = behind
            .chain(before)
            .fold((0.0, 0), |(total, met), (_, other)| {
                (total + (other - mean), met + 1)
            });
        if met > 0 {
            sum += (y - mean) * total / f64::from(met);
            count += 1;
        }
    }
    (count > 0).then(|| sum / count as f64 / variance)
}

/// True if a variance is only rounding.
fn is_nothing(variance: f64, mean: f64) -> bool {
    variance <= 1e-24 * mean * mean
}

/// The share of a group of inputs, its members together: of pairs that have the whole group in common and nothing else, the covariance
/// over the variance. Limits are those of the jackknife, taken of artanh of the share, whose law is nearer to the normal one, and somewhat wider, because that of
/// squares is askew. None where nothing varies.
pub fn of_group(pairs: &[[f64; 2]]) -> Option<Estimate> {
    const FEWEST: usize = 8;
    let middle = pairs.iter().flatten().sum::<f64>() / (2 * pairs.len()) as f64;
    let moments = |[a, b]: [f64; 2]| {
        let (a, b) = (a - middle, b - middle);
        [a + b, a * b, (a * a + b * b) / 2.0]
    };
    let each = pairs.iter().copied().map(moments);
    let all = each.clone().fold([0.0; 3], |sum, own| {
        [sum[0] + own[0], sum[1] + own[1], sum[2] + own[2]]
    });
    // Of `n` pairs with these sums: the covariance about their mean over the variance.
    let share = |[sum, product, square]: [f64; 3], n: f64| {
        let of_mean = sum * sum / (4.0 * n);
        (product - of_mean) / (square - of_mean)
    };
    let n = pairs.len() as f64;
    if pairs.is_empty() || is_nothing(all[2] / n, middle) {
        return None;
    }
    let value = share(all, n);
    // Where pairs are equal artanh has no limit.
    let stretched = |share: f64| libm::atanh(share.clamp(-0.999_999, 0.999_999));
    let half = (pairs.len() >= FEWEST).then(|| {
        let left_out = each.map(|own| {
            let rest = [all[0] - own[0], all[1] - own[1], all[2] - own[2]];
            stretched(share(rest, n - 1.0))
        });
        let left_out: Vec<f64> = left_out.collect();
        let spread = crate::sample::standard_deviation(&left_out).unwrap_or(0.0) * (n - 1.0).sqrt();
        // Student's factor for n - 1 degrees of freedom; the room was measured.
        let student = 1.96 + 2.4 / (n - 1.0) + 3.0 / (n - 1.0).powi(2);
        (1.0 + 2.0 / n.sqrt()) * student * spread
    });
    let limit = |half: f64| libm::tanh(stretched(value) + half);
    Some(bounded(Estimate {
        value,
        low: half.map(|half| limit(-half)),
        high: half.map(limit),
    }))
}

/// The estimate within 0 and 1.
fn bounded(estimate: Estimate) -> Estimate {
    let part = |value: f64| value.clamp(0.0, 1.0);
    Estimate {
        value: part(estimate.value),
        low: estimate.low.map(part),
        high: estimate.high.map(part),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::sample::points::{Points, Sampling};

    /// Ishigami's function with a = 7, b = 0.1, whose shares are 0.3139, 0.4424 and 0 in closed form.
    fn ishigami(x: [f64; 3]) -> f64 {
        x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
    }

    fn expected() -> [f64; 3] {
        let (a, b) = (7.0_f64, 0.1_f64);
        let first = 0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2);
        let second = a * a / 8.0;
        let both = 8.0 * b * b * PI.powi(8) / 225.0;
        let all = first + second + both;
        [first / all, second / all, 0.0]
    }

    fn share<const N: usize>(
        members: &[(u32, [f64; N])],
        axis: usize,
        result: impl Fn([f64; N]) -> f64,
    ) -> Estimate {
        let numbers: Vec<u32> = members.iter().map(|(member, _)| *member).collect();
        let inputs: Vec<f64> = members.iter().map(|(_, x)| x[axis]).collect();
        let results: Vec<f64> = members.iter().map(|(_, x)| result(*x)).collect();
        Ranked::new(&numbers, &inputs)
            .share(&results)
            .expect("it varies")
    }

    #[test]
    fn the_shares_of_ishigami_s_function_are_found_by_both_ways_of_sampling() {
        for sampling in [Sampling::Sobol, Sampling::Random] {
            let points = Points { sampling, seed: 1 };
            let members: Vec<(u32, [f64; 3])> = (0..8192)
                .map(|member| {
                    (
                        member,
                        [0, 1, 2].map(|axis| PI * (2.0 * points.at(member, axis) - 1.0)),
                    )
                })
                .collect();
            for (axis, expected) in expected().into_iter().enumerate() {
                let found = share(&members, axis, ishigami);
                assert!(
                    (found.value - expected).abs() < 0.02,
                    "{sampling:?} {axis}: {found:?}"
                );
                assert!(
                    found.high.unwrap() - found.low.unwrap() < 0.1,
                    "{sampling:?} {axis}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn limits_of_shares_of_fields_hold_the_truth() {
        for sampling in [Sampling::Sobol, Sampling::Random] {
            for count in [64, 256, 1024] {
                let mut held = [0; 2];
                for seed in 0..200 {
                    let points = Points { sampling, seed };
                    // y = x1 + 2 x2: shares 1/5 and 4/5.
                    let at = |member| [points.at(member, 0), points.at(member, 1)];
                    let members: Vec<(u32, [f64; 2])> =
                        (0..count).map(|member| (member, at(member))).collect();
                    for (axis, truth) in [0.2, 0.8].into_iter().enumerate() {
                        let found = share(&members, axis, |x| x[0] + 2.0 * x[1]);
                        held[axis] +=
                            u32::from(found.low.unwrap() <= truth && truth <= found.high.unwrap());
                    }
                }
                // 200 seeds tell a share of 95 % within 3 %.
                assert!(
                    held.iter().all(|held| *held >= 184),
                    "{sampling:?} {count}: {held:?}"
                );
            }
        }
    }

    #[test]
    fn limits_of_shares_of_groups_hold_the_truth() {
        // The common part and the own parts are normal, of variances 3 and 7; as they are, and as exponents of a tenth of them, which is askew: of a log-normal
        // law the share is (exp(c) - 1)/(exp(c + d) - 1).
        let (common, own) = (0.3_f64, 0.7_f64);
        let askew = (common.exp() - 1.0) / ((common + own).exp() - 1.0);
        for (make, truth) in [
            ((|z| z) as fn(f64) -> f64, common),
            (f64::exp as fn(f64) -> f64, askew),
        ] {
            for count in [16, 32, 128, 512] {
                let held = (0..400).filter(|seed| {
                    let points = Points {
                        sampling: Sampling::Random,
                        seed: *seed,
                    };
                    let normal =
                        |pair, axis| crate::sample::normal::quantile(points.at(pair, axis));
                    let pair = |pair| {
                        let both = common.sqrt() * normal(pair, 0);
                        [1, 2].map(|axis| make(both + own.sqrt() * normal(pair, axis)))
                    };
                    let pairs: Vec<[f64; 2]> = (0..count).map(pair).collect();
                    let found = of_group(&pairs).unwrap();
                    found.low.unwrap() <= truth && truth <= found.high.unwrap()
                });
                let held = held.count();
                assert!(held >= 368, "{count} pairs, {truth}: {held} of 400");
            }
        }
    }

    #[test]
    fn a_group_makes_the_part_of_the_variance_that_its_pairs_have_in_common() {
        let points = Points {
            sampling: Sampling::Random,
            seed: 5,
        };
        // The group makes 3 of 4 parts; the rest is each member's own.
        let root = 3.0_f64.sqrt();
        let pairs: Vec<[f64; 2]> = (0..4000)
            .map(|pair| {
                let common = root * points.at(pair, 0);
                [common + points.at(pair, 1), common + points.at(pair, 2)]
            })
            .collect();
        let found = of_group(&pairs).unwrap();
        assert!((found.value - 0.75).abs() < 0.02, "{found:?}");
        assert!(found.low.unwrap() < 0.75 && 0.75 < found.high.unwrap());
        assert_eq!(of_group(&[[1.0, 1.0]; 20]), None);
        assert_eq!(of_group(&[]), None);
    }
}
