//! What a client takes of its answers: whether they have left, for how long it has taken nothing, and when that is too long.

use std::io::{Error, ErrorKind, IoSlice, Result};
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard};
use std::task::{Context, Poll};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::Notify;
use tokio::time::{Instant, Sleep, sleep_until};

/// Who takes less of an answer than this, in bytes a second, is given up in the end, as who takes nothing.
pub(super) const LEAST_RATE: f64 = 4096.0;

/// How far a client has taken what it asked for.
#[derive(Debug, Default)]
pub(super) struct Taking {
    state: Mutex<State>,
    taken: Notify,
}

#[derive(Debug, Default)]
struct State {
    /// An answer was handed over to be sent, and some of it may still be here.
    unsent: bool,
    /// Since when a write waits for the client.
    stalled: Option<Instant>,
}

impl Taking {
    /// An answer is complete; what has not been sent of it waits to be.
    pub(super) fn hand_over(&self) {
        self.state().unsent = true;
    }

    /// Whether everything has left.
    pub(super) fn is_empty(&self) -> bool {
        !self.state().unsent
    }

    /// Comes back when everything has left. The next answer is not made before: of many requests at once one answer lies
    /// here at a time, and it is the client's own doing when the others wait.
    pub(super) async fn emptied(&self) {
        loop {
            let taken = self.taken.notified();
            if self.is_empty() {
                return;
            }
            taken.await;
        }
    }

    /// For how long the client has taken nothing of what waits for it.
    pub(super) fn stalled_for(&self, now: Instant) -> Option<Duration> {
        let since = self.state().stalled;
        since.map(|since| now.saturating_duration_since(since))
    }

    fn everything_left(&self) {
        let mut state = self.state();
        state.stalled = None;
        if state.unsent {
            state.unsent = false;
            self.taken.notify_waiters();
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("nothing panics with this lock")
    }
}

/// A stream whose writes are watched, and end when the client takes too little for too long.
#[derive(Debug)]
pub(super) struct Watched<S> {
    inner: S,
    taking: Arc<Taking>,
    stall: Duration,
    /// When the client is given up, while a write waits for it or has done so.
    deadline: Option<Instant>,
    alarm: Pin<Box<Sleep>>,
}

impl<S> Watched<S> {
    /// Watches `inner`: a client that takes nothing for `stall` is given up, and so is one that takes a little now and then to
    /// last for ever.
    pub(super) fn new(inner: S, taking: Arc<Taking>, stall: Duration) -> Self {
        Self {
            inner,
            taking,
            stall,
            deadline: None,
            alarm: Box::pin(sleep_until(Instant::now())),
        }
    }

    /// Notes what came of a write.
    fn note(
        &mut self,
        context: &mut Context<'_>,
        written: Poll<Result<usize>>,
    ) -> Poll<Result<usize>> {
        match (&written, self.deadline) {
            // The usual way asks for no time.
            (Poll::Ready(_), None) => {}
            (Poll::Ready(Ok(bytes)), Some(deadline)) => {
                let earned = Duration::from_secs_f64(*bytes as f64 / LEAST_RATE);
                self.deadline = Some((deadline + earned).min(Instant::now() + self.stall));
                self.taking.state().stalled = None;
            }
            (Poll::Ready(Err(_)), _) => {}
            (Poll::Pending, _) => return self.wait(context),
        }
        written
    }

    fn wait(&mut self, context: &mut Context<'_>) -> Poll<Result<usize>> {
        let now = Instant::now();
        let deadline = *self.deadline.get_or_insert(now + self.stall);
        self.taking.state().stalled.get_or_insert(now);
        self.alarm.as_mut().reset(deadline);
        match self.alarm.as_mut().poll(context) {
            Poll::Pending => Poll::Pending,
            Poll::Ready(()) => Poll::Ready(Err(Error::new(
                ErrorKind::TimedOut,
                "the client does not take its answer",
            ))),
        }
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Watched<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<Result<()>> {
        Pin::new(&mut self.inner).poll_read(context, buffer)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Watched<S> {
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
            self.taking.everything_left();
        }
        flushed
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Result<()>> {
        Pin::new(&mut self.inner).poll_shutdown(context)
    }
}
