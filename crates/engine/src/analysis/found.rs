//! Results of a method at some positions under one load.

use super::AnalysisError;
use super::between::{Sample, Watched};
use super::case::Case;
use super::plan::Sweep;
use crate::contact::{Contradiction, MeshContact};

/// Results at the positions of a sweep under one load.
pub(super) struct Found<K = ()> {
    /// The contact at each.
    pub(super) contacts: Vec<MeshContact>,
    /// Further results of the method at each.
    pub(super) kept: Vec<K>,
    /// δ and k at all places in the curve at which these contacts are.
    pub(super) transmission_error: Vec<f64>,
    pub(super) stiffness: Vec<f64>,
}

/// Part of a contact that a method keeps, for the extremes of a curve.
pub(super) trait Kept: Clone {
    /// Values whose largest over the curve is in the results: pressures and stresses. Each position has the same number of them.
    fn watched(&self) -> Vec<f64>;
}

impl Kept for () {
    fn watched(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// Results at positions between those of a sweep.
pub(super) struct Between<K> {
    /// The mesh positions, in no order.
    pub(super) positions: Vec<f64>,
    /// The contact at each.
    pub(super) contacts: Vec<MeshContact>,
    /// Further results of the method at each; empty if it has none.
    pub(super) kept: Vec<K>,
}

impl<K> Between<K> {
    /// Nothing.
    pub(super) const fn nothing() -> Self {
        Self {
            positions: Vec::new(),
            contacts: Vec::new(),
            kept: Vec::new(),
        }
    }

    /// Adds the results `found` at `positions`.
    pub(super) fn add(&mut self, positions: &[f64], found: Found<K>) {
        self.positions.extend(positions);
        self.contacts.extend(found.contacts);
        self.kept.extend(found.kept);
    }
}

impl<K: Kept> Found<K> {
    /// The largest pressures and the other watched values at each of `positions`, where its contacts stand.
    pub(super) fn watched(&self, positions: &[f64]) -> Vec<Watched> {
        let each = positions.iter().zip(&self.contacts).enumerate();
        each.map(|(i, (position, contact))| {
            let beside = self.kept.get(i).map(K::watched).unwrap_or_default();
            let pressures = [contact.peak_pressure, Some(contact.smooth_pressure)];
            let values = pressures.into_iter().chain(beside.into_iter().map(Some));
            (*position, values.collect())
        })
        .collect()
    }
}

impl Found {
    /// Values at the `contacts` of the positions of `sweep` with this `stiffness`: equal in all mesh periods in which contacts repeat.
    pub(super) fn of_contacts(
        (case, sweep): (&Case, &Sweep),
        contacts: Vec<MeshContact>,
        stiffness: &[f64],
    ) -> Self {
        let places = sweep.places(case);
        let (delta, stiffness) = places
            .iter()
            .map(|place| {
                let contact = &contacts[place.contact];
                (contact.transmission_error, stiffness[place.contact])
            })
            .unzip();
        Self {
            transmission_error: delta,
            stiffness,
            kept: Vec::new(),
            contacts,
        }
    }
}

impl<K> Found<K> {
    /// Refuses deflections, with the terms that a method adds to its contacts, that are too large.
    pub(super) fn check(&self, case: &Case, sweep: &Sweep) -> Result<(), AnalysisError> {
        let module = case.pair.driving().data().rack.module;
        let places = sweep.places(case).into_iter().zip(&self.transmission_error);
        for (place, delta) in places {
            let deflection = delta - self.contacts[place.contact].touch;
            Contradiction::of_deflection(deflection, module)
                .map_err(|error| AnalysisError::at_position(error.into(), place.position))?;
        }
        Ok(())
    }

    /// Samples of the curve at these places.
    pub(super) fn samples(&self, case: &Case, sweep: &Sweep) -> Vec<Sample> {
        let places = sweep.places(case);
        Sample::of(
            &places,
            &self.contacts,
            &self.transmission_error,
            &self.stiffness,
        )
    }

    /// The same with `kept` beside.
    pub(super) fn keeping<L>(self, kept: Vec<L>) -> Found<L> {
        Found {
            contacts: self.contacts,
            kept,
            transmission_error: self.transmission_error,
            stiffness: self.stiffness,
        }
    }
}
