//! The contact as its load vanishes: rigid flanks, turned until the first of them touch.

use super::cells::{MeshContact, PairContact};
use super::facings::Facings;
use super::model::PositionError;
use crate::gear::GearPair;

/// Gaps that differ by less than this part of the module close together: rounding of coordinates.
const TOGETHER: f64 = 1e-9;

/// The limit of the contact of `pair` at the mesh position `eta` as the load goes to zero: δ is the kinematic error of modified
/// and deviating flanks, negative where a flank stands out towards its mate.
///
/// The tangent stiffness of a line contact goes to zero with its load, and so does its pressure.
///
/// # Errors
///
/// [`PositionError::NoContact`] if no flanks face each other.
pub fn light_contact(pair: &GearPair, eta: f64) -> Result<MeshContact, PositionError> {
    let (period, fraction) = (eta.floor() as i64, eta - eta.floor());
    let mut facings = Facings::new(pair, fraction, period).ok_or(PositionError::NoContact)?;
    let touch = facings.touch(period);
    let touching = facings.within(period, touch + TOGETHER * pair.driving().data().rack.module);
    let share = 1.0 / touching.len() as f64;
    let mut pairs: Vec<PairContact> = touching
        .iter()
        .map(|(i, _)| {
            let facing = &facings.all()[*i];
            PairContact {
                pair: period + facing.pair,
                share,
                tip_corner: facing.off_path.then_some(facing.seat),
                fillet: None,
            }
        })
        .collect();
    pairs.sort_by_key(|pair| pair.pair);
    Ok(MeshContact {
        transmission_error: touch,
        stiffness: 0.0,
        pairs,
        peak_pressure: Some(0.0),
        equilibrium: 0.0,
        complementarity: 0.0,
        penetration: 0.0,
        iterations: 0,
    })
}
