//! Submitting a job.

use axum::response::Response;
use meshwright_engine::run::Run;
use meshwright_wire::Submission;
use serde_json::value::RawValue;

use super::answer;
use super::app::App;
use super::blocking::blocking;
use super::body::JsonBody;
use super::client::Client;
use super::headers::Made;
use super::memory::{AnswerMemory, SMALL_ANSWER};
use super::parameters::{IdempotencyKey, User};
use super::prefer::Wait;
use super::problem::Refusal;
use super::results::text_of;
use super::view::JobView;
use crate::jobs::Job;

/// Submit a job
///
/// Queues the computation of a gear pair and answers at once with the job, before it is computed. The job is on the
/// disk by then. A submission equal to one whose job is successful gets a new job that is successful at once.
#[utoipa::path(
    post, path = "/v1/jobs", tag = "Jobs", operation_id = "submit_job",
    request_body(content = Submission, content_type = "application/json", description = "The submission."),
    params(IdempotencyKey, User, Wait),
    responses(
        (status = 202, description = "The job is queued, or is known and successful already.", body = JobView, headers(
            ("Location" = String, description = "The address of the job."),
            ("Retry-After" = u32, description = "Seconds after which it is worth looking."),
        )),
        (status = 200, description = "The job has ended: with `Prefer: wait` in time, and its `results` or its `problem` is inside; with a repeated `Idempotency-Key` meanwhile.", body = JobView),
        JsonBody,
        (status = 422, description = "The submission cannot be computed; `errors` says which field is why. Or the key was used for another submission."),
        (status = 429, description = "More jobs of this client wait than may."),
        (status = 503, description = "The queue is full, nothing can be stored, or the service is shutting down. Try again after `Retry-After` seconds."),
    ),
)]
pub(super) async fn submit(
    client: Client,
    IdempotencyKey(key): IdempotencyKey,
    wait: Wait,
    JsonBody(document, memory): JsonBody,
) -> Result<Response, Refusal> {
    // The document is small then, and its client may wait for long.
    let read = move |_: &Run| {
        let submission = Submission::parse(&document);
        drop((document, memory));
        submission
    };
    let submission = blocking(client.name(), read).await??;
    // Begun before the job is, so that its end is among them.
    let changes = client.app.jobs.changes();
    let submitted = client
        .app
        .jobs
        .submit(&client.member, &submission, key)
        .await?;
    let (mut job, repeated) = (submitted.record, submitted.repeated);
    let made = (!job.status.has_ended()).then(|| Made(vec![job.id]));

    // The job was made: whatever goes wrong from here on, it is told of it.
    let wait = wait.grant(&client);
    let (mut results, mut memory) = (None, None);
    if let Some(patience) = wait.patience() {
        if let Ok(now) = client
            .app
            .jobs
            .until_ended(changes, job.clone(), patience)
            .await
        {
            job = now;
        }
        if client.check_again().await.is_ok() {
            (results, memory) = results_of(&client.app, &job).await.unzip();
        }
    }
    let has_waited = wait.patience().is_some();
    let view = JobView::with_results(&job, results, &client.app.edge).to_json();
    let view = memory.unwrap_or_default().hold(view);
    let (address, has_ended) = (client.app.edge.job(job.id), job.status.has_ended());
    let mut response = answer::submitted(view, &address, has_ended, repeated || has_waited);
    if let Some(made) = made {
        response.extensions_mut().insert(made);
    }
    wait.acknowledge(response.headers_mut());
    Ok(response)
}

/// The results of a job, where it has some that can be read now. Those that cannot still stand at their address.
async fn results_of(app: &App, job: &Job) -> Option<(Box<RawValue>, AnswerMemory)> {
    job.document.as_ref()?;
    let stored = app.jobs.stored(job).await.ok()?;
    // Their text, and that of the whole answer.
    let memory = app
        .bodies
        .for_answer(&job.client, 2 * stored.bytes + SMALL_ANSWER as u64);
    let memory = memory.await.ok()?;
    let document = app.jobs.document_of(job, &stored).await.ok()?;
    let text = text_of(&job.client, document).await.ok()?;
    Some((RawValue::from_string(text).ok()?, memory))
}
