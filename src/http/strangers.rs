//! Those whose key is not known, or who have none: how often they may ask, by where they come from and in all.

use std::collections::HashSet;
use std::hash::Hash;
use std::num::NonZeroU32;
use std::sync::Mutex;
use std::time::Duration;

use axum::http::HeaderMap;
use governor::clock::{Clock as _, DefaultClock};
use governor::state::keyed::HashMapStateStore;
use governor::{DefaultDirectRateLimiter, NotUntil, Quota, RateLimiter};

use super::credential::{Credential, bearer};
use super::guests::Origin;

/// An origin may send so many times its requests of a second at once: the page alone takes thirty.
const BURST_SECONDS: u32 = 5;

/// All origins together may send as much as so many.
const ORIGINS: u32 = 20;

/// However many others come, an origin gets in so many times a second, and a page's worth at once.
const LEAST: (u32, u32) = (5, 40);

/// So many origins are remembered before those that have been quiet are forgotten, and so many keys.
const MOST_REMEMBERED: usize = 10_000;

type Keyed<K> = RateLimiter<K, HashMapStateStore<K>, DefaultClock>;

/// The bounds of those who are not known.
#[derive(Debug)]
pub(super) struct Strangers {
    /// Those with a key that may be one stand apart: who floods without one does not keep them from showing theirs.
    of_origin: Keyed<(Origin, bool)>,
    of_all: DefaultDirectRateLimiter,
    least: Keyed<(Origin, bool)>,
    /// The fingerprints of keys and tokens that were found to be known. Whether they still are is looked at each time.
    proven: Mutex<HashSet<String>>,
}

impl Strangers {
    /// So many requests a second of one origin.
    pub(super) fn new(rate: NonZeroU32) -> Self {
        let quota = |rate: NonZeroU32, burst: u32| {
            Quota::per_second(rate).allow_burst(NonZeroU32::new(burst).unwrap_or(rate))
        };
        let all = rate.saturating_mul(NonZeroU32::MIN.saturating_add(ORIGINS - 1));
        let least = NonZeroU32::new(LEAST.0).map_or(rate, |least| least.min(rate));
        let burst = rate.get().saturating_mul(BURST_SECONDS);
        Self {
            of_origin: RateLimiter::hashmap(quota(rate, burst)),
            of_all: RateLimiter::direct(quota(all, all.get().saturating_mul(2))),
            least: RateLimiter::hashmap(quota(least, LEAST.1.min(burst))),
            proven: Mutex::default(),
        }
    }

    /// Counts a request, unless its key was found to be known.
    ///
    /// # Errors
    ///
    /// The time after which it may come again.
    pub(super) fn admit(&self, origin: Origin, headers: &HeaderMap) -> Result<(), Duration> {
        let shown = bearer(headers).ok().flatten();
        if shown.as_ref().is_some_and(|shown| self.is_proven(shown)) {
            return Ok(());
        }
        let who = (origin, shown.is_some());
        forget_the_quiet(&self.of_origin);
        self.of_origin.check_key(&who).map_err(wait)?;
        if self.of_all.check().is_ok() {
            return Ok(());
        }
        forget_the_quiet(&self.least);
        self.least.check_key(&who).map_err(wait)
    }

    /// A key or token of this fingerprint was found to be known.
    pub(super) fn prove(&self, fingerprint: String) {
        let mut proven = self.proven.lock().expect("nothing panics with this lock");
        if proven.len() >= MOST_REMEMBERED {
            proven.clear();
        }
        proven.insert(fingerprint);
    }

    fn is_proven(&self, shown: &Credential) -> bool {
        let proven = self.proven.lock().expect("nothing panics with this lock");
        proven.contains(&shown.fingerprint())
    }
}

fn forget_the_quiet<K: Hash + Eq + Clone>(limiter: &Keyed<K>) {
    if limiter.len() > MOST_REMEMBERED {
        limiter.retain_recent();
    }
}

fn wait(until: NotUntil<<DefaultClock as governor::clock::Clock>::Instant>) -> Duration {
    until.wait_time_from(DefaultClock::default().now())
}

#[cfg(test)]
mod tests {
    use std::net::IpAddr;

    use axum::http::HeaderValue;
    use axum::http::header::AUTHORIZATION;

    use super::*;
    use crate::keys::Key;

    fn origin(last: u8) -> Origin {
        IpAddr::from([127, 0, 0, last]).into()
    }

    fn with(key: &Key) -> HeaderMap {
        let value = format!("Bearer {}", key.reveal());
        HeaderMap::from_iter([(AUTHORIZATION, HeaderValue::try_from(value).unwrap())])
    }

    /// How many of a thousand requests get in.
    fn admitted(strangers: &Strangers, from: u8, headers: &HeaderMap) -> usize {
        let admit = |_: &u32| strangers.admit(origin(from), headers).is_ok();
        (0..1000).filter(admit).count()
    }

    #[test]
    fn a_stranger_gets_a_burst_and_a_key_that_was_proven_is_not_counted() {
        let strangers = Strangers::new(NonZeroU32::new(10).unwrap());
        let (none, key) = (HeaderMap::new(), Key::random().unwrap());
        assert!((50..60).contains(&admitted(&strangers, 1, &none)));
        // Who has a key can show it all the same; one that proves to be none stays among the strangers.
        assert!((50..60).contains(&admitted(&strangers, 1, &with(&key))));
        strangers.prove(key.secret_hash());
        assert_eq!(admitted(&strangers, 1, &with(&key)), 1000);
        assert!(admitted(&strangers, 1, &with(&Key::random().unwrap())) < 10);
    }

    #[test]
    fn a_flood_from_many_origins_leaves_another_one_a_page() {
        let strangers = Strangers::new(NonZeroU32::new(10).unwrap());
        let none = HeaderMap::new();
        let all: usize = (1..=50).map(|from| admitted(&strangers, from, &none)).sum();
        // 400 in all at once, and 40 of each beyond that.
        assert!(all < 400 + 50 * 40 + 400, "{all}");
        assert!(admitted(&strangers, 200, &none) >= 40);
    }
}
