//! Models of gearboxes in REXS: submissions out of them, and a job as one.

use std::ops::ControlFlow;

use axum::Json;
use axum::response::Response;
use meshwright_engine::run::Run;
use meshwright_exchange::rexs::{
    Choices, Fault, Import, LoadedFlank, NotRead, Refused, each_stage,
};
use meshwright_wire::declare::document;
use meshwright_wire::{Code, FieldError, Problem, Submission, model_of};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::{IntoParams, ToSchema};

use super::answer::file;
use super::blocking::blocking;
use super::body::ModelBody;
use super::client::{Client, Onlooker};
use super::parameters::{JobId, Parameters, number, whole};
use super::problem::{Refusal, internal};
use crate::jobs::{Job, JobError, Resource as _};

/// Stages beyond this number are not looked at.
const MOST_STAGES: usize = 20;

/// Choices that a model leaves open.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct ModelParameters {
    /// The id of one cylindrical stage; without it, all of them.
    #[param(example = 2)]
    #[serde(default, deserialize_with = "whole")]
    stage: Option<i64>,
    /// The torque on the driven gear, in N m, instead of those of the model.
    #[param(example = 115.0, exclusive_minimum = 0.0)]
    #[serde(default, deserialize_with = "number")]
    torque: Option<f64>,
    /// The method, instead of the flexible one or that of the model.
    #[param(example = "flexible")]
    method: Option<String>,
    /// The bore radius of both gears, in mm, instead of those of the model.
    #[param(example = 16.0, exclusive_minimum = 0.0)]
    #[serde(default, deserialize_with = "number")]
    bore_radius_mm: Option<f64>,
    /// The flanks of both gears that are loaded, instead of those of the model.
    #[param(example = "left", inline)]
    flank: Option<FlankParameter>,
}

/// The side of the loaded flanks.
#[derive(Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = LoadedFlank, title = "Loaded flank")]
pub(super) enum FlankParameter {
    Left,
    Right,
}

impl FlankParameter {
    fn flank(self) -> LoadedFlank {
        match self {
            Self::Left => LoadedFlank::Left,
            Self::Right => LoadedFlank::Right,
        }
    }
}

/// The submissions of a model.
#[derive(Default, Serialize, ToSchema)]
#[schema(as = RexsModel, title = "Model")]
pub(super) struct ModelView {
    /// A submission for each cylindrical stage that is a pair of external gears, every default filled in.
    #[schema(value_type = Vec<Submission>)]
    submissions: Vec<Submission>,
    /// Parts of the model that none of the stages read.
    not_read: Vec<NotReadView>,
    /// Assumptions where the model is silent, a sentence each.
    assumed: Vec<String>,
    /// Why the other stages cannot be taken.
    refused: Vec<RefusedView>,
}

document! {
    /// An attribute of a model that was not read.
    pub(super) struct NotReadView as NotRead, "NotRead" view of (not_read: NotRead) {
        /// The component.
        component: String = not_read.component,
        /// Its attribute; null where nothing of the component was read.
        attribute: Option<String> = not_read.attribute,
    }
}

document! {
    /// Why a stage of a model cannot be taken.
    pub(super) struct RefusedView as RefusedPlace, "RefusedPlace" view of (fault: Fault) {
        /// The component and its attribute, or the line, or the file.
        place: String = fault.place,
        /// The fault, and the nearest value that would do.
        detail: String = fault.detail,
    }
}

/// Read a model of a gearbox
///
/// Takes a REXS model, version 1.0 to 2 as XML, as JSON or as either in a zip archive. The answer has the submission of each of its cylindrical stages, and a
/// list of the parts that were not read. Makes no job.
#[utoipa::path(
    post, path = "/v1/rexs", tag = "Reference", operation_id = "read_model",
    request_body(
        content((String = "application/xml"), (HashMap<String, Value> = "application/json"), (Value = "application/octet-stream")),
        description = "The model, in any of its containers.",
    ),
    params(ModelParameters),
    responses(
        (status = 200, description = "The submissions.", body = ModelView),
        (status = 400, description = "A parameter is not understood."),
        ModelBody,
        (status = 422, description = "The file is no model, or none of its stages can be taken; each error gives the reason."),
    ),
)]
pub(super) async fn read(
    onlooker: Onlooker,
    Parameters(parameters): Parameters<ModelParameters>,
    ModelBody(model, memory): ModelBody,
) -> Result<Json<ModelView>, Refusal> {
    let read = move |run: &Run| {
        let view = model_view(&model, &parameters, run);
        drop(memory);
        view
    };
    Ok(Json(blocking(onlooker.name(), read).await??))
}

fn model_view(model: &[u8], parameters: &ModelParameters, run: &Run) -> Result<ModelView, Problem> {
    let choices = Choices {
        stage: parameters.stage,
        torques: parameters.torque.into_iter().collect(),
        method: parameters.method.clone(),
        bore_radii: parameters.bore_radius_mm.into_iter().collect(),
        flank: parameters.flank.map(FlankParameter::flank),
    };
    let (mut view, mut errors) = (ModelView::default(), Vec::new());
    let take = |stage: Option<i64>, import: Result<Import, Refused>| {
        if run.check().is_err() {
            return ControlFlow::Break(());
        }
        let taken = import.map_err(|Refused(faults)| {
            let faults = faults.into_iter();
            faults
                .map(|fault| of_model(stage, fault))
                .collect::<Vec<_>>()
        });
        let taken = taken.and_then(|import| Ok((checked(stage, &import)?, import)));
        ControlFlow::Continue(match taken {
            Ok((submission, import)) => {
                view.submissions.push(submission);
                let remarks = import.remarks.into_iter();
                let assumed = remarks.filter(|remark| !remark.starts_with("Not read"));
                view.assumed.extend(assumed);
                true
            }
            Err(faults) => {
                errors.extend(faults);
                false
            }
        })
    };
    let not_read = each_stage(model, &choices, MOST_STAGES, take).map_err(|Refused(faults)| {
        let errors = faults.into_iter().map(|fault| of_model(None, fault));
        refusal(errors.collect())
    })?;
    if view.submissions.is_empty() {
        return Err(refusal(errors));
    }
    let refused = errors.into_iter().map(|(fault, _)| RefusedView::of(fault));
    view.refused = refused.collect();
    view.not_read = not_read.into_iter().map(NotReadView::of).collect();
    Ok(view)
}

/// A fault at a place of the model, and the same for the field of its submission.
type Wrong = (Fault, FieldError);

/// A fault of the model itself, without a field of a submission.
fn of_model(stage: Option<i64>, fault: Fault) -> Wrong {
    let error = FieldError::new("", Code::ModelRefused, "");
    wrong(stage, fault, error)
}

/// The error with the place and the words of the fault, after the stage that it is of.
fn wrong(stage: Option<i64>, fault: Fault, error: FieldError) -> Wrong {
    let stage = stage.map_or_else(String::new, |stage| format!("Stage {stage}: "));
    let detail = format!("{stage}{}: {}", fault.place, fault.detail);
    (fault, FieldError { detail, ..error })
}

/// The problem of a model of which nothing can be taken.
fn refusal(wrong: Vec<Wrong>) -> Problem {
    let (faults, errors) = wrong.into_iter().unzip();
    let detail = Refused(faults).to_string();
    Problem {
        errors,
        ..Problem::new(Code::ModelRefused, detail.trim_end())
    }
}

/// The submission, if it can be computed; faults are reported at their places in the model.
fn checked(stage: Option<i64>, import: &Import) -> Result<Submission, Vec<Wrong>> {
    let parsed = Submission::parse(import.submission.to_string().as_bytes());
    parsed.map_err(|problem| {
        let errors = problem.errors.into_iter();
        let faults = errors.map(|error| {
            let place = import.origin(&error.pointer);
            let fault = Fault {
                place: place.unwrap_or(&error.pointer).to_owned(),
                detail: error.detail.clone(),
            };
            wrong(stage, fault, error)
        });
        faults.collect()
    })
}

/// Memory of the results' text, its values and the model together, in multiples of the text's size.
const TIMES_THE_RESULTS: u64 = 8;

/// Get a job as a model of a gearbox
///
/// A REXS model, version 2.0, of the submission; of a job that has results with its curves, one load case for each torque.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/submission.rexs", tag = "Jobs", operation_id = "get_model",
    responses(
        (status = 200, description = "The model.", body = String, content_type = "application/xml"),
    ),
)]
pub(super) async fn write(client: Client, JobId(id): JobId) -> Result<Response, Refusal> {
    let job = Job::find(&client.app.jobs, client.name(), id).await?;
    let submission = client.app.jobs.submission(job.id).await?;
    let stored = match &job.document {
        None => None,
        // Of designs whose statistics alone were kept there are no curves to tell.
        Some(_) => match client.app.jobs.stored(&job).await {
            Err(JobError::ResultsNotKept(_)) => None,
            stored => Some(stored?),
        },
    };
    let most = TIMES_THE_RESULTS * stored.as_ref().map_or(0, |stored| stored.bytes);
    let memory = client.app.bodies.for_answer(client.name(), most).await?;
    let document = match &stored {
        None => None,
        Some(stored) => Some(client.app.jobs.document_of(&job, stored).await?),
    };
    let date = job.submitted_at.strftime("%Y-%m-%dT%H:%M:%S+00:00");
    let date = date.to_string();
    let written = blocking(client.name(), move |_| {
        let submission = Submission::parse(submission.as_bytes())?;
        let results: Option<Value> = match document {
            None => None,
            Some(document) => {
                let text = document.text().map_err(JobError::from)?;
                Some(serde_json::from_str(&text).map_err(|_| internal())?)
            }
        };
        Ok::<_, Refusal>(model_of(&submission, results.as_ref(), &date))
    });
    let model = memory.hold(written.await??);
    Ok(file("application/xml", &format!("{id}.rexs"), model))
}
