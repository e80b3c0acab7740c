//! The population of a study: its statistics, and one member or design by itself.

use std::sync::Arc;

use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use meshwright_connections::{Keep, Part};
use meshwright_engine::run::Run;
use meshwright_studies::{PopulationResults, PopulationSample, RowState, SearchState, Study};
use meshwright_wire::{Code, Problem, Submission};

use super::{MIB, over_rows, tag_of};
use crate::http::answer::{json, tag_of_parts, tell_when_to_return};
use crate::http::app::App;
use crate::http::blocking::blocking;
use crate::http::client::Client;
use crate::http::memory::{SMALL, weight};
use crate::http::parameters::{IfNoneMatch, StudyId};
use crate::http::problem::Refusal;
use crate::jobs::{Resource as _, StudyRecord};

/// Get the statistics of a population
///
/// Mean, spread, percentiles with their confidence limits, a histogram and influences of every quantity, as far as the study has come; it can
/// be asked at any time. A percentile's limits are order statistics, drawn together as far as Sobol' points settle sooner than random members; there are none where
/// the members are too few to carry them. The share of a field is found by ranks, that of a gear's teeth from pairs of members that have
/// the gear in common.
#[utoipa::path(
    get, path = "/v1/studies/{id}/results/population", tag = "Studies", operation_id = "get_study_population",
    params(IfNoneMatch),
    responses(
        (status = 200, description = "Statistics of the members so far.", body = PopulationResults, headers(
            ("Retry-After" = u32, description = "Until the study has ended: seconds after which it is worth looking again."),
        )),
        (status = 404, description = "There is no such study, or it is no population."),
    ),
)]
pub(in crate::http) async fn population(
    client: Client,
    StudyId(id): StudyId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let study = StudyRecord::find(&client.app.jobs, client.name(), id).await?;
    let tag = tag_of(&study, "population", &client.app.edge);
    let name = Arc::from(client.name());
    let made = async {
        let results = results(&client.app, name, &study).await?;
        Ok::<_, Refusal>(axum::Json(results).into_response())
    };
    let mut response = tag.answer(Keep::AskAgain, &request, made).await?;
    tell_when_to_return(study.status().has_ended(), &mut response);
    Ok(response)
}

/// The table is read once for as many torques as fit in memory.
async fn results(
    app: &App,
    client: Arc<str>,
    record: &StudyRecord,
) -> Result<PopulationResults, Problem> {
    let (study, _memory) = document(app, &client, record).await?;
    let study = Arc::new(study);
    let at_once = PopulationSample::torques_at_once(&study);
    let mut whole: Option<PopulationResults> = None;
    for first in (0..Study::MOST_TORQUES).step_by(at_once) {
        let Some(sample) = PopulationSample::new(&study, first..first + at_once) else {
            return Err(Problem::new(
                Code::NotFound,
                "This study is no population; its table is at /results.",
            ));
        };
        let add = |sample: &mut PopulationSample, row: u64, state: &RowState| {
            sample.add(row as u32, state);
        };
        let sample = over_rows(app, &client, record.id, sample, add).await?;
        let (id, status) = (record.id, record.status());
        let (part, is_last) = blocking(&client, move |_| {
            (sample.results(Some(id), status), sample.has_all_torques())
        })
        .await?;
        match &mut whole {
            None => whole = Some(part),
            Some(whole) => whole.quantities.extend(part.quantities),
        }
        if is_last {
            break;
        }
    }
    whole.ok_or_else(crate::http::problem::internal)
}

/// The study as it was sent, read, and the memory that it takes.
async fn document(
    app: &App,
    client: &str,
    record: &StudyRecord,
) -> Result<(Study, Option<Part>), Problem> {
    let short = app.jobs.short_study_text(record.id, SMALL as u64).await?;
    let (text, bytes) = match short {
        Some(text) => (text, None),
        None => {
            let bytes = app.bodies.for_bytes(client, MIB << 20).await?;
            (app.jobs.study_text(record.id).await?, bytes)
        }
    };
    let memory = app.bodies.to_read(client, text.as_bytes(), weight).await?;
    let read = move |run: &Run| {
        let study = Study::parse(text.as_bytes(), run);
        drop((text, bytes));
        (study, memory)
    };
    let (study, memory) = blocking(client, read).await?;
    Ok((study?, memory))
}

/// Get the submission of a design
///
/// The design of a row of the table, as a submission with every default filled in, including the drawn teeth of a member: the input of its job. A design that
/// cannot be built is given as far as it can be put together.
#[utoipa::path(
    get, path = "/v1/studies/{id}/designs/{row}", tag = "Studies", operation_id = "get_study_design",
    params(
        ("row" = u32, Path, example = 0, description = "The place of the design in the table, from 0.", minimum = 0),
        IfNoneMatch,
    ),
    responses(
        (status = 200, description = "The submission.", body = Submission),
        (status = 404, description = "There is no such study, or it has no such row."),
    ),
)]
pub(in crate::http) async fn design(
    client: Client,
    Path((id, row)): Path<(String, String)>,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let StudyId(id) = StudyId::of(&id)?;
    let record = StudyRecord::find(&client.app.jobs, client.name(), id).await?;
    let wanted = row.parse::<u32>().ok();
    let text = async {
        let found = match wanted {
            Some(row) => submission_of(&client.app, client.name(), &record, row).await?,
            None => None,
        };
        let Some(text) = found else {
            let detail = format!("The study has {} designs, counted from 0.", record.total);
            return Err(Problem::new(Code::NotFound, detail).into());
        };
        Ok::<_, Refusal>(json(text))
    };
    let tag = tag_of_parts(&["design", &record.id.to_string(), &row]);
    tag.answer(Keep::ForGood, &request, text).await
}

/// The submission of a row; none if there is no such row.
async fn submission_of(
    app: &App,
    client: &str,
    record: &StudyRecord,
    row: u32,
) -> Result<Option<String>, Problem> {
    let (study, memory) = document(app, client, record).await?;
    if !study.is_search() {
        return blocking(client, move |_| {
            let _memory = memory;
            study.submission_of(row as usize)
        })
        .await;
    }
    // The rows hold the designs that a search has asked for.
    let rows = app.jobs.study_rows(record.id, u64::from(row), 1).await?;
    blocking(client, move |_| {
        let row = rows.first()?;
        study.submission_searched(&row.label, &row.changes)
    })
    .await
}

/// Get the best design of a search
///
/// The design of `search.best`, as a submission with every default filled in: the best so far while the search runs.
#[utoipa::path(
    get, path = "/v1/studies/{id}/best", tag = "Studies", operation_id = "get_study_best",
    params(IfNoneMatch),
    responses(
        (status = 200, description = "The submission.", body = Submission, headers(
            ("Retry-After" = u32, description = "Until the search has ended: seconds after which it is worth looking again."),
        )),
        (status = 404, description = "There is no such study, it is no search, or no design of it could be had so far."),
    ),
)]
pub(in crate::http) async fn best(
    client: Client,
    StudyId(id): StudyId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let record = StudyRecord::find(&client.app.jobs, client.name(), id).await?;
    let Some(state) = &record.search else {
        let detail = "This study is no search; its table is at /results.";
        return Err(Problem::new(Code::NotFound, detail).into());
    };
    let state: SearchState =
        serde_json::from_str(state).map_err(|_| crate::http::problem::internal())?;
    let Some(best) = state.best else {
        let detail = state
            .why_nothing()
            .unwrap_or_else(|| "No design of this search has been computed so far.".to_owned());
        return Err(Problem::new(Code::ResultNotReady, detail).into());
    };
    let text = async {
        let found = submission_of(&client.app, client.name(), &record, best.row as u32).await?;
        let text = found.ok_or_else(crate::http::problem::internal)?;
        Ok::<_, Refusal>(json(text))
    };
    let tag = tag_of_parts(&["best", &record.id.to_string(), &best.row.to_string()]);
    let mut response = tag.answer(Keep::AskAgain, &request, text).await?;
    tell_when_to_return(record.status().has_ended(), &mut response);
    Ok(response)
}
