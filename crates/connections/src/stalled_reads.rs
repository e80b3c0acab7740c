//! Reads of a request's body: for how long it has waited for bytes, and what is left of it when the answer is made.

use std::future::poll_fn;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard};
use std::task::{Context, Poll};
use std::time::Duration;

use bytes::Bytes;
use http_body::{Body, Frame, SizeHint};
use hyper::body::Incoming;
use tokio::time::{Instant, timeout};

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

/// A body with more bytes left than this is not read to its end.
const LONGEST_REST: u64 = 1 << 20;

/// Time in which the rest of a body has to arrive.
const TIME_FOR_REST: Duration = Duration::from_secs(2);

/// A body that was dropped, with what was not read of it.
#[derive(Debug)]
pub(super) struct Rest<B>(Arc<Mutex<Option<B>>>);

impl<B> Clone for Rest<B> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<B> Default for Rest<B> {
    fn default() -> Self {
        Self(Arc::default())
    }
}

impl<B> Rest<B> {
    fn place(&self) -> MutexGuard<'_, Option<B>> {
        self.0.lock().expect("nothing panics with this lock")
    }
}

impl<B: Body<Data = Bytes> + Unpin> Rest<B> {
    /// Reads and discards the rest, so that the connection can take the next request. False if it is too long, late, or broken off: then the
    /// connection has to end with the answer, and the answer has to say so. It does so too where the client `waits` to be asked for its body.
    pub(super) async fn discard(self, reads: Arc<Reads>, waits: bool) -> bool {
        let body = self.place().take();
        let Some(body) = body.filter(|body| !body.is_end_stream()) else {
            return true;
        };
        if waits || body.size_hint().lower() > LONGEST_REST {
            return false;
        }
        let mut body = WatchedBody::new(body, reads);
        let read = async {
            let mut bytes = 0;
            while !body.is_end_stream() {
                let next = poll_fn(|context| Pin::new(&mut body).poll_frame(context)).await;
                let Some(frame) = next else { return true };
                let Ok(frame) = frame else { return false };
                bytes += frame.data_ref().map_or(0, |data| data.len() as u64);
                if bytes > LONGEST_REST {
                    return false;
                }
            }
            true
        };
        timeout(TIME_FOR_REST, read).await.unwrap_or(false)
    }
}

/// The body of a request whose reads are watched.
#[derive(Debug)]
pub struct WatchedBody<B = Incoming> {
    /// Absent only while it is dropped.
    inner: Option<B>,
    reads: Arc<Reads>,
    /// How much later than at the least rate the bytes came that are here: a byte now and then does not make a client fast.
    late: Duration,
    /// Where the body is put when it is dropped.
    rest: Rest<B>,
}

impl<B> WatchedBody<B> {
    pub(super) fn new(inner: B, reads: Arc<Reads>) -> Self {
        Self {
            inner: Some(inner),
            reads,
            late: Duration::ZERO,
            rest: Rest::default(),
        }
    }

    /// Where the body is put when it is dropped.
    pub(super) fn rest(&self) -> Rest<B> {
        self.rest.clone()
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
        let Some(inner) = &mut self.inner else {
            return Poll::Ready(None);
        };
        let polled = Pin::new(inner).poll_frame(context);
        let came = match &polled {
            Poll::Pending => Poll::Pending,
            Poll::Ready(Some(Ok(frame))) => Poll::Ready(frame.data_ref().map_or(0, Bytes::len)),
            Poll::Ready(_) => Poll::Ready(0),
        };
        self.note(Instant::now(), came);
        polled
    }

    fn is_end_stream(&self) -> bool {
        self.inner.as_ref().is_none_or(Body::is_end_stream)
    }

    fn size_hint(&self) -> SizeHint {
        let inner = self.inner.as_ref();
        inner.map_or_else(SizeHint::default, Body::size_hint)
    }
}

/// Who drops the body waits for nothing, and leaves the rest to be discarded.
impl<B> Drop for WatchedBody<B> {
    fn drop(&mut self) {
        *self.reads.since() = None;
        *self.rest.place() = self.inner.take();
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
