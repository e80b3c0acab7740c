//! Stalled reads: for how long a request has waited for bytes of its body.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard};
use std::task::{Context, Poll};
use std::time::Duration;

use bytes::Bytes;
use http_body::{Body, Frame, SizeHint};
use hyper::body::Incoming;
use tokio::time::Instant;

use super::stalled_writes::LEAST_RATE;

/// Since when a connection waits for bytes of a body, if it does.
#[derive(Debug, Default)]
pub(super) struct Reads(Mutex<Option<Instant>>);

impl Reads {
    /// For how long a request has waited for its client, less the time that the bytes were worth which came.
    pub(super) fn stalled_for(&self, now: Instant) -> Option<Duration> {
        let since = *self.since();
        since.map(|since| now.saturating_duration_since(since))
    }

    fn since(&self) -> MutexGuard<'_, Option<Instant>> {
        self.0.lock().expect("nothing panics with this lock")
    }
}

/// The body of a request whose reads are watched.
#[derive(Debug)]
pub struct WatchedBody<B = Incoming> {
    inner: B,
    reads: Arc<Reads>,
    /// How much later than at the least rate the bytes came that are here: a byte now and then does not make a client fast.
    late: Duration,
}

impl<B> WatchedBody<B> {
    pub(super) fn new(inner: B, reads: Arc<Reads>) -> Self {
        Self {
            inner,
            reads,
            late: Duration::ZERO,
        }
    }

    /// Notes the result of a poll: so many bytes, or nothing yet.
    fn note(&mut self, now: Instant, polled: Poll<usize>) {
        let mut since = self.reads.since();
        match polled {
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

impl<B: Body<Data = Bytes> + Unpin> Body for WatchedBody<B> {
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

/// Who drops the body waits for nothing.
impl<B> Drop for WatchedBody<B> {
    fn drop(&mut self) {
        *self.reads.since() = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trickle_is_a_stall_and_a_fast_client_has_none() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        let reads = Arc::new(Reads::default());
        let mut body = WatchedBody::new((), Arc::clone(&reads));
        let ms = |stalled: Option<Duration>| stalled.map(|stalled| stalled.as_millis());

        assert_eq!(ms(reads.stalled_for(at(0))), None);
        body.note(at(0), Poll::Pending);
        // A byte every 900 ms.
        for i in 1..=3 {
            body.note(at(900 * i), Poll::Ready(1));
            assert_eq!(ms(reads.stalled_for(at(900 * i))), None, "nobody waits now");
            body.note(at(900 * i), Poll::Pending);
        }
        assert!(ms(reads.stalled_for(at(2700))) > Some(2690));
        // All that was late comes at once, and then the next part in its time.
        body.note(at(2700), Poll::Ready(64 << 10));
        body.note(at(2800), Poll::Pending);
        assert_eq!(ms(reads.stalled_for(at(2900))), Some(100));
        drop(body);
        assert_eq!(ms(reads.stalled_for(at(9000))), None);
    }
}
