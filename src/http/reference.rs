//! Answers that need no job: checks of submissions, examples, and limits.

use std::sync::LazyLock;

use axum::Json;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use meshwright_engine::analysis::{Estimate, PartCost};
use meshwright_engine::run::Run;
use meshwright_studies::table::{QuantityEntry, quantities as all_quantities};
use meshwright_studies::{MOST_DESIGNS, Study};
use meshwright_wire::declare::document;
use meshwright_wire::materials::{MATERIALS, MaterialEntry};
use meshwright_wire::solve::EstimateDocument;
use meshwright_wire::{Code, Limits, Problem, Submission, Validation};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use super::app::App;
use super::batch::MOST_IN_BATCH;
use super::blocking::blocking;
use super::body::JsonBody;
use super::client::Onlooker;
use super::problem::Refusal;
use super::static_files::StaticFile;
use crate::compute::PreviewRules;
use crate::jobs::{LONGEST_LINK_DAYS, MOST_LINKS, MOST_PROJECT_BYTES, MOST_PROJECTS, Rules};
use crate::webhooks::most_webhooks;

/// The answer for a document that can be computed.
#[derive(Serialize, ToSchema)]
#[serde(untagged)]
#[schema(title = "Validated")]
pub(super) enum Validated {
    /// Of a submission.
    Submission(Box<Validation>),
    /// Of a study.
    Study(StudyValidation),
}

/// The answer to a study that would be taken.
#[derive(Serialize, ToSchema)]
#[schema(title = "StudyValidation")]
pub(super) struct StudyValidation {
    /// True; a study that is not valid is answered with its problem.
    valid: bool,
    /// Designs in all; of a search, the most that it may come to.
    total: usize,
    /// Estimated cost of the computation; null if none of the sampled designs can be built.
    estimate: Option<StudyEstimate>,
}

/// Estimated cost of a study, from a few of its designs.
#[derive(Debug, Serialize, ToSchema)]
#[schema(title = "StudyEstimate")]
pub(super) struct StudyEstimate {
    /// One design: of those that were looked at, the one that takes longest.
    design: EstimateDocument,
    /// Time of all designs on one core, in seconds, by those that were looked at: a part that these share, as the gears of the members of a population, is made
    /// once. Designs that are equal or cannot be built take less.
    seconds: f64,
    /// Positions times torques of all designs.
    positions: u64,
}

impl StudyValidation {
    fn of(study: &Study, run: &Run) -> Result<Self, Problem> {
        Ok(Self {
            valid: true,
            total: study.total(),
            estimate: StudyEstimate::of(study, run)?,
        })
    }
}

impl StudyEstimate {
    /// That of `study`; none where none of the designs that are looked at can be built.
    pub(super) fn of(study: &Study, run: &Run) -> Result<Option<Self>, Problem> {
        let samples = study.samples(SAMPLES, run)?;
        let mut estimates = Vec::with_capacity(samples.len());
        for sample in &samples {
            run.check().map_err(|_| stopped())?;
            #[expect(clippy::disallowed_methods, reason = "in `blocking`")]
            estimates.push(sample.estimate());
        }
        let scale = study.total() as f64 / estimates.len().max(1) as f64;
        let positions: u64 = samples.iter().map(Submission::positions_total).sum();
        let longest = samples
            .iter()
            .zip(&estimates)
            .max_by(|(_, a), (_, b)| a.seconds.total_cmp(&b.seconds));
        Ok(longest.map(|(sample, estimate)| Self {
            design: EstimateDocument::of((sample, estimate)),
            seconds: seconds_of_all(&estimates, [study.total(), study.unlike_designs()]),
            positions: (scale * positions as f64) as u64,
        }))
    }
}

/// Seconds of one core for `total` designs, from some of them as `samples`. At most `unlike` of the designs have gears of their own. A part that samples share is
/// made once for all designs; another part is made for each of the unlike ones.
fn seconds_of_all(samples: &[Estimate], [total, unlike]: [usize; 2]) -> f64 {
    let mut known: Vec<&PartCost> = Vec::new();
    let [mut first, mut later, mut own] = [0.0; 3];
    for (number, sample) in samples.iter().enumerate() {
        own += sample.seconds;
        for part in &sample.parts {
            own -= part.seconds;
            if known.iter().any(|known| known.is_same(part)) {
                continue;
            }
            known.push(part);
            *(if number == 0 { &mut first } else { &mut later }) += part.seconds;
        }
    }
    let count = samples.len();
    let each_later = later / count.saturating_sub(1).max(1) as f64;
    let own = own / count.max(1) as f64;
    first + each_later * unlike.saturating_sub(1) as f64 + own * total as f64
}

/// Number of designs of a study that are estimated. Each estimate divides two gears into elements.
const SAMPLES: usize = 3;

fn stopped() -> Problem {
    Problem::new(Code::Stopped, "The work was stopped before it was done.")
}

/// True if a document is meant for a study: it has a field that no submission has.
fn is_study(document: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct OfStudies {
        base: Option<IgnoredAny>,
        axes: Option<IgnoredAny>,
        designs: Option<IgnoredAny>,
        population: Option<IgnoredAny>,
        search: Option<IgnoredAny>,
    }
    let read = serde_json::from_slice::<OfStudies>(document);
    read.is_ok_and(|it| {
        let fields = [it.base, it.axes, it.designs, it.population, it.search];
        fields.iter().any(Option::is_some)
    })
}

/// Check a submission or a study
///
/// Makes no job. The answer to a submission is the submission with every default, the pair's derived geometry, warnings, and an estimate of size and time. The
/// answer to a study, population or search is the number of its designs and their estimated cost. A document that cannot be computed is answered with the
/// problem of its submission. Made to be called on every edit of a form.
#[utoipa::path(
    post, path = "/v1/validate", tag = "Reference", operation_id = "validate",
    request_body(content = Submission, content_type = "application/json", description = "The submission, or the study."),
    responses(
        (status = 200, description = "The document can be computed.", body = Validated),
        JsonBody<16>,
        (status = 422, description = "The document cannot be computed; `errors` names the fields."),
        (status = 503, description = "Too many submissions are checked at once. Try again after `Retry-After` seconds."),
    ),
)]
pub(super) async fn validate(
    onlooker: Onlooker,
    JsonBody(document, _memory): JsonBody<16>,
) -> Result<Json<Validated>, Refusal> {
    #[expect(clippy::disallowed_methods, reason = "in `blocking`")]
    let validated = blocking(onlooker.name(), move |run| {
        if is_study(&document) {
            let study = Study::submitted(&document, run)?;
            return StudyValidation::of(&study, run).map(Validated::Study);
        }
        let submission = Submission::parse(&document)?;
        let validation = meshwright_wire::validate(&submission);
        Ok::<_, Problem>(Validated::Submission(Box::new(validation)))
    });
    Ok(Json(validated.await??))
}

document! {
    /// A submission to start from.
    pub(super) struct Example as Example view of (example: &meshwright_wire::Example) {
        /// A short name.
        name: &'static str = example.name,
        /// Description of the example.
        description: &'static str = example.description,
        /// False for the one example that shows a refusal.
        valid: bool = example.valid,
        /// The submission, ready for `POST /v1/jobs`.
        #[schema(value_type = Submission)]
        submission: Value = serde_json::from_str(example.json).expect("a test reads every example"),
    }
}

/// The examples.
#[derive(Serialize, ToSchema)]
pub(super) struct Examples {
    /// The examples.
    items: Vec<Example>,
}

/// Get examples
///
/// Submissions to start from: the test cases of the paper and its study.
#[utoipa::path(
    get, path = "/v1/examples", tag = "Reference", operation_id = "get_examples",
    security(()),
    responses((status = 200, description = "The examples.", body = Examples)),
)]
pub(super) async fn examples(request: HeaderMap) -> Response {
    static EXAMPLES: LazyLock<StaticFile> = LazyLock::new(|| {
        let items = meshwright_wire::examples()
            .iter()
            .map(Example::of)
            .collect();
        let json = serde_json::to_vec(&Examples { items }).expect("examples are plain data");
        StaticFile::document("application/json", json)
    });
    EXAMPLES.answer(&request).await
}

/// The quantities.
#[derive(Serialize, ToSchema)]
pub(super) struct Quantities {
    /// The quantities, in the order of the columns of a table.
    items: Vec<QuantityEntry>,
}

/// Get quantities
///
/// The quantities of a design. Columns of tables, goals and bounds of searches, and results of populations use these names. Each has a title, its unit, the
/// better direction, and the submissions that have it.
#[utoipa::path(
    get, path = "/v1/quantities", tag = "Reference", operation_id = "get_quantities",
    security(()),
    responses((status = 200, description = "The quantities.", body = Quantities)),
)]
pub(super) async fn quantities(request: HeaderMap) -> Response {
    static QUANTITIES: LazyLock<StaticFile> = LazyLock::new(|| {
        let items = all_quantities().collect();
        let json = serde_json::to_vec(&Quantities { items }).expect("quantities are plain data");
        StaticFile::document("application/json", json)
    });
    QUANTITIES.answer(&request).await
}

/// The materials that have names.
#[derive(Serialize, ToSchema)]
#[schema(title = "Materials")]
pub(super) struct Materials {
    /// The materials.
    items: &'static [MaterialEntry],
}

/// Get materials
///
/// The materials that `material.name` of a gear takes: their numbers at a temperature, modulus and expansion at others, and where these are printed.
#[utoipa::path(
    get, path = "/v1/materials", tag = "Reference", operation_id = "get_materials",
    security(()),
    responses((status = 200, description = "The materials.", body = Materials)),
)]
pub(super) async fn materials(request: HeaderMap) -> Response {
    static FILE: LazyLock<StaticFile> = LazyLock::new(|| {
        let materials = Materials { items: &MATERIALS };
        let json = serde_json::to_vec(&materials).expect("materials are plain data");
        StaticFile::document("application/json", json)
    });
    FILE.answer(&request).await
}

document! {
    /// The limits of every submission, and those of this service.
    pub(super) struct ServiceLimits as ServiceLimits, "Limits" view of (app: &App) {
        #[serde(flatten)]
        submission: Limits = Limits::of(MOST_DESIGNS),
        /// Limits of previews.
        previews: PreviewLimits = PreviewLimits::of(app.previews.rules()),
        /// Limits of one client.
        client: ClientLimits = ClientLimits::of(app.jobs.rules()),
    }
}

document! {
    /// Limits of one client, unless its key says otherwise.
    pub(super) struct ClientLimits as ClientLimits, "ClientLimits" view of (rules: &Rules) {
        /// The most jobs that may wait, those of studies aside.
        jobs_waiting: u32 = rules.client_queue_limit,
        /// The most of them that one user of it may have.
        jobs_waiting_of_user: u32 = rules.user_limit(rules.client_queue_limit),
        /// The most designs of studies that may wait.
        designs_waiting: i64 = rules.client_design_limit,
        /// The most memory that one job may take, in MB.
        job_memory_mb: u64 = rules.job_memory_mb,
        /// The most submissions of a batch.
        batch: usize = MOST_IN_BATCH,
        /// The most webhooks.
        webhooks: i64 = most_webhooks(),
        /// The most links to the results of one job.
        shares_of_job: i64 = MOST_LINKS,
        /// The most projects.
        projects: i64 = MOST_PROJECTS,
        /// The most bytes of the document of a project.
        project_bytes: usize = MOST_PROJECT_BYTES,
        /// The longest time that a link to results is open, in days.
        share_days: i64 = LONGEST_LINK_DAYS,
    }
}

document! {
    /// Limits of previews.
    pub(super) struct PreviewLimits as PreviewLimits, "PreviewLimits"
    view of (rules: PreviewRules) {
        /// The most positions times torques of one.
        positions: u64 = rules.most_positions,
        /// The most at once.
        at_once: usize = rules.at_once,
        /// From the request to its answer, in seconds.
        time_limit_seconds: u64 = rules.time_limit.as_secs(),
    }
}

/// Get limits
///
/// The bounds that submissions must keep, and those of previews.
#[utoipa::path(
    get, path = "/v1/limits", tag = "Reference", operation_id = "get_limits",
    security(()),
    responses((status = 200, description = "The limits.", body = ServiceLimits)),
)]
pub(super) async fn limits(State(app): State<App>) -> Json<ServiceLimits> {
    Json(ServiceLimits::of(&app))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// The estimate of a study of this `plan` on the pair of case 2, over one mesh period.
    fn estimated(plan: (&str, Value)) -> StudyEstimate {
        let base = include_str!("../../api/examples/test-case-2.json");
        let mut base: Value = serde_json::from_str(base).expect("an example");
        base["resolution"] = json!({ "positions_per_mesh_period": 8, "span_mesh_periods": 1 });
        let study = json!({ "base": base, plan.0: plan.1 });
        let run = Run::unattended();
        let study = Study::parse(study.to_string().as_bytes(), &run).expect("a study");
        let estimate = StudyEstimate::of(&study, &run).expect("not stopped");
        estimate.expect("designs that can be built")
    }

    #[test]
    fn the_gears_of_a_population_are_estimated_once_and_those_of_unlike_designs_each_time() {
        let of_members = |size: u32| {
            let accuracy = json!({ "driving": { "iso_1328_class": 6 } });
            estimated(("population", json!({ "size": size, "accuracy": accuracy })))
        };
        let [two, many] = [2, 202].map(of_members);
        // The one design has its gears and its contacts, and each further member contacts alone.
        let member = (many.seconds - two.seconds) / 200.0;
        let gears = two.seconds - 2.0 * member;
        assert!(member > 0.0 && gears > 2.0 * member, "{member} {gears}");
        assert!((two.design.seconds / (gears + member) - 1.0).abs() < 1e-9);

        // Holes that move leave the teeth and the other gear as they are.
        let of_circles = |count: u32| {
            let radii: Vec<f64> = (0..count).map(|i| 33.0 + 0.01 * f64::from(i)).collect();
            let path = "/pair/driven/blank/holes/circle_radius_mm";
            estimated(("axes", json!([{ "path": path, "values": radii }])))
        };
        let [two, many] = [2, 12].map(of_circles);
        let each = (many.seconds - two.seconds) / 10.0;
        assert!(
            each > 1.1 * member && each < 0.8 * two.design.seconds,
            "{each} of {}",
            two.design.seconds
        );
    }
}
