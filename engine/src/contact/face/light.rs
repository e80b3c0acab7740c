//! The contact along faces as its load vanishes.

use std::sync::Arc;

use faer::Mat;

use super::{FaceModel, FlankYield};
use crate::contact::{MeshContact, PositionError};
use crate::gear::SolidPair;

/// The limit of the contact of `pair` at the mesh position `eta` as the load goes to zero, its face cut into so many `slices`: δ is that at which
/// the first of them touches.
///
/// # Errors
///
/// [`PositionError::NoContact`] if no flanks face each other.
pub fn light_face(pair: &SolidPair, slices: usize, eta: f64) -> Result<MeshContact, PositionError> {
    let rigid: Arc<dyn FlankYield> = Arc::new(Rigid);
    let yields = [Arc::clone(&rigid), rigid];
    let model = FaceModel::new(pair.clone(), yields, slices, usize::MAX);
    let first = model.first_touch(eta);
    let (transmission_error, pair) = first.ok_or(PositionError::NoContact)?;
    Ok(MeshContact::unloaded(
        transmission_error,
        vec![(pair, None)],
    ))
}

/// Flanks that yield nowhere.
struct Rigid;

impl FlankYield for Rigid {
    fn basis_len(&self) -> usize {
        0
    }

    fn basis(&self, _: f64, _: f64, _: &mut [f64]) {}

    fn smooth(&self, _: &[usize]) -> Mat<f64> {
        Mat::new()
    }

    fn repeats_after(&self) -> usize {
        1
    }

    fn at_ends(&self, _: (f64, f64), _: (f64, f64), _: f64) -> f64 {
        0.0
    }
}
