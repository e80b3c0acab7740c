//! Orders of a motion, and its amplitudes at them.

use crate::gear::gcd;

/// An order of a motion: how often it comes in a true period, as a fraction in lowest terms. Where a motion repeats only after several true periods,
/// some of its orders come a broken number of times in one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Order {
    times: u32,
    periods: u32,
}

impl Order {
    /// `times` in so many true `periods`, neither of which is 0.
    pub fn new(times: u32, periods: u32) -> Self {
        let common = gcd(times, periods);
        Self {
            times: times / common,
            periods: periods / common,
        }
    }

    /// How often it comes in a true period.
    pub fn per_true_period(self) -> f64 {
        f64::from(self.times) / f64::from(self.periods)
    }

    /// True periods in which it comes a whole number of times.
    pub fn periods(self) -> u32 {
        self.periods
    }

    /// Half of it.
    pub(super) fn half(self) -> Self {
        Self::new(self.times, 2 * self.periods)
    }

    /// True if it comes a whole number of times in every true period, as all orders of the static curve do.
    pub fn is_whole(self) -> bool {
        self.periods == 1
    }

    /// How often it comes in so many true `periods`, if that is a whole number.
    fn times_in(self, periods: u32) -> Option<usize> {
        let whole = periods.is_multiple_of(self.periods);
        whole.then_some(self.times as usize * (periods / self.periods) as usize)
    }
}

/// The amplitudes of a motion at all orders that come a whole number of times in so many true periods.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lines {
    periods: u32,
    /// Amplitudes of waves with one, two, … cycles in them. Seven digits are more than anybody reads, and speeds are many.
    amplitudes: Vec<f32>,
}

impl Lines {
    /// Orders of `samples` at equal steps of `periods` true periods.
    pub(super) fn of(samples: &[f64], periods: u32) -> Self {
        let lines = crate::fourier::harmonics(samples).into_iter();
        Self {
            periods,
            amplitudes: lines.map(|(amplitude, _)| amplitude as f32).collect(),
        }
    }

    /// The amplitude at `order`: 0 where the motion repeats without it.
    pub(super) fn at(&self, order: Order) -> f64 {
        let place = order.times_in(self.periods);
        let amplitude = place.and_then(|times| self.amplitudes.get(times - 1));
        amplitude.map_or(0.0, |amplitude| f64::from(*amplitude))
    }

    /// The orders, with their amplitudes.
    pub(super) fn all(&self) -> impl Iterator<Item = (Order, f64)> {
        let all = self.amplitudes.iter().zip(1..);
        all.map(|(amplitude, times)| (Order::new(times, self.periods), f64::from(*amplitude)))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn an_order_is_found_in_a_motion_that_repeats_after_its_periods_only() {
        // Half a cycle and one cycle in a true period: a wave with two cycles in four of them has one in two.
        let samples: Vec<f64> = (0..64)
            .map(|i| {
                let turn = 2.0 * PI * f64::from(i) / 64.0;
                3.0 + 0.5 * turn.cos() + 0.25 * (2.0 * turn + 0.3).sin()
            })
            .collect();
        let lines = Lines::of(&samples, 2);
        for (order, expected) in [
            (Order::new(2, 4), 0.5),
            (Order::new(1, 1), 0.25),
            (Order::new(3, 1), 0.0),
            (Order::new(1, 3), 0.0),
        ] {
            assert!((lines.at(order) - expected).abs() < 1e-7, "{order:?}");
        }
        assert!(Order::new(6, 3).is_whole() && !Order::new(3, 2).is_whole());
        let (order, amplitude) = lines.all().next().expect("lines");
        assert!(order.per_true_period() == 0.5 && amplitude == lines.at(order));
    }
}
