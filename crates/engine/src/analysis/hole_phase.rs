//! The best turn of the holes of the driving gear against those of the driven one, and the plan of its computation (`hole_turns`).

use super::case::Case;
use crate::gear::{GearPair, Member};

/// Places of a hole pitch, at least, at which the term of the driving holes is known: as many as show five harmonics of the hole order.
const LEAST_PLACES: u32 = 12;

/// Positions in a mesh period at which the first order is known: at most, and at least where they divide those of the curve. The effect of holes changes slowly
/// over a mesh period.
const FIRST_ORDER: [u32; 2] = [20, 10];

/// Positions in a mesh period at which turns are solved in full, likewise: their difference to the first order, which is solved for, has no kinks of the mesh.
const FULL: [u32; 2] = [9, 4];

/// A turn of the driving blank, and its amplitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtTurn {
    /// The turn in radians, counter-clockwise.
    pub turn: f64,
    /// The amplitude of δ at the order of the holes in meters, by full solutions at two turns.
    pub amplitude: f64,
    /// The peak-to-peak of δ in meters at first order, at up to 20 positions of each mesh period.
    pub peak_to_peak: f64,
}

/// The best turn of the driving blank under its teeth, by which the holes of both gears excite least together. Lengths are in meters, angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct HolePhase {
    /// The output torque T under which it is the best: the largest of the case.
    pub output_torque: f64,
    /// The order of the holes per revolution of the driven gear: N_2.
    pub order: u32,
    /// The turn from where the driving blank stands, from 0 to 2π/N_1, counter-clockwise.
    pub turn_of_driving: f64,
    /// The amplitude of δ at this order with it, by full solutions at two turns.
    pub amplitude: f64,
    /// Amplitude of the curve.
    pub amplitude_now: f64,
    /// The best turn where the other flanks carry.
    pub other_flanks_turn: f64,
    /// Values from turn 0 to a whole hole pitch.
    pub over_turn: Vec<AtTurn>,
}

/// Plan of the computation of the best turn.
pub(super) struct PhasePlan {
    pub(super) output_torque: f64,
    /// ν = p/q in lowest terms.
    pub(super) ratio: [u32; 2],
    /// Positions in a mesh period: of the first order, and of the full solution.
    pub(super) per_period: [u32; 2],
}

impl PhasePlan {
    /// Best phase of `case`; `None` where both blanks do not repeat at one order, teeth deviate, the gears run, or the method sees no holes.
    pub(super) fn of(case: &Case) -> Option<Self> {
        if !case.method().finds_hole_phase()
            || !case.pair.is_as_drawn()
            || case.runs().is_some()
            || !case.covers_whole_periods()
        {
            return None;
        }
        let output_torque = case.loaded_torques().reduce(f64::max)?;
        let ratios = Member::BOTH.map(|member| hole_ratio(&case.pair, member));
        let [Some(driving), Some(driven)] = ratios else {
            return None;
        };
        let first_order = divisor(case.resolution.positions_per_mesh_period, FIRST_ORDER);
        (driving == driven).then(|| Self {
            output_torque,
            ratio: driving,
            per_period: [first_order, divisor(first_order, FULL)],
        })
    }

    /// Its contact solutions, for either pair of flanks: one mesh period, and two turns in full.
    pub(super) fn solutions(&self) -> u64 {
        let [first_order, full] = self.per_period.map(u64::from);
        2 * (first_order + 2 * u64::from(self.ratio[1]) * full)
    }

    /// Number of them that are the first at their fraction of the mesh period.
    pub(super) fn first_solutions(&self) -> u64 {
        let [first_order, full] = self.per_period.map(u64::from);
        2 * (first_order + 2 * full)
    }

    /// How often `member` is joined with its blank for it, beside the curve: in the mirror, and the driving gear at each turn.
    pub(super) fn joined(&self, member: Member) -> u32 {
        match member {
            Member::Driving => 2 * self.turns() + 3,
            Member::Driven => 1,
        }
    }

    /// The torque under which it is computed.
    pub(super) fn output_torque(&self) -> f64 {
        self.output_torque
    }

    /// Turns of the driving blank, with none, at which the terms of its teeth are known.
    pub(super) fn turns(&self) -> u32 {
        LEAST_PLACES.div_ceil(self.ratio[1])
    }
}

/// The largest divisor of `count` between `most` and `least`; itself if there is none.
fn divisor(count: u32, [most, least]: [u32; 2]) -> u32 {
    let divisors = (least..=most).rev();
    let mut divisors = divisors.filter(|part| count.is_multiple_of(*part));
    divisors.next().unwrap_or(count)
}

/// N/z of `member` in lowest terms; `None` without holes.
fn hole_ratio(pair: &GearPair, member: Member) -> Option<[u32; 2]> {
    let gear = pair.gear(member);
    let (repeats, period) = (gear.hole_repeats(), pair.period_of(member));
    (repeats > 0).then(|| [repeats * period / gear.tooth_count(), period])
}
