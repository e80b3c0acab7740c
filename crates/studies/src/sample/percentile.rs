//! Percentiles, and how far they are to be trusted.

use crate::sample::{Estimate, REPLICATES};

/// The value below which `percent` of the sorted values lie, linear between neighbors, as `numpy.percentile` has it.
///
/// # Panics
///
/// Without values.
pub fn percentile(sorted: &[f64], percent: f64) -> f64 {
    let place = percent / 100.0 * (sorted.len() - 1) as f64;
    let (below, part) = (place.floor() as usize, place.fract());
    match sorted.get(below + 1) {
        // At a place of its own a value has no part of its neighbor, which may lie beyond all numbers.
        Some(above) if part > 0.0 => sorted[below] + part * (above - sorted[below]),
        _ => sorted[below],
    }
}

/// A percentile of independent members: its limits are the order statistics between which it lies with 95 % confidence, whatever
/// the law. A limit is none where not even the outermost member would do: of the 95th percentile above up to 71 members, of the 99th up to 366.
///
/// `effect` is how many times the share of members below the percentile varies as much as that of as many independent members would:
/// 1 unless members share inputs.
pub fn of_independent(sorted: &[f64], percent: f64, effect: f64) -> Estimate {
    let [low, high] = limits(sorted.len(), percent, effect.max(1.0));
    Estimate {
        value: percentile(sorted, percent),
        low: low.map(|rank| sorted[rank - 1]),
        high: high.map(|rank| sorted[rank - 1]),
    }
}

/// A percentile of replicated scramblings, of members and their values, sorted by value. The limits are order statistics again. They are narrower
/// as far as the share of members below the percentile varies less between replicates than between sets of independent members. `effect` is that of
/// shared inputs, as for [`of_independent`].
///
/// Without shared inputs limits are never wider than those of independent members, and there are none where those have none.
pub fn of_replicates(sorted: &[(u32, f64)], percent: f64, effect: f64) -> Estimate {
    let values: Vec<f64> = sorted.iter().map(|(_, value)| *value).collect();
    let outer = of_independent(&values, percent, effect);
    let effect = effect * settled(sorted, outer.value, percent / 100.0);
    let [low, high] = limits(values.len(), percent, effect);
    // Roundings of a rank may not lead beyond the limits of independent members.
    let inner = |limit: Option<f64>, rank: Option<usize>, nearer: fn(f64, f64) -> f64| {
        limit.map(|limit| rank.map_or(limit, |rank| nearer(limit, values[rank - 1])))
    };
    Estimate {
        low: inner(outer.low, low, f64::max),
        high: inner(outer.high, high, f64::min),
        ..outer
    }
}

/// The ranks, from 1, of the members among `count` that bound a percentile, as good as `effect` times fewer independent ones.
fn limits(count: usize, percent: f64, effect: f64) -> [Option<usize>; 2] {
    let independent = ((count as f64 / effect).floor() as u32).max(1);
    let [low, high] = ranks(independent, percent / 100.0);
    // A rank among other than all members is the rank of the same share among all, rounded outward.
    let scale = count as f64 / f64::from(independent);
    let at = |rank: f64| (rank as usize).clamp(1, count);
    [
        low.map(|rank| at((scale * f64::from(rank)).floor())),
        high.map(|rank| at((scale * f64::from(rank)).ceil())),
    ]
}

/// How many times the number of members not above `limit` varies as much, from replicate to replicate, as that of independent members would, at most 1;
/// `share` of them are expected below.
fn settled(sorted: &[(u32, f64)], limit: f64, share: f64) -> f64 {
    // Sixteen replicates tell a variance within a third: so much more it may be. Measured, limits then hold the truth 94 to 100 times of 100.
    const ROOM: f64 = 1.5;
    // Nobody needs more, and ranks among fifty times as many members are soon found.
    const LEAST: f64 = 0.02;
    let replicates = REPLICATES as usize;
    let mut beyond_share = vec![0.0; replicates];
    for (member, value) in sorted {
        let below = f64::from(u8::from(*value <= limit));
        beyond_share[(member % REPLICATES) as usize] += below - share;
    }
    let mean = beyond_share.iter().sum::<f64>() / replicates as f64;
    let squares: f64 = beyond_share.iter().map(|own| (own - mean).powi(2)).sum();
    let of_sum = squares * replicates as f64 / (replicates - 1) as f64;
    let independent = sorted.len() as f64 * share * (1.0 - share);
    (ROOM * of_sum / independent).clamp(LEAST, 1.0)
}

/// How many times the number of members not above `limit` varies as much as that of independent ones would, where some are `pairs`
/// with inputs in common, among `count` members.
pub fn design_effect(pairs: &[[f64; 2]], count: usize, limit: f64, share: f64) -> f64 {
    let below = |value: f64| f64::from(u8::from(value <= limit)) - share;
    let covariance: f64 = pairs.iter().map(|[a, b]| below(*a) * below(*b)).sum();
    let variance = share * (1.0 - share) * count as f64;
    if variance > 0.0 {
        (1.0 + 2.0 * covariance / variance).clamp(1.0, 2.0)
    } else {
        1.0
    }
}

/// The largest rank below which, and the smallest above which, the quantile `p` of a law lies with a probability of at most 2.5 % each,
/// among `n` independent members.
fn ranks(n: u32, p: f64) -> [Option<u32>; 2] {
    // 2.5 % to the digits that anybody tells: 0.99^367 is 0.02501.
    const EACH: f64 = 0.025_05;
    // Number of standard deviations from the mean beyond which nothing adds to either sum.
    const NOTHING: f64 = 12.0;
    let mean = f64::from(n) * p;
    let reach = NOTHING * (mean * (1.0 - p)).sqrt() + NOTHING;
    let first = (mean - reach).max(0.0) as u32;
    let last = ((mean + reach) as u32).min(n);
    // Number of members not above the quantile: B of the binomial law. It lies below rank l with P(B < l).
    let mut below = 0.0;
    let mut low = None;
    for k in first..n {
        below += binomial(n, p, k);
        if below > EACH {
            break;
        }
        low = Some(k + 1);
    }
    // The quantile lies above rank u with P(B >= u).
    let mut above = 0.0;
    let mut high = None;
    for k in (1..=last).rev() {
        above += binomial(n, p, k);
        if above > EACH {
            break;
        }
        high = Some(k);
    }
    [low, high]
}

/// The probability of k among n.
fn binomial(n: u32, p: f64, k: u32) -> f64 {
    let [n, k] = [n, k].map(f64::from);
    let choices = libm::lgamma(n + 1.0) - libm::lgamma(k + 1.0) - libm::lgamma(n - k + 1.0);
    libm::exp(choices + k * libm::log(p) + (n - k) * libm::log1p(-p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::normal::quantile;
    use crate::sample::points::{Points, Sampling};

    #[test]
    fn percentiles_are_those_of_numpy() {
        let sorted = [1.0, 2.0, 4.0, 8.0];
        // numpy.percentile([1, 2, 4, 8], [0, 5, 50, 95, 100]).
        for (percent, value) in [
            (0.0, 1.0),
            (5.0, 1.15),
            (50.0, 3.0),
            (95.0, 7.4),
            (100.0, 8.0),
        ] {
            assert!((percentile(&sorted, percent) - value).abs() < 1e-12);
        }
        assert_eq!(percentile(&[3.0], 99.0), 3.0);
    }

    #[test]
    fn ranks_are_those_of_textbooks() {
        // The median of 10: from the 2nd to the 9th (97.9 %); of 100: from the 40th to the 61st.
        assert_eq!(ranks(10, 0.5), [Some(2), Some(9)]);
        assert_eq!(ranks(100, 0.5), [Some(40), Some(61)]);
        // Of five members none bounds the median with so much confidence; of 100 none bounds the 99th percentile above.
        assert_eq!(ranks(5, 0.5), [None, None]);
        assert_eq!(ranks(100, 0.99)[1], None);
        let [low, high] = ranks(100_000, 0.5);
        assert!((f64::from(low.unwrap()) - 49_690.0).abs() < 2.0);
        assert!((f64::from(high.unwrap()) - 50_311.0).abs() < 2.0);
    }

    /// A quantity of a member whose percentiles are known in closed form.
    struct Known {
        of: fn(&dyn Fn(u32) -> f64, f64) -> f64,
        percentile: fn(f64) -> f64,
    }

    const KNOWN: [Known; 3] = [
        // The sum of two uniform numbers, whose law is a triangle.
        Known {
            of: |at, _| at(0) + at(1),
            percentile: |p| {
                if p < 0.5 {
                    (2.0 * p).sqrt()
                } else {
                    2.0 - (2.0 * (1.0 - p)).sqrt()
                }
            },
        },
        // The sum of eight normal ones, of variance 1.
        Known {
            of: |at, _| (0..8).map(|axis| quantile(at(axis))).sum::<f64>() / 8_f64.sqrt(),
            percentile: quantile,
        },
        // One fifth of the variance is on an axis, the rest is each member's own, as teeth are. Exponential, so that it is askew.
        Known {
            of: |at, own| (0.5 * quantile(at(0)) + quantile(own)).exp(),
            percentile: |p| (1.25_f64.sqrt() * quantile(p)).exp(),
        },
    ];

    /// Members of a sample and their values, sorted by value.
    fn sorted(known: &Known, sampling: Sampling, seed: u32, count: u32) -> Vec<(u32, f64)> {
        let points = Points { sampling, seed };
        let own = Points {
            sampling: Sampling::Random,
            seed: seed + 1_000_000,
        };
        let value = |member| (known.of)(&|axis| points.at(member, axis), own.at(member, 0));
        let mut values: Vec<(u32, f64)> =
            (0..count).map(|member| (member, value(member))).collect();
        values.sort_by(|a, b| a.1.total_cmp(&b.1));
        values
    }

    #[test]
    fn limits_hold_the_true_percentile_and_are_no_wider_than_those_of_independent_members() {
        const SEEDS: u32 = 400;
        let (mut all_held, mut all) = (0, 0);
        for count in [64, 256, 1024] {
            for (i, known) in KNOWN.iter().enumerate() {
                let mut held = [0; 4];
                for seed in 0..SEEDS {
                    let members = sorted(known, Sampling::Sobol, seed, count);
                    let values: Vec<f64> = members.iter().map(|(_, value)| *value).collect();
                    for (held, percent) in held.iter_mut().zip([5.0, 50.0, 95.0, 99.0]) {
                        let truth = (known.percentile)(percent / 100.0);
                        let found = of_replicates(&members, percent, 1.0);
                        let holds = found.low.is_none_or(|low| low <= truth)
                            && found.high.is_none_or(|high| truth <= high);
                        *held += u32::from(holds);
                        let wide = of_independent(&values, percent, 1.0);
                        assert_eq!(
                            (found.low.is_some(), found.high.is_some()),
                            (wide.low.is_some(), wide.high.is_some())
                        );
                        assert!(found.low >= wide.low && found.low <= Some(found.value));
                        assert!(
                            found
                                .high
                                .zip(wide.high)
                                .is_none_or(|(own, wide)| own <= wide)
                        );
                    }
                }
                for held in held {
                    let share = f64::from(held) / f64::from(SEEDS);
                    assert!(share >= 0.92, "{count} members, quantity {i}: {share}");
                    all_held += held;
                    all += SEEDS;
                }
            }
        }
        let share = f64::from(all_held) / f64::from(all);
        assert!(share >= 0.94, "{share}");
    }

    #[test]
    fn limits_of_random_members_hold_the_true_percentile_nineteen_times_of_twenty() {
        let known = &KNOWN[2];
        let truth = (known.percentile)(0.75);
        let holds = (0..400).filter(|seed| {
            let members = sorted(known, Sampling::Random, *seed, 320);
            let values: Vec<f64> = members.iter().map(|(_, value)| *value).collect();
            let found = of_independent(&values, 75.0, 1.0);
            found.low.expect("enough members") <= truth
                && truth <= found.high.expect("enough members")
        });
        let share = holds.count() as f64 / 400.0;
        assert!((0.92..=0.99).contains(&share), "{share}");
    }

    #[test]
    fn sobol_points_tell_the_middle_of_a_smooth_quantity_nearer_than_independent_ones() {
        // Measured: 0.4 times as wide.
        let width = |found: Estimate| {
            found.high.expect("enough members") - found.low.expect("enough members")
        };
        let (mut own, mut independent) = (0.0, 0.0);
        for seed in 0..50 {
            let members = sorted(&KNOWN[0], Sampling::Sobol, seed, 1024);
            let values: Vec<f64> = members.iter().map(|(_, value)| *value).collect();
            own += width(of_replicates(&members, 50.0, 1.0));
            independent += width(of_independent(&values, 50.0, 1.0));
        }
        assert!(own < 0.5 * independent, "{own} {independent}");
    }

    #[test]
    fn a_limit_that_no_member_carries_is_none() {
        // 0.95^71 = 0.0262 and 0.95^72 = 0.0249; 0.99^366 = 0.0253 and 0.99^367 = 0.0250. Beyond 2.5 % the largest member is no limit.
        for (percent, fewest) in [(95.0, 72), (99.0, 367)] {
            for (count, is_known) in [(fewest - 1, false), (fewest, true)] {
                let members = sorted(&KNOWN[0], Sampling::Sobol, 1, count);
                let found = of_replicates(&members, percent, 1.0);
                assert_eq!(found.high.is_some(), is_known, "{percent} {count}");
                let found = of_replicates(&members, 100.0 - percent, 1.0);
                assert_eq!(found.low.is_some(), is_known, "{percent} {count}");
            }
        }
    }

    #[test]
    fn members_that_share_inputs_count_for_fewer() {
        // Two of two are equal: as good as half as many.
        let pairs: Vec<[f64; 2]> = (0..1000).map(|i| [f64::from(i); 2]).collect();
        let effect = design_effect(&pairs, 2000, 499.5, 0.5);
        assert!((effect - 2.0).abs() < 1e-9, "{effect}");
        let apart: Vec<[f64; 2]> = (0..1000)
            .map(|i| [f64::from(i), f64::from(i * 577 % 1000)])
            .collect();
        assert!(design_effect(&apart, 2000, 499.5, 0.5) < 1.1);
        let sorted: Vec<f64> = (1..=200).map(f64::from).collect();
        let [alone, shared] = [1.0, 2.0].map(|effect| of_independent(&sorted, 50.0, effect));
        assert_eq!((alone.low, alone.high), (Some(86.0), Some(115.0)));
        assert_eq!((shared.low, shared.high), (Some(80.0), Some(122.0)));
    }
}
