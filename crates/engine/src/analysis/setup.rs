//! Basis of every method by finite elements.

use super::plan::Sweep;
use super::running::RestingStresses;
use super::{AnalysisError, Case};
use crate::assembly::{Blanks, Modeling, PairSpec, Parts};
use crate::contact::positions::{contacts, contacts_keeping};
use crate::contact::{ContactCells, ContactSolution, MeshContact, PairModel};
use crate::gear::PairDeviations;
use crate::grid::GridLevel;
use crate::run::Run;

/// Contacts at the positions of a sweep, a value of each, and the stiffness there.
pub(super) type Solved<T> = (Vec<MeshContact>, Vec<T>, Vec<f64>);

/// A case, how its pair is modeled, who provides the parts of the model, and the handle of the run.
#[derive(Clone, Copy)]
pub(super) struct Setup<'a> {
    pub(super) case: &'a Case,
    /// Deviations of the teeth of its pair.
    pub(super) deviations: &'a PairDeviations,
    /// How its gears are stressed without load.
    pub(super) resting: Option<&'a [RestingStresses; 2]>,
    pub(super) modeling: Modeling,
    pub(super) parts: &'a dyn Parts,
    pub(super) run: &'a Run,
}

impl<'a> Setup<'a> {
    /// `case`, whose teeth have these `deviations`, at `level`, with teeth coupled up to `farthest` apart.
    pub(super) fn new(
        (case, deviations): (&'a Case, &'a PairDeviations),
        level: GridLevel,
        farthest: usize,
        parts: &'a dyn Parts,
        run: &'a Run,
    ) -> Self {
        let modeling = Modeling {
            level,
            interface_radii: case.resolution.interface_radii,
            farthest,
            solver: case.resolution.contact_solver,
        };
        Self {
            case,
            deviations,
            resting: None,
            modeling,
            parts,
            run,
        }
    }

    /// The pair with those of its blanks that take part.
    pub(super) fn spec(&self, blanks: Blanks) -> PairSpec {
        PairSpec::new(&self.case.pair, blanks, &self.modeling)
    }

    /// Its model, and the unknowns of it before condensation.
    pub(super) fn model(&self, blanks: Blanks) -> Result<(PairModel, u64), AnalysisError> {
        Ok(self.spec(blanks).model(self.parts, self.run)?)
    }

    /// The contacts of `model` at the positions of `sweep` under `load`, the value that `keep` takes of each, and the stiffness there.
    pub(super) fn solved<T: Send>(
        &self,
        model: &PairModel,
        load: f64,
        sweep: &Sweep,
        keep: impl Fn(&ContactCells<'_>, &ContactSolution) -> T + Sync,
    ) -> Result<Solved<T>, AnalysisError> {
        let made = model.deviating(self.deviations);
        let middle = contacts_keeping(made, load, &sweep.positions, self.run, keep)?;
        let (found, kept): (Vec<MeshContact>, Vec<T>) = middle.into_iter().unzip();
        let stiffness = sweep.stiffness(load, &found, |load| {
            Ok(contacts(made, load, &sweep.positions, self.run)?)
        })?;
        Ok((found, kept, stiffness))
    }
}
