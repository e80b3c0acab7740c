//! The outline of a pair: numbers for pages that draw it, or the drawing itself.

use axum::http::HeaderMap;
use axum::http::header::{ACCEPT, HeaderValue, VARY};
use axum::response::Response;
use meshwright_wire::{PairOutline, Submission};

use super::answer::json;
use super::blocking::blocking;
use super::body::JsonBody;
use super::client::Onlooker;
use super::pictures;
use super::problem::{Refusal, internal};

/// Get the outline of a pair
///
/// Takes a submission and answers with the pair as it is cut: the profile of a tooth of each gear, its holes, web and circles, where both
/// gears stand, and the line of action with its points A to E. Makes no job and computes no load: a drawing can follow the hand.
/// With `Accept: image/svg+xml` the answer is the drawing itself.
#[utoipa::path(
    post, path = "/v1/outline", tag = "Reference", operation_id = "outline",
    request_body(content = Submission, content_type = "application/json", description = "The submission."),
    responses(
        (status = 200, description = "The outline.", content((PairOutline = "application/json"), (String = "image/svg+xml"))),
        JsonBody,
        (status = 422, description = "The pair cannot be made; `errors` says which field is why."),
    ),
)]
pub(super) async fn outline(
    onlooker: Onlooker,
    request: HeaderMap,
    JsonBody(document, _memory): JsonBody,
) -> Result<Response, Refusal> {
    let as_picture = wants_picture(&request);
    let made = blocking(onlooker.name(), move |_| {
        let submission = Submission::parse(&document)?;
        let pair = &submission.case().pair;
        if as_picture {
            return Ok(pictures::answer(pictures::pair(pair)));
        }
        let outline = PairOutline::of(pair).to_json().map_err(|_| internal())?;
        Ok::<_, Refusal>(json(outline))
    });
    let mut response = made.await??;
    let headers = response.headers_mut();
    headers.insert(VARY, HeaderValue::from_static("accept"));
    Ok(response)
}

/// Whether the client asks for a picture by its name.
fn wants_picture(request: &HeaderMap) -> bool {
    let mut accepted = request.get_all(ACCEPT).iter();
    accepted.any(|value| {
        value
            .to_str()
            .is_ok_and(|text| text.contains("image/svg+xml"))
    })
}
