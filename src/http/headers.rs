//! Headers of every answer: what browsers may not do with it, and its name in the log.

use std::time::SystemTime;

use axum::extract::{MatchedPath, Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, DATE, HeaderName, HeaderValue, REFERRER_POLICY,
    STRICT_TRANSPORT_SECURITY, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::middleware::Next;
use axum::response::Response;
use uuid::Uuid;

use crate::jobs::{Clock, without_secrets};
use crate::spans::{self, Place, Span, Value};

/// Content other than the page runs nothing. The page runs its own files and connects to its own service. The documentation brings scripts of its own.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const POLICY_OF_PAGE: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const POLICY_OF_DOCS: &str = "default-src 'self'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// The page of a link shows pictures of the same link, and runs nothing.
const POLICY_OF_SHARED: &str = "default-src 'none'; img-src 'self'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");
const TRACE_PARENT: HeaderName = HeaderName::from_static("traceparent");
const RESOURCE_POLICY: HeaderName = HeaderName::from_static("cross-origin-resource-policy");

/// The most characters of a request's id that a client gives.
const LONGEST_ID: usize = 128;

/// Adds the headers that restrict browsers, and forbids caches to keep private answers.
pub(super) async fn secure(
    State(public_url_is_https): State<bool>,
    request: Request,
    next: Next,
) -> Response {
    let policy = policy_of(request.uri().path());
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    for (name, value) in [
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (X_FRAME_OPTIONS, "DENY"),
        (REFERRER_POLICY, "no-referrer"),
        (RESOURCE_POLICY, "same-site"),
        (CONTENT_SECURITY_POLICY, policy),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if public_url_is_https {
        let value = HeaderValue::from_static("max-age=31536000");
        headers.insert(STRICT_TRANSPORT_SECURITY, value);
    }
    headers
        .entry(CACHE_CONTROL)
        .or_insert(HeaderValue::from_static("no-store"));
    response
}

/// Says when the answer was made, by the clock of the service: one that is kept beside the clock would stay in the future when
/// that is set back.
pub(super) async fn date(State(clock): State<Clock>, request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    let now = clock
        .now()
        .strftime("%a, %d %b %Y %H:%M:%S GMT")
        .to_string();
    if let Ok(now) = HeaderValue::try_from(now) {
        response.headers_mut().insert(DATE, now);
    }
    response
}

fn policy_of(path: &str) -> &'static str {
    match path {
        "/" => POLICY_OF_PAGE,
        _ if path.starts_with("/guides") => POLICY_OF_PAGE,
        _ if path.starts_with("/docs") => POLICY_OF_DOCS,
        _ if path.starts_with("/shared/") => POLICY_OF_SHARED,
        _ => POLICY,
    }
}

/// Gives every request an id and a place in a trace: those that it came with, if they are such, or new ones. They stand in
/// the log and on the answer.
pub(super) async fn name(mut request: Request, next: Next) -> Response {
    let id = request
        .headers()
        .get(REQUEST_ID)
        .filter(|id| is_id(id))
        .cloned()
        .unwrap_or_else(|| value(&Uuid::new_v4().to_string()));
    let parent = request
        .headers()
        .get(TRACE_PARENT)
        .and_then(|parent| Trace::parse(parent.to_str().ok()?));
    let trace = parent.unwrap_or_else(Trace::begin).step();
    request.headers_mut().insert(REQUEST_ID, id.clone());
    request.extensions_mut().insert(trace.clone());
    let mut response = next.run(request).await;
    response.headers_mut().insert(REQUEST_ID, id);
    response
        .headers_mut()
        .insert(TRACE_PARENT, value(&trace.to_header()));
    response
}

fn is_id(id: &HeaderValue) -> bool {
    // A text in a log must not look like another line of it.
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"-_.:/+=".contains(byte);
    (1..=LONGEST_ID).contains(&id.len()) && id.as_bytes().iter().all(is_plain)
}

fn value(text: &str) -> HeaderValue {
    HeaderValue::from_str(text).expect("hexadecimal digits are visible ASCII")
}

/// The jobs that a request has made and that are computed, for its span.
#[derive(Clone)]
pub(super) struct Made(pub(super) Vec<Uuid>);

/// Records status and route in the span of a request.
pub(super) async fn tell(request: Request, next: Next) -> Response {
    /// The most characters of a path that are exported.
    const LONGEST_PATH: usize = 200;
    let trace = request.extensions().get::<Trace>();
    // Health is asked for all the time, by those who keep the service alive.
    let is_quiet = request.uri().path().starts_with("/health/");
    let Some(trace) = trace
        .filter(|trace| trace.is_exported() && !is_quiet)
        .cloned()
    else {
        return next.run(request).await;
    };
    let begin = SystemTime::now();
    let method = super::metrics::known(request.method());
    // The pattern, not the address: requests of one kind have one name.
    let route = request.extensions().get::<MatchedPath>();
    let route = route.map_or("none", MatchedPath::as_str).to_owned();
    let id = request.headers().get(REQUEST_ID);
    let id = id.and_then(|id| id.to_str().ok()).unwrap_or_default();
    let path = without_secrets(request.uri().path());
    let path: String = path.chars().take(LONGEST_PATH).collect();
    let mut attributes: Vec<(_, Value)> = vec![
        ("http.request.method", method.into()),
        ("http.route", route.clone().into()),
        ("url.path", path.into()),
        ("meshwright.request.id", id.to_owned().into()),
    ];
    let mut response = next.run(request).await;
    let status = response.status();
    let status_code = i64::from(status.as_u16());
    attributes.push(("http.response.status_code", status_code.into()));
    let made = response.extensions_mut().remove::<Made>();
    let made = made.into_iter().flat_map(|Made(jobs)| jobs);
    spans::export(|| Span {
        place: Place {
            trace: bytes(&trace.id),
            span: bytes(&trace.span),
        },
        parent: (!trace.parent.is_empty()).then(|| bytes(&trace.parent)),
        is_entry: true,
        name: format!("{method} {route}").into(),
        begin,
        end: SystemTime::now(),
        attributes,
        causes: made.map(|job| Place::of_job(job, None)).collect(),
        failed: status.is_server_error(),
    });
    response
}

/// The bytes of hexadecimal digits, from the last one on; zeros where there are none.
fn bytes<const COUNT: usize>(digits: &str) -> [u8; COUNT] {
    let number = u128::from_str_radix(digits, 16).unwrap_or(0).to_be_bytes();
    let mut bytes = [0; COUNT];
    bytes.copy_from_slice(&number[number.len() - COUNT..]);
    bytes
}

/// A place in a trace (W3C Trace Context).
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Trace {
    /// The id of the whole trace.
    pub(super) id: String,
    span: String,
    /// The span that this one is a part of; empty at the beginning.
    parent: String,
    flags: String,
}

impl Trace {
    fn begin() -> Self {
        Self {
            id: Uuid::new_v4().simple().to_string(),
            span: String::new(),
            parent: String::new(),
            flags: if spans::are_exported() { "01" } else { "00" }.to_owned(),
        }
    }

    /// Reads a `traceparent`; `None` if it is none.
    fn parse(text: &str) -> Option<Self> {
        let mut parts = text.split('-');
        let mut part = |length: usize| {
            let is_hex = |part: &&str| {
                part.len() == length
                    && part
                        .bytes()
                        .all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
            };
            parts.next().filter(is_hex).map(str::to_owned)
        };
        let (version, id, span, flags) = (part(2)?, part(32)?, part(16)?, part(2)?);
        let is_zero = |text: &str| text.bytes().all(|byte| byte == b'0');
        // A later version may have more parts behind these.
        let known = version != "ff" && (version != "00" || parts.next().is_none());
        (known && !is_zero(&id) && !is_zero(&span)).then_some(Self {
            id,
            span,
            parent: String::new(),
            flags,
        })
    }

    /// A step of its own in the same trace.
    fn step(self) -> Self {
        let span = Uuid::new_v4().simple().to_string();
        Self {
            parent: self.span,
            span: span[..16].to_owned(),
            ..self
        }
    }

    /// True if spans are exported and the parent span is sampled.
    fn is_exported(&self) -> bool {
        let flags = u8::from_str_radix(&self.flags, 16).unwrap_or(0);
        spans::are_exported() && flags & 1 == 1
    }

    fn to_header(&self) -> String {
        format!("00-{}-{}-{}", self.id, self.span, self.flags)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trace_goes_on_with_a_step_of_its_own() {
        // The example of the recommendation.
        let parent = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01";
        let trace = Trace::parse(parent).unwrap().step();
        let header = trace.to_header();
        assert!(
            header.starts_with("00-0af7651916cd43dd8448eb211c80319c-") && header.ends_with("-01")
        );
        assert!(!header.contains("b7ad6b7169203331"));
        assert!(Trace::parse(&header).is_some());
        assert!(
            Trace::parse("01-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01-more").is_some()
        );
        for text in [
            "",
            "00",
            "ff-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01",
            "00-00000000000000000000000000000000-b7ad6b7169203331-01",
            "00-0af7651916cd43dd8448eb211c80319c-0000000000000000-01",
            "00-0AF7651916CD43DD8448EB211C80319C-b7ad6b7169203331-01",
            "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01-more",
        ] {
            assert_eq!(Trace::parse(text), None, "{text}");
        }
    }

    #[test]
    fn an_id_that_could_pass_for_a_line_of_the_log_is_none() {
        for (id, good) in [
            ("abc-1", true),
            ("a b", false),
            ("a\"b", false),
            ("", false),
            ("a{b}", false),
        ] {
            assert_eq!(is_id(&HeaderValue::from_str(id).unwrap()), good, "{id}");
        }
        assert!(!is_id(&HeaderValue::from_str(&"a".repeat(200)).unwrap()));
    }
}
