//! A submission: a request, checked once, with every default filled in.

use meshwright_engine::analysis::blank_modes::{ModesRequest, blank_modes_estimate};
use meshwright_engine::analysis::forces::{ForcesRequest, MORE_POSITIONS};
use meshwright_engine::analysis::{
    Case, Estimate, FaceHoles, Faces, Method, Model, RotationSpeed, SectionHoles, Warning,
    estimate, windows_at_largest_steps,
};
use meshwright_engine::assembly::FaceResolution;
use meshwright_engine::gear::GearPair;

mod checks;
mod document;
pub(crate) mod places;

pub use checks::{MOST_POSITIONS, MOST_PROJECTED_POSITIONS};
pub(super) use document::MOST_TAGS;
#[cfg(test)]
pub(super) use document::OUTPUT_TORQUE;
pub use document::{MOST_TORQUES, TAGS};

use checks::bearable_torque;
use document::FaceRows;
pub(super) use document::{Purpose, SubmissionDocument};

use super::declare::{
    Choice, EACH, Errors, Kind, Location, Node, Object as _, ObjectReader, utoipa_schema, word,
};
use super::pair::PairDocument;
use super::problem::{FieldError, Problem};
use super::resolution::ResolutionDocument;
use super::size::{MOST_VALUES, refuse_many_values};
use super::warning::WarningDocument;
use crate::hash::sha256_hex;

/// The version of the solver, which a result belongs to.
pub const SOLVER_VERSION: &str = concat!("meshwright ", env!("CARGO_PKG_VERSION"));

/// The version of the document of a submission: one more in a release that adds fields, in whichever part. A process that reads only earlier versions leaves
/// the job to others instead of refusing fields that it does not know.
pub const DOCUMENT_VERSION: i64 = 4;

/// A request: a gear pair, torques, and the way to compute.
///
/// A value of this type can be computed: its gears can be made and mesh, and the work is within the limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Submission {
    document: SubmissionDocument,
    case: Case,
    forces: Option<ForcesRequest>,
    modes: Option<ModesRequest>,
}

impl serde::Serialize for Submission {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.document.write(serializer)
    }
}

impl utoipa::PartialSchema for Submission {
    fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
        <SubmissionDocument as utoipa::PartialSchema>::schema()
    }
}

impl utoipa::ToSchema for Submission {
    fn name() -> std::borrow::Cow<'static, str> {
        SubmissionDocument::name()
    }

    fn schemas(schemas: &mut Vec<(String, utoipa::openapi::RefOr<utoipa::openapi::Schema>)>) {
        SubmissionDocument::schemas(schemas);
    }
}

/// The schema of the word of a method.
pub fn method_schema() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
    utoipa_schema(Method::describe(
        "How the curves are computed.",
        &word("Method"),
    ))
}

/// Windows of a true period that are chosen by the teeth of the pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Windows {
    /// The mesh periods of each.
    pub mesh_periods: u32,
    /// How many there are at most.
    pub places: u32,
}

impl Windows {
    /// The span, and where windows of `pair` begin; its true period where they would be as long.
    fn within(self, pair: &GearPair) -> (Option<u32>, Option<Vec<u32>>) {
        if self.mesh_periods.saturating_mul(self.places) >= pair.period() {
            return (None, None);
        }
        let starts = windows_at_largest_steps(pair, self.mesh_periods, self.places as usize);
        (Some(self.mesh_periods), Some(starts))
    }
}

impl SubmissionDocument {
    /// The submission, if all that it says goes together.
    fn checked(
        mut self,
        purpose: Purpose,
        windows: Option<Windows>,
        errors: &Errors,
    ) -> Option<Submission> {
        let solid = if self.method.sees_faces() {
            self.refuse_plane_choices(errors);
            Some(self.pair.to_solid_pair(self.distance_growth(), errors)?)
        } else {
            self.pair
                .refuse_three_dimensions(self.method.word(), errors);
            None
        };
        let pair = match &solid {
            Some(solid) => solid.section().clone(),
            None => self.pair.to_pair(self.distance_growth(), errors)?,
        };
        self.check_running(&pair, errors);
        self.check_stress(errors);
        self.check_torques(&pair, errors);
        self.check_interface(&pair, errors);
        if let Some(windows) = windows {
            (
                self.resolution.span_mesh_periods,
                self.resolution.window_starts,
            ) = windows.within(&pair);
        }
        self.check_span(&pair, errors);
        self.check_windows(&pair, errors);
        self.resolution
            .span_mesh_periods
            .get_or_insert(pair.period());
        self.fill_in_table();
        self.check_forces(&pair, errors);
        self.check_size(purpose, &pair, errors);
        let faces = |pair| {
            let faces = Faces {
                pair,
                resolution: FaceResolution {
                    face_order: self.resolution.face_order as usize,
                    ..FaceResolution::STANDARD
                },
                slices: self.resolution.face_slices as usize,
                at_each_position: self.face_load == FaceRows::Positions,
                cure: true,
            };
            self.check_holes(&faces, errors);
            Box::new(faces)
        };
        let model = match (self.method, solid) {
            (Method::ThreeDimensionalProjected, Some(solid)) => {
                Model::Faces(faces(solid), FaceHoles::FirstOrder)
            }
            (_, Some(solid)) => Model::Faces(faces(solid), FaceHoles::Whole),
            (Method::LoadDistribution, None) => Model::Formulas(self.resolution.formulas()),
            (Method::Decomposition, None) => Model::Section(SectionHoles::Fitted),
            (Method::ProjectedDecomposition, None) => Model::Section(SectionHoles::FirstOrder),
            (_, None) => Model::Section(SectionHoles::Whole),
        };
        let largest = self.output_torques_n_m.iter().copied().fold(0.0, f64::max);
        let bearable = bearable_torque(&pair);
        let case = Case {
            pair,
            model,
            output_torques: self.output_torques_n_m.clone(),
            resolution: self.resolution.data(),
            windows: self.resolution.windows().to_vec(),
            stress: self.stress,
            driving_speed: self
                .driving_speed_rpm
                .map(|speed| RotationSpeed(speed / 60.0)),
            running: self
                .running
                .as_ref()
                .map(|running| running.data(&self.pair)),
        };
        let forces = self.force_table.as_ref().map(|table| ForcesRequest {
            table: table.data(largest, bearable),
            dynamics: self
                .dynamics
                .as_ref()
                .map(|dynamics| dynamics.data(self.modes.is_some())),
        });
        let modes = self.modes.as_ref();
        let modes = modes.map(|modes| modes.data(self.dynamics.as_ref()));
        self.check_modes(&case, errors);
        self.check_supports(&case, errors);
        Some(Submission {
            document: self,
            case,
            forces,
            modes,
        })
    }
}

impl Submission {
    /// Reads and checks a submission.
    ///
    /// # Errors
    ///
    /// A [`Problem`]: `malformed_json` (400) where the text is not JSON; else 422 with every field that is wrong, its
    /// JSON pointer, and the nearest value that would do.
    pub fn parse(document: &[u8]) -> Result<Self, Problem> {
        refuse_many_values(document, MOST_VALUES)?;
        Self::of_node(&Node::parse(document)?)
    }

    /// Reads and checks a submission that is taken apart already.
    pub fn of_node(node: &Node) -> Result<Self, Problem> {
        Self::of_node_with(node, None, |_, _, _| Some(()))
    }

    /// The same over `windows`, after `finish` has added to the pair the parts that cannot be written down beforehand. Its faults are reported.
    pub fn of_node_with(
        node: &Node,
        windows: Option<Windows>,
        finish: impl FnOnce(&mut PairDocument, Method, &Errors) -> Option<()>,
    ) -> Result<Self, Problem> {
        let errors = Errors::default();
        let document = SubmissionDocument::read(node, &Location::root(&errors), &EACH);
        let document = document.filter(|_| errors.count() == 0);
        let read = document.and_then(|mut document| {
            finish(&mut document.pair, document.method, &errors)?;
            document.checked(Purpose::Job, windows, &errors)
        });
        errors.mended(places::pointing).settle(read)
    }

    /// Faults of the fields of a submission, each by itself, without checks against each other.
    pub fn wrong_fields(node: &Node) -> Vec<FieldError> {
        let errors = Errors::default();
        SubmissionDocument::read(node, &Location::root(&errors), &EACH);
        errors.mended(places::pointing).into_errors()
    }

    /// Reads the remaining fields of `reader`, and checks them.
    pub(super) fn read(
        reader: ObjectReader<'_>,
        purpose: Purpose,
        errors: &Errors,
    ) -> Option<Self> {
        let document = SubmissionDocument::read_whole(reader)?;
        if errors.count() > 0 {
            return None;
        }
        document.checked(purpose, None, errors)
    }

    /// The case of the engine.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// Warnings of the document itself, about values that are not taken as written; then those of the engine.
    pub(super) fn warnings(&self, of_engine: &[Warning]) -> Vec<WarningDocument> {
        let own = self.document.pair.digits_taken().into_iter();
        own.chain(of_engine.iter().map(WarningDocument::of))
            .collect()
    }

    /// The request beside the curves.
    pub fn forces(&self) -> Option<&ForcesRequest> {
        self.forces.as_ref()
    }

    /// The natural modes that are asked for beside the curves.
    pub fn modes(&self) -> Option<&ModesRequest> {
        self.modes.as_ref()
    }

    /// What it costs, its modes included.
    pub fn estimate(&self) -> Estimate {
        let mut estimate = estimate(&self.case, self.forces());
        if self.modes.is_some() {
            let modes = blank_modes_estimate(&self.case);
            estimate.seconds += modes.seconds;
            estimate.memory += modes.memory;
        }
        estimate
    }

    /// The document with every default filled in.
    pub fn canonical_json(&self) -> String {
        serde_json::to_string(&self.document).expect("a submission is words and finite numbers")
    }

    /// SHA-256, in hexadecimal, of all that decides the result: the canonical document without its tags and the names of materials, and the solver's version.
    pub fn input_hash(&self) -> String {
        let mut untagged = SubmissionDocument {
            tags: Vec::new(),
            ..self.document.clone()
        };
        for gear in [&mut untagged.pair.driving, &mut untagged.pair.driven] {
            gear.material = gear.material.clone().unnamed();
        }
        let text =
            serde_json::to_string(&untagged).expect("a submission is words and finite numbers");
        sha256_hex(format!("{SOLVER_VERSION}\0{text}"))
    }

    /// Positions times torques, those of the force table included.
    pub fn positions_total(&self) -> u64 {
        let per_period = u64::from(self.case.resolution.positions_per_mesh_period);
        let of_table = self.forces.as_ref().map_or(0, |forces| {
            let positions = u64::from(self.case.pair.period() * MORE_POSITIONS) * per_period;
            u64::from(forces.table.loads) * positions
        });
        let windows = self.case.windows.len().max(1);
        (self.case.positions() * windows * self.case.output_torques.len()) as u64 + of_table
    }

    /// The method's word.
    pub fn method(&self) -> &'static str {
        self.case.method().word()
    }

    /// The tags.
    pub fn tags(&self) -> &[String] {
        &self.document.tags
    }

    /// How it is computed, with every default filled in.
    pub(super) fn resolution(&self) -> &ResolutionDocument {
        &self.document.resolution
    }
}

#[cfg(test)]
mod tests;
