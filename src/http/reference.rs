//! Answers that need no job: checks of submissions, examples, and limits.

use std::sync::LazyLock;

use axum::Json;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Response;
use meshwright_engine::run::Run;
use meshwright_studies::table::{QuantityEntry, quantities as all_quantities};
use meshwright_studies::{MOST_DESIGNS, Study};
use meshwright_wire::declare::document;
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
use crate::jobs::{LONGEST_LINK_DAYS, MOST_LINKS, Rules};
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
#[derive(Serialize, ToSchema)]
#[schema(title = "StudyEstimate")]
pub(super) struct StudyEstimate {
    /// One design: of those that were looked at, the one that takes longest.
    design: EstimateDocument,
    /// Time of all designs on one core, in seconds: their number times the mean of those that were looked at. Designs that are equal, cannot be
    /// built or have parts in common take less.
    seconds: f64,
    /// Positions times torques of all designs.
    positions: u64,
}

impl StudyValidation {
    fn of(study: &Study, run: &Run) -> Result<Self, Problem> {
        let samples = study.samples(SAMPLES, run)?;
        let mut estimates = Vec::with_capacity(samples.len());
        for sample in &samples {
            run.check().map_err(|_| stopped())?;
            estimates.push(EstimateDocument::of(sample));
        }
        let (total, count) = (study.total(), estimates.len());
        let scale = total as f64 / count.max(1) as f64;
        let seconds: f64 = estimates.iter().map(|each| each.seconds).sum();
        let positions: u64 = estimates.iter().map(|each| each.positions).sum();
        let longest = estimates
            .into_iter()
            .max_by(|a, b| a.seconds.total_cmp(&b.seconds));
        Ok(Self {
            valid: true,
            total,
            estimate: longest.map(|design| StudyEstimate {
                design,
                seconds: scale * seconds,
                positions: (scale * positions as f64) as u64,
            }),
        })
    }
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
        (status = 200, description = "It can be computed.", body = Validated),
        JsonBody<16>,
        (status = 422, description = "It cannot be computed; `errors` says which field is why."),
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
