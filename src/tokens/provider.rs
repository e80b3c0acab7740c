//! The keys of an identity provider: where they are is discovered, and they are kept for a while.

use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use jiff::{SignedDuration, Timestamp};
use jsonwebtoken::jwk::{Jwk, PublicKeyUse};
use jsonwebtoken::{Algorithm, DecodingKey};
use reqwest::header::ACCEPT;
use reqwest::{Client, StatusCode, Url};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use tracing::{info, warn};

use super::rules::IssuerUrl;
use crate::client::{bounded, told};
use crate::jobs::Clock;

/// Each of the provider's two documents comes in so much time, and has so many bytes at most.
const TIME_OUT: Duration = Duration::from_secs(5);
const MOST_BYTES: usize = 256 << 10;

/// While there are keys they are asked for no more often than this, whatever keys tokens name.
const PATIENCE: SignedDuration = SignedDuration::from_mins(1);

/// The same while there are none.
const IMPATIENCE: SignedDuration = SignedDuration::from_secs(5);

/// After so long the keys are asked for anew: one that was withdrawn opens nothing then.
const FRESH: SignedDuration = SignedDuration::from_mins(10);

/// A provider that cannot be reached is trusted for so long with the keys that it had.
const KEPT: SignedDuration = SignedDuration::from_hours(24);

/// The keys of a provider.
pub(super) struct Provider {
    issuer: IssuerUrl,
    client: Client,
    clock: Clock,
    state: Mutex<State>,
    /// Held by who asks the provider; others wait for the answer.
    asking: Arc<tokio::sync::Mutex<()>>,
}

#[derive(Default)]
struct State {
    keys: Option<Keys>,
    asked: Option<Timestamp>,
    /// Whether the last answer was none.
    failed: bool,
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

/// What is known of a key.
pub(super) enum Found {
    Key(DecodingKey),
    /// The provider has no such key.
    Unknown,
    /// The provider gave no answer.
    Unreachable,
}

impl Provider {
    pub(super) fn new(issuer: IssuerUrl, clock: Clock) -> Result<Self, reqwest::Error> {
        Ok(Self {
            issuer,
            client: bounded(TIME_OUT).build()?,
            clock,
            state: Mutex::default(),
            asking: Arc::default(),
        })
    }

    /// The key of this name. The provider is asked if there is none, or if what is known is old, and not too often.
    pub(super) async fn key(self: &Arc<Self>, id: &str, algorithm: Algorithm) -> Found {
        let (found, is_fresh) = self.look(id, algorithm);
        let turn = Arc::clone(&self.asking);
        let turn = match found {
            Found::Key(_) if is_fresh => return found,
            // Who has a key does not wait for somebody else who asks.
            Found::Key(_) => match turn.try_lock_owned() {
                Ok(turn) => turn,
                Err(_) => return found,
            },
            Found::Unknown | Found::Unreachable => turn.lock_owned().await,
        };
        if self.may_ask() {
            // It is asked to the end, though who asked may have gone.
            let this = Arc::clone(self);
            let asked = tokio::spawn(async move {
                this.ask().await;
                drop(turn);
            });
            let _ = asked.await;
        }
        self.look(id, algorithm).0
    }

    /// Asks for the keys before somebody needs them.
    pub(super) async fn ask_first(&self) {
        let _turn = self.asking.lock().await;
        if self.may_ask() {
            self.ask().await;
        }
    }

    async fn ask(&self) {
        self.state().asked = Some(self.clock.steady());
        let fetched = self.fetch().await;
        let mut state = self.state();
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

    /// What is known of a key, and whether that is fresh.
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
            None if state.failed => Found::Unreachable,
            None => Found::Unknown,
        };
        (found, age(keys) < FRESH)
    }

    fn may_ask(&self) -> bool {
        let state = self.state();
        let patience = match state.keys {
            Some(_) => PATIENCE,
            None => IMPATIENCE,
        };
        let now = self.clock.steady();
        state
            .asked
            .is_none_or(|asked| asked.duration_until(now) >= patience)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("nothing panics with this lock")
    }

    async fn fetch(&self) -> Result<Vec<Known>, String> {
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
        let told = |error: reqwest::Error| told(&error.without_url(), TIME_OUT);
        let request = self.client.get(url).header(ACCEPT, "application/json");
        let mut answer = request.send().await.map_err(told)?;
        if answer.status() != StatusCode::OK {
            return Err(format!("it answered {}", answer.status().as_u16()));
        }
        let mut text = Vec::new();
        while let Some(part) = answer.chunk().await.map_err(told)? {
            if text.len() + part.len() > MOST_BYTES {
                return Err(format!("its answer has more than {MOST_BYTES} bytes"));
            }
            text.extend_from_slice(&part);
        }
        serde_json::from_slice(&text).map_err(|error| format!("its answer cannot be read: {error}"))
    }
}

/// What is needed of a discovery document.
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
