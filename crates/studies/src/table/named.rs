//! The quantities of the curves of results, by their names.

use meshwright_wire::problem::Problem;
use meshwright_wire::results::Results;
use meshwright_wire::warning::GearName;

use super::quantity::{Of, QUANTITIES};
use super::summary::Summary;

/// Tells the quantities of each curve of `results`.
///
/// # Errors
///
/// `internal_error` if a number is not finite, which no valid case may come to.
pub(crate) fn name_quantities(results: &mut Results) -> Result<(), Problem> {
    let summary = Summary::of(results)?;
    for (curve, told) in results.curves.iter_mut().zip(summary.curves()) {
        let values = QUANTITIES.iter().map(|quantity| {
            let value = match quantity.of {
                Of::Pair(of) => of(&summary),
                Of::Curve(of) => of(told, GearName::Driven),
            };
            (quantity.name.to_owned(), value)
        });
        curve.quantities = Some(values.collect());
    }
    Ok(())
}
