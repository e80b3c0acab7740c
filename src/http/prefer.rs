//! `Prefer: wait=N` (RFC 7240): a client that would rather wait than ask again.

use std::convert::Infallible;
use std::time::Duration;

use axum::extract::FromRequestParts;
use axum::http::HeaderMap;
use axum::http::header::HeaderValue;
use axum::http::request::Parts;

/// Nobody waits longer than this, in seconds.
pub(super) const LONGEST_WAIT_S: u64 = 60;

/// So long a client would wait for the end of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Wait(Option<u64>);

impl Wait {
    /// The time that is granted.
    pub(super) fn granted(self) -> Option<Duration> {
        self.0
            .map(|seconds| Duration::from_secs(seconds.min(LONGEST_WAIT_S)))
    }

    /// Says in an answer what was granted.
    pub(super) fn acknowledge(self, headers: &mut HeaderMap) {
        if let Some(granted) = self.granted() {
            let value = HeaderValue::from_str(&format!("wait={}", granted.as_secs()))
                .expect("digits are visible ASCII");
            headers.insert("preference-applied", value);
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
        assert_eq!(
            Wait(Some(u64::MAX)).granted(),
            Some(Duration::from_secs(LONGEST_WAIT_S))
        );
    }
}
