//! The body of a request: a JSON document of bounded size.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::extract::{FromRequest, Request};
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_ENCODING, CONTENT_TYPE, EXPECT};
use futures_util::StreamExt;
use http_body::Body as _;
use meshwright_connections::Part;
use meshwright_engine::run::Run;
use meshwright_exchange::rexs::{Refused, is_packed, unpacked};
use meshwright_wire::declare::escaped;
use meshwright_wire::{Code, Problem};
use serde::Deserialize;
use serde_path_to_error::Segment;
use tokio::time::timeout;
use utoipa::IntoResponses;
use utoipa::openapi::{RefOr, Response};

use super::app::App;
use super::blocking::blocking;
use super::client::ClientName;
use super::faults;
use super::memory::{weight, weight_of_lines};
use super::problem::Refusal;
use crate::mark::without_mark;

/// Multiple of the limit that is read and discarded, because a client that is still sending does not see the answer.
const DRAINED: usize = 64;

/// The bytes of a request's JSON document, at most `MIB` MiB, and the memory reserved for them and for the values parsed from them. The largest submission,
/// with every table full, has a few hundred thousand bytes. A document is received and parsed only once its memory is reserved; a client with many documents
/// shares its memory among them.
pub(super) struct JsonBody<const MIB: usize = 1>(pub(super) Bytes, pub(super) Memory);

/// The memory of a document: for its bytes, and for the values parsed from them.
pub(super) type Memory = [Option<Part>; 2];

impl<const MIB: usize> FromRequest<App> for JsonBody<MIB> {
    type Rejection = Refusal;

    async fn from_request(request: Request, app: &App) -> Result<Self, Refusal> {
        let (body, memory) = taken(request, app, MIB, &["json"], weight).await?;
        let mark = body.len() - without_mark(&body).len();
        Ok(Self(body.slice(mark..), memory))
    }
}

impl<const MIB: usize> IntoResponses for JsonBody<MIB> {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let broken = (
            "400",
            "The body is no JSON, or a header is not understood.".to_owned(),
        );
        [broken]
            .into_iter()
            .chain(refusals(MIB, "JSON"))
            .map(declared)
            .collect()
    }
}

/// Faults of a body that show before it is read: status and sentence.
fn refusals(mib: usize, kind: &str) -> [(&'static str, String); 2] {
    [
        ("413", format!("The body has more than {mib} MiB.")),
        ("415", format!("The body is not declared as {kind}.")),
    ]
}

fn declared((status, sentence): (&str, String)) -> (String, RefOr<Response>) {
    (status.to_owned(), Response::new(sentence).into())
}

/// The name of the client that sent `request`.
fn client_of(request: &Request) -> Arc<str> {
    let client = request.extensions().get::<ClientName>();
    client.map_or_else(|| Arc::from(""), |client| Arc::clone(&client.0))
}

/// The body of `request`, of one of the media types `kinds` and `mib` MiB at most, and the memory for it.
async fn taken(
    request: Request,
    app: &App,
    mib: usize,
    kinds: &[&str],
    weigh: fn(&[u8]) -> u64,
) -> Result<(Bytes, Memory), Problem> {
    let limit = mib * 1024 * 1024;
    let media_type = check_media_type(request.headers(), kinds);
    let length = request.body().size_hint().upper();
    if request.headers().contains_key(EXPECT) {
        // The client waits with its body until it is told to go on.
        media_type.clone()?;
        if length.is_some_and(|length| length > limit as u64) {
            return Err(too_long(limit));
        }
    }
    let length = length.map_or(limit, |length| length.min(limit as u64) as usize);
    let client = client_of(&request);
    let bytes = app.bodies.for_bytes(&client, length).await?;
    let body = timeout(app.times.body, read(request.into_body(), limit, length)).await;
    let body = body.map_err(|_| late(app.times.body))??;
    media_type?;
    let made = app.bodies.to_read(&client, &body, weigh).await?;
    Ok((body, [bytes, made]))
}

impl<const MIB: usize> JsonBody<MIB> {
    /// The document as a `T`, which is an object.
    pub(super) fn parse<'a, T: Deserialize<'a>>(&'a self) -> Result<T, Problem> {
        let read = serde_json::from_slice(&self.0);
        if let Err(error) = &read
            && !error.is_data()
        {
            let detail = format!("The JSON ends or breaks: {error}.");
            return Err(Problem::new(Code::MalformedJson, detail));
        }
        // A derived reader takes a list of the fields for the object, too.
        let first = self.0.trim_ascii_start().first();
        if let Some(problem) = first.and_then(|first| faults::of_whole_document(*first)) {
            return Err(problem);
        }
        read.or_else(|_| {
            let mut json = serde_json::Deserializer::from_slice(&self.0);
            serde_path_to_error::deserialize(&mut json).map_err(|error| fault_of(&error))
        })
    }
}

/// The fault that was met in reading a document.
pub(super) fn fault_of(error: &serde_path_to_error::Error<serde_json::Error>) -> Problem {
    let message = error.inner().to_string();
    let message = message
        .rsplit_once(" at line ")
        .map_or(&*message, |(message, _)| message);
    faults::of_document(&pointer_of(error.path()), message)
}

/// The pointer to the place at which a document could not be read: the object that lacks a field, where one is missing.
fn pointer_of(path: &serde_path_to_error::Path) -> String {
    let steps = path.iter().map(|segment| match segment {
        Segment::Map { key } => format!("/{}", escaped(key)),
        Segment::Seq { index } => format!("/{index}"),
        Segment::Enum { .. } | Segment::Unknown => String::new(),
    });
    steps.collect()
}

/// A model of a gearbox may have so many MiB, unpacked.
const MODEL_MIB: usize = 4;

/// The media types of the containers of a model.
pub(super) const MODEL_TYPES: &[&str] = &["xml", "json", "zip"];

/// The bytes of a request's model of a gearbox, unpacked, and the memory that it takes.
pub(super) struct ModelBody(pub(super) Bytes, pub(super) Memory);

impl FromRequest<App> for ModelBody {
    type Rejection = Refusal;

    async fn from_request(request: Request, app: &App) -> Result<Self, Refusal> {
        let client = client_of(&request);
        let (body, memory) = taken(request, app, MODEL_MIB, MODEL_TYPES, weight).await?;
        if !is_packed(&body) {
            return Ok(Self(body, memory));
        }
        // Unpacked content of an archive takes as much memory as the same content sent unpacked.
        let limit = MODEL_MIB * 1024 * 1024;
        let bytes = app.bodies.for_bytes(&client, limit).await?;
        let unpack = move |_: &Run| unpacked(&body, limit).map(Cow::into_owned);
        let model = blocking(&client, unpack).await?;
        let refuse =
            |refused: Refused| Problem::new(Code::ModelRefused, refused.to_string().trim_end());
        let model = model.map_err(refuse)?;
        let made = app.bodies.to_read(&client, &model, weight).await?;
        Ok(Self(model.into(), [bytes, made]))
    }
}

impl IntoResponses for ModelBody {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let refusals = refusals(MODEL_MIB, "XML, JSON or a zip archive");
        refusals.into_iter().map(declared).collect()
    }
}

/// The body of a request for an outline, and the memory that it takes.
pub(super) enum OutlineBody {
    /// A submission.
    Submission(Bytes, Memory),
    /// A drawing in DXF.
    Drawing(Bytes, Memory),
}

impl FromRequest<App> for OutlineBody {
    type Rejection = Refusal;

    async fn from_request(request: Request, app: &App) -> Result<Self, Refusal> {
        if check_media_type(request.headers(), &["json"]).is_ok() {
            let (body, memory) = taken(request, app, 1, &["json"], weight).await?;
            return Ok(Self::Submission(body, memory));
        }
        let kinds = ["json", "dxf"];
        let (body, memory) = taken(request, app, DRAWING_MIB, &kinds, weight_of_lines).await?;
        Ok(Self::Drawing(body, memory))
    }
}

impl IntoResponses for OutlineBody {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let large =
            format!("The body has more than 1 MiB, as a drawing more than {DRAWING_MIB} MiB.");
        let mut answers = JsonBody::<1>::responses();
        answers.extend([
            declared(("413", large)),
            declared((
                "415",
                "The body is not declared as JSON or a drawing.".to_owned(),
            )),
        ]);
        answers
    }
}

/// A drawing may have so many MiB.
const DRAWING_MIB: usize = 4;

/// Checks that the body is declared as one of `kinds`, by any of its names.
fn check_media_type(headers: &HeaderMap, kinds: &[&str]) -> Result<(), Problem> {
    let refuse = |detail: String| Err(Problem::new(Code::UnsupportedMediaType, detail));
    if headers
        .get(CONTENT_ENCODING)
        .is_some_and(|encoding| encoding != "identity")
    {
        return refuse("Send the body without a Content-Encoding.".to_owned());
    }
    let wanted: Vec<String> = kinds
        .iter()
        .map(|kind| format!("application/{kind}"))
        .collect();
    let wanted = wanted.join(" or ");
    let Some(given) = headers.get(CONTENT_TYPE) else {
        return refuse(format!("Send the body with Content-Type: {wanted}."));
    };
    let essence = given
        .to_str()
        .unwrap_or_default()
        .split(';')
        .next()
        .unwrap_or_default()
        .trim()
        .to_ascii_lowercase();
    let known = |kind: &&str| match essence.strip_prefix("application/") {
        Some(name) => {
            name == *kind
                || name.ends_with(&format!("+{kind}"))
                // Names that browsers give to an archive, and to a file of an unknown kind.
                || (*kind == "zip" && ["x-zip-compressed", "octet-stream"].contains(&name))
                || (*kind == "dxf" && ["x-dxf", "octet-stream"].contains(&name))
        }
        None => match *kind {
            "xml" => essence == "text/xml",
            "dxf" => ["image/vnd.dxf", "image/x-dxf"].contains(&&*essence),
            _ => false,
        },
    };
    if kinds.iter().any(known) {
        return Ok(());
    }
    refuse(format!(
        "Send the body with Content-Type: {wanted}, not {essence:?}."
    ))
}

async fn read(body: Body, limit: usize, expected: usize) -> Result<Bytes, Problem> {
    let (mut stream, mut length) = (body.into_data_stream(), 0_usize);
    let mut bytes = Vec::with_capacity(expected);
    while let Some(chunk) = stream.next().await {
        let chunk = chunk.map_err(|_| broken())?;
        length = length.saturating_add(chunk.len());
        if length > DRAINED * limit {
            break;
        }
        if length <= limit {
            bytes.extend_from_slice(&chunk);
        }
    }
    if length > limit {
        return Err(too_long(limit));
    }
    Ok(bytes.into())
}

fn too_long(limit: usize) -> Problem {
    Problem::new(
        Code::PayloadTooLarge,
        format!("The body has more than {limit} bytes, the limit here."),
    )
}

fn late(limit: Duration) -> Problem {
    Problem::new(
        Code::RequestTimeout,
        format!("The body was not here within {} s.", limit.as_secs_f64()),
    )
}

fn broken() -> Problem {
    Problem::new(
        Code::MalformedJson,
        "The body ended before it was complete.",
    )
}
