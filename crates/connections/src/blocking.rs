//! Work of some milliseconds or more that no request should hold others up with.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};
use std::thread;

use tokio::task::{JoinError, spawn_blocking};

use super::budget::Budget;

/// Pieces of such work at the same time; others wait for their turn, which clients take one after the other. The cores are the bottleneck. Some work takes
/// seconds, so one client never has all places.
static PLACES: LazyLock<Budget> = LazyLock::new(|| {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    Budget::leaving_as_much(2 * cores as u64)
});

/// Does work for `client` on a thread that delays no other request. The work gets a flag that becomes true when nobody waits for it any more: then it stops.
///
/// # Errors
///
/// Where the work panics.
pub async fn blocking<T: Send + 'static>(
    client: &str,
    work: impl FnOnce(Arc<AtomicBool>) -> T + Send + 'static,
) -> Result<T, JoinError> {
    let part = PLACES.take(client, 1).await;
    let stop = StopOnDrop::default();
    let stopped = Arc::clone(&stop.0);
    let done = spawn_blocking(move || {
        // Its place is free when it has ended, whether anybody waits for it or not.
        let _part = part;
        work(stopped)
    });
    done.await
}

/// The stop of work, which comes when this is dropped: when the request that wanted the work ends, however it ends.
#[derive(Debug, Default)]
pub struct StopOnDrop(pub Arc<AtomicBool>);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;

    #[tokio::test]
    async fn work_stops_when_nobody_waits_for_it() {
        let (begun, begins) = mpsc::channel();
        let (ended, ends) = mpsc::channel();
        let work = blocking("anybody", move |stop| {
            begun.send(()).unwrap();
            while !stop.load(Ordering::Relaxed) {
                thread::yield_now();
            }
            ended.send(()).unwrap();
        });
        let request = tokio::spawn(work);
        spawn_blocking(move || begins.recv().unwrap())
            .await
            .unwrap();
        request.abort();
        let end = spawn_blocking(move || ends.recv_timeout(Duration::from_secs(60)));
        assert!(end.await.unwrap().is_ok());
    }
}
