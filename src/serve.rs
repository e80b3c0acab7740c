//! The service as a whole: its start, its end, and nothing else.

use std::fs::{File, OpenOptions, TryLockError};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, bail};
use meshwright_engine::analysis::Library;
use meshwright_engine::run::Run;
use tokio::net::TcpListener;
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;
use tracing::{info, warn};

use crate::config::Config;
use crate::http::{App, Edge, router};
use crate::jobs::{Clock, Jobs, Pace, Previews, Rules, Solve, Store, Workers};
use crate::wire::{Problem, Submission};

/// At a shutdown, running work and open answers get so long to end.
const GRACE: Duration = Duration::from_secs(10);

/// How a submission is computed with the substructures that all computations share, as by
/// [`wire::solve`](fn@crate::wire::solve).
pub type Compute =
    Arc<dyn Fn(&Submission, &Library, &Run) -> Result<String, Problem> + Send + Sync>;

/// A service that runs.
pub struct Service {
    address: SocketAddr,
    stop: CancellationToken,
    server: JoinHandle<std::io::Result<()>>,
    workers: Workers,
    store: Store,
    _lock: DatabaseLock,
}

/// Starts the service: the database, the workers, the listener. It computes with `compute` and reads the time from `clock`.
///
/// # Errors
///
/// When the database cannot be opened, belongs to another process, or the address cannot be taken.
pub async fn serve(config: &Config, compute: Compute, clock: Clock) -> anyhow::Result<Service> {
    let lock = DatabaseLock::take(&config.database)?;
    let store = Store::open(&config.database)
        .await
        .with_context(|| format!("cannot use the database {}", config.database.display()))?;
    let listener = TcpListener::bind(config.listen)
        .await
        .with_context(|| format!("cannot listen on {}", config.listen))?;
    let address = listener
        .local_addr()
        .context("the listener has no address")?;

    let stop = CancellationToken::new();
    let library = Library::with_capacity(config.cache_bytes());
    let solve: Solve = {
        let library = library.clone();
        Arc::new(move |submission, run| compute(submission, &library, run))
    };
    let previews = Previews::new(Arc::clone(&solve), config.preview_rules(), stop.clone())?;
    let jobs = Jobs::new(
        store.clone(),
        Rules {
            queue_limit: config.queue_limit,
        },
        clock,
        stop.clone(),
    );
    let pace = Pace::with_time_limit(config.time_limit());
    let workers = Workers::start(jobs.clone(), solve, config.worker_count(), pace).await?;

    let edge = Edge {
        public_url: config.public_url.clone().unwrap_or_default(),
        cors_origins: config.cors_origin.clone(),
    };
    let app = App {
        jobs,
        previews,
        library,
        workers_alive: workers.alive(),
        edge: Arc::new(edge),
    };
    let server =
        axum::serve(listener, router(app)).with_graceful_shutdown(stop.clone().cancelled_owned());
    let server = tokio::spawn(server.into_future());
    info!(%address, database = %config.database.display(), workers = config.worker_count(), "serving");
    Ok(Service {
        address,
        stop,
        server,
        workers,
        store,
        _lock: lock,
    })
}

impl Service {
    /// The address that it listens on.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Ends in order: takes no more work, returns running jobs to the queue, stops previews, ends open streams, closes the
    /// database.
    pub async fn shut_down(mut self) {
        info!("shutting down");
        self.stop.cancel();
        if tokio::time::timeout(GRACE, self.workers.ended())
            .await
            .is_err()
        {
            // Its job stands in the queue already, or is recovered at the next start.
            warn!("the engine did not stop in time");
        }
        if tokio::time::timeout(GRACE, &mut self.server).await.is_err() {
            warn!("some answers did not end in time");
            self.server.abort();
        }
        self.store.close().await;
    }

    /// Ends as a crash would: nothing is returned to the queue, nobody is told.
    pub async fn kill(self) {
        self.server.abort();
        self.workers.kill().await;
        // Streams that are open would keep their connections beyond this; in a crash they end with the process.
        self.stop.cancel();
        self.store.close().await;
    }
}

/// One process works on a database. That makes it certain, at the start, that a job that is said to run has lost its
/// worker; without it, two services would take each other's jobs for lost.
struct DatabaseLock {
    // The lock is the system's, and ends with the file or the process, however that ends.
    _file: File,
}

impl DatabaseLock {
    fn take(database: &Path) -> anyhow::Result<Self> {
        let mut name = database.as_os_str().to_owned();
        name.push(".lock");
        let path = PathBuf::from(name);
        let file = OpenOptions::new()
            .create(true)
            .truncate(false)
            .write(true)
            .open(&path)
            .with_context(|| format!("cannot write {}", path.display()))?;
        match file.try_lock() {
            Ok(()) => Ok(Self { _file: file }),
            Err(TryLockError::WouldBlock) => {
                bail!("another process serves the database {}", database.display())
            }
            // Some file systems have no locks; there the operator vouches for it.
            Err(TryLockError::Error(error)) => {
                warn!(%error, "the database cannot be locked: make sure that no other process serves it");
                Ok(Self { _file: file })
            }
        }
    }
}
