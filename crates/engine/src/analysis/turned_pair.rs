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

/// A pair on its blanks, and on the same ones alike all around.
pub(super) enum TurnedPair {
    /// In its transverse section.
    InPlane(Box<[PairModel; 2]>),
    /// Along its faces.
    AlongFaces(Box<[FaceModel; 2]>),
}

impl TurnedPair {
    /// The pair of `setup`.
    pub(super) fn new(setup: Setup<'_>) -> Result<Self, AnalysisError> {
        let Some(faces) = setup.case.faces() else {
            let (whole, _) = setup.model(Blanks::Flexible)?;
            let round = round_average(&whole, &Member::BOTH);
            return Ok(Self::InPlane(Box::new([whole, round])));
        };
        let faces = faces.at(setup.modeling.level);
        let whole = yields(&faces, setup.parts, setup.run)?;
        let round = whole.each_ref().map(|of| of.round_average().into());
        let models = [whole, round].map(|yields| face_model(&faces, &yields));
        Ok(Self::AlongFaces(Box::new(models)))
    }

    /// δ at `positions` under `load`.
    pub(super) fn on_blanks(
        &self,
        load: f64,
        positions: &[f64],
        run: &Run,
    ) -> Result<Vec<f64>, AnalysisError> {
        Ok(match self {
            Self::InPlane(models) => {
                let found = contacts(models[0].as_drawn(), load, positions, run)?;
                let found = found.iter().map(|contact| contact.transmission_error);
                found.collect()
            }
            Self::AlongFaces(models) => {
                let found = models[0].contacts(load, positions, run)?;
                let found = found.iter().map(|contact| contact.mesh.transmission_error);
                found.collect()
            }
        })
    }

    /// δ at `positions` under `load` on blanks that are alike all around, and the forces on the flanks.
    pub(super) fn on_round_blanks(
        &self,
        load: f64,
        positions: &[f64],
        run: &Run,
    ) -> Result<Vec<(f64, Vec<PairLoads>)>, AnalysisError> {
        Ok(match self {
            Self::InPlane(models) => {
                let keep = |cells: &ContactCells<'_>, solution: &ContactSolution| {
                    cells.loads(&[&solution.forces, &solution.load_derivative])
                };
                let found = contacts_keeping(models[1].as_drawn(), load, positions, run, keep)?;
                let found = found.into_iter();
                found
                    .map(|(contact, loads)| (contact.transmission_error, loads))
                    .collect()
            }
            Self::AlongFaces(models) => {
                let found = models[1].contacts(load, positions, run)?;
                let found = found.iter();
                found
                    .map(|contact| (contact.mesh.transmission_error, models[1].loads(contact)))
                    .collect()
            }
        })
    }

    /// By how much the blank of `member` gives way under `loads`, so many mesh periods after they were found.
    pub(super) fn added(&self, member: Member, loads: &[PairLoads], periods: u32) -> f64 {
        self.of(0, member, loads, periods)
    }

    /// The same of a blank that is alike all around.
    pub(super) fn added_round(&self, member: Member, loads: &[PairLoads]) -> f64 {
        self.of(1, member, loads, 0)
    }

    fn of(&self, model: usize, member: Member, loads: &[PairLoads], periods: u32) -> f64 {
        let periods = i64::from(periods);
        let [delta, _] = match self {
            Self::InPlane(models) => yielded(&models[model], &[member], loads, periods),
            Self::AlongFaces(models) => models[model].yielded(member, loads, periods),
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
