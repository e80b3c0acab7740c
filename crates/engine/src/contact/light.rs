//! The contact as its load vanishes: rigid flanks, turned until the first of them touch.

use std::ops::RangeInclusive;

use super::mesh_contact::{MeshContact, PairContact};
use super::model::PositionError;
use crate::gear::{GearPair, Member, PairDeviations};
use crate::touch::gap_profile::GapProfile;

/// Gaps that differ by less than this part of the module are taken as equal, which is the rounding of coordinates. It decides which pairs count as
/// touching; δ moves by less.
pub(super) const TOGETHER: f64 = 1e-9;

/// Steps to the touching flanks; each squares the remainder.
const MOST_STEPS: u32 = 20;

/// Where the flanks of one pair touch first as the driven gear turns back.
#[derive(Debug, Clone, Copy)]
pub(super) struct FirstTouch {
    /// The pair n.
    pub(super) pair: i64,
    /// The δ at which they touch.
    pub(super) delta: f64,
    /// The gear whose tip corner touches off the path of contact.
    pub(super) tip_corner: Option<Member>,
}

impl FirstTouch {
    /// First contact of the flanks of `pair` in a transverse section, at the δ `delta`.
    pub(super) fn of(pair: i64, facing: &GapProfile, delta: f64) -> Self {
        Self {
            pair,
            delta,
            tip_corner: facing.off_path.then_some(facing.primary),
        }
    }
}

/// The limit of the contact of `pair` with these `deviations` at the mesh position `eta` as the load goes to zero: δ is the kinematic error of
/// modified and deviating flanks, negative where a flank stands out towards its mate.
///
/// The driven gear is turned until the flanks as they are just touch.
/// The tangent stiffness of a line contact goes to zero with its load, and so does its pressure.
///
/// # Errors
///
/// [`PositionError::NoContact`] if no flanks face each other.
pub fn light_contact(
    pair: &GearPair,
    deviations: &PairDeviations,
    eta: f64,
) -> Result<MeshContact, PositionError> {
    let rounding = TOGETHER * pair.driving().data().rack.module;
    let touch = |n: i64, lag: f64| {
        let facing = GapProfile::real(pair, deviations, eta, n, lag)?;
        Some(FirstTouch::of(n, &facing, facing.touch()))
    };
    let apart = 2.0 * deviations.nearest() + rounding;
    let near = touching_near(on_path(pair, eta, 0.0), apart, |n| touch(n, 0.0));
    let mut lag = 0.0;
    let mut touches = near.clone();
    for _ in 0..MOST_STEPS {
        let step = first(&touches);
        if step.abs() < 1e-6 * rounding || !step.is_finite() {
            break;
        }
        lag += step;
        let turned = near.iter().filter_map(|near| touch(near.pair, lag));
        touches = turned.collect();
    }
    MeshContact::of_first(lag, &touches, rounding)
}

impl MeshContact {
    /// Contact of pairs which just touch at `transmission_error`, each perhaps with the tip corner of a gear.
    pub fn unloaded(transmission_error: f64, touching: Vec<(i64, Option<Member>)>) -> Self {
        let share = 1.0 / touching.len() as f64;
        let pairs = touching.into_iter().map(|(pair, tip_corner)| PairContact {
            tip_corner,
            ..PairContact::of_share(pair, share)
        });
        Self {
            transmission_error,
            touch: transmission_error,
            pairs: pairs.collect(),
            peak_pressure: Some(0.0),
            ..Self::default()
        }
    }

    /// Contact of the pairs of `touches` which touch first, or within `rounding` of it, at the δ `lag` more than they say.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if there are none.
    pub(super) fn of_first(
        lag: f64,
        touches: &[FirstTouch],
        rounding: f64,
    ) -> Result<Self, PositionError> {
        let least = first(touches);
        let touching = touches
            .iter()
            .filter(|touch| touch.delta <= least + rounding);
        let touching: Vec<_> = touching
            .map(|touch| (touch.pair, touch.tip_corner))
            .collect();
        if touching.is_empty() {
            return Err(PositionError::NoContact);
        }
        Ok(Self::unloaded(lag + least, touching))
    }
}

/// The δ at which the first of `touches` touches; without end if there are none.
pub(super) fn first(touches: &[FirstTouch]) -> f64 {
    let each = touches.iter().map(|touch| touch.delta);
    each.fold(f64::INFINITY, f64::min)
}

/// The pairs of which at the mesh position `eta` any section, up to `beside` mesh periods ahead of the middle one or behind it, is on the path of
/// contact of `pair`, and one more to either side.
pub(super) fn on_path(pair: &GearPair, eta: f64, beside: f64) -> RangeInclusive<i64> {
    let (s_a, s_e) = pair.path_of_contact();
    let periods = |s: f64| (s - pair.roll_length_of(0.0)) / pair.base_pitch();
    let first = (eta - periods(s_e) - beside).floor() as i64;
    let last = (eta - periods(s_a) + beside).ceil() as i64;
    first..=last
}

/// Where the pairs `on_path` and those beside them touch by `touch`, rising by pair: all that come within `apart` and a tenth of δ of the first.
/// The teeth of two pairs deviate from each other by at most `apart`.
pub(super) fn touching_near(
    on_path: RangeInclusive<i64>,
    apart: f64,
    touch: impl Fn(i64) -> Option<FirstTouch>,
) -> Vec<FirstTouch> {
    let mut found: Vec<FirstTouch> = on_path.clone().filter_map(&touch).collect();
    // Beyond the path of contact gaps as drawn grow from pair to pair, and a lag closes all of them by about the same amount.
    let most = |found: &[FirstTouch]| {
        let least = first(found);
        least + 0.1 * least.abs() + apart
    };
    for (begin, step) in [(on_path.start() - 1, -1), (on_path.end() + 1, 1)] {
        let mut n = begin;
        while let Some(touch) = touch(n) {
            found.push(touch);
            if touch.delta > most(&found) {
                break;
            }
            n += step;
        }
    }
    let most = most(&found);
    found.retain(|touch| touch.delta <= most);
    found.sort_unstable_by_key(|touch| touch.pair);
    found
}
