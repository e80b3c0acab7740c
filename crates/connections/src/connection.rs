//! A connection, and the requests on it that are being answered.

use std::net::{IpAddr, Ipv6Addr};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use tokio::sync::OwnedSemaphorePermit;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

use super::budget::Part;
use super::limit::{Connections, Overloaded};
use super::stalled_reads::Reads;
use super::stalled_writes::Writes;

/// A connection whose client has sent nothing of its request for so long counts as idle; so does one of a client with a key that has read
/// nothing of its answer, and one without a key at once.
pub(super) const STALLED: Duration = Duration::from_secs(1);

/// A new connection has so long to say who it is before it is evicted.
pub(super) const NEW: Duration = Duration::from_secs(1);

/// The address of a client. Whoever has one address of IPv6 has a network of them, so that they count as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Address(IpAddr);

impl From<IpAddr> for Address {
    fn from(address: IpAddr) -> Self {
        Self(match address.to_canonical() {
            IpAddr::V6(address) => {
                let [a, b, c, d, ..] = address.segments();
                Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0).into()
            }
            address => address,
        })
    }
}

/// Who sends requests on a connection.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Identity {
    /// Accepted at this time, without a request so far.
    New(Instant),
    /// It has had requests, none of them with a known key.
    Unauthenticated,
    /// The last key on it that is known is this client's.
    Client(Arc<str>),
}

/// Whose limits connections and requests count for: a client, or an address without a key that is known.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Owner {
    Client(Arc<str>),
    Address(Address),
}

impl Owner {
    /// A name that no other one has.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Client(client) => format!("client {client}"),
            Self::Address(Address(address)) => format!("address {address}"),
        }
    }
}

/// A connection.
#[derive(Debug)]
pub struct Connection {
    /// Where its client is.
    pub address: Address,
    identity: Mutex<Identity>,
    /// Requests that are being answered.
    active: AtomicUsize,
    pub(super) reads: Arc<Reads>,
    pub(super) writes: Arc<Writes>,
    /// Comes when its place is needed.
    pub(super) evict: CancellationToken,
    pub(super) limit: Arc<Connections>,
    /// Its place among the regular connections, or in the reserve.
    pub(super) place: Mutex<Option<OwnedSemaphorePermit>>,
}

impl Connection {
    pub(super) fn new(address: Address, limit: &Arc<Connections>) -> Self {
        Self {
            address,
            identity: Mutex::new(Identity::New(Instant::now())),
            active: AtomicUsize::new(0),
            reads: Arc::default(),
            writes: Arc::default(),
            evict: CancellationToken::new(),
            limit: Arc::clone(limit),
            place: Mutex::default(),
        }
    }

    /// A request on it had a key of this client.
    pub(super) fn authenticated(&self, client: &Arc<str>) {
        *self.identity() = Identity::Client(Arc::clone(client));
    }

    /// True if it may be evicted: no request is being answered, or its client sends nothing of it, or reads nothing of the answer.
    pub(super) fn is_idle(&self, now: Instant) -> bool {
        let patience = match *self.identity() {
            Identity::Client(_) => STALLED,
            Identity::New(_) | Identity::Unauthenticated => Duration::ZERO,
        };
        let longer =
            |stalled: Option<Duration>, than| stalled.is_some_and(|stalled| stalled >= than);
        !self.is_busy()
            || longer(self.reads.stalled_for(now), STALLED)
            || longer(self.writes.stalled_for(now), patience)
    }

    /// True if a request is being answered, or its answer is not yet written.
    pub(super) fn is_busy(&self) -> bool {
        self.active.load(Ordering::Relaxed) > 0 || !self.writes.is_empty()
    }

    /// For how long it has been there without a request; none if it had one.
    pub(super) fn new_for(&self, now: Instant) -> Option<Duration> {
        match *self.identity() {
            Identity::New(since) => Some(now.saturating_duration_since(since)),
            Identity::Unauthenticated | Identity::Client(_) => None,
        }
    }

    /// Whose connection it is.
    pub(super) fn owner(&self) -> Owner {
        match &*self.identity() {
            Identity::Client(client) => Owner::Client(Arc::clone(client)),
            Identity::New(_) | Identity::Unauthenticated => Owner::Address(self.address),
        }
    }

    /// The client whose key it had last; its address, if it had none.
    pub fn client(&self) -> String {
        match self.owner() {
            Owner::Client(client) => client.to_string(),
            owner @ Owner::Address(_) => owner.name(),
        }
    }

    fn identity(&self) -> MutexGuard<'_, Identity> {
        self.identity.lock().expect("nothing panics with this lock")
    }
}

/// A request that is being answered, until the last byte of its answer was handed over to be written.
#[derive(Debug)]
pub struct ActiveRequest {
    pub(super) connection: Arc<Connection>,
    /// Its part of the active connections of its client or of its address.
    part: Mutex<Option<Part>>,
}

impl ActiveRequest {
    pub(super) fn begin(connection: &Arc<Connection>) -> Self {
        connection.active.fetch_add(1, Ordering::Relaxed);
        let mut identity = connection.identity();
        if let Identity::New(_) = *identity {
            *identity = Identity::Unauthenticated;
        }
        drop(identity);
        Self {
            connection: Arc::clone(connection),
            part: Mutex::default(),
        }
    }

    /// Waits for a regular place, where its connection has none.
    ///
    /// # Errors
    ///
    /// [`Overloaded::Connections`], after a while.
    pub async fn leave_reserve(&self) -> Result<(), Overloaded> {
        self.connection.leave_reserve().await
    }

    /// Counts it for its address, unless it is counted already.
    ///
    /// # Errors
    ///
    /// [`Overloaded::Client`], where as many are active as may be.
    pub fn count_for_address(&self) -> Result<(), Overloaded> {
        if self.part().is_some() {
            return Ok(());
        }
        self.count_for(&Owner::Address(self.connection.address))
    }

    /// Counts the connection for this client, whose key it has, from now on.
    ///
    /// # Errors
    ///
    /// [`Overloaded::Client`], where as many of it are active as may be.
    pub fn authenticated(&self, client: &Arc<str>) -> Result<(), Overloaded> {
        self.connection.authenticated(client);
        self.count_for(&Owner::Client(Arc::clone(client)))
    }

    fn count_for(&self, owner: &Owner) -> Result<(), Overloaded> {
        *self.part() = None;
        *self.part() = Some(self.connection.limit.count_active(&owner.name())?);
        Ok(())
    }

    fn part(&self) -> MutexGuard<'_, Option<Part>> {
        self.part.lock().expect("nothing panics with this lock")
    }
}

impl Drop for ActiveRequest {
    fn drop(&mut self) {
        // The answer is complete; some of it may wait to be written.
        self.connection.writes.answer_is_complete();
        self.connection.active.fetch_sub(1, Ordering::Relaxed);
    }
}
