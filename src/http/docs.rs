//! The OpenAPI document and the page that shows it.

use std::sync::{Arc, LazyLock};

use axum::Router;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::{Redirect, Response};
use axum::routing::get;
use meshwright_wire::{Code, Problem};
use serde_json::{Value, json};
use utoipa::OpenApi as _;
use utoipa::openapi::path::{Operation, Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::security::{HttpAuthScheme, HttpBuilder, SecurityRequirement, SecurityScheme};
use utoipa::openapi::{
    ContentBuilder, HeaderBuilder, KnownFormat, ObjectBuilder, OpenApi, Ref, RefOr, Required,
    ResponseBuilder, SchemaFormat, Server, ServerBuilder, Type,
};

use super::app::App;
use super::contract;
use super::events::ProgressView;
use super::problem::Refusal;
use super::static_files::{Folder, StaticFile, files};
use super::studies::StudyProgressView;

/// The part of the document before the paths.
#[derive(utoipa::OpenApi)]
#[openapi(
    info(
        title = "Meshwright",
        description = "Static transmission error and mesh stiffness of spur and helical gear pairs, with tip relief and lightening holes.\n\nSubmit a job, look until it is `successful`, get its results. Units stand in the names of fields. Every error is a problem document (RFC 9457) with a stable `code`.",
        license(name = "MIT", identifier = "MIT"),
    ),
    components(schemas(ProgressView, StudyProgressView)),
    tags(
        (name = "Jobs", description = "Computations, from submission to end."),
        (name = "Results", description = "What was computed."),
        (name = "Studies", description = "Many variants of a submission at once, and their table."),
        (name = "Webhooks", description = "Where a client is told that its jobs and studies have ended."),
        (name = "Reference", description = "What can be known without a job."),
        (name = "Operation", description = "For those who run the service."),
    ),
)]
struct Introduction;

/// The name of the security scheme.
const KEY: &str = "key";

/// The same for tokens, where there is somebody who makes them.
const TOKEN: &str = "token";

pub(super) fn introduction() -> OpenApi {
    let mut openapi = Introduction::openapi();
    let scheme = HttpBuilder::new()
        .scheme(HttpAuthScheme::Bearer)
        .bearer_format("mw_ID_SECRET")
        .description(Some("A key that the operator of the service made (`meshwright keys create`). Needed as soon as there is one, and wherever others than this machine can call. Where the operator names an identity provider, one of its tokens will do as well."))
        .build();
    openapi
        .components
        .get_or_insert_default()
        .add_security_scheme(KEY, SecurityScheme::Http(scheme));
    say_whether_keys_are_needed(&mut openapi, false, None);
    openapi
}

/// Working examples for operations: a submission, a study, a model and a drawing.
const SUBMISSION: &str = include_str!("../../api/examples/standard-pair.json");
const STUDY: &str = include_str!("../../api/examples/study-section-5.json");
const MODEL: &str = include_str!("../../api/examples/test-case-2.rexs");
const DRAWING: &str = include_str!("../../api/examples/openings.dxf");

/// An example of the body of the operation at `path`, if it takes one.
fn example_of(path: &str) -> Option<Value> {
    let read = |text: &str| serde_json::from_str::<Value>(text).ok();
    Some(match path {
        "/v1/jobs" | "/v1/outline" | "/v1/preview" | "/v1/validate" => read(SUBMISSION)?,
        "/v1/jobs/batch" => json!({ "submissions": [read(SUBMISSION)?] }),
        "/v1/studies" => read(STUDY)?,
        "/v1/draw-deviations" => {
            json!({ "gear": read(SUBMISSION)?.pointer("/pair/driven")?, "iso_1328_class": 6, "seed": 1 })
        }
        "/v1/rexs" => MODEL.into(),
        "/v1/jobs/{id}/shares" => json!({ "ends_at": "2100-01-01T00:00:00Z" }),
        "/v1/webhooks" => json!({ "url": "https://hooks.example.com/meshwright" }),
        _ => return None,
    })
}

/// Adds the example of the body to the operation at `path`. A body that is not JSON is bytes, as generators of clients send it.
fn show_body(path: &str, operation: &mut Operation) {
    let Some(RefOr::T(body)) = &mut operation.request_body else {
        return;
    };
    for (media_type, content) in &mut body.content {
        let RefOr::T(content) = content else { continue };
        // A model is shown as XML; its other containers hold the same.
        let is_drawing = path == "/v1/outline" && media_type == "application/octet-stream";
        let example = if is_drawing {
            Some(DRAWING.into())
        } else {
            example_of(path)
        };
        let is_text = is_drawing || media_type == "application/xml";
        content.example = example.filter(|one| one.is_string() == is_text);
        if !media_type.ends_with("json") {
            let bytes = ObjectBuilder::new()
                .schema_type(Type::String)
                .format(Some(SchemaFormat::KnownFormat(KnownFormat::Binary)));
            content.schema = Some(bytes.into());
        }
    }
}

/// Adds to every operation the answers that all have in common: for missing rights, for limits, for the state of the service. Each refusal is a problem.
pub(super) fn add_common_answers(openapi: &mut OpenApi) {
    const WITH_KEY: [(&str, &str); 3] = [
        (
            "401",
            "A key is needed, and there is none, or it is not known.",
        ),
        ("403", "The key may not do this."),
        (
            "503",
            "Nothing can be stored or read now, or too much comes at once. Try again after `Retry-After` seconds.",
        ),
    ];
    const ALWAYS: [(&str, &str); 5] = [
        ("400", "The request is not understood."),
        ("408", "The body came too slowly."),
        ("421", "The service is not called so."),
        (
            "429",
            "More is asked by this client than one may ask, or by those without a key. Try again after `Retry-After` seconds.",
        ),
        ("default", "Any other problem."),
    ];
    for (path, item) in &mut openapi.paths.paths {
        let operations = [&mut item.get, &mut item.post, &mut item.delete];
        for operation in operations.into_iter().flatten() {
            describe_ids(path, operation);
            show_body(path, operation);
            add_answers_to_conditions(operation);
            let is_public = operation.security.is_some();
            let with_key = WITH_KEY.iter().filter(|_| !is_public);
            let responses = &mut operation.responses.responses;
            for (status, description) in with_key.chain(&ALWAYS) {
                let response = || {
                    ResponseBuilder::new()
                        .description(*description)
                        .build()
                        .into()
                };
                responses
                    .entry((*status).to_owned())
                    .or_insert_with(response);
            }
            for (status, response) in responses {
                if let RefOr::T(response) = response
                    && status.starts_with(['4', '5', 'd'])
                    && response.content.is_empty()
                {
                    let problem =
                        ContentBuilder::new().schema(Some(Ref::from_schema_name("Problem")));
                    let media_type = "application/problem+json".to_owned();
                    response
                        .content
                        .insert(media_type, RefOr::T(problem.build()));
                }
            }
        }
    }
}

/// Says whose `id` a path has, before its other parameters, and that there may be no such: handlers take it by a type of their own.
fn describe_ids(path: &str, operation: &mut Operation) {
    let whose = [
        ("/v1/jobs/", "job"),
        ("/v1/studies/", "study"),
        ("/v1/webhooks/", "webhook"),
        ("/v1/shares/", "link"),
    ];
    let whose = whose.iter().find(|(root, _)| path.starts_with(root));
    let Some((_, whose)) = whose.filter(|_| path.contains("{id}")) else {
        return;
    };
    let uuid = ObjectBuilder::new()
        .schema_type(Type::String)
        .format(Some(SchemaFormat::Custom("uuid".to_owned())));
    let id = ParameterBuilder::new()
        .name("id")
        .parameter_in(ParameterIn::Path)
        .required(Required::True)
        .description(Some(format!("The id of the {whose}.")))
        .schema(Some(uuid));
    let parameters = operation.parameters.get_or_insert_default();
    parameters.retain(|parameter| !is_called("id", parameter));
    parameters.insert(0, id.build().into());
    let missing = ResponseBuilder::new().description(format!("There is no such {whose}."));
    let responses = &mut operation.responses.responses;
    responses
        .entry("404".to_owned())
        .or_insert(missing.build().into());
}

fn is_called(name: &str, parameter: &RefOr<Parameter>) -> bool {
    matches!(parameter, RefOr::T(parameter) if parameter.name == name)
}

/// Adds the `ETag` and the answer without a body, where a request may say which answer it has.
fn add_answers_to_conditions(operation: &mut Operation) {
    let mut parameters = operation.parameters.iter().flatten();
    if !parameters.any(|parameter| is_called("If-None-Match", parameter)) {
        return;
    }
    let responses = &mut operation.responses.responses;
    if let Some(RefOr::T(whole)) = responses.get_mut("200") {
        let tag = HeaderBuilder::new()
            .schema(Some(ObjectBuilder::new().schema_type(Type::String)))
            .description(Some("Stands for this answer."));
        whole.headers.insert("ETag".to_owned(), tag.build().into());
    }
    let same = "Nothing has changed since the answer of that `ETag`.";
    let same = ResponseBuilder::new().description(same).build();
    responses.insert("304".to_owned(), same.into());
}

/// Says whether requests need a key, but for those that never do, and whose tokens will do as well.
pub(super) fn say_whether_keys_are_needed(
    openapi: &mut OpenApi,
    needed: bool,
    issuer: Option<&str>,
) {
    let with = |name: &str| SecurityRequirement::new(name, Vec::<String>::new());
    let mut security = vec![with(KEY)];
    if let Some(issuer) = issuer {
        let scheme = HttpBuilder::new()
            .scheme(HttpAuthScheme::Bearer)
            .bearer_format("JWT")
            .description(Some(format!("A token of {issuer}, for this service.")))
            .build();
        openapi
            .components
            .get_or_insert_default()
            .add_security_scheme(TOKEN, SecurityScheme::Http(scheme));
        security.push(with(TOKEN));
    }
    if !needed {
        security.insert(0, SecurityRequirement::default());
    }
    openapi.security = Some(security);
}

/// Gives pages of a list a name that a person would: utoipa names a generic type and its parameter, `Page_Job`.
fn name_lists(value: &mut Value) {
    const LISTS: [(&str, &str); 2] = [
        ("Page_Job", "JobList"),
        ("Page_SubmittedStudy", "StudyList"),
    ];
    match value {
        Value::String(text) => {
            for (name, list) in LISTS {
                if text == &format!("#/components/schemas/{name}") {
                    *text = format!("#/components/schemas/{list}");
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(name_lists),
        Value::Object(fields) => {
            for (name, list) in LISTS {
                if let Some(schema) = fields.shift_remove(name) {
                    fields.insert(list.to_owned(), schema);
                }
            }
            fields.values_mut().for_each(name_lists);
        }
        _ => {}
    }
}

/// The document with the schemas of the declared types, of which utoipa knows only the names.
pub(super) fn finished(openapi: &OpenApi) -> Value {
    fn put_declared(value: &mut Value) {
        if let Some(declared) = value.get_mut("x-declared").map(Value::take) {
            *value = declared;
        }
        match value {
            Value::Array(items) => items.iter_mut().for_each(put_declared),
            Value::Object(fields) => fields.values_mut().for_each(put_declared),
            _ => {}
        }
    }
    let mut document = serde_json::to_value(openapi).expect("the document is plain data");
    put_declared(&mut document);
    name_lists(&mut document);
    contract::finish(&mut document);
    document
}

/// Where the service is.
pub(super) fn server(public_url: &str) -> Server {
    ServerBuilder::new()
        .url(if public_url.is_empty() {
            "/"
        } else {
            public_url
        })
        .build()
}

/// The document at /openapi.json and the page at /docs, which needs nothing from elsewhere.
pub(super) fn routes_of_docs(openapi: &OpenApi) -> Router<App> {
    let json = StaticFile::document("application/json", finished(openapi).to_string());
    let json = Arc::new(json);
    let description = get(move |request: HeaderMap| async move { json.answer(&request).await });
    Router::new()
        .route("/openapi.json", description)
        .route("/docs", get(async || Redirect::to("docs/")))
        .route(
            "/docs/",
            get(async |request| file("index.html", request).await),
        )
        .route(
            "/docs/{name}",
            get(async |Path(name): Path<String>, request| file(&name, request).await),
        )
}

static FILES: LazyLock<Folder> = LazyLock::new(|| Folder::of(files::DOCS));

async fn file(name: &str, request: HeaderMap) -> Result<Response, Refusal> {
    let file = FILES.find(name).ok_or_else(|| {
        let detail = format!("The documentation has no file {name:?}; it begins at /docs/.");
        Problem::new(Code::NotFound, detail)
    })?;
    Ok(file.answer(&request).await)
}
