//! The limit of connections, of those that one client has busy, and which idle one is evicted for a new one.

use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, timeout};

use super::budget::{Budget, Part};
use super::connection::{Address, Connection, NEW, Owner};

/// One client, or one address without a key, has so large a part of the connections busy at most.
const OF_CLIENT: usize = 4;

/// Connections accepted beyond the limit: for health checks, which are answered on them at once, and for others until a regular place is free.
const RESERVE: usize = 64;

/// Longest time that a request waits in the reserve for a regular place.
const LONGEST_WAIT: Duration = Duration::from_secs(2);

/// A new connection is spared from eviction as long as no more than one in so many is new, and for a tenth of the time as long as no more
/// than half of them are.
const SPARED: usize = 4;

/// An evicted connection has ended in this time, or a further one is evicted.
const EVICTING: Duration = Duration::from_millis(50);

/// Why a request is not answered now.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Overloaded {
    /// Its client, or its address, has as many as it may have.
    #[error("as many requests of yours are being answered as one client may have at the same time")]
    Client,
    /// The request came on a connection of the reserve, and no regular place became free.
    #[error("all connections are busy")]
    Connections,
}

/// Places for connections.
#[derive(Debug)]
struct Places {
    most: usize,
    free: Arc<Semaphore>,
}

impl Places {
    fn new(most: usize) -> Self {
        let free = Arc::new(Semaphore::new(most));
        Self { most, free }
    }

    fn try_take(&self) -> Option<OwnedSemaphorePermit> {
        Arc::clone(&self.free).try_acquire_owned().ok()
    }
}

/// The connections that there are.
#[derive(Debug)]
pub(super) struct Connections {
    regular: Places,
    reserve: Places,
    /// The requests in the reserve that wait for a regular place, by address.
    waiting: Budget,
    /// The requests that are being answered, by owner.
    active: Budget,
    present: Mutex<Present>,
}

#[derive(Debug, Default)]
struct Present {
    last: u64,
    /// By their order of arrival.
    connections: BTreeMap<u64, Arc<Connection>>,
}

impl Present {
    /// Of the idle connections on these places, those without a key first, of the address that has most; then those of the client that has
    /// most. Of these, the one that was accepted first.
    fn next_to_evict(&self, places: &Places, now: Instant) -> Option<&Connection> {
        let on_places = || {
            self.connections
                .iter()
                .filter(|(_, connection)| connection.is_on(places))
        };
        let mut sizes: HashMap<Owner, usize> = HashMap::new();
        let mut new = 0;
        for (_, connection) in on_places() {
            *sizes.entry(connection.owner()).or_default() += 1;
            new += usize::from(connection.new_for(now).is_some_and(|age| age < NEW));
        }
        let spared = match new {
            new if new <= places.most / SPARED => NEW,
            new if new <= places.most / 2 => NEW / 10,
            _ => Duration::ZERO,
        };
        let idle = on_places().filter(|(_, connection)| {
            connection.is_idle(now)
                && !connection.evict.is_cancelled()
                && connection.new_for(now).is_none_or(|age| age >= spared)
        });
        let chosen = idle.max_by_key(|(number, connection)| {
            let owner = connection.owner();
            let is_unauthenticated = matches!(owner, Owner::Address(_));
            (
                is_unauthenticated,
                sizes.get(&owner).copied(),
                Reverse(**number),
            )
        });
        chosen.map(|(_, connection)| &**connection)
    }
}

impl Connections {
    pub(super) fn new(most: usize) -> Arc<Self> {
        let most = most.max(1);
        Arc::new(Self {
            regular: Places::new(most),
            reserve: Places::new(RESERVE),
            waiting: Budget::limited(RESERVE as u64 / 2, RESERVE as u64 / 4),
            active: Budget::limited(u64::MAX, (most / OF_CLIENT).max(1) as u64),
            present: Mutex::default(),
        })
    }

    /// Admits a connection from `address`: to a regular place, or to the reserve while an idle connection is evicted. Waits where there is
    /// neither.
    pub(super) async fn admit(self: &Arc<Self>, address: Address) -> Admitted {
        let mut place = self.regular.try_take();
        if place.is_none() {
            self.evict_from(&self.regular);
            place = self.reserve.try_take();
        }
        while place.is_none() {
            place = self.after_eviction(&self.reserve).await;
        }
        let connection = Connection::new(address);
        *connection
            .place
            .lock()
            .expect("nothing panics with this lock") = place;
        let connection = Arc::new(connection);
        let mut present = self.present();
        present.last += 1;
        let number = present.last;
        present.connections.insert(number, Arc::clone(&connection));
        drop(present);
        metrics::gauge!("meshwright_connections").increment(1.0);
        Admitted {
            number,
            connection,
            limit: Arc::clone(self),
        }
    }

    /// A place that is free after an idle connection was evicted; none where all were busy.
    async fn after_eviction(&self, places: &Places) -> Option<OwnedSemaphorePermit> {
        self.evict_from(places);
        let next = Arc::clone(&places.free).acquire_owned();
        timeout(EVICTING, next).await.ok()?.ok()
    }

    /// A regular place for a connection of the reserve.
    async fn regular_place(&self, address: &str) -> Option<OwnedSemaphorePermit> {
        if let Some(place) = self.regular.try_take() {
            return Some(place);
        }
        let _waiting = self.waiting.try_take(address, 1)?;
        let start = Instant::now();
        loop {
            let place = self.after_eviction(&self.regular).await;
            if place.is_some() || start.elapsed() >= LONGEST_WAIT {
                return place;
            }
        }
    }

    /// Evicts one of the idle connections.
    pub(super) fn evict_one(&self) {
        self.evict_from(&self.regular);
    }

    fn evict_from(&self, places: &Places) {
        if let Some(connection) = self.present().next_to_evict(places, Instant::now()) {
            connection.evict.cancel();
            metrics::counter!("meshwright_connections_evicted_total").increment(1);
        }
    }

    /// Waits for a regular place, where `connection` has none.
    ///
    /// # Errors
    ///
    /// [`Overloaded::Connections`], after a while.
    pub(super) async fn leave_reserve(&self, connection: &Connection) -> Result<(), Overloaded> {
        if !connection.is_on(&self.reserve) {
            return Ok(());
        }
        let address = Owner::Address(connection.address).name();
        let place = self.regular_place(&address).await;
        *connection.place() = Some(place.ok_or(Overloaded::Connections)?);
        Ok(())
    }

    /// Counts a request of `owner` as active.
    pub(super) fn count_active(&self, owner: &str) -> Result<Part, Overloaded> {
        let part = self.active.try_take(owner, 1);
        part.ok_or(Overloaded::Client)
    }

    fn present(&self) -> MutexGuard<'_, Present> {
        self.present.lock().expect("nothing panics with this lock")
    }
}

impl Connection {
    fn is_on(&self, places: &Places) -> bool {
        let place = self.place();
        place
            .as_ref()
            .is_some_and(|place| Arc::ptr_eq(place.semaphore(), &places.free))
    }

    fn place(&self) -> MutexGuard<'_, Option<OwnedSemaphorePermit>> {
        self.place.lock().expect("nothing panics with this lock")
    }
}

/// An admitted connection; its place is free when this is dropped.
pub(super) struct Admitted {
    number: u64,
    pub(super) connection: Arc<Connection>,
    pub(super) limit: Arc<Connections>,
}

impl Drop for Admitted {
    fn drop(&mut self) {
        self.limit.present().connections.remove(&self.number);
        *self.connection.place() = None;
        metrics::gauge!("meshwright_connections").decrement(1.0);
    }
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;
    use std::net::IpAddr;
    use std::pin::Pin;
    use std::task::{Context, Poll};

    use bytes::Bytes;
    use futures_util::poll;
    use http_body::{Body, Frame};

    use super::super::active_request::ActiveRequest;
    use super::super::connection::STALLED;
    use super::super::stalled_reads::WatchedBody;
    use super::*;

    /// A body that never comes.
    struct Nothing;

    impl Body for Nothing {
        type Data = Bytes;
        type Error = Infallible;

        fn poll_frame(
            self: Pin<&mut Self>,
            _: &mut Context<'_>,
        ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
            Poll::Pending
        }
    }

    async fn enter(limit: &Arc<Connections>, last: u8) -> Admitted {
        let address = IpAddr::from([127, 0, 0, last]);
        limit.admit(address.into()).await
    }

    fn number(all: &[Admitted], connection: &Connection) -> Option<usize> {
        all.iter()
            .position(|at| std::ptr::eq(&*at.connection, connection))
    }

    /// The order in which these are evicted, by their numbers, if all that is asked at this time.
    fn order(limit: &Connections, all: &[Admitted], now: Instant) -> Vec<usize> {
        let present = limit.present();
        let next = || present.next_to_evict(&limit.regular, now);
        let leaving = std::iter::from_fn(|| next().inspect(|connection| connection.evict.cancel()));
        leaving
            .filter_map(|connection| number(all, connection))
            .collect()
    }

    #[tokio::test]
    async fn connections_without_a_key_are_evicted_first_and_those_of_the_address_with_most_of_them_before_others()
     {
        let limit = Connections::new(16);
        let mut places = Vec::new();
        for last in [1, 1, 2, 3, 3, 3] {
            places.push(enter(&limit, last).await);
        }
        places[0].connection.authenticated(&"portal".into());
        let _at_work = ActiveRequest::begin(&places[3].connection, &limit);
        // Two of the third address idle, then single ones by age; who has a key goes last, who is at work not at all.
        let order = order(&limit, &places, Instant::now() + NEW);
        assert_eq!(order, [4, 5, 1, 2, 0]);
    }

    #[tokio::test]
    async fn of_those_with_a_key_the_client_with_most_connections_is_evicted_first_whatever_its_addresses()
     {
        let limit = Connections::new(16);
        let mut places = Vec::new();
        for (last, client) in [
            (1, "other"),
            (1, "hog"),
            (2, "hog"),
            (3, "hog"),
            (3, "third"),
        ] {
            let place = enter(&limit, last).await;
            place.connection.authenticated(&client.into());
            places.push(place);
        }
        let order = order(&limit, &places, Instant::now());
        assert_eq!(order, [1, 2, 3, 0, 4]);
    }

    #[tokio::test]
    async fn a_new_connection_has_a_second_to_say_who_it_is_unless_too_many_are_new() {
        let limit = Connections::new(16);
        let mut places = Vec::new();
        for _ in 0..8 {
            let place = enter(&limit, 1).await;
            place.connection.authenticated(&"hog".into());
            places.push(place);
        }
        let now = Instant::now();
        places.push(enter(&limit, 1).await);
        let first = |now| {
            let present = limit.present();
            let next = present.next_to_evict(&limit.regular, now).unwrap();
            number(&places, next)
        };
        assert_eq!(
            (first(now), first(Instant::now() + NEW)),
            (Some(0), Some(8))
        );
        places.truncate(8);
        for _ in 0..5 {
            places.push(enter(&limit, 1).await);
        }
        let soon = now + NEW / 5;
        assert_eq!(order(&limit, &places, soon)[..5], [8, 9, 10, 11, 12]);
    }

    #[tokio::test]
    async fn a_connection_that_sends_nothing_of_its_request_is_idle_after_a_second() {
        let limit = Connections::new(1);
        let place = enter(&limit, 1).await;
        place.connection.authenticated(&"hog".into());
        let _at_work = ActiveRequest::begin(&place.connection, &limit);
        let mut body = WatchedBody::new(Nothing, Arc::clone(&place.connection.reads));
        let start = Instant::now();
        let is_idle = |at| place.connection.is_idle(at);
        assert!(!is_idle(start + STALLED), "nobody has looked for the body");
        assert!(
            poll!(std::future::poll_fn(
                |context| Pin::new(&mut body).poll_frame(context)
            ))
            .is_pending()
        );
        assert!(!is_idle(start + STALLED / 2) && is_idle(Instant::now() + STALLED));
        drop(body);
        assert!(!is_idle(Instant::now() + STALLED));
    }

    #[test]
    fn a_network_of_ipv6_is_one_address_and_a_mapped_address_is_itself() {
        let address = |text: &str| Address::from(text.parse::<IpAddr>().unwrap());
        assert_eq!(address("2001:db8:1:2::1"), address("2001:db8:1:2:ffff::9"));
        assert_ne!(address("2001:db8:1:2::1"), address("2001:db8:1:3::1"));
        assert_eq!(address("::ffff:10.0.0.1"), address("10.0.0.1"));
        assert_ne!(address("10.0.0.1"), address("10.0.0.2"));
    }

    #[tokio::test]
    async fn one_client_has_a_quarter_of_the_connections_busy_and_each_address_and_client_has_its_own()
     {
        let limit = Connections::new(16);
        let mut all = Vec::new();
        for _ in 0..16 {
            all.push(enter(&limit, 1).await);
        }
        let requests: Vec<_> = all
            .iter()
            .map(|at| ActiveRequest::begin(&at.connection, &limit))
            .collect();
        let of_address = requests
            .iter()
            .filter(|request| request.count_for_address().is_ok());
        assert_eq!(of_address.count(), 4);
        // Connections with a key count for its client, and no more for the address.
        let of = |client: &str| {
            let client = client.into();
            requests
                .iter()
                .filter(|request| request.authenticated(&client).is_ok())
                .count()
        };
        assert_eq!(of("portal"), 4);
        assert!(requests[15].count_for_address().is_ok());
        drop(requests);
        let request = ActiveRequest::begin(&all[0].connection, &limit);
        assert!(request.authenticated(&"portal".into()).is_ok());
    }

    #[tokio::test]
    async fn where_all_are_busy_the_reserve_admits_a_connection_which_waits_two_seconds_for_a_regular_place()
     {
        let limit = Connections::new(4);
        let mut all = Vec::new();
        for last in 1..=4 {
            all.push(enter(&limit, last).await);
        }
        let mut busy: Vec<_> = all
            .iter()
            .map(|at| ActiveRequest::begin(&at.connection, &limit))
            .collect();
        let late = enter(&limit, 9).await;
        let start = Instant::now();
        assert_eq!(
            limit.leave_reserve(&late.connection).await,
            Err(Overloaded::Connections)
        );
        assert!(start.elapsed() >= LONGEST_WAIT);
        // One that ends makes room.
        let leaving = limit.leave_reserve(&late.connection);
        busy.pop();
        drop(all.pop());
        assert!(leaving.await.is_ok());
        assert_eq!(limit.reserve.free.available_permits(), RESERVE);
    }
}
