//! How a quantity is spread.

use crate::sample::normal;

/// The law of a quantity that varies from member to member.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// The normal law, cut off below `low` and above `high`.
    Normal {
        /// The mean of the law before it is cut.
        mean: f64,
        /// Its standard deviation before it is cut, positive.
        standard_deviation: f64,
        /// Where it begins, not above the mean.
        low: f64,
        /// Where it ends, not below the mean and above `low`.
        high: f64,
    },
    /// Every value as likely.
    Uniform {
        /// The smallest value.
        low: f64,
        /// The largest value, above `low`.
        high: f64,
    },
    /// Rising from `low` to `mode`, falling to `high`, both linearly.
    Triangular {
        /// The smallest value.
        low: f64,
        /// The likeliest value.
        mode: f64,
        /// The largest value, above `low`.
        high: f64,
    },
}

impl Law {
    /// The value that is not reached with the probability u, 0 < u < 1.
    pub fn quantile(&self, u: f64) -> f64 {
        match *self {
            Self::Normal {
                mean,
                standard_deviation,
                low,
                high,
            } => {
                let [a, b] = [low, high].map(|end| (end - mean) / standard_deviation);
                let below = normal::distribution(a);
                // The upper tail is computed by itself, because one less a small number loses its digits.
                let above = normal::distribution(-b);
                let z = if u < 0.5 {
                    normal::quantile(below + u * (1.0 - below - above))
                } else {
                    -normal::quantile(above + (1.0 - u) * (1.0 - below - above))
                };
                (mean + standard_deviation * z).clamp(low, high)
            }
            Self::Uniform { low, high } => (low + u * (high - low)).clamp(low, high),
            Self::Triangular { low, mode, high } => {
                let (width, rise) = (high - low, mode - low);
                let value = if u * width < rise {
                    low + (u * width * rise).sqrt()
                } else {
                    high - ((1.0 - u) * width * (high - mode)).sqrt()
                };
                value.clamp(low, high)
            }
        }
    }

    /// The value in the middle: half of all are below it.
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The share of values up to `x`, by bisection of the quantile, which rises.
    fn share_below(law: &Law, x: f64) -> f64 {
        let (mut low, mut high) = (1e-12, 1.0 - 1e-12);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if law.quantile(middle) < x {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    #[test]
    fn a_uniform_and_a_triangular_law_have_the_shares_of_their_areas() {
        let uniform = Law::Uniform {
            low: -1.0,
            high: 3.0,
        };
        assert!((share_below(&uniform, 0.0) - 0.25).abs() < 1e-9);
        let triangle = Law::Triangular {
            low: 0.0,
            mode: 1.0,
            high: 4.0,
        };
        // The triangle's height is 1/2: below 1 lies an area of 1/4, below 2 all but (2/3)^2 x 3/4.
        assert!((share_below(&triangle, 1.0) - 0.25).abs() < 1e-9);
        assert!((share_below(&triangle, 2.0) - (1.0 - 4.0 / 9.0 * 0.75)).abs() < 1e-9);
        let at_an_end = Law::Triangular {
            low: 2.0,
            mode: 2.0,
            high: 3.0,
        };
        assert!((share_below(&at_an_end, 2.5) - 0.75).abs() < 1e-9);
    }

    #[test]
    fn a_cut_normal_law_is_the_normal_one_within_its_limits() {
        let whole = |low: f64, high: f64| Law::Normal {
            mean: 10.0,
            standard_deviation: 2.0,
            low,
            high,
        };
        let open = whole(f64::NEG_INFINITY, f64::INFINITY);
        assert!((open.quantile(0.975) - (10.0 + 2.0 * 1.959_963_984_540_054)).abs() < 1e-11);
        // Between -1 and +2 standard deviations: 0.818595 of all; below the mean 0.341345 of them.
        let cut = whole(8.0, 14.0);
        let below_mean = 0.341_344_746_068_543 / 0.818_594_614_120_364;
        assert!((share_below(&cut, 10.0) - below_mean).abs() < 1e-9);
        assert!(cut.quantile(1e-12) >= 8.0 && cut.quantile(1.0 - 1e-12) <= 14.0);
        // Far out in a tail, where 1 - p has no digits left.
        let tail = whole(10.0, 10.0 + 1e-9);
        assert!((tail.median() - 10.0 - 0.5e-9).abs() < 1e-14);
    }
}
