//! The pair with its holed blanks rigid (paper: wh), whose contacts repeat each mesh period.

use std::sync::Arc;

use super::AnalysisError;
use super::setup::Setup;
use crate::assembly::{Blanks, ContactsSpec, PairSpec};
use crate::contact::{MeshContact, PairModel};

/// The pair with its holed blanks rigid inside R_w.
pub(super) struct RigidBlank<'a> {
    pub(super) setup: Setup<'a>,
    /// Unknowns before condensation.
    pub(super) degrees_of_freedom: u64,
    spec: PairSpec,
    model: PairModel,
}

impl<'a> RigidBlank<'a> {
    pub(super) fn new(setup: Setup<'a>) -> Result<Self, AnalysisError> {
        let spec = setup.spec(Blanks::HoledRigid);
        let (model, degrees_of_freedom) = spec.model(setup.parts, setup.run)?;
        Ok(Self {
            setup,
            degrees_of_freedom,
            spec,
            model,
        })
    }

    /// Its contacts under `load` at `positions`. They depend on no hole: all hole patterns on the same teeth have them alike.
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
}
