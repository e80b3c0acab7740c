//! Rooms: threads for computations that requests wait for, one computation at a time in each.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use meshwright_connections::{Budget, Part};
use meshwright_engine::run::Run;
use meshwright_wire::{Code, Problem};
use rayon::ThreadPool;
use tokio::sync::oneshot;
use tracing::error;

use super::message_of;
use super::threads::{Cores, NoThreads, Work, engine_threads};

/// Rooms that there are at least, so that a newer computation begins while the one that it replaces winds down, and a second client finds one.
const FEWEST_ROOMS: usize = 2;

/// The rooms of one kind of computation; cloning shares them.
#[derive(Clone)]
pub(super) struct Rooms(Arc<Shared>);

struct Shared {
    memory: Budget,
    parts: Budget,
    // A mutex of the standard library: it is never held across an await.
    free: Mutex<Vec<Arc<ThreadPool>>>,
}

/// Threads for one computation. They are free for the next when this is dropped.
pub(super) struct Room {
    rooms: Arc<Shared>,
    threads: Arc<ThreadPool>,
    client: String,
    _part: Part,
}

impl Rooms {
    /// As many rooms as the machine is good for, at most `at_once`, shared as `budget` says. Their threads are called by `kind`, and their computations take
    /// parts of `memory`.
    ///
    /// # Errors
    ///
    /// When the threads cannot be started.
    pub(super) fn new(
        kind: &'static str,
        at_once: usize,
        budget: impl FnOnce(u64) -> Budget,
        memory: Budget,
    ) -> Result<Self, NoThreads> {
        let cores = Cores::here();
        let count = at_once.min(cores.rooms().max(FEWEST_ROOMS));
        let free: Result<_, _> = (0..count)
            .map(|room| {
                let name = move |index| format!("{kind}-{room}-{index}");
                engine_threads(name, Work::Preview, cores.for_one()).map(Arc::new)
            })
            .collect();
        Ok(Self(Arc::new(Shared {
            memory,
            parts: budget(count as u64),
            free: Mutex::new(free?),
        })))
    }

    /// Waits for threads. Of the clients that wait, the one that has fewest gets them first.
    pub(super) async fn enter(&self, client: &str) -> Room {
        let part = self.0.parts.take(client, 1).await;
        let threads = self.0.free().pop();
        Room {
            rooms: Arc::clone(&self.0),
            threads: threads.expect("there are as many rooms as parts"),
            client: client.to_owned(),
            _part: part,
        }
    }
}

impl Shared {
    fn free(&self) -> MutexGuard<'_, Vec<Arc<ThreadPool>>> {
        self.free
            .lock()
            .expect("nothing panics while it holds this lock")
    }
}

impl Room {
    /// Starts the computation on the room's threads, with so many MB of memory, counted there. A panic in it is the engine's fault and ends this computation
    /// only.
    pub(super) fn launch<T: Send + 'static>(
        self,
        memory: impl FnOnce() -> u64 + Send + 'static,
        work: impl FnOnce(&Run) -> Result<T, Problem> + Send + 'static,
        run: Run,
    ) -> oneshot::Receiver<(Result<T, Problem>, Duration)> {
        let (sender, receiver) = oneshot::channel();
        let threads = Arc::clone(&self.threads);
        threads.spawn(move || {
            let is_wanted = || run.check().is_ok();
            let memory = self
                .rooms
                .memory
                .take_on_thread(&self.client, memory(), is_wanted);
            let start = Instant::now();
            let work = || work(&run);
            let result = catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
                error!(
                    panic = message_of(&*panic),
                    "the engine panicked while a request waited"
                );
                Err(failure())
            });
            let computed = start.elapsed();
            // Before the answer, so that who asks again at once finds the room free.
            drop(memory);
            drop(self);
            // Nobody waits for a computation that was stopped.
            let _ = sender.send((result, computed));
        });
        receiver
    }
}

impl Drop for Room {
    fn drop(&mut self) {
        // The permit follows when the fields are dropped, so that who gets it finds the threads.
        self.rooms.free().push(Arc::clone(&self.threads));
    }
}

/// The cause stands in the log.
pub(super) fn failure() -> Problem {
    Problem::new(
        Code::InternalError,
        "The service failed while it computed this. The failure has been logged.",
    )
}
