//! The keys of an identity provider: where they are is discovered, and they are kept for a while.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use jsonwebtoken::jwk::{Jwk, PublicKeyUse};
use jsonwebtoken::{Algorithm, DecodingKey};
use meshwright_connections::spawn;
use reqwest::header::ACCEPT;
use reqwest::{Client, StatusCode, Url};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use tokio::sync::Semaphore;
use tokio_util::sync::CancellationToken;
use tracing::{info, warn};

use super::rules::IssuerUrl;
use crate::client::{bounded, unreachable};
use crate::jobs::Clock;

/// Bytes of each of the provider's two documents, at most.
const MOST_BYTES: usize = 256 << 10;

/// Between two fetches lies at least so much time, whatever keys tokens name.
const BETWEEN: SignedDuration = SignedDuration::from_secs(5);

/// Maximum number of requests that wait for one fetch. A provider that does not answer holds no more than these, whoever sends them.
const MOST_WAITING: usize = 64;

/// After so long the keys are asked for anew: one that was withdrawn opens nothing then.
const FRESH: SignedDuration = SignedDuration::from_mins(10);

/// A provider that cannot be reached is trusted for so long with the keys that it had.
const KEPT: SignedDuration = SignedDuration::from_hours(24);

/// The keys of a provider.
pub(super) struct Provider {
    issuer: IssuerUrl,
    /// Time for one of its two documents.
    time: Duration,
    client: Client,
    clock: Clock,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    keys: Option<Keys>,
    /// The fetch under way.
    fetch: Option<Arc<Fetch>>,
    /// When the last one ended.
    fetched: Option<Timestamp>,
    /// True if the last answer failed.
    failed: bool,
}

/// One fetch of the keys, and those who wait for it.
struct Fetch {
    ended: CancellationToken,
    places: Semaphore,
}

/// The keys as they were at a time.
struct Keys {
    at: Timestamp,
    keys: Vec<Known>,
}

struct Known {
    id: String,
    /// The only algorithm that it is for, where the provider says so.
    algorithm: Option<Algorithm>,
    key: DecodingKey,
}

/// Result of a lookup of a key.
pub(super) enum Found {
    Key(DecodingKey),
    /// The provider has no such key.
    Unknown,
    /// The provider gave no answer.
    Unreachable,
}

impl Provider {
    pub(super) fn new(
        issuer: IssuerUrl,
        clock: Clock,
        time: Duration,
    ) -> Result<Self, reqwest::Error> {
        Ok(Self {
            issuer,
            time,
            client: bounded(time).build()?,
            clock,
            state: Mutex::default(),
        })
    }

    /// Fetches the keys before somebody needs them.
    pub(super) fn fetch_first(self: &Arc<Self>) {
        let _ = self.fetch();
    }

    /// The key of this name. If it is unknown or old, the keys are fetched, with a limit on the rate. Waiting requests share one fetch and its answer. A name
    /// without a waiting request is unknown once the keys are there.
    pub(super) async fn key(self: &Arc<Self>, id: &str, algorithm: Algorithm) -> Found {
        let (found, is_fresh) = self.look(id, algorithm);
        let is_known = matches!(found, Found::Key(_));
        if is_known && is_fresh {
            return found;
        }
        let Some((fetch, is_new)) = self.fetch() else {
            return found;
        };
        // A key that is known waits for no fetch that another request has begun.
        let place = fetch.places.try_acquire().ok();
        if place.is_none() || (is_known && !is_new) {
            return found;
        }
        fetch.ended.cancelled().await;
        match self.look(id, algorithm).0 {
            // The lookup failed.
            Found::Unknown if self.state().failed => Found::Unreachable,
            found => found,
        }
    }

    /// The fetch under way, and whether it begins now; none if the last one has just ended. It goes on to its end, also when nobody waits any
    /// more.
    fn fetch(self: &Arc<Self>) -> Option<(Arc<Fetch>, bool)> {
        let mut state = self.state();
        if let Some(fetch) = &state.fetch {
            return Some((Arc::clone(fetch), false));
        }
        let now = self.clock.steady();
        let last = state.fetched.map(|last| last.duration_until(now));
        if last.is_some_and(|last| last < BETWEEN) {
            return None;
        }
        let fetch = Arc::new(Fetch {
            ended: CancellationToken::new(),
            places: Semaphore::new(MOST_WAITING),
        });
        state.fetch = Some(Arc::clone(&fetch));
        let (this, ended) = (Arc::clone(self), fetch.ended.clone());
        spawn(async move {
            this.ask().await;
            ended.cancel();
        });
        Some((fetch, true))
    }

    /// True if the last answer was valid.
    pub(super) fn answers(&self) -> bool {
        !self.state().failed
    }

    async fn ask(&self) {
        let fetched = self.documents().await;
        let mut state = self.state();
        state.fetch = None;
        state.fetched = Some(self.clock.steady());
        state.failed = fetched.is_err();
        match fetched {
            Ok(keys) => {
                info!(
                    issuer = self.issuer.text,
                    keys = keys.len(),
                    "the keys of the identity provider are here"
                );
                let at = self.clock.steady();
                state.keys = Some(Keys { at, keys });
            }
            Err(error) => {
                warn!(
                    issuer = self.issuer.text,
                    error, "the identity provider gives no keys"
                );
            }
        }
    }

    /// A key as it is known, and true if that is fresh.
    fn look(&self, id: &str, algorithm: Algorithm) -> (Found, bool) {
        let now = self.clock.steady();
        let state = self.state();
        let age = |keys: &Keys| keys.at.duration_until(now);
        let Some(keys) = state.keys.as_ref().filter(|keys| age(keys) < KEPT) else {
            return (Found::Unreachable, false);
        };
        let fits = |known: &&Known| {
            known.id == id
                && known.key.family() == algorithm.family()
                && known.algorithm.is_none_or(|only| only == algorithm)
        };
        let found = match keys.keys.iter().find(fits) {
            Some(known) => Found::Key(known.key.clone()),
            None => Found::Unknown,
        };
        (found, age(keys) < FRESH)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("nothing panics with this lock")
    }

    async fn documents(&self) -> Result<Vec<Known>, String> {
        let discovered: Discovered = self.document(&self.issuer.discovery()).await?;
        if discovered.issuer != self.issuer.text {
            return Err(format!(
                "its discovery document is of the issuer {:?}",
                discovered.issuer
            ));
        }
        let url = Url::parse(&discovered.jwks_uri).map_err(|error| error.to_string())?;
        if !self.issuer.may_have_keys_at(&url) {
            return Err("its keys are not behind https".to_owned());
        }
        let set: KeySet = self.document(url.as_str()).await?;
        let keys: Vec<Known> = set.keys.into_iter().filter_map(Known::of).collect();
        if keys.is_empty() {
            return Err("none of its keys checks a signature".to_owned());
        }
        Ok(keys)
    }

    async fn document<T: DeserializeOwned>(&self, url: &str) -> Result<T, String> {
        let failed = |error: reqwest::Error| match error.is_timeout() {
            true => format!("no answer within {} s", self.time.as_secs_f64()),
            false => unreachable(&error.without_url()),
        };
        let request = self.client.get(url).header(ACCEPT, "application/json");
        let mut answer = request.send().await.map_err(failed)?;
        if answer.status() != StatusCode::OK {
            return Err(format!("it answered {}", answer.status().as_u16()));
        }
        let mut text = Vec::new();
        while let Some(part) = answer.chunk().await.map_err(failed)? {
            if text.len() + part.len() > MOST_BYTES {
                return Err(format!("its answer has more than {MOST_BYTES} bytes"));
            }
            text.extend_from_slice(&part);
        }
        serde_json::from_slice(&text).map_err(|error| format!("its answer cannot be read: {error}"))
    }
}

/// The fields of a discovery document that the service reads.
#[derive(Deserialize)]
struct Discovered {
    issuer: String,
    jwks_uri: String,
}

/// Keys (RFC 7517), each read by itself: one of a kind that is not known here spoils no other.
#[derive(Deserialize)]
struct KeySet {
    keys: Vec<Value>,
}

impl Known {
    /// A key that checks signatures and has a name; others are of no use here.
    fn of(value: Value) -> Option<Self> {
        let jwk: Jwk = serde_json::from_value(value).ok()?;
        let common = &jwk.common;
        let signs = matches!(common.public_key_use, None | Some(PublicKeyUse::Signature));
        let algorithm = match common.key_algorithm {
            Some(algorithm) => Some(algorithm.to_string().parse().ok()?),
            None => None,
        };
        let key = DecodingKey::from_jwk(&jwk).ok()?;
        let id = common.key_id.clone().filter(|_| signs)?;
        Some(Self { id, algorithm, key })
    }
}
