//! Parts of a request beside its body: path, query and headers.

use std::str::FromStr;

use axum::extract::{FromRequestParts, Path, Query};
use axum::http::HeaderMap;
use axum::http::request::Parts;
use meshwright_wire::{Code, Problem};
use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};
use utoipa::IntoParams;
use uuid::Uuid;

use super::faults;
use super::problem::Refusal;
use crate::keys::is_user_name;

/// The parameters in the query of a request, whose names are known by now.
pub(super) struct Parameters<T>(pub(super) T);

impl<T: DeserializeOwned, S: Sync> FromRequestParts<S> for Parameters<T> {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Refusal> {
        // No text that is kept has it, and PostgreSQL does not even take it for a text.
        let query = form_urlencoded::parse(parts.uri.query().unwrap_or_default().as_bytes());
        for (name, value) in query {
            if value.contains('\0') {
                let detail = format!("{name:?} has a character NUL, which stands in no text here.");
                return Err(invalid(detail).into());
            }
        }
        let parameters = Query::try_from_uri(&parts.uri).map_err(|error| {
            // The cause begins with the name of the parameter, if there is one; before it stand words of the library.
            let cause = std::error::Error::source(&error).map(ToString::to_string);
            let cause = cause.unwrap_or_else(|| error.body_text());
            let (name, message) = cause.split_once(": ").unwrap_or(("", &cause));
            let mut query =
                form_urlencoded::parse(parts.uri.query().unwrap_or_default().as_bytes());
            let given = query.find_map(|(key, value)| (key == name).then_some(value));
            invalid(faults::of_parameter(name, message, given.as_deref()))
        });
        let Query(parameters) = parameters?;
        Ok(Self(parameters))
    }
}

/// A number of a query, which has a decimal point.
pub(super) fn number<'de, D: Deserializer<'de>>(given: D) -> Result<Option<f64>, D::Error> {
    let text = String::deserialize(given)?;
    match number_of(&text) {
        Some(number) => Ok(Some(number)),
        None => Err(D::Error::custom(match number_of(&with_point(&text)) {
            Some(nearest) => {
                format!("{text:?} is no number; with a decimal point, {nearest} would do")
            }
            None => format!("{text:?} is no number"),
        })),
    }
}

/// A whole number of a query.
pub(super) fn whole<'de, T, D>(given: D) -> Result<Option<T>, D::Error>
where
    T: FromStr + ToString,
    D: Deserializer<'de>,
{
    let text = String::deserialize(given)?;
    if let Ok(number) = text.parse() {
        return Ok(Some(number));
    }
    let rounded = number_of(&with_point(&text)).map(|number| format!("{:.0}", number.round()));
    let nearest = rounded.and_then(|rounded| rounded.parse::<T>().ok());
    Err(D::Error::custom(match nearest {
        Some(nearest) => format!(
            "{text:?} is no whole number; {} would do",
            nearest.to_string()
        ),
        None => format!("{text:?} is no whole number that is taken"),
    }))
}

fn number_of(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// A decimal comma as a point.
fn with_point(text: &str) -> String {
    text.replacen(',', ".", 1)
}

/// The word under which a client may repeat a submission.
#[derive(IntoParams)]
#[into_params(names("Idempotency-Key"), parameter_in = Header)]
pub(super) struct IdempotencyKey(
    /// A word of the client's choice, 1 to 255 characters, kept for a day: the same key and document are taken once, however often they are sent.
    #[param(min_length = 1, max_length = 255, pattern = "^[!-~]([ -~]*[!-~])?$")]
    pub(super) Option<String>,
);

impl<S: Sync> FromRequestParts<S> for IdempotencyKey {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Refusal> {
        let Some(key) = parts.headers.get("idempotency-key") else {
            return Ok(Self(None));
        };
        match key.to_str() {
            Ok(key)
                if (1..=255).contains(&key.len())
                    && key
                        .bytes()
                        .all(|byte| byte == b' ' || byte.is_ascii_graphic()) =>
            {
                Ok(Self(Some(key.to_owned())))
            }
            _ => Err(invalid("Idempotency-Key has 1 to 255 visible ASCII characters.").into()),
        }
    }
}

/// The user of a client on whose behalf a request comes.
#[derive(IntoParams)]
#[into_params(names("Meshwright-User"), parameter_in = Header)]
pub(super) struct User(
    /// The user of the client who submits, by an opaque name of the client's choice: users take turns, and each has its part of the queue. It is
    /// no border of access. Taken beside a key; a token names its user itself, and where no key is needed there are no users.
    #[param(min_length = 1, max_length = 128, pattern = "^[!-~]+$")]
    pub(super) Option<String>,
);

impl User {
    const HEADER: &'static str = "meshwright-user";

    /// That of a request with a key.
    ///
    /// # Errors
    ///
    /// `out_of_range`, if it is no name or there are two.
    pub(super) fn of(headers: &HeaderMap) -> Result<Self, Problem> {
        let mut given = headers.get_all(Self::HEADER).iter();
        let Some(name) = given.next() else {
            return Ok(Self(None));
        };
        let name = name.to_str().ok().filter(|name| is_user_name(name));
        match (name, given.next()) {
            (Some(name), None) => Ok(Self(Some(name.to_owned()))),
            _ => Err(Problem::new(
                Code::OutOfRange,
                "Meshwright-User has 1 to 128 visible ASCII characters, and stands once.",
            )),
        }
    }

    /// Refuses it in a request with a token.
    ///
    /// # Errors
    ///
    /// `conflicting_fields`.
    pub(super) fn refuse_beside_token(headers: &HeaderMap) -> Result<(), Problem> {
        if headers.contains_key(Self::HEADER) {
            let detail = "A token names its user itself; send it without Meshwright-User.";
            return Err(Problem::new(Code::ConflictingFields, detail));
        }
        Ok(())
    }
}

/// The header of a conditional request. The answer has an `ETag`, or is 304.
#[derive(IntoParams)]
#[into_params(parameter_in = Header)]
#[expect(dead_code, reason = "the document alone reads it")]
pub(super) struct IfNoneMatch {
    /// The `ETag` of an earlier answer.
    #[param(rename = "If-None-Match")]
    tag: Option<String>,
}

/// The header of a change that is made from what was read.
#[derive(IntoParams)]
#[into_params(parameter_in = Header)]
#[expect(dead_code, reason = "the document alone reads it")]
pub(super) struct IfMatch {
    /// The `ETag` of what was read. Needed, so that nobody's change is lost.
    #[param(rename = "If-Match")]
    tag: String,
}

/// The id in a path.
#[derive(Deserialize)]
struct Named {
    id: String,
}

/// Declares the ids that stand in paths.
macro_rules! ids {
    ($($Id:ident, $missing:ident: $sentence:literal;)*) => {$(
        /// The id in a path. A text that is no id is answered as an unknown id.
        pub(super) struct $Id(pub(super) Uuid);

        impl $Id {
            /// That of a text, where there is one.
            pub(super) fn of(text: &str) -> Result<Self, Problem> {
                let id = text.parse();
                id.map(Self).map_err(|_| Problem::new(Code::$missing, $sentence))
            }
        }

        impl<S: Send + Sync> FromRequestParts<S> for $Id {
            type Rejection = Refusal;

            async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Refusal> {
                let named = Path::<Named>::from_request_parts(parts, state).await;
                let named = named.map_err(|_| invalid("The request is not understood."))?;
                Ok(Self::of(&named.id)?)
            }
        }
    )*};
}

ids! {
    JobId, JobNotFound: "There is no job of this id.";
    StudyId, StudyNotFound: "There is no study of this id.";
    WebhookId, WebhookNotFound: "There is no webhook of this id.";
    ProjectId, ProjectNotFound: "There is no project of this id.";
    ShareId, NotFound: "There is no link of this id.";
}

/// A parameter or header that is not understood.
pub(super) fn invalid(detail: impl Into<String>) -> Problem {
    Problem::new(Code::InvalidParameter, detail)
}
