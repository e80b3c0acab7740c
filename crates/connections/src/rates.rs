//! Rates of requests by key: a token bucket for each.

use std::collections::HashMap;
use std::hash::Hash;
use std::num::NonZeroU32;
use std::sync::Mutex;
use std::time::Duration;

use tokio::time::Instant;

/// At this number of keys, buckets that are full again are forgotten.
const MOST_REMEMBERED: usize = 10_000;

/// Token buckets by key.
#[derive(Debug)]
pub struct Rates<K>(Mutex<Buckets<K>>);

#[derive(Debug)]
struct Buckets<K> {
    /// When the bucket of a key is full again.
    full_at: HashMap<K, Instant>,
    /// At this number they are looked through.
    prune_at: usize,
}

impl<K> Default for Rates<K> {
    fn default() -> Self {
        Self(Mutex::new(Buckets {
            full_at: HashMap::new(),
            prune_at: MOST_REMEMBERED,
        }))
    }
}

impl<K: Hash + Eq> Rates<K> {
    /// Counts a request of `key`, which may send `rate` a second and `burst` at once.
    ///
    /// # Errors
    ///
    /// The time after which it may send the next.
    pub fn count(
        &self,
        key: K,
        rate: NonZeroU32,
        burst: u32,
        now: Instant,
    ) -> Result<(), Duration> {
        let mut buckets = self.0.lock().expect("nothing panics with this lock");
        let Buckets { full_at, prune_at } = &mut *buckets;
        if full_at.len() >= *prune_at {
            full_at.retain(|_, full_at| *full_at > now);
            *prune_at = MOST_REMEMBERED.max(2 * full_at.len());
        }
        let interval = Duration::from_secs(1) / rate.get();
        let full = full_at.get(&key).map_or(now, |at| *at.max(&now)) + interval;
        let wait = full.saturating_duration_since(now + interval * burst.max(1));
        if !wait.is_zero() {
            return Err(wait);
        }
        full_at.insert(key, full);
        Ok(())
    }

    #[cfg(test)]
    fn len(&self) -> usize {
        self.0.lock().unwrap().full_at.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_sends_its_burst_at_once_and_then_its_rate() {
        let rates = Rates::default();
        let (rate, start) = (NonZeroU32::new(10).unwrap(), Instant::now());
        let sent = |ms: u64| {
            let now = start + Duration::from_millis(ms);
            let send = |_: &u32| rates.count("a", rate, 20, now).is_ok();
            (0..100).filter(send).count()
        };
        assert_eq!((sent(0), sent(0), sent(100), sent(1100)), (20, 0, 1, 10));
        assert_eq!(
            rates.count("a", rate, 20, start + Duration::from_millis(1100)),
            Err(Duration::from_millis(100))
        );
        assert_eq!(rates.count("b", rate, 20, start), Ok(()));
    }

    #[test]
    fn a_million_keys_that_come_once_are_forgotten() {
        let rates = Rates::default();
        let (rate, start) = (NonZeroU32::new(1000).unwrap(), Instant::now());
        for key in 0..1_000_000_u32 {
            // A new one each millisecond, which is how long a bucket takes to be full again.
            let now = start + Duration::from_millis(key.into());
            assert!(rates.count(key, rate, 1, now).is_ok());
        }
        assert!(rates.len() <= MOST_REMEMBERED, "{}", rates.len());
    }
}
