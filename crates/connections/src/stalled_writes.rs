//! Stalled writes: whether the answers of a connection have left, for how long its client has read nothing, and when it is closed for that.

use std::io::{Error, ErrorKind, IoSlice, Result};
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard};
use std::task::{Context, Poll};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::Notify;
use tokio::time::{Instant, Sleep, sleep_until};

/// A client that reads an answer at less than this, in bytes a second, is closed in the end, as one that reads nothing.
pub(super) const LEAST_RATE: f64 = 4096.0;

/// How far the answers of a connection have left.
#[derive(Debug, Default)]
pub(super) struct Writes {
    state: Mutex<State>,
    flushed: Notify,
}

#[derive(Debug, Default)]
struct State {
    /// An answer is complete, and some of it may not have been written yet.
    unsent: bool,
    /// Since when a write waits for the client.
    stalled: Option<Instant>,
}

impl Writes {
    /// An answer is complete; some of it may wait to be written.
    pub(super) fn answer_is_complete(&self) {
        self.state().unsent = true;
    }

    /// True if everything was written.
    pub(super) fn is_empty(&self) -> bool {
        !self.state().unsent
    }

    /// Returns when everything was written. The next answer is not made before: of many pipelined requests one answer is in memory
    /// at a time.
    pub(super) async fn flushed(&self) {
        loop {
            let flushed = self.flushed.notified();
            if self.is_empty() {
                return;
            }
            flushed.await;
        }
    }

    /// For how long a write has waited for the client.
    pub(super) fn stalled_for(&self, now: Instant) -> Option<Duration> {
        let since = self.state().stalled;
        since.map(|since| now.saturating_duration_since(since))
    }

    fn all_written(&self) {
        let mut state = self.state();
        state.stalled = None;
        if state.unsent {
            state.unsent = false;
            self.flushed.notify_waiters();
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("nothing panics with this lock")
    }
}

/// A stream whose writes are watched, and fail when the client reads too little for too long.
#[derive(Debug)]
pub(super) struct WatchedStream<S> {
    inner: S,
    writes: Arc<Writes>,
    stall: Duration,
    /// When the client is given up, once a write has waited for it.
    deadline: Option<Instant>,
    alarm: Pin<Box<Sleep>>,
}

impl<S> WatchedStream<S> {
    /// Watches `inner`: a client that reads nothing for `stall` is given up, and so is one that reads a little now and then.
    pub(super) fn new(inner: S, writes: Arc<Writes>, stall: Duration) -> Self {
        Self {
            inner,
            writes,
            stall,
            deadline: None,
            alarm: Box::pin(sleep_until(Instant::now())),
        }
    }

    /// Records the result of a write.
    fn note(
        &mut self,
        context: &mut Context<'_>,
        written: Poll<Result<usize>>,
    ) -> Poll<Result<usize>> {
        match (&written, self.deadline) {
            // The usual case needs no clock.
            (Poll::Ready(_), None) => {}
            (Poll::Ready(Ok(bytes)), Some(deadline)) => {
                let earned = Duration::from_secs_f64(*bytes as f64 / LEAST_RATE);
                self.deadline = Some((deadline + earned).min(Instant::now() + self.stall));
                self.writes.state().stalled = None;
            }
            (Poll::Ready(Err(_)), _) => {}
            (Poll::Pending, _) => return self.wait(context),
        }
        written
    }

    fn wait(&mut self, context: &mut Context<'_>) -> Poll<Result<usize>> {
        let now = Instant::now();
        let deadline = *self.deadline.get_or_insert(now + self.stall);
        self.writes.state().stalled.get_or_insert(now);
        self.alarm.as_mut().reset(deadline);
        match self.alarm.as_mut().poll(context) {
            Poll::Pending => Poll::Pending,
            Poll::Ready(()) => Poll::Ready(Err(Error::new(
                ErrorKind::TimedOut,
                "the client does not read its answer",
            ))),
        }
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for WatchedStream<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<Result<()>> {
        Pin::new(&mut self.inner).poll_read(context, buffer)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for WatchedStream<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<Result<usize>> {
        let written = Pin::new(&mut self.inner).poll_write(context, bytes);
        self.note(context, written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        pieces: &[IoSlice<'_>],
    ) -> Poll<Result<usize>> {
        let written = Pin::new(&mut self.inner).poll_write_vectored(context, pieces);
        self.note(context, written)
    }

    fn is_write_vectored(&self) -> bool {
        self.inner.is_write_vectored()
    }

    /// Is called when there is nothing left to write.
    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Result<()>> {
        let flushed = Pin::new(&mut self.inner).poll_flush(context);
        if let Poll::Ready(Ok(())) = flushed {
            self.deadline = None;
            self.writes.all_written();
        }
        flushed
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Result<()>> {
        Pin::new(&mut self.inner).poll_shutdown(context)
    }
}
