//! The names of the parameters of a query. An unknown one is refused, as an unknown field is, wherever an operation is called.

use std::collections::HashMap;
use std::sync::Arc;

use axum::extract::{MatchedPath, Request, State};
use axum::http::Method;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use utoipa::openapi::path::{Operation, ParameterIn};
use utoipa::openapi::{OpenApi, RefOr};

use super::access::is_health;
use super::faults;
use super::parameters::invalid;
use super::problem::Refusal;

/// The names of the parameters that each operation takes in its query, by its path and method.
pub(super) struct Queries(HashMap<(String, Method), Vec<String>>);

impl Queries {
    /// Those that the OpenAPI document declares.
    pub(super) fn of(openapi: &OpenApi) -> Self {
        let operations = openapi.paths.paths.iter().flat_map(|(path, item)| {
            let operations = [
                (Method::GET, &item.get),
                (Method::POST, &item.post),
                (Method::PUT, &item.put),
                (Method::DELETE, &item.delete),
            ];
            let given = operations.into_iter();
            given.filter_map(move |(method, operation)| {
                Some(((path.clone(), method), names(operation.as_ref()?)))
            })
        });
        Self(operations.collect())
    }
}

/// The names of the parameters in the query of an operation.
fn names(operation: &Operation) -> Vec<String> {
    let parameters = operation.parameters.iter().flatten();
    let in_query = parameters.filter_map(|parameter| match parameter {
        RefOr::T(one) if one.parameter_in == ParameterIn::Query => Some(one.name.clone()),
        _ => None,
    });
    in_query.collect()
}

/// Refuses a request whose query has a name that its operation does not take. Health is answered always.
pub(super) async fn refuse_unknown_names(
    State(queries): State<Arc<Queries>>,
    request: Request,
    next: Next,
) -> Response {
    let method = match request.method() {
        &Method::HEAD => Method::GET,
        other => other.clone(),
    };
    let query = request.uri().query().filter(|_| !is_health(request.uri()));
    let path = request.extensions().get::<MatchedPath>();
    if let (Some(query), Some(path)) = (query, path)
        && let Some(known) = queries.0.get(&(path.as_str().to_owned(), method))
    {
        let mut given = form_urlencoded::parse(query.as_bytes());
        if let Some((name, _)) = given.find(|(name, _)| !known.iter().any(|one| one == name)) {
            let detail = faults::of_unknown_parameter(&name, known);
            return Refusal::from(invalid(detail)).into_response();
        }
    }
    next.run(request).await
}
