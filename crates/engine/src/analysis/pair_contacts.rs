//! A pair with those of its blanks that take part, and its contacts.

use std::sync::Arc;

use super::AnalysisError;
use super::found::Found;
use super::plan::Sweep;
use super::setup::Setup;
use crate::assembly::{Blanks, ContactsSpec, PairSpec};
use crate::contact::positions::contacts;
use crate::contact::{MeshContact, PairModel};

/// A pair as a method models it.
pub(super) struct ModeledPair<'a> {
    pub(super) setup: Setup<'a>,
    /// Unknowns before condensation.
    pub(super) degrees_of_freedom: u64,
    pub(super) model: PairModel,
    spec: PairSpec,
}

impl<'a> ModeledPair<'a> {
    pub(super) fn new(setup: Setup<'a>, blanks: Blanks) -> Result<Self, AnalysisError> {
        let spec = setup.spec(blanks);
        let (model, degrees_of_freedom) = spec.model(setup.parts, setup.run)?;
        Ok(Self {
            setup,
            degrees_of_freedom,
            model,
            spec,
        })
    }

    /// Its contacts under `load` at `positions`. They are equal for equal pairs: with rigid blanks all hole patterns on the same teeth, and as drawn all
    /// members of a population.
    pub(super) fn contacts(
        &self,
        load: f64,
        positions: &[f64],
    ) -> Result<Arc<Vec<MeshContact>>, AnalysisError> {
        let spec = ContactsSpec {
            load,
            positions: positions.to_vec(),
            pair: self.spec.clone(),
            deviations: self.setup.deviations.clone(),
        };
        Ok(self
            .setup
            .parts
            .contacts(&spec, &self.model, self.setup.run)?)
    }

    /// Results of `sweep` under `load`. Contacts of a drawn pair are computed once: all members of a population have one drawing, and no two of them are the
    /// same.
    pub(super) fn found(&self, load: f64, sweep: &Sweep) -> Result<Found, AnalysisError> {
        let Setup {
            case,
            deviations,
            run,
            ..
        } = self.setup;
        let at = |load: f64| -> Result<Vec<MeshContact>, AnalysisError> {
            if case.pair.is_as_drawn() {
                return Ok(self.contacts(load, &sweep.positions)?.to_vec());
            }
            let made = self.model.deviating(deviations);
            Ok(contacts(made, load, &sweep.positions, run)?)
        };
        let contacts = at(load)?;
        let stiffness = sweep.stiffness(load, &contacts, at)?;
        Ok(Found::of_contacts((case, sweep), contacts, &stiffness))
    }
}
