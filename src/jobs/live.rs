//! State of a job in memory: progress and stop of running jobs, and notifications.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use meshwright_engine::run::Run;
use meshwright_store::{Job, Progress};
use tokio::sync::{Notify, broadcast, watch};
use uuid::Uuid;

/// Stands for every job and study.
const ANYTHING: Uuid = Uuid::nil();

/// Something that has happened.
#[derive(Debug, Clone)]
pub(super) enum Change {
    /// A change of a job or a study, or of [`ANYTHING`]: every watcher has to look.
    Of(Uuid),
    /// To a job that has not ended.
    Going(Uuid),
    /// A job has ended, like this.
    End(Arc<Job>),
}

/// The jobs that this process runs, and the bell for every change of state.
#[derive(Debug)]
pub(super) struct Live {
    // A mutex of the standard library: it is never held across an await.
    running: Mutex<HashMap<Uuid, Running>>,
    changes: broadcast::Sender<Change>,
    /// Rung when a job begins to wait. A worker that finds one rings again, so that one ring wakes as many as needed.
    pub(super) work: Notify,
    /// How often that was.
    rung: AtomicU64,
    /// Rung when a message to a webhook begins to wait.
    pub(super) mail: Notify,
}

/// One attempt at one job, seen from outside of it.
#[derive(Debug, Clone)]
pub(super) struct Running {
    stop: Arc<AtomicBool>,
    progress: Arc<watch::Sender<Progress>>,
}

impl Running {
    /// The handle for the engine's work.
    pub(super) fn run(&self) -> Run {
        let progress = Arc::clone(&self.progress);
        Run::new(Arc::clone(&self.stop), move |done, total| {
            progress.send_if_modified(|now| {
                // Threads report out of order; the shown progress never decreases.
                let next = Progress {
                    done: done.max(now.done),
                    total: if total == 0 { now.total } else { total },
                };
                std::mem::replace(now, next) != next
            });
        })
    }

    pub(super) fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub(super) fn progress(&self) -> Progress {
        *self.progress.borrow()
    }

    pub(super) fn watch(&self) -> watch::Receiver<Progress> {
        self.progress.subscribe()
    }
}

impl Live {
    pub(super) fn new() -> Self {
        Self {
            running: Mutex::default(),
            changes: broadcast::channel(1024).0,
            work: Notify::new(),
            rung: AtomicU64::new(0),
            mail: Notify::new(),
        }
    }

    /// Enters an attempt; it leaves when the guard is dropped.
    pub(super) fn enter(self: &Arc<Self>, id: Uuid, progress: Progress) -> Entered {
        let running = Running {
            stop: Arc::default(),
            progress: Arc::new(watch::channel(progress).0),
        };
        self.lock().insert(id, running.clone());
        Entered {
            live: Arc::clone(self),
            id,
            running,
        }
    }

    /// The jobs that this process runs.
    pub(super) fn ids(&self) -> Vec<Uuid> {
        self.lock().keys().copied().collect()
    }

    pub(super) fn running(&self, id: Uuid) -> Option<Running> {
        self.lock().get(&id).cloned()
    }

    /// Tells those who wait that something has happened to a job or a study.
    pub(super) fn changed(&self, id: Uuid) {
        self.tell(Change::Of(id));
    }

    /// The same of a job that goes on.
    pub(super) fn goes_on(&self, id: Uuid) {
        self.tell(Change::Going(id));
    }

    /// The same of a job as it stands now, and of the study that it belongs to.
    pub(super) fn changed_job(&self, job: &Job) {
        if job.status.has_ended() {
            self.tell(Change::End(Arc::new(job.clone())));
        } else {
            self.goes_on(job.id);
        }
        if let Some(study) = job.study {
            self.changed(study);
        }
    }

    fn tell(&self, change: Change) {
        // No receiver is no error: nobody waits.
        let _ = self.changes.send(change);
    }

    /// Tells a worker that a job may wait.
    pub(super) fn ring(&self) {
        self.rung.fetch_add(1, Ordering::SeqCst);
        self.work.notify_one();
    }

    /// How often that was notified.
    pub(super) fn rung(&self) -> u64 {
        self.rung.load(Ordering::SeqCst)
    }

    /// Tells everybody to look, because something may have happened.
    pub(super) fn look(&self) {
        self.changed(ANYTHING);
        self.ring();
    }

    pub(super) fn changes(&self) -> Changes {
        Changes(self.changes.subscribe())
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<Uuid, Running>> {
        self.running
            .lock()
            .expect("nothing panics while it holds this lock")
    }
}

/// The guard of an attempt that is listed as running.
pub(super) struct Entered {
    live: Arc<Live>,
    id: Uuid,
    pub(super) running: Running,
}

impl Drop for Entered {
    fn drop(&mut self) {
        let mut running = self.live.lock();
        // A later attempt at the same job may have taken the place.
        if running
            .get(&self.id)
            .is_some_and(|entry| Arc::ptr_eq(&entry.stop, &self.running.stop))
        {
            running.remove(&self.id);
        }
    }
}

/// Changes of all jobs and studies, from a time on.
pub struct Changes(broadcast::Receiver<Change>);

impl Changes {
    async fn next(&mut self) -> Change {
        match self.0.recv().await {
            Ok(change) => change,
            // One who lags has missed news.
            Err(broadcast::error::RecvError::Lagged(_)) => Change::Of(ANYTHING),
            Err(broadcast::error::RecvError::Closed) => std::future::pending().await,
        }
    }

    /// Comes back when something may have ended.
    pub(crate) async fn end(&mut self) {
        while let Change::Going(_) = self.next().await {}
    }

    /// Comes back with a job when it has ended, or without it when that may be.
    pub(super) async fn end_of(&mut self, id: Uuid) -> Option<Arc<Job>> {
        loop {
            match self.next().await {
                Change::End(job) if job.id == id => return Some(job),
                Change::Of(other) if other == id || other == ANYTHING => return None,
                _ => {}
            }
        }
    }
}

/// Changes of one job.
pub struct News {
    pub(super) id: Uuid,
    pub(super) live: Arc<Live>,
    pub(super) changes: Changes,
}

impl News {
    /// Comes back when the state of the job may have changed.
    pub async fn changed_state(&mut self) {
        loop {
            let id = match self.changes.next().await {
                Change::Of(id) | Change::Going(id) => id,
                Change::End(job) => job.id,
            };
            if id == self.id || id == ANYTHING {
                return;
            }
        }
    }

    /// Comes back when the state or the progress of the job may have changed, `seen` being the progress known.
    pub async fn changed(&mut self, seen: Option<Progress>) {
        let progress = self.live.running(self.id).map(|running| running.watch());
        let moved = async {
            match progress {
                Some(mut progress) => {
                    // An attempt that ends drops its sender; the change of state follows.
                    if progress.wait_for(|now| Some(*now) != seen).await.is_err() {
                        std::future::pending::<()>().await;
                    }
                }
                None => std::future::pending().await,
            }
        };
        tokio::select! {
            () = self.changed_state() => {}
            () = moved => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_never_goes_back_and_a_stop_reaches_the_work() {
        let live = Arc::new(Live::new());
        let id = Uuid::now_v7();
        let entered = live.enter(id, Progress { done: 0, total: 8 });
        let run = entered.running.run();
        run.reached(3).unwrap();
        assert_eq!(
            live.running(id).unwrap().progress(),
            Progress { done: 3, total: 8 }
        );
        run.expect(10);
        run.reached(1).unwrap();
        assert_eq!(
            live.running(id).unwrap().progress(),
            Progress { done: 4, total: 10 }
        );
        live.running(id).unwrap().stop();
        assert!(run.reached(1).is_err());
    }

    #[test]
    fn an_attempt_that_ends_late_leaves_the_next_one_listed() {
        let live = Arc::new(Live::new());
        let id = Uuid::now_v7();
        let first = live.enter(id, Progress::default());
        let second = live.enter(id, Progress::default());
        drop(first);
        assert!(live.running(id).is_some());
        drop(second);
        assert!(live.running(id).is_none());
    }
}
