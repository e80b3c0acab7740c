//! Percentiles, and how far they are to be trusted.

use crate::{BATCHES, Estimate};

/// The value below which `percent` of the sorted values lie, linear between neighbors, as `numpy.percentile` has it.
///
/// # Panics
///
/// Without values.
pub fn percentile(sorted: &[f64], percent: f64) -> f64 {
    let place = percent / 100.0 * (sorted.len() - 1) as f64;
    let (below, part) = (place.floor() as usize, place.fract());
    match sorted.get(below + 1) {
        Some(above) => sorted[below] + part * (above - sorted[below]),
        None => sorted[below],
    }
}

/// A percentile of independent members: its limits are the order statistics between which it lies with 95 % confidence, whatever
/// the law. A limit is none where not even the outermost member would do.
///
/// `effect` is how many times the share of members below the percentile varies as much as that of as many independent members would:
/// 1 unless members share inputs.
pub fn of_independent(sorted: &[f64], percent: f64, effect: f64) -> Estimate {
    let n = sorted.len();
    let independent = ((n as f64 / effect.max(1.0)).floor() as u32).max(1);
    let [low, high] = ranks(independent, percent / 100.0);
    // A rank among fewer members is the rank of the same share among all, rounded outward.
    let scale = n as f64 / f64::from(independent);
    let at = |rank: f64| sorted[(rank as usize).clamp(1, n) - 1];
    Estimate {
        value: percentile(sorted, percent),
        low: low.map(|rank| at((scale * f64::from(rank)).floor())),
        high: high.map(|rank| at((scale * f64::from(rank)).ceil())),
    }
}

/// A percentile of replicated scramblings: its limits follow from the percentiles of the batches, which are independent.
/// There are none as long as a batch has no members.
pub fn of_batches(sorted: &[f64], batches: &[Vec<f64>; BATCHES], percent: f64) -> Estimate {
    let value = percentile(sorted, percent);
    let parts: Option<Vec<f64>> = batches
        .iter()
        .map(|sorted| (!sorted.is_empty()).then(|| percentile(sorted, percent)))
        .collect();
    Estimate::of_parts(value, &parts.unwrap_or_default())
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
    const EACH: f64 = 0.025;
    // So many members are not above the quantile: B of the binomial law. It lies below rank l with P(B < l).
    let mut below = 0.0;
    let mut low = None;
    for k in 0..n {
        below += binomial(n, p, k);
        if below > EACH {
            break;
        }
        low = Some(k + 1);
    }
    // It lies above rank u with P(B >= u).
    let mut above = 0.0;
    let mut high = None;
    for k in (1..=n).rev() {
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
    use crate::points::{Points, Sampling};

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

    #[test]
    fn limits_hold_the_true_percentile_nineteen_times_of_twenty() {
        // Of exponential members, whose percentiles are -ln(1 - p); by both ways, over many seeds.
        let truth = |percent: f64| -(1.0 - percent / 100.0).ln();
        for sampling in [Sampling::Random, Sampling::Sobol] {
            let mut held = 0;
            let rounds = 400;
            for seed in 0..rounds {
                let points = Points { sampling, seed };
                let value =
                    |member| -(1.0 - points.at(member, 0)).ln() + 0.0 * points.at(member, 1);
                let mut all: Vec<f64> = (0..320).map(value).collect();
                let mut batches: [Vec<f64>; BATCHES] = Default::default();
                for (member, value) in (0..).zip(&all) {
                    batches[crate::batch(member)].push(*value);
                }
                all.sort_by(f64::total_cmp);
                batches
                    .iter_mut()
                    .for_each(|batch| batch.sort_by(f64::total_cmp));
                let found = match sampling {
                    Sampling::Random => of_independent(&all, 75.0, 1.0),
                    Sampling::Sobol => of_batches(&all, &batches, 75.0),
                };
                let (low, high) = (found.low.unwrap(), found.high.unwrap());
                held += u32::from(low <= truth(75.0) && truth(75.0) <= high);
            }
            let share = f64::from(held) / f64::from(rounds);
            assert!((0.91..=0.99).contains(&share), "{sampling:?}: {share}");
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
