//! The results document: curves over mesh position, their statistics and spectra, and the evidence for them.

mod between;
mod columns;
mod curve;
mod decomposition;
mod evidence;
mod exchanged;
mod forces;
mod hole_phase;
mod largest_where;
mod list;
mod load_share;
mod merged;
mod modes;
mod spectrum;
mod stress;
mod unseen;

#[cfg(test)]
mod tests;

use std::borrow::Cow;

use meshwright_engine::analysis::Analysis;
use meshwright_engine::analysis::blank_modes::MetMode;
use meshwright_engine::analysis::forces::Forces;

pub use between::{BetweenDocument, FaceBetween};
pub use curve::{
    CurveDocument, CurveRunningDocument, FaceDocument, LeadCureDocument, MOST_MESH_ORDERS,
    RadialGrowth, StatisticsDocument, StatisticsValues, TransmissionErrorStatistics,
};
pub use decomposition::{
    BlankFitDocument, BlankHarmonicDocument, BlankSampleDocument, DecompositionDocument,
};
pub use evidence::{Definition, ErrorEstimateDocument, EvidenceDocument};
pub use forces::{
    BranchDocument, CurveDynamicsDocument, DynamicErrorDocument, ExcitationName,
    ForceTableDocument, OrderAmplitudesDocument, ResonanceDocument,
};
pub use hole_phase::{HolePhaseDocument, OverTurnDocument};
pub use largest_where::{PressureStatistics, WhereDocument};
pub use load_share::LoadShareDocument;
pub use modes::{CrossingDocument, ModeDirection, ModeDocument, ModesDocument, WaveName};
pub use spectrum::{NamedOrderDocument, OrderKindName, SpectrumDocument};
pub use stress::{
    GearPeakStress, GearStressDocument, GearStressWhere, PeakStressDocument, StressDocument,
};

use list::{all, each};

use super::declare::document;
use super::geometry::{Frequencies, PairGeometry};
use super::problem::{Code, Problem};
use super::submission::Submission;
use super::units::{known, one_or_null, rounded_json};
use super::warning::{GearName, WarningDocument};

document! {
    /// Results of a submission. They are bit-identical for the same input and version.
    pub struct Results as Results, "Results"
    answer of (submission: &Submission, analysis: &Analysis, forces: Option<&Forces>) with {
        let case = submission.case();
        let dynamics = |i: usize| forces.and_then(|forces| forces.dynamics.get(i));
    } {
        /// How the curves were computed.
        #[schema(schema_with = crate::method_schema)]
        method: Cow<'static, str> = submission.method().into(),
        /// The derived geometry.
        pair: PairGeometry = PairGeometry::of(case),
        /// The frequencies at the speed given; absent without a speed.
        frequencies?: Frequencies = Frequencies::of_case(case),
        /// Warnings to read with the numbers.
        #[serde(deserialize_with = "known")]
        warnings: Vec<WarningDocument> = submission.warnings(&analysis.warnings),
        /// One curve for each output torque, in the order of the submission.
        curves: Vec<CurveDocument> = analysis
            .curves
            .iter()
            .enumerate()
            .map(|(i, curve)| CurveDocument::of(case, curve, dynamics(i)))
            .collect(),
        /// The force over mesh position and approach; absent unless the submission asks for it.
        force_table?: ForceTableDocument =
            forces.map(|forces| ForceTableDocument::of(&forces.table)),
        /// How the holes of both gears stand best. Null where the gears do not repeat at one order,
        /// teeth deviate or the gears run, over a part of the true period, for the load
        /// distribution, and in results of versions before 0.6.
        #[serde(default, serialize_with = "one_or_null")]
        #[schema(required)]
        hole_phase: Option<HolePhaseDocument> =
            analysis.hole_phase.as_ref().map(HolePhaseDocument::of),
        /// The natural modes of both gears; absent unless the submission asks for them.
        modes?: ModesDocument = None,
        /// Evidence for the numbers, and their meaning.
        evidence: EvidenceDocument = EvidenceDocument::of(submission, analysis),
    }
}

impl Results {
    /// Reads a document that this version wrote, or another one: members that it does not know are passed over.
    ///
    /// # Errors
    ///
    /// A text that is not JSON, or lacks fields that every version had.
    pub fn read(document: &str) -> serde_json::Result<Self> {
        serde_json::from_str(document)
    }

    /// The same with the points between positions in the lists of its curves, rising; `None` if it has none, as documents of versions before 0.6.
    pub fn with_points(mut self) -> Option<Self> {
        let curves = self.curves.into_iter();
        self.curves = curves
            .map(CurveDocument::with_points)
            .collect::<Option<_>>()?;
        Some(self)
    }

    /// The same with the natural modes of both gears, and a warning that names where the mesh meets them within the speeds asked.
    pub(crate) fn with_modes(mut self, submission: &Submission, modes: &[Vec<MetMode>; 2]) -> Self {
        let modes = ModesDocument::of(modes);
        if submission
            .modes()
            .is_some_and(|request| request.speeds.is_some())
        {
            for gear in [GearName::Driving, GearName::Driven] {
                self.warnings
                    .extend(WarningDocument::of_crossings(gear, modes.of_gear(gear)));
            }
        }
        self.modes = Some(modes);
        self
    }

    /// The document as JSON, its numbers rounded to ten significant digits.
    ///
    /// # Errors
    ///
    /// `internal_error` if a number is not finite, which no valid case may come to.
    pub fn to_json(&self) -> Result<String, Problem> {
        rounded_json(self).map_err(|error| Problem::new(Code::InternalError, error.to_string()))
    }
}
