//! Parts of answers.

use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE, HeaderValue, LOCATION, RETRY_AFTER};
use axum::response::{IntoResponse, Response};
use meshwright_connections::Tag;
use meshwright_wire::hash::sha256_hex_of;

/// A document that is JSON already.
pub(super) fn json(text: impl IntoResponse) -> Response {
    ([(CONTENT_TYPE, "application/json")], text).into_response()
}

/// A file that a browser saves under this name.
pub(super) fn file(media_type: &str, name: &str, body: impl IntoResponse) -> Response {
    let saved_as = format!("attachment; filename=\"{name}\"");
    let headers = [
        (CONTENT_TYPE, media_type.to_owned()),
        (CONTENT_DISPOSITION, saved_as),
    ];
    (headers, body).into_response()
}

/// The answer to a submission, whose result stands at `address`: 200 if it has ended and the client `expects_end`, 202 otherwise.
pub(super) fn submitted(
    view: impl IntoResponse,
    address: &str,
    has_ended: bool,
    expects_end: bool,
) -> Response {
    let mut response = json(view);
    if !(has_ended && expects_end) {
        *response.status_mut() = StatusCode::ACCEPTED;
    }
    let address = HeaderValue::from_str(address);
    let address =
        address.expect("the public address was checked at the start, an id is hexadecimal");
    response.headers_mut().insert(LOCATION, address);
    tell_when_to_return(has_ended, &mut response);
    response
}

/// The tag of an answer that is the same as long as these parts are.
pub(super) fn tag_of_parts(parts: &[&str]) -> Tag {
    Tag::of_hash(&sha256_hex_of(parts)[..32], "")
}

/// Until something has ended it is worth looking again.
pub(super) fn tell_when_to_return(has_ended: bool, response: &mut Response) {
    if !has_ended {
        let seconds = HeaderValue::from_static("1");
        response.headers_mut().insert(RETRY_AFTER, seconds);
    }
}
