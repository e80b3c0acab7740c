//! Where the members of a sample stand: points of a unit cube, one axis for each input.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};
use sobol_burley::parts::{hash, owen_scramble_rev, sobol_rev};

use crate::sample::REPLICATES;

/// Maximum number of members of one replicate with a point of their own.
const LONGEST_SEQUENCE: u32 = 1 << 16;

/// Maximum number of members of a sample.
pub const MOST_MEMBERS: u32 = REPLICATES * LONGEST_SEQUENCE;

/// Number of axes of the points.
pub const MOST_AXES: u32 = sobol_burley::NUM_DIMENSIONS;

/// How the members of a sample are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Sobol' points with Joe and Kuo's directions, in [`REPLICATES`] independent scramblings after Owen (by Burley's hash).
    Sobol,
    /// Independent of each other.
    Random,
}

/// The points of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Points {
    /// How they are spread.
    pub sampling: Sampling,
    /// Seed.
    pub seed: u32,
}

impl Points {
    /// Where `member` stands on `axis`: a number between 0 and 1, both excluded.
    ///
    /// # Panics
    ///
    /// If there is no such axis.
    pub fn at(&self, member: u32, axis: u32) -> f64 {
        let mut generator = ChaCha8Rng::seed_from_u64(u64::from(self.seed));
        match self.sampling {
            Sampling::Sobol => {
                let (place, replicate) = (member / REPLICATES, member % REPLICATES);
                generator.set_stream(u64::from(replicate));
                scrambled(place, axis, generator.next_u32())
            }
            Sampling::Random => {
                generator.set_stream(u64::from(member));
                generator.set_word_pos(2 * u128::from(axis));
                centered(generator.next_u64() >> 12, 52)
            }
        }
    }
}

/// The middle of step `i` of the 2^`bits` that divide the numbers from 0 to 1.
fn centered(i: u64, bits: u32) -> f64 {
    (i as f64 + 0.5) / (1_u64 << bits) as f64
}

/// A coordinate of a Sobol' point, both its digits and the order of the points scrambled by `seed`.
fn scrambled(place: u32, axis: u32, seed: u32) -> f64 {
    // The crate's own function does the same and gives 24 digits, zero among its numbers.
    let order = owen_scramble_rev(place.reverse_bits(), hash(seed));
    let digits = sobol_rev(order, axis);
    let own = hash(seed ^ hash(axis.wrapping_add(1)));
    centered(u64::from(owen_scramble_rev(digits, own).reverse_bits()), 32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_replicate_of_sobol_points_fills_every_stratum_once() {
        let points = Points {
            sampling: Sampling::Sobol,
            seed: 1,
        };
        for replicate in [0, 7, 15] {
            for axis in [0, 1, 5, 100, MOST_AXES - 1] {
                let mut strata = vec![0; 64];
                for place in 0..64 {
                    let at = points.at(place * REPLICATES + replicate, axis);
                    assert!(at > 0.0 && at < 1.0);
                    strata[(64.0 * at) as usize] += 1;
                }
                assert_eq!(strata, vec![1; 64], "replicate {replicate}, axis {axis}");
            }
            // The first two axes together: every cell of 8 x 8.
            let mut cells = vec![0; 64];
            for place in 0..64 {
                let at = |axis| (8.0 * points.at(place * REPLICATES + replicate, axis)) as usize;
                cells[at(0) * 8 + at(1)] += 1;
            }
            assert_eq!(cells, vec![1; 64]);
        }
    }

    #[test]
    fn a_sobol_mean_settles_faster_than_a_random_one() {
        // The mean of (x - 1/2)^2 + x y is 1/12 + 1/4.
        let error = |sampling, seed, count: u32| {
            let points = Points { sampling, seed };
            let sum: f64 = (0..count)
                .map(|member| {
                    let (x, y) = (points.at(member, 0), points.at(member, 1));
                    (x - 0.5).powi(2) + x * y
                })
                .sum();
            sum / f64::from(count) - (1.0 / 12.0 + 0.25)
        };
        let rms = |sampling| {
            let squares = (0..20).map(|seed| error(sampling, seed, 4096).powi(2));
            (squares.sum::<f64>() / 20.0).sqrt()
        };
        assert!(rms(Sampling::Sobol) < 0.05 * rms(Sampling::Random));
    }

    #[test]
    fn random_members_are_independent_and_uniform() {
        let points = Points {
            sampling: Sampling::Random,
            seed: 3,
        };
        let n = 20_000;
        let drawn: Vec<[f64; 2]> = (0..n)
            .map(|member| [points.at(member, 0), points.at(member, 1)])
            .collect();
        let mean = |f: &dyn Fn(&[f64; 2]) -> f64| drawn.iter().map(f).sum::<f64>() / f64::from(n);
        // Five standard errors.
        let allowed = 5.0 / f64::from(n).sqrt();
        assert!((mean(&|at| at[0]) - 0.5).abs() < allowed * (1.0_f64 / 12.0).sqrt());
        assert!((mean(&|at| (at[0] - 0.5) * (at[1] - 0.5))).abs() < allowed / 12.0);
    }

    #[test]
    fn members_are_the_same_on_every_machine() {
        let at = |sampling, seed| {
            let points = Points { sampling, seed };
            [(0, 0), (1, 0), (17, 3), (99_999, 103)].map(|(member, axis)| points.at(member, axis))
        };
        assert_eq!(at(Sampling::Sobol, 1), at(Sampling::Sobol, 1));
        assert_ne!(at(Sampling::Sobol, 1), at(Sampling::Sobol, 2));
        assert_eq!(at(Sampling::Sobol, 1), SOBOL_OF_SEED_1);
        assert_eq!(at(Sampling::Random, 1), RANDOM_OF_SEED_1);
    }

    // Values of the first version; a change would change every population that anybody has drawn.
    const SOBOL_OF_SEED_1: [f64; 4] = [
        0.867_147_446_726_448_8,
        0.621_823_520_981_706_7,
        0.526_784_538_407_81,
        0.668_633_232_475_258_4,
    ];
    const RANDOM_OF_SEED_1: [f64; 4] = [
        0.402_485_663_664_848_06,
        0.851_912_160_844_185_2,
        0.470_050_349_249_106_05,
        0.513_687_579_048_170_6,
    ];
}
