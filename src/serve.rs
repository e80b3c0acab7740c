//! The service as a whole: its start, its end, and nothing else.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, bail};
use futures_util::FutureExt as _;
use meshwright_connections::Server;
use meshwright_engine::library::Library;
use meshwright_engine::run::Run;
use meshwright_store::{DatabaseLock, LockError};
use meshwright_wire::{Problem, Results, Submission};
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;
use tracing::{info, warn};

use crate::compute::{Asker, FileRules, Files, Previews, Solve};
use crate::config::{Config, Part};
use crate::http::{
    Access, App, BodyMemory, Edge, KeysRule, Outlines, Readings, router, router_of_metrics,
};
use crate::jobs::{
    Clock, DatabaseAddress, Job, JobError, Jobs, Keeper, Migrate, OpenError, Resource as _, Store,
    Workers,
};
use crate::times::Times;
use crate::tokens::Tokens;
use crate::webhooks::{Deliveries, HookRules, Webhooks};

/// Longest time of a shutdown with [`Times::USUAL`]. A container gives ten seconds for all of it.
pub const END: Duration = Times::USUAL.shutdown.saturating_add(CLOSING);

/// Time that the database has to close at the end.
const CLOSING: Duration = Duration::from_secs(1);

/// How a submission is computed with the substructures that all computations share, as by
/// [`studies::solve`](fn@meshwright_studies::solve).
pub type Compute =
    Arc<dyn Fn(&Submission, &Library, &Run) -> Result<Results, Problem> + Send + Sync>;

/// Surroundings of the service beside its configuration.
pub struct World {
    /// How a submission is computed.
    pub compute: Compute,
    /// The clock.
    pub clock: Clock,
    /// Where messages may be sent.
    pub hooks: HookRules,
    /// Its timeouts.
    pub times: Times,
}

/// A service that runs.
pub struct Service {
    address: Option<SocketAddr>,
    metrics_address: Option<SocketAddr>,
    stop: CancellationToken,
    server: Option<Server>,
    metrics_server: Option<Server>,
    workers: Workers,
    keeper: Option<Keeper>,
    deliveries: Option<Deliveries>,
    store: Store,
    lock: Option<DatabaseLock>,
    times: Times,
}

/// The database cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("cannot use the database {place}")]
pub struct UnusableDatabase {
    place: DatabaseAddress,
    #[source]
    cause: OpenError,
}

impl UnusableDatabase {
    /// True if another start may succeed: a disk may be emptied, another program may end, a server may come up.
    pub fn may_pass(&self) -> bool {
        match self.cause {
            OpenError::Full | OpenError::Locked => true,
            _ => self.place.file().is_none() && self.cause.may_pass(),
        }
    }
}

/// Opens the database of a command.
///
/// # Errors
///
/// [`UnusableDatabase`].
pub async fn open(place: &DatabaseAddress, migrate: Migrate) -> Result<Store, UnusableDatabase> {
    let opened = Store::open_as(place, migrate).await;
    opened.map_err(|cause| UnusableDatabase {
        place: place.clone(),
        cause,
    })
}

/// Starts the service: the database, the workers, the listeners.
///
/// # Errors
///
/// [`UnusableDatabase`] when the database cannot be opened; others when it belongs to another process, or an address cannot
/// be taken.
pub async fn serve(config: &Config, world: World) -> anyhow::Result<Service> {
    let lock = match config.database.file() {
        Some(_) if config.role != Part::All => bail!(
            "only a database of PostgreSQL can be shared by processes of different roles; {} is a file, and its one process has the role all",
            config.database
        ),
        Some(path) => {
            Some(DatabaseLock::take(path).map_err(|error| unusable(&config.database, error))?)
        }
        None => None,
    };
    let store = open(&config.database, config.migrate).await?;
    let listener = if config.role.answers() {
        Some(listen(config.listen).await?)
    } else {
        None
    };
    let address = listener.as_ref().and_then(|it| it.local_addr().ok());
    let metrics_listener = match config.admission.metrics_listen {
        Some(address) => Some(listen(address).await?),
        None => None,
    };
    let metrics_address = metrics_listener
        .as_ref()
        .and_then(|it| it.local_addr().ok());

    let stop = CancellationToken::new();
    let library = Library::with_capacity(config.cache_bytes());
    let solve: Solve = {
        let (library, compute) = (library.clone(), world.compute);
        Arc::new(move |submission, run| compute(submission, &library, run))
    };
    let jobs = Jobs::new(store.clone(), config.rules(), world.clock, stop.clone());
    let previews = Previews::new(
        Arc::clone(&solve),
        config.preview_rules(),
        jobs.memory().clone(),
        stop.clone(),
    )?;
    let bodies = BodyMemory::of(config.memory().reading << 20, config.memory().answers << 20);
    let files = files(config, &jobs, &bodies, world.times)?;
    let pace = config.pace();
    let in_order = lock.as_ref().is_some_and(DatabaseLock::ended_in_order);
    let workers =
        Workers::start(jobs.clone(), solve, config.worker_count(), pace, in_order).await?;
    let webhooks = Webhooks::new(jobs.clone(), world.hooks);
    let (mut keeper, mut deliveries) = (None, None);
    if config.role.answers() {
        keeper = Some(Keeper::start(jobs.clone(), config.keep()));
        let started = Deliveries::start(webhooks.clone(), world.times.webhook);
        deliveries = Some(started.context("webhooks cannot be sent")?);
    }

    let access = Access::new(config.access_rules());
    let has_keys = store.has_keys().await?;
    if has_keys {
        access.found_keys();
    }
    let keys_are_off = config.admission.keys == Some(KeysRule::None);
    let tokens = match config.oidc.rules().filter(|_| config.role.answers()) {
        Some(rules) => {
            let tokens = Tokens::start(rules, jobs.clock().clone(), world.times.provider);
            Some(tokens.context("the identity provider cannot be asked")?)
        }
        None => None,
    };
    let asks_for_keys = access.always_asks_for_keys() || (has_keys && !keys_are_off);
    if config.role.answers() && asks_for_keys && !has_keys && tokens.is_none() {
        warn!(
            "nobody gets in without a key, and there is none yet: make one with `meshwright keys create`"
        );
    }
    if config.role.answers() && keys_are_off {
        warn!(
            "everybody who reaches {} may do everything: --keys none",
            config.listen
        );
    }
    let edge = Edge {
        public_url: config.public_url.clone().unwrap_or_default(),
        cors_origins: config.cors_origin.clone(),
        asks_for_keys,
        issuer: tokens.as_ref().map(|it| it.issuer().to_owned()),
        metrics_here: metrics_listener.is_none(),
    };
    let app = App {
        jobs,
        previews,
        files,
        library,
        computes: config.role.computes(),
        workers_alive: workers.alive(),
        webhooks,
        tokens,
        access: Arc::new(access),
        edge: Arc::new(edge),
        readings: Arc::new(Readings::default()),
        times: world.times,
        outlines: Outlines::default(),
        bodies,
    };
    let bounds = config.bounds();
    let metrics_server = metrics_listener.map(|listener| {
        Server::start(
            listener,
            router_of_metrics(app.clone()),
            bounds,
            stop.clone(),
        )
    });
    let server =
        listener.map(|listener| Server::start(listener, router(app), bounds, stop.clone()));
    info!(?address, database = %config.database, role = ?config.role, workers = config.worker_count(), "serving");
    Ok(Service {
        address,
        metrics_address,
        stop,
        server,
        metrics_server,
        workers,
        keeper,
        deliveries,
        store,
        lock,
        times: world.times,
    })
}

/// The files that are computed anew from `jobs`. Half of the memory for answers may hold files that wait for their clients.
fn files(config: &Config, jobs: &Jobs, bodies: &BodyMemory, times: Times) -> anyhow::Result<Files> {
    let rules = FileRules {
        at_once: config.preview_rules().at_once,
        wait: times.file,
        keep: times.keep_file,
        look: times.look_at_jobs,
        bytes: bodies.most_answers() / 2,
    };
    let of_jobs = jobs.clone();
    let is_there = move |Asker { client, job }| {
        let jobs = of_jobs.clone();
        // Where the database does not answer, the job counts as being there.
        async move {
            !matches!(
                Job::find(&jobs, &client, job).await,
                Err(JobError::NotFound(_))
            )
        }
        .boxed()
    };
    let (memory, stop) = (jobs.memory().clone(), jobs.stop().clone());
    Ok(Files::new(rules, Arc::new(is_there), memory, stop)?)
}

/// Brings the tables of a database up to date, if it is no file that another process serves.
///
/// # Errors
///
/// [`UnusableDatabase`], or that the database belongs to another process.
pub async fn migrate(place: &DatabaseAddress) -> anyhow::Result<()> {
    let _alone = match place.file() {
        Some(path) => Some(DatabaseLock::take(path).map_err(|error| unusable(place, error))?),
        None => None,
    };
    let store = open(place, Migrate::Auto).await?;
    store.close().await;
    Ok(())
}

/// A database that cannot even be opened is as unusable as one that SQLite does not read: to start again does not help. One that
/// another process serves is free when that ends.
fn unusable(place: &DatabaseAddress, error: LockError) -> anyhow::Error {
    match error {
        LockError::Taken(_) => error.into(),
        LockError::Open { error, .. } => UnusableDatabase {
            place: place.clone(),
            cause: OpenError::of_system(error),
        }
        .into(),
    }
}

async fn listen(address: SocketAddr) -> anyhow::Result<TcpListener> {
    let listener = TcpListener::bind(address).await;
    listener.with_context(|| format!("cannot listen on {address}"))
}

impl Service {
    /// The address that it listens on; none if it only computes.
    pub fn address(&self) -> Option<SocketAddr> {
        self.address
    }

    /// The address at which its numbers are, if that is another one.
    pub fn metrics_address(&self) -> Option<SocketAddr> {
        self.metrics_address
    }

    /// Ends in order: takes no more work, returns running jobs to the queue, stops previews, ends open streams, closes the
    /// database. It takes no longer than [`END`], whatever clients, the engine or the database do.
    pub async fn shut_down(mut self) {
        info!("shutting down");
        self.stop.cancel();
        let work = async {
            self.workers.ended().await;
            if let Some(keeper) = self.keeper {
                keeper.ended().await;
            }
            if let Some(deliveries) = self.deliveries {
                deliveries.ended().await;
            }
        };
        let ended = async |server: Option<Server>| match server {
            Some(server) => server.ended(self.times.shutdown).await,
            None => true,
        };
        let (workers, answers, numbers) = tokio::join!(
            tokio::time::timeout(self.times.shutdown, work),
            ended(self.server),
            ended(self.metrics_server)
        );
        if workers.is_err() {
            // Its job stands in the queue already, or is recovered at the next start.
            warn!("the engine did not stop in time");
        }
        if !(answers && numbers) {
            warn!("some answers did not end in time");
        }
        // A job that still counts as running was not lost by a crash.
        if let Some(lock) = &self.lock {
            lock.end_in_order();
        }
        if tokio::time::timeout(CLOSING, self.store.close())
            .await
            .is_err()
        {
            warn!("the database did not close in time");
        }
    }

    /// Ends as a crash would: nothing is returned to the queue, nobody is notified.
    pub async fn kill(self) {
        if let Some(server) = self.server {
            server.kill();
        }
        if let Some(server) = self.metrics_server {
            server.kill();
        }
        self.workers.kill().await;
        // Streams that are open would keep their connections beyond this; in a crash they end with the process.
        self.stop.cancel();
        self.store.close().await;
    }
}
