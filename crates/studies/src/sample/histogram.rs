//! How often which values occur.

use crate::sample::percentile::percentile;

/// Maximum number of bars of a histogram.
const MOST_BARS: f64 = 64.0;

/// Bars of one width between the smallest and the largest value.
#[derive(Debug, Clone, PartialEq)]
pub struct Histogram {
    /// Where bars begin, and where the last one ends.
    pub edges: Vec<f64>,
    /// How many values each has. The lower edge belongs to a bar, to the last one both, as `numpy.histogram` has it.
    pub counts: Vec<u64>,
}

/// The histogram of sorted values, none of nothing. Bars are as wide as Freedman and Diaconis say.
pub fn histogram(sorted: &[f64]) -> Option<Histogram> {
    let (smallest, largest) = (*sorted.first()?, *sorted.last()?);
    if smallest == largest {
        return Some(Histogram {
            edges: vec![smallest - 0.5, smallest + 0.5],
            counts: vec![sorted.len() as u64],
        });
    }
    let quartiles = percentile(sorted, 75.0) - percentile(sorted, 25.0);
    let width = 2.0 * quartiles / libm::cbrt(sorted.len() as f64);
    let bars = ((largest - smallest) / width).ceil().clamp(1.0, MOST_BARS) as usize;
    let edge = |i: usize| {
        if i == bars {
            largest
        } else {
            smallest + (largest - smallest) * i as f64 / bars as f64
        }
    };
    let edges: Vec<f64> = (0..=bars).map(edge).collect();
    let below: Vec<usize> = edges
        .iter()
        .map(|edge| sorted.partition_point(|value| value < edge))
        .collect();
    let counts = (0..bars).map(|i| {
        let end = if i + 1 == bars {
            sorted.len()
        } else {
            below[i + 1]
        };
        (end - below[i]) as u64
    });
    Some(Histogram {
        counts: counts.collect(),
        edges,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_stands_in_one_bar() {
        let sorted: Vec<f64> = (0..1000).map(|i| f64::from(i).powi(2)).collect();
        let found = histogram(&sorted).unwrap();
        assert_eq!(found.counts.iter().sum::<u64>(), 1000);
        assert_eq!(found.edges.len(), found.counts.len() + 1);
        for (i, count) in found.counts.iter().enumerate() {
            let last = i + 1 == found.counts.len();
            let inside =
                |value: &&f64| **value >= found.edges[i] && (**value < found.edges[i + 1] || last);
            assert_eq!(*count, sorted.iter().filter(inside).count() as u64);
        }
        // Freedman and Diaconis: 2 x 500,000 / 10 is the width, and ten of them span the values.
        assert_eq!(found.counts.len(), 10);
    }

    #[test]
    fn values_that_are_all_alike_or_nearly_have_bars_too() {
        assert_eq!(histogram(&[2.0, 2.0]).unwrap().counts, [2]);
        assert_eq!(histogram(&[]), None);
        // No width at all between the quartiles.
        let found = histogram(&[0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 9.0]).unwrap();
        assert_eq!(
            (found.counts.len(), found.counts.iter().sum::<u64>()),
            (64, 7)
        );
    }
}
