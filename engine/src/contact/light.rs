//! The contact as its load vanishes: rigid flanks, turned until the first of them touch.

use super::cells::{MeshContact, PairContact};
use super::facing::Facing;
use super::model::PositionError;
use crate::gear::{GearPair, Member, PairDeviations};

/// Gaps that differ by less than this part of the module close together: rounding of coordinates.
const TOGETHER: f64 = 1e-9;

/// Steps to the touching flanks; each squares what is left.
const MOST_STEPS: u32 = 20;

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
    let near = pairs_near(pair, deviations, eta, rounding)?;
    let mut lag = 0.0;
    let mut facing = Vec::new();
    for _ in 0..MOST_STEPS {
        facing = near
            .iter()
            .filter_map(|n| Some((*n, Facing::real(pair, deviations, eta, *n, lag)?)))
            .collect();
        let least = facing.iter().map(|(_, facing)| facing.touch());
        let step = least.fold(f64::INFINITY, f64::min);
        if !step.is_finite() {
            return Err(PositionError::NoContact);
        }
        lag += step;
        if step.abs() < 1e-6 * rounding {
            break;
        }
    }
    facing.retain(|(_, facing)| facing.touch() <= rounding);
    let touching = facing
        .iter()
        .map(|(n, facing)| (*n, facing.off_path.then_some(facing.seat)));
    Ok(MeshContact::unloaded(lag, touching.collect()))
}

impl MeshContact {
    /// That of pairs which just touch at `transmission_error`, each perhaps with the tip corner of a gear.
    pub fn unloaded(transmission_error: f64, touching: Vec<(i64, Option<Member>)>) -> Self {
        let share = 1.0 / touching.len() as f64;
        let pairs = touching.into_iter().map(|(pair, tip_corner)| PairContact {
            pair,
            share,
            clearance: None,
            tip_corner,
            fillet: None,
        });
        Self {
            transmission_error,
            stiffness: 0.0,
            driving_load: 0.0,
            pairs: pairs.collect(),
            peak_pressure: Some(0.0),
            peak_place: None,
            equilibrium: 0.0,
            complementarity: 0.0,
            penetration: 0.0,
            iterations: 0,
        }
    }
}

/// The pairs one of which touches first, whatever its teeth deviate, rising.
fn pairs_near(
    pair: &GearPair,
    deviations: &PairDeviations,
    eta: f64,
    rounding: f64,
) -> Result<Vec<i64>, PositionError> {
    let touch = |n: i64| Facing::real(pair, deviations, eta, n, 0.0).map(|facing| facing.touch());
    let (s_a, s_e) = pair.path_of_contact();
    let periods = |s: f64| (s - pair.roll_length_of(0.0)) / pair.base_pitch();
    let first = (eta - periods(s_e)).floor() as i64;
    let last = (eta - periods(s_a)).ceil() as i64;
    let found = (first..=last).filter_map(|n| Some((n, touch(n)?)));
    let mut found: Vec<(i64, f64)> = found.collect();
    let least = |found: &[(i64, f64)]| {
        let touches = found.iter().map(|found| found.1);
        touches.fold(f64::INFINITY, f64::min)
    };
    // Beyond the path of contact gaps as drawn grow from pair to pair, and a lag closes all of them about alike.
    let most = |found: &[(i64, f64)]| {
        let least = least(found);
        least + 0.1 * least.abs() + 2.0 * deviations.nearest() + rounding
    };
    for (begin, step) in [(first - 1, -1), (last + 1, 1)] {
        let mut n = begin;
        while let Some(touch) = touch(n) {
            found.push((n, touch));
            if touch > most(&found) {
                break;
            }
            n += step;
        }
    }
    let most = most(&found);
    let mut near: Vec<i64> = found
        .iter()
        .filter(|(_, touch)| *touch <= most)
        .map(|(n, _)| *n)
        .collect();
    near.sort_unstable();
    if near.is_empty() {
        return Err(PositionError::NoContact);
    }
    Ok(near)
}
