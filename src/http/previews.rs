//! Previews: results in the answer to the request itself.

use std::time::Duration;

use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, HeaderName};
use axum::response::{IntoResponse, Response};
use meshwright_engine::run::Run;
use meshwright_wire::{Code, Preview, Problem, is_plain};

use super::blocking::blocking;
use super::body::JsonBody;
use super::client::Client;
use super::problem::Refusal;
use crate::compute::Previewed;

/// See the results at once
///
/// For a form that shows the curve while a hole is dragged: the same submission as for a job, answered in the same request
/// with the same results document, to the last digit. Nothing is kept: no job, no id, no entry in a list. In return it is
/// bounded: fewer positions times torques and less time than a job, and only so many at once (`/v1/limits` tells the
/// bounds).
///
/// With a `preview_id`, a newer request of the same client stops the older one, which is answered with
/// `preview_superseded`; the newer one is never refused for the sake of the older. A client that closes the connection
/// stops its preview too. Teeth are computed once and kept for all: only the first preview of a pair takes the time of a
/// job, a moved hole far less.
#[utoipa::path(
    post, path = "/v1/preview", tag = "Results", operation_id = "preview",
    request_body(content = Preview, content_type = "application/json", description = "The submission, and perhaps a `preview_id`."),
    responses(
        (status = 200, description = "The results, as a job would give them.", body = meshwright_wire::Results, headers(
            ("Server-Timing" = String, description = "`engine`: time of the computation; `wait`: time until there were threads for it; both in ms."),
            ("Cache-Control" = String, description = "`no-store`."),
        )),
        JsonBody,
        (status = 409, description = "A newer request with the same `preview_id` took the place of this one."),
        (status = 422, description = "The submission cannot be computed, or is too large or too long for a preview; `errors` says which field is why. `POST /v1/jobs` takes more."),
        (status = 503, description = "As many previews are computed as the service takes at once, it was not computed in time although its estimate is below the limit (`preview_time_limit`), or the service is shutting down. Try again after `Retry-After` seconds."),
    ),
)]
pub(super) async fn preview(
    client: Client,
    JsonBody(document, memory): JsonBody,
) -> Result<Response, Refusal> {
    let most = client.app.previews.rules().most_positions;
    let read = move |_: &Run| {
        let preview = Preview::parse(&document, most);
        drop((document, memory));
        preview
    };
    let preview = blocking(client.name(), read).await??;
    let jobs = &client.app.jobs;
    jobs.check_memory(client.name(), &preview.submission)
        .await?;
    let preview = refuse_long(&client, preview).await?;
    let previewed = client.app.previews.compute(client.name(), preview).await?;
    let headers = [
        (CONTENT_TYPE, "application/json".to_owned()),
        (CACHE_CONTROL, "no-store".to_owned()),
        (HeaderName::from_static("server-timing"), timing(&previewed)),
    ];
    Ok((headers, previewed.document).into_response())
}

/// Plane pairs of at most so many teeth together on the standard grid are computed within a second or two, whatever their estimate: they need
/// none.
const QUICK_TEETH: u32 = 200;

/// Previews of a shorter limit than this are all estimated.
const USUAL_LIMIT: Duration = Duration::from_secs(5);

/// Gives a preview back, unless it is estimated to take longer than one may.
async fn refuse_long(client: &Client, preview: Preview) -> Result<Preview, Problem> {
    let limit = client.app.previews.rules().time_limit;
    let submission = &preview.submission;
    let is_quick = submission.modes().is_none()
        && submission.forces().is_none()
        && is_plain(submission.case(), QUICK_TEETH);
    if limit >= USUAL_LIMIT && is_quick {
        return Ok(preview);
    }
    // The estimate divides both gears into elements.
    #[expect(clippy::disallowed_methods, reason = "in `blocking`")]
    let estimated = blocking(client.name(), move |_| {
        let submission = &preview.submission;
        let estimate = submission.estimate();
        (preview, estimate.seconds)
    });
    let (preview, seconds) = estimated.await?;
    if seconds <= limit.as_secs_f64() {
        return Ok(preview);
    }
    let detail = format!(
        "The preview is estimated to take {seconds:.1} s of a core; one may take {} s here. Fewer positions or torques, a coarser grid or a projected method take less, and POST /v1/jobs takes more.",
        limit.as_secs()
    );
    Err(Problem::new(Code::TooLarge, detail))
}

fn timing(previewed: &Previewed) -> String {
    let [engine, wait] =
        [previewed.computed, previewed.waited].map(|time| time.as_secs_f64() * 1e3);
    format!("engine;dur={engine:.2}, wait;dur={wait:.2}")
}
