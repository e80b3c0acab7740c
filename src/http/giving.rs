//! What a client gives of its requests: for how long a request has waited for bytes of it.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::Bytes;
use http_body::{Body, Frame, SizeHint};
use tokio::time::Instant;

use super::taking::LEAST_RATE;

/// How far a client has given what it announced.
#[derive(Debug, Default)]
pub(super) struct Giving(Mutex<Option<Instant>>);

impl Giving {
    /// For how long a request has waited for its client, what came in good time aside.
    pub(super) fn stalled_for(&self, now: Instant) -> Option<Duration> {
        let since = *self.since();
        since.map(|since| now.saturating_duration_since(since))
    }

    fn since(&self) -> MutexGuard<'_, Option<Instant>> {
        self.0.lock().expect("nothing panics with this lock")
    }
}

/// The body of a request whose coming is watched.
pub(super) struct Awaited<B> {
    inner: B,
    giving: Arc<Giving>,
    /// So much later than it should be is what has come: a byte now and then does not make a client swift.
    late: Duration,
}

impl<B> Awaited<B> {
    pub(super) fn new(inner: B, giving: Arc<Giving>) -> Self {
        Self {
            inner,
            giving,
            late: Duration::ZERO,
        }
    }

    /// Notes what came of a look for more: so many bytes, or nothing yet.
    fn note(&mut self, now: Instant, came: Poll<usize>) {
        let mut since = self.giving.since();
        match came {
            Poll::Pending => {
                since.get_or_insert_with(|| now.checked_sub(self.late).unwrap_or(now));
            }
            Poll::Ready(bytes) => {
                let waited = since
                    .take()
                    .map(|since| now.saturating_duration_since(since));
                let earned = Duration::from_secs_f64(bytes as f64 / LEAST_RATE);
                self.late = waited.unwrap_or(self.late).saturating_sub(earned);
            }
        }
    }
}

impl<B: Body<Data = Bytes> + Unpin> Body for Awaited<B> {
    type Data = Bytes;
    type Error = B::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, B::Error>>> {
        let polled = Pin::new(&mut self.inner).poll_frame(context);
        let came = match &polled {
            Poll::Pending => Poll::Pending,
            Poll::Ready(Some(Ok(frame))) => Poll::Ready(frame.data_ref().map_or(0, Bytes::len)),
            Poll::Ready(_) => Poll::Ready(0),
        };
        self.note(Instant::now(), came);
        polled
    }

    fn is_end_stream(&self) -> bool {
        self.inner.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.inner.size_hint()
    }
}

/// Who reads no more of it waits for nobody.
impl<B> Drop for Awaited<B> {
    fn drop(&mut self) {
        *self.giving.since() = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trickle_is_no_less_of_a_stall_than_nothing_and_what_comes_swiftly_is_none() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let giving = Arc::new(Giving::default());
        let mut body = Awaited::new((), Arc::clone(&giving));
        let ms = |stalled: Option<Duration>| stalled.map(|stalled| stalled.as_millis());

        assert_eq!(ms(giving.stalled_for(at(0))), None);
        body.note(at(0), Poll::Pending);
        // A byte every 900 ms.
        for i in 1..=3 {
            body.note(at(900 * i), Poll::Ready(1));
            assert_eq!(
                ms(giving.stalled_for(at(900 * i))),
                None,
                "nobody waits now"
            );
            body.note(at(900 * i), Poll::Pending);
        }
        assert!(ms(giving.stalled_for(at(2700))) > Some(2690));
        // All that was late comes at once, and then the next part in its time.
        body.note(at(2700), Poll::Ready(64 << 10));
        body.note(at(2800), Poll::Pending);
        assert_eq!(ms(giving.stalled_for(at(2900))), Some(100));
        drop(body);
        assert_eq!(ms(giving.stalled_for(at(9000))), None);
    }
}
