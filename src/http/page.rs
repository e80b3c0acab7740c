//! Pages of lists: their parameters, and the address of the next one.

use axum::Json;
use axum::http::header::{HeaderValue, LINK};
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;
use meshwright_wire::Problem;
use serde::Serialize;
use utoipa::ToSchema;

use super::edge::Edge;
use super::parameters::invalid;
use crate::jobs::{Cursor, Listed, Span};

/// A list has so many items unless the request says otherwise, and so many at most.
pub(super) const USUAL_LIMIT: u32 = 50;
pub(super) const LARGEST_LIMIT: u32 = 200;

/// Some items of a list, and where it goes on.
#[derive(Serialize, ToSchema)]
pub(super) struct Page<T> {
    /// The items, newest first.
    items: Vec<T>,
    /// The value of `cursor` that gives the next items; null at the end of the list.
    next: Option<String>,
}

/// The number of items that is asked for.
pub(super) fn limit(given: Option<u32>, usual: u32) -> Result<u32, Problem> {
    match given {
        None => Ok(usual),
        Some(limit) if (1..=LARGEST_LIMIT).contains(&limit) => Ok(limit),
        Some(limit) => Err(invalid(format!(
            "limit is {limit}; it lies between 1 and {LARGEST_LIMIT}."
        ))),
    }
}

/// The place behind which the list goes on.
pub(super) fn cursor(given: Option<&str>) -> Result<Option<Cursor>, Problem> {
    given.map(str::parse).transpose().map_err(|_| {
        invalid("cursor is not one that a list has given; take it from next as it stands.")
    })
}

/// The span of time that is asked for.
pub(super) fn span(since: Option<&str>, until: Option<&str>) -> Result<Span, Problem> {
    let instant = |name: &str, text: Option<&str>| {
        text.map(str::parse::<Timestamp>).transpose().map_err(|_| {
            invalid(format!(
                "{name} is no instant; it has the form 2026-11-21T16:00:00Z."
            ))
        })
    };
    Ok(Span {
        from: instant("submitted_since", since)?,
        until: instant("submitted_before", until)?,
    })
}

/// The answer: one page of `found`, and a link to the next one at `path` with the same parameters.
pub(super) fn answer<'a, T, V: Serialize>(
    edge: &Edge,
    path: &str,
    parameters: &[(&str, Option<&str>)],
    found: &'a Listed<T>,
    view: impl Fn(&'a T) -> V,
) -> Response {
    let page = Page {
        items: found.items.iter().map(view).collect(),
        next: found.next.map(|cursor| cursor.to_string()),
    };
    let link = page.next.as_ref().map(|cursor| {
        let mut query = form_urlencoded::Serializer::new(String::new());
        for (name, value) in parameters {
            if let Some(value) = value {
                query.append_pair(name, value);
            }
        }
        query.append_pair("cursor", cursor);
        format!(
            "<{}{path}?{}>; rel=\"next\"",
            edge.public_url,
            query.finish()
        )
    });
    let mut response = Json(page).into_response();
    if let Some(link) = link.and_then(|link| HeaderValue::try_from(link).ok()) {
        response.headers_mut().insert(LINK, link);
    }
    response
}
