//! Requests without a key that is known: how many a second are answered, by address and in all.

use std::collections::HashSet;
use std::num::NonZeroU32;
use std::sync::Mutex;
use std::time::Duration;

use tokio::time::Instant;

use super::{Address, Rates};

/// An address may send so many times its requests of a second at once: the page alone takes thirty.
const BURST_SECONDS: NonZeroU32 = NonZeroU32::new(5).unwrap();

/// All addresses together may send as much as so many.
const ADDRESSES: NonZeroU32 = NonZeroU32::new(20).unwrap();

/// However many others send, an address may send so many a second, and a page's worth at once.
const LEAST: (u32, u32) = (5, 40);

/// Maximum number of remembered keys.
const MOST_REMEMBERED: usize = 10_000;

/// An address, and whether the request has something that may be a key: a flood without one does not keep others from showing theirs.
type Source = (Address, bool);

/// The limits of requests without a key that is known.
#[derive(Debug)]
pub struct Unauthenticated {
    rate: NonZeroU32,
    of_address: Rates<Source>,
    of_all: Rates<()>,
    least: Rates<Source>,
    /// The fingerprints of keys and tokens that were found to be known. Whether they still are is looked at each time.
    known: Mutex<HashSet<String>>,
}

impl Unauthenticated {
    /// Limits requests per second of one address.
    pub fn new(rate: NonZeroU32) -> Self {
        Self {
            rate,
            of_address: Rates::default(),
            of_all: Rates::default(),
            least: Rates::default(),
            known: Mutex::default(),
        }
    }

    /// Counts a request with a key or token of this fingerprint, if it has one, unless that was found to be known.
    ///
    /// # Errors
    ///
    /// The time after which the next is answered.
    pub fn count(&self, address: Address, fingerprint: Option<&str>) -> Result<(), Duration> {
        if fingerprint.is_some_and(|fingerprint| self.is_known(fingerprint)) {
            return Ok(());
        }
        let (source, now) = ((address, fingerprint.is_some()), Instant::now());
        let burst = self.rate.saturating_mul(BURST_SECONDS).get();
        self.of_address.count(source, self.rate, burst, now)?;
        let all = self.rate.saturating_mul(ADDRESSES);
        if self
            .of_all
            .count((), all, all.get().saturating_mul(2), now)
            .is_ok()
        {
            return Ok(());
        }
        let least = NonZeroU32::new(LEAST.0).map_or(self.rate, |least| least.min(self.rate));
        self.least.count(source, least, LEAST.1.min(burst), now)
    }

    /// A key or token of this fingerprint was found to be known.
    pub fn remember(&self, fingerprint: String) {
        let mut known = self.known.lock().expect("nothing panics with this lock");
        if known.len() >= MOST_REMEMBERED {
            known.clear();
        }
        known.insert(fingerprint);
    }

    fn is_known(&self, fingerprint: &str) -> bool {
        let known = self.known.lock().expect("nothing panics with this lock");
        known.contains(fingerprint)
    }
}

#[cfg(test)]
mod tests {
    use std::net::IpAddr;

    use super::*;

    fn address(last: u8) -> Address {
        IpAddr::from([127, 0, 0, last]).into()
    }

    /// How many of a thousand requests get in.
    fn admitted(limits: &Unauthenticated, from: u8, fingerprint: Option<&str>) -> usize {
        let admit = |_: &u32| limits.count(address(from), fingerprint).is_ok();
        (0..1000).filter(admit).count()
    }

    #[test]
    fn a_request_without_a_key_has_a_burst_and_a_key_that_is_known_is_not_counted() {
        let limits = Unauthenticated::new(NonZeroU32::new(10).unwrap());
        assert!((50..60).contains(&admitted(&limits, 1, None)));
        // Who has a key can show it all the same; one that proves to be none stays among the limits.
        assert!((50..60).contains(&admitted(&limits, 1, Some("known"))));
        limits.remember("known".to_owned());
        assert_eq!(admitted(&limits, 1, Some("known")), 1000);
        assert!(admitted(&limits, 1, Some("another")) < 10);
    }

    #[test]
    fn a_flood_from_many_addresses_leaves_another_one_a_page() {
        let limits = Unauthenticated::new(NonZeroU32::new(10).unwrap());
        let all: usize = (1..=50).map(|from| admitted(&limits, from, None)).sum();
        // 400 in all at once, and 40 of each beyond that.
        assert!(all < 400 + 50 * 40 + 400, "{all}");
        assert!(admitted(&limits, 200, None) >= 40);
    }
}
