//! A pair at one turn of its driving blank, ready for contact: in the plane, or along its faces.

use super::AnalysisError;
use super::case::{Case, Faces, Model};
use super::projected::{round_average, yielded};
use super::setup::Setup;
use super::three_dimensional::{face_model, yields};
use crate::assembly::Blanks;
use crate::contact::face::FaceModel;
use crate::contact::positions::{contacts, contacts_keeping};
use crate::contact::{ContactCells, ContactSolution, PairLoads, PairModel};
use crate::gear::{Member, SolidPair};
use crate::run::Run;

/// A pair on its blanks.
pub(super) enum TurnedPair {
    /// In its transverse section.
    InPlane(Box<PairModel>),
    /// Along its faces.
    AlongFaces(Box<FaceModel>),
}

impl TurnedPair {
    /// The pair of `setup`.
    pub(super) fn new(setup: Setup<'_>) -> Result<Self, AnalysisError> {
        let Some(faces) = setup.case.faces() else {
            let (whole, _) = setup.model(Blanks::Flexible)?;
            return Ok(Self::InPlane(Box::new(whole)));
        };
        let faces = faces.at(setup.modeling.level);
        let yields = yields(&faces, setup.parts, setup.run)?;
        Ok(Self::AlongFaces(Box::new(face_model(&faces, &yields))))
    }

    /// The pair of `setup`, and the same on the mean of its blanks over a revolution.
    pub(super) fn with_round(setup: Setup<'_>) -> Result<[Self; 2], AnalysisError> {
        let Some(faces) = setup.case.faces() else {
            let (whole, _) = setup.model(Blanks::Flexible)?;
            let round = round_average(&whole, &Member::BOTH);
            return Ok([whole, round].map(|model| Self::InPlane(Box::new(model))));
        };
        let faces = faces.at(setup.modeling.level);
        let whole = yields(&faces, setup.parts, setup.run)?;
        let round = whole.each_ref().map(|of| of.round_average().into());
        let models = [whole, round].map(|yields| face_model(&faces, &yields));
        Ok(models.map(|model| Self::AlongFaces(Box::new(model))))
    }

    /// δ at `positions` under `load`.
    pub(super) fn transmission_errors(
        &self,
        load: f64,
        positions: &[f64],
        run: &Run,
    ) -> Result<Vec<f64>, AnalysisError> {
        Ok(match self {
            Self::InPlane(model) => {
                let found = contacts(model.as_drawn(), load, positions, run)?;
                let found = found.iter().map(|contact| contact.transmission_error);
                found.collect()
            }
            Self::AlongFaces(model) => {
                let found = model.contacts(load, positions, run)?;
                let found = found.iter().map(|contact| contact.mesh.transmission_error);
                found.collect()
            }
        })
    }

    /// δ at `positions` under `load`, and the forces on the flanks.
    pub(super) fn with_loads(
        &self,
        load: f64,
        positions: &[f64],
        run: &Run,
    ) -> Result<Vec<(f64, Vec<PairLoads>)>, AnalysisError> {
        Ok(match self {
            Self::InPlane(model) => {
                let keep = |cells: &ContactCells<'_>, solution: &ContactSolution| {
                    cells.loads(&[&solution.forces, &solution.load_derivative])
                };
                let found = contacts_keeping(model.as_drawn(), load, positions, run, keep)?;
                let found = found.into_iter();
                found
                    .map(|(contact, loads)| (contact.transmission_error, loads))
                    .collect()
            }
            Self::AlongFaces(model) => {
                let found = model.contacts(load, positions, run)?;
                let found = found.iter();
                found
                    .map(|contact| (contact.mesh.transmission_error, model.loads(contact)))
                    .collect()
            }
        })
    }

    /// The part of δ by which the blank of `member` yields to `loads`, at this number of mesh periods after they were found.
    pub(super) fn yielded(&self, member: Member, loads: &[PairLoads], periods: u32) -> f64 {
        let periods = i64::from(periods);
        let [delta, _] = match self {
            Self::InPlane(model) => yielded(model, &[member], loads, periods),
            Self::AlongFaces(model) => model.yielded(member, loads, periods),
        };
        delta
    }
}

impl Case {
    /// The same with the driving blank turned by `angle` under its teeth, counter-clockwise.
    pub(super) fn with_driving_blank_turned(&self, angle: f64) -> Self {
        Self {
            pair: self.pair.with_driving_blank_turned(angle),
            model: self
                .model
                .of_pair(|faces| faces.pair.with_driving_blank_turned(angle)),
            ..self.clone()
        }
    }

    /// The same pair as its other flanks have it, with the blanks that stand under those.
    pub(super) fn mirror_image_of_gears(&self) -> Self {
        Self {
            pair: self.pair.mirror_image_of_gears(),
            model: self
                .model
                .of_pair(|faces| faces.pair.turned_over_with_blanks()),
            ..self.clone()
        }
    }
}

impl Model {
    /// The same of another pair along its faces.
    fn of_pair(&self, pair: impl Fn(&Faces) -> SolidPair) -> Self {
        match self {
            Self::Faces(faces, holes) => {
                let faces = Faces {
                    pair: pair(faces),
                    ..(**faces).clone()
                };
                Self::Faces(Box::new(faces), *holes)
            }
            Self::Section(_) | Self::Formulas(_) => self.clone(),
        }
    }
}
