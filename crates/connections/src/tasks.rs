//! Tasks on the threads that answer requests, and the time of each of their polls.

use std::future::poll_fn;
use std::pin::pin;
use std::sync::OnceLock;
use std::time::Duration;

use tokio::task::JoinHandle;

static GAUGE: OnceLock<Gauge> = OnceLock::new();

/// Measures each poll of a task. While one task is polled, its thread answers nobody else.
#[derive(Debug, Clone, Copy)]
pub struct Gauge {
    /// The processor time that the thread has had so far.
    pub time: fn() -> Duration,
    /// Hears the duration of each poll.
    pub polled: fn(Duration),
}

/// Has the polls of all tasks measured that begin from now on; the first gauge stays.
pub fn measure_polls(gauge: Gauge) {
    GAUGE.get_or_init(|| gauge);
}

/// Begins a task on the threads that answer requests.
pub fn spawn<F>(task: F) -> JoinHandle<F::Output>
where
    F: Future<Output: Send> + Send + 'static,
{
    match GAUGE.get() {
        None => tokio::spawn(task),
        // A large task is moved once, and not from frame to frame.
        Some(gauge) => tokio::spawn(measured_by(*gauge, Box::pin(task))),
    }
}

/// `task`, each of its polls measured.
async fn measured_by<F: Future>(gauge: Gauge, task: F) -> F::Output {
    let mut task = pin!(task);
    poll_fn(|context| {
        let before = (gauge.time)();
        let polled = task.as_mut().poll(context);
        (gauge.polled)((gauge.time)().saturating_sub(before));
        polled
    })
    .await
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use tokio::task::yield_now;

    use super::*;

    static TAKEN: AtomicU64 = AtomicU64::new(0);
    static CLOCK: AtomicU64 = AtomicU64::new(0);

    #[tokio::test]
    async fn a_gauge_is_told_what_each_poll_takes_and_not_what_passes_between_them() {
        let gauge = Gauge {
            time: || Duration::from_millis(CLOCK.load(Ordering::Relaxed)),
            polled: |taken| {
                TAKEN.fetch_max(taken.as_millis() as u64, Ordering::Relaxed);
            },
        };
        let work = |milliseconds| CLOCK.fetch_add(milliseconds, Ordering::Relaxed);
        let task = measured_by(gauge, async move {
            work(3);
            yield_now().await;
            work(5);
            yield_now().await;
            work(4);
        });
        let mut task = pin!(task);
        while futures_util::poll!(&mut task).is_pending() {
            // The time of other tasks of the thread.
            work(1000);
        }
        assert_eq!(TAKEN.load(Ordering::Relaxed), 5);
    }
}
