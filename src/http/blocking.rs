//! Work of some milliseconds or more that no request should hold others up with.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};
use std::thread;

use meshwright_connections::{Budget, Part};
use meshwright_engine::run::Run;
use meshwright_wire::Problem;

use super::problem::internal;

/// So many pieces of such work are done at the same time; others wait for their turn, which clients take one after the other.
/// It is the cores that are short. Some takes seconds, so one client never has all places.
static ROOM: LazyLock<Budget> = LazyLock::new(|| {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    Budget::leaving_as_much(2 * cores as u64)
});

/// So many tables are read at the same time: each takes a connection to the database, of which there are twice as many, so that
/// short questions never wait for long ones.
static READERS: LazyLock<Budget> = LazyLock::new(|| Budget::of(2));

/// The turn of `client` to read some of a table.
pub(super) async fn turn_to_read(client: &str) -> Part {
    READERS.take(client, 1).await
}

/// Does work for `client` where it holds nobody up. The work is told to stop when nobody waits for it any more.
pub(super) async fn blocking<T: Send + 'static>(
    client: &str,
    work: impl FnOnce(&Run) -> T + Send + 'static,
) -> Result<T, Problem> {
    let part = ROOM.take(client, 1).await;
    let stop = StopOnDrop::default();
    let run = Run::new(Arc::clone(&stop.0), |_, _| {});
    let done = tokio::task::spawn_blocking(move || {
        // Its place is free when it has ended, whether anybody waits for it or not.
        let _part = part;
        work(&run)
    });
    let done = done.await;
    done.map_err(|error| {
        tracing::error!(%error, "work beside the requests failed");
        internal()
    })
}

/// Tells work to stop when the request that wanted it ends, however it ends.
#[derive(Default)]
struct StopOnDrop(Arc<AtomicBool>);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use futures_util::poll;

    use super::*;

    #[tokio::test]
    async fn however_many_tables_a_client_reads_two_are_made_at_a_time_and_another_client_is_next()
    {
        let first = turn_to_read("reader").await;
        let _second = turn_to_read("reader").await;
        let mut others: Vec<_> = (0..40).map(|_| Box::pin(turn_to_read("reader"))).collect();
        for other in &mut others {
            assert!(poll!(other).is_pending());
        }
        let mut late = Box::pin(turn_to_read("somebody else"));
        assert!(poll!(&mut late).is_pending());
        drop(first);
        // Kept, so that nobody else has it.
        let turn = poll!(&mut late);
        assert!(turn.is_ready());
        for other in &mut others {
            assert!(poll!(other).is_pending());
        }
    }

    #[tokio::test]
    async fn work_stops_when_nobody_waits_for_it() {
        let (begun, begins) = mpsc::channel();
        let (ended, ends) = mpsc::channel();
        let work = blocking("anybody", move |run: &Run| {
            begun.send(()).unwrap();
            while run.check().is_ok() {
                std::thread::yield_now();
            }
            ended.send(()).unwrap();
        });
        let request = tokio::spawn(work);
        tokio::task::spawn_blocking(move || begins.recv().unwrap())
            .await
            .unwrap();
        request.abort();
        let end = tokio::task::spawn_blocking(move || ends.recv_timeout(Duration::from_secs(20)));
        assert!(end.await.unwrap().is_ok());
    }
}
