//! A connection: its client, whether it is idle, and the requests on it that are being answered.

use std::net::{IpAddr, Ipv6Addr};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use tokio::sync::OwnedSemaphorePermit;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

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
    /// Had requests, none of them with a known key.
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
    /// Its place among the regular connections, or in the reserve.
    pub(super) place: Mutex<Option<OwnedSemaphorePermit>>,
}

impl Connection {
    pub(super) fn new(address: Address) -> Self {
        Self {
            address,
            identity: Mutex::new(Identity::New(Instant::now())),
            active: AtomicUsize::new(0),
            reads: Arc::default(),
            writes: Arc::default(),
            evict: CancellationToken::new(),
            place: Mutex::default(),
        }
    }

    /// A request on it begins, whose client is not known yet.
    pub(super) fn request_begins(&self) {
        self.active.fetch_add(1, Ordering::Relaxed);
        let mut identity = self.identity();
        if let Identity::New(_) = *identity {
            *identity = Identity::Unauthenticated;
        }
    }

    /// The answer to a request on it is complete; some of it may wait to be written.
    pub(super) fn request_ends(&self) {
        self.writes.answer_is_complete();
        self.active.fetch_sub(1, Ordering::Relaxed);
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
