//! Tooth pairs as springs fitted to a window: a curve of all pairs of a long true period in closed form.

use super::case::Case;
use super::load_share::LoadShare;
use crate::gear::{Member, PairDeviations, gcd};

/// Largest number of mesh periods of a true period at which springs are computed; of longer ones they are evenly spaced.
const MOST_PERIODS: usize = 50_000;

/// How much the compliance of all phases counts at one, beside the mean spread of the forces at a phase.
const PRIOR: f64 = 0.1;

/// A compliance is that of all phases but for a factor of so much, at most.
const MOST_APART: f64 = 3.0;

/// The least share of the load that tells of a compliance.
const LEAST_SHARE: f64 = 1e-9;

/// A spring behind a gap.
#[derive(Debug, Clone, Copy)]
struct Spring {
    /// The gap of flanks as drawn, in meters.
    gap: f64,
    /// In N/m.
    stiffness: f64,
}

/// Springs for the tooth pairs at each phase of their way through the mesh, with the deviations of every tooth.
///
/// A pair that carries the force f at the phase x has δ = g(x) − e + c(x) f, where its flanks stand e towards each other beyond their drawings. As e differs from
/// pair to pair, g and c at each phase follow by least squares from the pairs that passed it.
pub(super) struct PairSprings<'a> {
    case: &'a Case,
    load: f64,
    per_period: usize,
    /// The offset n − floor(η) of the pair at the first of the phases.
    last_offset: i64,
    /// At the phases η − n, rising by steps of the positions; `None` where no pair of the window carried.
    springs: Vec<Option<Spring>>,
    /// Distance by which each tooth of either gear stands towards its mate at each phase: tooth by tooth.
    towards: [Vec<f64>; 2],
}

impl<'a> PairSprings<'a> {
    /// Springs fitted to δ and the `load_shares` at the positions of `case` under `load`, whose teeth have these `deviations`.
    pub(super) fn of(
        (case, load): (&'a Case, f64),
        deviations: &PairDeviations,
        (transmission_error, load_shares): (&[f64], &[LoadShare]),
    ) -> Self {
        let per_period = case.resolution.positions_per_mesh_period as usize;
        let offsets = || load_shares.iter().map(|share| i64::from(share.pair_offset));
        let last_offset = offsets().max().unwrap_or(0);
        let count = (last_offset - offsets().min().unwrap_or(0) + 1) as usize * per_period;
        let mut springs = Self {
            case,
            load,
            per_period,
            last_offset,
            springs: vec![None; count],
            towards: Member::BOTH.map(|_| Vec::new()),
        };
        springs.towards = Member::BOTH.map(|member| springs.towards_of(member, deviations));
        springs.fit(transmission_error, load_shares);
        springs
    }

    /// Distance by which each tooth of `member` stands towards its mate at each phase.
    fn towards_of(&self, member: Member, deviations: &PairDeviations) -> Vec<f64> {
        let pair = &self.case.pair;
        let (gear, own) = (pair.gear(member), deviations.of_gear(member));
        let first = self.first_fraction();
        let rolls = (0..self.springs.len()).map(|phase| {
            let s = pair.roll_length_of(
                first + phase as f64 / self.per_period as f64 - self.last_offset as f64,
            );
            match member {
                Member::Driving => s,
                Member::Driven => pair.line_of_action() - s,
            }
        });
        let of_tooth = |tooth: usize| {
            let each = rolls.clone();
            each.map(move |s| own.at(tooth, s) + own.runout(gear, tooth, s, 0.0))
        };
        (0..gear.tooth_count() as usize)
            .flat_map(of_tooth)
            .collect()
    }

    /// The fraction of the mesh period at the first position.
    fn first_fraction(&self) -> f64 {
        self.case.resolution.first_position.fract()
    }

    /// The phase of a pair at `offset` at the step `i` of a mesh period.
    fn phase(&self, offset: i64, i: usize) -> usize {
        (self.last_offset - offset) as usize * self.per_period + i
    }

    /// The pair at `phase` at the step `i` of the mesh period that begins at `period`.
    fn pair_at(&self, phase: usize, period: i64) -> i64 {
        period + self.last_offset - (phase / self.per_period) as i64
    }

    /// How far the flanks of pair `n` stand towards each other at `phase`.
    fn pair_towards(&self, n: i64, phase: usize) -> f64 {
        let teeth = self.case.pair.teeth(n);
        let of = |member: Member| {
            let g = member.index();
            self.towards[g][teeth[g] * self.springs.len() + phase]
        };
        of(Member::Driving) + of(Member::Driven)
    }

    fn first_period(&self) -> i64 {
        self.case.resolution.first_position.floor() as i64
    }

    fn fit(&mut self, transmission_error: &[f64], load_shares: &[LoadShare]) {
        let mut fits = vec![Fit::default(); self.springs.len()];
        for (i, delta) in transmission_error.iter().enumerate() {
            let (period, step) = (i / self.per_period, i % self.per_period);
            for share in load_shares {
                let (offset, share) = (i64::from(share.pair_offset), share.share[i]);
                if share > LEAST_SHARE {
                    let phase = self.phase(offset, step);
                    let n = self.first_period() + period as i64 + offset;
                    fits[phase].add(share * self.load, delta + self.pair_towards(n, phase));
                }
            }
        }
        let known = fits.iter().filter(|fit| fit.count > 1.0);
        let sums = known.fold([0.0; 3], |[count, spread, both], fit| {
            [count + 1.0, spread + fit.spread(), both + fit.both()]
        });
        let [count, spread, both] = sums;
        let usual = if spread > 0.0 && both > 0.0 {
            both / spread
        } else {
            // Without a force, or without anything that differs, any will do.
            1.0 / self.load.max(1.0)
        };
        let weight = PRIOR * spread / f64::max(count, 1.0);
        let springs = fits.iter().map(|fit| fit.spring(usual, weight));
        self.springs = springs.collect();
    }

    /// δ of the springs at the step `i` of the mesh period that begins at `period`.
    fn at(&self, i: usize, period: i64, gaps: &mut Vec<Spring>) -> f64 {
        gaps.clear();
        for phase in (i..self.springs.len()).step_by(self.per_period) {
            if let Some(spring) = self.springs[phase] {
                let towards = self.pair_towards(self.pair_at(phase, period), phase);
                gaps.push(Spring {
                    gap: spring.gap - towards,
                    ..spring
                });
            }
        }
        gaps.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        let (mut stiffness, mut forces) = (0.0, self.load);
        let mut delta = 0.0;
        for (touching, spring) in gaps.iter().enumerate() {
            if touching > 0 && spring.gap >= delta {
                break;
            }
            stiffness += spring.stiffness;
            forces += spring.stiffness * spring.gap;
            delta = forces / stiffness;
        }
        delta
    }

    /// δ of the springs at the positions of the window.
    pub(super) fn in_window(&self) -> Vec<f64> {
        let mut gaps = Vec::new();
        let positions = 0..self.case.positions();
        let at = |i: usize| {
            let period = self.first_period() + (i / self.per_period) as i64;
            self.at(i % self.per_period, period, &mut gaps)
        };
        positions.map(at).collect()
    }

    /// The mean of δ of the springs over the mesh periods of the true period, at the steps of one.
    pub(super) fn over_true_period(&self) -> Vec<f64> {
        let period = self.case.pair.period();
        let mut step = period.div_ceil(MOST_PERIODS as u32);
        while gcd(step, period) > 1 {
            step += 1;
        }
        let periods = || (0..i64::from(period)).step_by(step as usize);
        let count = periods().count() as f64;
        let mut gaps = Vec::new();
        let mut mean = |i: usize| {
            let sum: f64 = periods().map(|period| self.at(i, period, &mut gaps)).sum();
            sum / count
        };
        (0..self.per_period).map(&mut mean).collect()
    }
}

/// The sums of a line through points.
#[derive(Debug, Clone, Copy, Default)]
struct Fit {
    count: f64,
    force: f64,
    delta: f64,
    forces: f64,
    products: f64,
}

impl Fit {
    fn add(&mut self, force: f64, delta: f64) {
        self.count += 1.0;
        self.force += force;
        self.delta += delta;
        self.forces += force * force;
        self.products += force * delta;
    }

    /// The sum of squares of the forces about their mean.
    fn spread(&self) -> f64 {
        (self.forces - self.force * self.force / self.count).max(0.0)
    }

    /// The sum of products of forces and δ about their means.
    fn both(&self) -> f64 {
        self.products - self.force * self.delta / self.count
    }

    /// The spring that fits; its compliance is drawn to the `usual` one with this `weight`.
    fn spring(&self, usual: f64, weight: f64) -> Option<Spring> {
        if self.count == 0.0 {
            return None;
        }
        let spread = self.spread() + weight;
        let fitted = if spread > 0.0 {
            (self.both() + weight * usual) / spread
        } else {
            usual
        };
        let compliance = fitted.clamp(usual / MOST_APART, usual * MOST_APART);
        Some(Spring {
            gap: (self.delta - compliance * self.force) / self.count,
            stiffness: 1.0 / compliance,
        })
    }
}
