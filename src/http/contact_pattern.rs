//! Where the flanks of a job's pair touch and how they press there, as numbers and as a picture.

use axum::http::HeaderMap;
use axum::response::Response;
use meshwright_engine::analysis::contact_pattern::ContactPattern;
use meshwright_wire::solve::contact_pattern;
use meshwright_wire::{Code, ContactPatternDocument, Problem, Submission};
use serde::Deserialize;
use utoipa::IntoParams;
use uuid::Uuid;

use super::client::Client;
use super::fields::{Cost, Done, File, NoLook};
use super::parameters::{IfNoneMatch, JobId, Parameters, number};
use super::pictures;
use super::problem::{Refusal, internal};

/// Which curve.
#[derive(Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct PatternParameters {
    /// One of the job's output torques, in N m, not 0; without it, all of them.
    #[param(example = 115.0)]
    #[serde(default, deserialize_with = "number")]
    torque: Option<f64>,
}

/// Get the contact pattern
///
/// The largest pressure over the period on both flanks of a pair that was computed along its faces, and the lines of contact at each position with
/// the load and the pressure along them. It is
/// computed anew from the submission, bounded, and answered later (202) as `fields.vtu` is.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/contact-pattern.json", tag = "Results", operation_id = "get_contact_pattern",
    params(PatternParameters, IfNoneMatch),
    responses(
        (status = 200, description = "The pattern.", body = ContactPatternDocument, headers(
            ("Solver-Version" = String, description = "The version of the solver that has computed this pattern."),
            ("Results-Solver-Version" = Option<String>, description = "The version that computed the job's results, where it is another one: its curves may differ a little from what is seen here."),
        )),
        NoLook,
    ),
)]
pub(super) async fn json(
    client: Client,
    Parameters(which): Parameters<PatternParameters>,
    JobId(id): JobId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let write = |pattern: &ContactPattern| {
        let document = ContactPatternDocument::of(pattern);
        Ok(document.to_json().map_err(|_| internal())?.into_bytes())
    };
    let file = File::shown("contact-pattern.json", "application/json");
    answer(&client, id, &which, &request, file, write).await
}

/// Get the contact pattern as a picture
///
/// The largest pressure over the period by color, on both flanks, over the face and the diameter: a row for each output torque.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results/contact-pattern.svg", tag = "Results", operation_id = "draw_contact_pattern",
    params(PatternParameters, IfNoneMatch),
    responses(
        (status = 200, description = "The picture.", body = String, content_type = "image/svg+xml", headers(
            ("Solver-Version" = String, description = "The version of the solver that has computed this pattern."),
            ("Results-Solver-Version" = Option<String>, description = "The version that computed the job's results, where it is another one."),
        )),
        NoLook,
    ),
)]
pub(super) async fn svg(
    client: Client,
    Parameters(which): Parameters<PatternParameters>,
    JobId(id): JobId,
    request: HeaderMap,
) -> Result<Response, Refusal> {
    let write = |pattern: &ContactPattern| Ok(pictures::contact_pattern(pattern).into_bytes());
    let file = File::shown("contact-pattern.svg", "image/svg+xml");
    answer(&client, id, &which, &request, file, write).await
}

async fn answer(
    client: &Client,
    id: Uuid,
    which: &PatternParameters,
    request: &HeaderMap,
    file: File,
    write: impl FnOnce(&ContactPattern) -> Result<Vec<u8>, Problem> + Send + 'static,
) -> Result<Response, Refusal> {
    let done = Done::find(client, id).await?;
    let torques = which.of(&done.submission)?;
    let form = which
        .torque
        .map_or_else(String::new, |torque| torque.to_string());
    let work = move |submission: &Submission, library: &_, run: &_| {
        write(&contact_pattern(submission, &torques, library, run)?)
    };
    let cost = |submission: &Submission| Ok(Cost::of_fields(submission, None));
    done.look(client, (file, &form), request, cost, work).await
}

impl PatternParameters {
    /// The torques that are meant, if `submission` has them.
    fn of(&self, submission: &Submission) -> Result<Vec<f64>, Problem> {
        let all = &submission.case().output_torques;
        let meant = |torque: &&f64| **torque != 0.0 && self.torque.is_none_or(|of| of == **torque);
        let torques: Vec<f64> = all.iter().filter(meant).copied().collect();
        if torques.is_empty() {
            let all: Vec<String> = all.iter().map(f64::to_string).collect();
            let detail = format!(
                "There is no such torque to look at; the job's are {} N m, and at 0 nothing is pressed.",
                all.join(", ")
            );
            return Err(Problem::new(Code::NotFound, detail));
        }
        Ok(torques)
    }
}
