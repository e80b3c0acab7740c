//! First-order effect of holes, the same in the plane and along faces: the pair with rotationally symmetric blanks repeats with the mesh period, and the
//! further compliance of the holes under its forces is added position by position.
//!
//! ```text
//! δ = δ_0 + qᵀ ΔH p,   1/k = 1/k_0 + qᵀ ΔH q,   ΔH = H − H_0
//! ```
//!
//! H_0 is the mean of H over the teeth, p the contact forces on it and q = dp/dF. The term of δ is exact at first order, whatever the contact law;
//! that of 1/k is where the law is linear.

use super::case::{Case, PositionInCurve};
use super::found::Found;
use super::plan::Sweep;
use crate::contact::MeshContact;

/// Results of the `sweep` of `case` where round blanks have these `contacts` and this `stiffness`: `round` gives qᵀ H_0 p and qᵀ H_0 q of the forces of each
/// contact, `whole` the same with H at a place of the curve.
pub(super) fn with_holes<K>(
    (case, sweep): (&Case, &Sweep),
    (contacts, stiffness): (Vec<MeshContact>, &[f64]),
    kept: Vec<K>,
    round: impl Fn(&K) -> [f64; 2],
    whole: impl Fn(&K, &PositionInCurve) -> [f64; 2],
) -> Found<K> {
    let round: Vec<[f64; 2]> = kept.iter().map(round).collect();
    let places = sweep.places(case);
    let at = |place: &PositionInCurve| {
        let i = place.contact;
        let after = whole(&kept[i], place);
        let [delta, compliance] = [0, 1].map(|k| after[k] - round[i][k]);
        (
            contacts[i].transmission_error + delta,
            1.0 / (1.0 / stiffness[i] + compliance),
        )
    };
    let (transmission_error, stiffness) = places.iter().map(at).unzip();
    Found {
        transmission_error,
        stiffness,
        contacts,
        kept,
    }
}
