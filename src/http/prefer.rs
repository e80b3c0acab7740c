//! `Prefer: wait=N` (RFC 7240): a client that would rather wait than ask again.

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::FromRequestParts;
use axum::http::HeaderMap;
use axum::http::header::HeaderValue;
use axum::http::request::Parts;
use meshwright_connections::Part;
use utoipa::IntoParams;

use super::client::Client;

/// Nobody waits longer than this, in seconds.
pub(super) const LONGEST_WAIT_S: u64 = 60;

/// Time that a client would wait for the end of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, IntoParams)]
#[into_params(names("Prefer"), parameter_in = Header)]
pub(super) struct Wait(
    /// `wait=N`: answer when it has ended, or after N seconds (60 at most).
    #[param(value_type = Option<String>)]
    Option<u64>,
);

/// The granted time and the place among the waiting requests. A request without a place is answered at once.
#[derive(Debug)]
pub(super) struct Granted {
    seconds: Option<u64>,
    _place: Option<Part>,
}

impl Wait {
    /// The time granted to `client`.
    pub(super) fn grant(self, client: &Client) -> Granted {
        let access = &client.app.access;
        let place = self.0.and_then(|_| access.place_to_wait(client.name()));
        Granted {
            seconds: self.0.map(|seconds| match place {
                Some(_) => seconds.min(LONGEST_WAIT_S),
                None => 0,
            }),
            _place: place,
        }
    }

    /// A preference that is not understood is ignored, as the standard asks.
    fn read<'a>(values: impl Iterator<Item = &'a str>) -> Self {
        let preferences = values.flat_map(|value| value.split([',', ';']));
        Self(preferences.map(str::trim).find_map(|preference| {
            let (name, seconds) = preference.split_once('=')?;
            if !name.trim().eq_ignore_ascii_case("wait") {
                return None;
            }
            seconds.trim().trim_matches('"').parse().ok()
        }))
    }
}

impl Granted {
    /// The time to wait.
    pub(super) fn patience(&self) -> Option<Duration> {
        self.seconds.map(Duration::from_secs)
    }

    /// Adds the granted preference to an answer.
    pub(super) fn acknowledge(&self, headers: &mut HeaderMap) {
        if let Some(seconds) = self.seconds {
            let value = HeaderValue::from_str(&format!("wait={seconds}"));
            headers.insert(
                "preference-applied",
                value.expect("digits are visible ASCII"),
            );
        }
    }
}

impl<S: Sync> FromRequestParts<S> for Wait {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, Infallible> {
        let values = parts.headers.get_all("prefer").iter();
        Ok(Self::read(values.filter_map(|value| value.to_str().ok())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wait_is_found_among_other_preferences_and_nonsense_is_ignored() {
        let read = |values: &[&str]| Wait::read(values.iter().copied()).0;
        assert_eq!(read(&["wait=20"]), Some(20));
        assert_eq!(read(&["respond-async, Wait = \"5\""]), Some(5));
        assert_eq!(read(&["respond-async", "wait=7"]), Some(7));
        assert_eq!(read(&["wait=soon"]), None);
        assert_eq!(read(&["wait", "wait=-1", ""]), None);
    }
}
