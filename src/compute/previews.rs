//! Previews: computations that a request waits for and nobody keeps.
//!
//! A preview is admitted if fewer than the limit are; then it waits for one of a few rooms, each with threads of its own,
//! and is computed there. One that is no longer wanted (replaced by a newer one, or its client has gone) counts no more
//! from that moment on, although its room is free only when the engine has obeyed the stop. So a newer preview is never
//! refused because of the older one that it replaces, and the engine never does more than its rooms allow.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use meshwright_connections::Budget;
use meshwright_engine::run::Run;
use meshwright_wire::{Preview, Problem, memory_of};
use tokio::time::{Instant, sleep_until};
use tokio_util::sync::CancellationToken;

use super::Solve;
use super::rooms::{Rooms, failure};
use super::threads::NoThreads;

/// Limits of previews.
#[derive(Debug, Clone, Copy)]
pub struct PreviewRules {
    /// Maximum number of requests that wait for a preview at the same time.
    pub at_once: usize,
    /// Positions times torques of one, at most.
    pub most_positions: u64,
    /// From the request to its answer, at most.
    pub time_limit: Duration,
}

/// A preview that was computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Previewed {
    /// The text of the results document: the one that a job would give.
    pub document: String,
    /// How long it waited for threads.
    pub waited: Duration,
    /// How long the engine took.
    pub computed: Duration,
}

/// Why there is no preview.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PreviewError {
    /// As many are wanted at once as are allowed.
    #[error("{0} previews are wanted at once, which is the limit")]
    Full(usize),
    /// A newer one took its place.
    #[error("a newer preview took the place of this one")]
    Superseded,
    /// The preview passed its time limit.
    #[error("the preview took longer than {0:?}")]
    TimeLimit(Duration),
    /// The service is shutting down.
    #[error("the service is shutting down")]
    ShuttingDown,
    /// The engine has no answer.
    #[error(transparent)]
    Failed(Problem),
}

/// The previews of this process; cloning shares them.
#[derive(Clone)]
pub struct Previews(Arc<Desk>);

struct Desk {
    solve: Solve,
    rules: PreviewRules,
    stop: CancellationToken,
    // A mutex of the standard library: it is never held across an await.
    wanted: Mutex<Wanted>,
    rooms: Rooms,
}

/// The previews that requests wait for, of each client in their order of arrival.
#[derive(Default)]
struct Wanted(HashMap<String, Vec<Arc<Ticket>>>);

impl Wanted {
    fn count(&self) -> usize {
        self.0.values().map(Vec::len).sum()
    }

    fn of(&self, client: &str) -> usize {
        self.0.get(client).map_or(0, Vec::len)
    }

    fn remove(&mut self, ticket: &Arc<Ticket>) {
        if let Some(tickets) = self.0.get_mut(&ticket.client) {
            tickets.retain(|other| !Arc::ptr_eq(other, ticket));
            if tickets.is_empty() {
                self.0.remove(&ticket.client);
            }
        }
    }

    /// The older one of the same name, if there is one.
    fn older(&self, client: &str, id: Option<&str>) -> Option<Arc<Ticket>> {
        let tickets = self.0.get(client)?;
        let same = |ticket: &&Arc<Ticket>| id.is_some() && ticket.id.as_deref() == id;
        tickets.iter().find(same).cloned()
    }

    /// The preview that gives way when a client has `than` of them: the newest of the client that has most, if the two clients then have equally many.
    fn too_many(&self, than: usize) -> Option<Arc<Ticket>> {
        let most = self.0.values().max_by_key(|tickets| tickets.len())?;
        most.last().filter(|_| most.len() > than + 1).cloned()
    }
}

/// One preview that a request waits for.
#[derive(Debug)]
struct Ticket {
    client: String,
    /// The client's name for the series of this preview.
    id: Option<String>,
    /// Comes when another one has taken its place.
    replaced: CancellationToken,
    /// True if a preview of another client took its place.
    crowded_out: AtomicBool,
    /// Tells the engine to stop.
    stop: Arc<AtomicBool>,
}

/// The guard of a preview that is wanted. Dropped, wherever its request ends, it stops the engine.
struct Admitted {
    desk: Arc<Desk>,
    ticket: Arc<Ticket>,
}

impl Previews {
    /// Previews that `solve` computes, until `stop` comes.
    ///
    /// # Errors
    ///
    /// When the threads cannot be started.
    pub fn new(
        solve: Solve,
        rules: PreviewRules,
        memory: Budget,
        stop: CancellationToken,
    ) -> Result<Self, NoThreads> {
        Ok(Self(Arc::new(Desk {
            solve,
            rules,
            stop,
            wanted: Mutex::default(),
            rooms: Rooms::new("preview", rules.at_once, Budget::of, memory)?,
        })))
    }

    /// Limits of previews.
    pub fn rules(&self) -> PreviewRules {
        self.0.rules
    }

    /// The number that requests wait for.
    pub fn count(&self) -> usize {
        self.0.wanted().count()
    }

    /// Computes `preview` for `client`, and stops the older one of the same client and id. Dropping the future stops the
    /// engine.
    ///
    /// # Errors
    ///
    /// A [`PreviewError`].
    pub async fn compute(&self, client: &str, preview: Preview) -> Result<Previewed, PreviewError> {
        let Preview { submission, id } = preview;
        let solve = Arc::clone(&self.0.solve);
        let submission = Arc::new(submission);
        let asked = Arc::clone(&submission);
        #[expect(clippy::disallowed_methods, reason = "on the engine's threads")]
        let memory = move || memory_of(&asked);
        let work = move |run: &Run| solve(&submission, run)?.to_json();
        let rules = self.rules();
        let admitted = self.admit(client, id)?;
        let start = Instant::now();
        let deadline = start + rules.time_limit;

        let room = self.0.rooms.enter(client);
        let room = admitted
            .unless_over(deadline, PreviewError::Full(rules.at_once), room)
            .await?;
        let waited = start.elapsed();
        let result = admitted
            .unless_over(
                deadline,
                PreviewError::TimeLimit(rules.time_limit),
                room.launch(memory, work, admitted.run()),
            )
            .await?;
        // The sender is only ever dropped with a result in it.
        let (result, computed) = result.unwrap_or_else(|_| (Err(failure()), Duration::ZERO));
        let document = result.map_err(PreviewError::Failed)?;
        metrics::histogram!("meshwright_preview_engine_seconds").record(computed.as_secs_f64());
        Ok(Previewed {
            document,
            waited,
            computed,
        })
    }

    /// Takes a place among those that are wanted, from the older one of the same name if there is one.
    fn admit(&self, client: &str, id: Option<String>) -> Result<Admitted, PreviewError> {
        let desk = &self.0;
        if desk.stop.is_cancelled() {
            return Err(PreviewError::ShuttingDown);
        }
        let mut wanted = desk.wanted();
        if let Some(older) = wanted.older(client, id.as_deref()) {
            // Its place goes over to the newer one.
            wanted.remove(&older);
            older.replace();
        } else if wanted.count() >= desk.rules.at_once {
            let count = wanted.count();
            let newest = wanted.too_many(wanted.of(client));
            let newest = newest.ok_or(PreviewError::Full(count))?;
            wanted.remove(&newest);
            newest.crowded_out.store(true, Ordering::Relaxed);
            newest.replace();
        }
        let ticket = Arc::new(Ticket {
            client: client.to_owned(),
            id,
            replaced: CancellationToken::new(),
            crowded_out: AtomicBool::new(false),
            stop: Arc::default(),
        });
        let own = wanted.0.entry(client.to_owned()).or_default();
        own.push(Arc::clone(&ticket));
        drop(wanted);
        Ok(Admitted {
            desk: Arc::clone(desk),
            ticket,
        })
    }
}

impl Desk {
    fn wanted(&self) -> MutexGuard<'_, Wanted> {
        self.wanted
            .lock()
            .expect("nothing panics while it holds this lock")
    }
}

impl Ticket {
    fn replace(&self) {
        self.stop.store(true, Ordering::Relaxed);
        self.replaced.cancel();
    }
}

impl Admitted {
    /// The handle for the engine's work.
    fn run(&self) -> Run {
        Run::new(Arc::clone(&self.ticket.stop), |_, _| {})
    }

    /// Why another one has its place.
    fn replaced(&self) -> PreviewError {
        if self.ticket.crowded_out.load(Ordering::Relaxed) {
            PreviewError::Full(self.desk.rules.at_once)
        } else {
            PreviewError::Superseded
        }
    }

    /// The result of `work`, unless the preview ends before it.
    async fn unless_over<T>(
        &self,
        deadline: Instant,
        late: PreviewError,
        work: impl Future<Output = T>,
    ) -> Result<T, PreviewError> {
        tokio::select! {
            // Work that was told to stop may have done so already.
            biased;
            () = self.ticket.replaced.cancelled() => Err(self.replaced()),
            () = self.desk.stop.cancelled() => Err(PreviewError::ShuttingDown),
            result = work => Ok(result),
            () = sleep_until(deadline) => Err(late),
        }
    }
}

impl Drop for Admitted {
    fn drop(&mut self) {
        self.desk.wanted().remove(&self.ticket);
        self.ticket.stop.store(true, Ordering::Relaxed);
    }
}
