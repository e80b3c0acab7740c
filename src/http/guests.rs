//! Connections that there are, and which of them goes when there is no room for a new one.

use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap};
use std::net::{IpAddr, Ipv6Addr};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, timeout};
use tokio_util::sync::CancellationToken;

use super::giving::Giving;
use super::taking::Taking;

/// A client that has given nothing of its request for so long counts as idle; so does one with a key that has taken nothing of its
/// answer, and one without a key at once.
const STALLED: Duration = Duration::from_secs(1);

/// Who has just come has so long to say who it is before it gives way to others, as long as one in [`NEWCOMERS`] is new.
const MOMENT: Duration = Duration::from_secs(1);
const NEWCOMERS: usize = 4;

/// A guest that was asked to leave has done so in this time, or a further one is asked.
const LEAVING: Duration = Duration::from_millis(50);

/// Where a client comes from. Who has one address of IPv6 has a network of them, so that they count as one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Origin(IpAddr);

impl From<IpAddr> for Origin {
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

/// What is known of a guest.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Standing {
    /// It has come at this time, and asked nothing.
    New(Instant),
    /// It has asked something, without a key that is known.
    Stranger,
    /// The last key on it that is known is this client's.
    Client(Arc<str>),
}

/// A connection.
#[derive(Debug)]
pub(super) struct Guest {
    pub(super) origin: Origin,
    standing: Mutex<Standing>,
    /// Requests that are being answered.
    busy: AtomicUsize,
    pub(super) giving: Arc<Giving>,
    pub(super) taking: Arc<Taking>,
    /// Comes when its place is needed.
    pub(super) leave: CancellationToken,
}

impl Guest {
    pub(super) fn from(origin: Origin) -> Self {
        Self {
            origin,
            standing: Mutex::new(Standing::New(Instant::now())),
            busy: AtomicUsize::new(0),
            giving: Arc::default(),
            taking: Arc::default(),
            leave: CancellationToken::new(),
        }
    }

    /// A request on it had a key of this client.
    pub(super) fn recognize(&self, client: &Arc<str>) {
        *self.standing() = Standing::Client(Arc::clone(client));
    }

    /// Whether nobody would miss it: no request is under way, or its client gives nothing of it, or takes nothing of the answer.
    pub(super) fn is_idle(&self, now: Instant) -> bool {
        let patience = match *self.standing() {
            Standing::Client(_) => STALLED,
            Standing::New(_) | Standing::Stranger => Duration::ZERO,
        };
        let longer =
            |stalled: Option<Duration>, than| stalled.is_some_and(|stalled| stalled >= than);
        !self.is_busy()
            || longer(self.giving.stalled_for(now), STALLED)
            || longer(self.taking.stalled_for(now), patience)
    }

    /// Whether a request is being answered, or its answer is not sent.
    pub(super) fn is_busy(&self) -> bool {
        self.busy.load(Ordering::Relaxed) > 0 || !self.taking.is_empty()
    }

    fn is_new(&self, now: Instant) -> bool {
        matches!(*self.standing(), Standing::New(since) if now.saturating_duration_since(since) < MOMENT)
    }

    /// With whom it is counted: the others of its client, or the strangers of its origin.
    fn company(&self) -> Company {
        match &*self.standing() {
            Standing::Client(client) => Company::Client(Arc::clone(client)),
            Standing::New(_) | Standing::Stranger => Company::Strangers(self.origin),
        }
    }

    fn standing(&self) -> MutexGuard<'_, Standing> {
        self.standing.lock().expect("nothing panics with this lock")
    }
}

/// Guests that give way together.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Company {
    Client(Arc<str>),
    Strangers(Origin),
}

/// Counts a request as long as it is being answered.
pub(super) struct Busy(Arc<Guest>);

impl Busy {
    pub(super) fn begin(guest: &Arc<Guest>) -> Self {
        guest.busy.fetch_add(1, Ordering::Relaxed);
        let mut standing = guest.standing();
        if let Standing::New(_) = *standing {
            *standing = Standing::Stranger;
        }
        drop(standing);
        Self(Arc::clone(guest))
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        // What was answered may not have left.
        self.0.taking.hand_over();
        self.0.busy.fetch_sub(1, Ordering::Relaxed);
    }
}

/// The connections that there are.
pub(super) struct Guests {
    most: usize,
    room: Arc<Semaphore>,
    present: Mutex<Present>,
}

#[derive(Default)]
struct Present {
    last: u64,
    /// By their order of arrival.
    guests: BTreeMap<u64, Arc<Guest>>,
}

impl Present {
    /// Of the idle guests, strangers first, of the origin that has most of them; then those of the client that has most. Of
    /// these, the one that came first.
    fn next_to_leave(&self, most: usize, now: Instant) -> Option<&Guest> {
        let mut sizes: HashMap<Company, usize> = HashMap::new();
        let mut newcomers = 0;
        for guest in self.guests.values() {
            *sizes.entry(guest.company()).or_default() += 1;
            newcomers += usize::from(guest.is_new(now));
        }
        let spares_newcomers = newcomers <= most / NEWCOMERS;
        let idle = self.guests.iter().filter(|(_, guest)| {
            guest.is_idle(now)
                && !guest.leave.is_cancelled()
                && !(spares_newcomers && guest.is_new(now))
        });
        let chosen = idle.max_by_key(|(number, guest)| {
            let company = guest.company();
            let is_stranger = matches!(company, Company::Strangers(_));
            (is_stranger, sizes.get(&company).copied(), Reverse(**number))
        });
        chosen.map(|(_, guest)| &**guest)
    }
}

impl Guests {
    pub(super) fn new(most: usize) -> Arc<Self> {
        let most = most.max(1);
        Arc::new(Self {
            most,
            room: Arc::new(Semaphore::new(most)),
            present: Mutex::default(),
        })
    }

    /// A place for a guest, once there is one. Where there is none, one that nobody would miss is asked to leave.
    pub(super) async fn place(self: &Arc<Self>, guest: Guest) -> Place {
        let mut permit = Arc::clone(&self.room).try_acquire_owned().ok();
        while permit.is_none() {
            self.send_one_away();
            let next = Arc::clone(&self.room).acquire_owned();
            // Everybody may have been busy; then it is worth looking again.
            permit = timeout(LEAVING, next).await.ok().and_then(Result::ok);
        }
        let guest = Arc::new(guest);
        let mut present = self.present();
        present.last += 1;
        let number = present.last;
        present.guests.insert(number, Arc::clone(&guest));
        drop(present);
        metrics::gauge!("meshwright_connections").increment(1.0);
        Place {
            guests: Arc::clone(self),
            number,
            guest,
            _permit: permit,
        }
    }

    /// Asks one of the idle guests to leave.
    pub(super) fn send_one_away(&self) {
        if let Some(guest) = self.present().next_to_leave(self.most, Instant::now()) {
            guest.leave.cancel();
            metrics::counter!("meshwright_connections_evicted_total").increment(1);
        }
    }

    fn present(&self) -> MutexGuard<'_, Present> {
        self.present.lock().expect("nothing panics with this lock")
    }
}

/// The place of a connection, free when it is dropped.
pub(super) struct Place {
    guests: Arc<Guests>,
    number: u64,
    pub(super) guest: Arc<Guest>,
    _permit: Option<OwnedSemaphorePermit>,
}

impl Drop for Place {
    fn drop(&mut self) {
        self.guests.present().guests.remove(&self.number);
        metrics::gauge!("meshwright_connections").decrement(1.0);
    }
}

#[cfg(test)]
mod tests {
    use std::io;
    use std::pin::Pin;

    use axum::body::Bytes;
    use futures_util::{poll, stream};
    use http_body::Body as _;

    use super::super::giving::Awaited;
    use super::*;

    fn origin(last: u8) -> Origin {
        Origin::from(IpAddr::from([127, 0, 0, last]))
    }

    async fn enter(guests: &Arc<Guests>, last: u8) -> Place {
        guests.place(Guest::from(origin(last))).await
    }

    fn number(places: &[Place], guest: &Guest) -> Option<usize> {
        places.iter().position(|at| std::ptr::eq(&*at.guest, guest))
    }

    /// The order in which these leave, by their numbers, if all of that is asked at this time.
    fn order(guests: &Guests, places: &[Place], now: Instant) -> Vec<usize> {
        let present = guests.present();
        let next = || present.next_to_leave(guests.most, now);
        let leaving = std::iter::from_fn(|| next().inspect(|guest| guest.leave.cancel()));
        leaving.filter_map(|guest| number(places, guest)).collect()
    }

    #[tokio::test]
    async fn strangers_leave_first_and_those_of_the_most_crowded_origin_before_others() {
        let guests = Guests::new(16);
        let mut places = Vec::new();
        for last in [1, 1, 2, 3, 3, 3] {
            places.push(enter(&guests, last).await);
        }
        places[0].guest.recognize(&"portal".into());
        let _at_work = Busy::begin(&places[3].guest);
        // Two of the third origin idle, then single ones by age; who has a key goes last, who is at work not at all.
        let order = order(&guests, &places, Instant::now() + MOMENT);
        assert_eq!(order, [4, 5, 1, 2, 0]);
    }

    #[tokio::test]
    async fn of_those_with_a_key_the_client_leaves_first_that_has_most_of_them_wherever_it_comes_from()
     {
        let guests = Guests::new(16);
        let mut places = Vec::new();
        for (last, client) in [
            (1, "other"),
            (1, "hog"),
            (2, "hog"),
            (3, "hog"),
            (3, "third"),
        ] {
            let place = enter(&guests, last).await;
            place.guest.recognize(&client.into());
            places.push(place);
        }
        let order = order(&guests, &places, Instant::now());
        assert_eq!(order, [1, 2, 3, 0, 4]);
    }

    #[tokio::test]
    async fn a_newcomer_has_a_moment_to_say_who_it_is_unless_too_many_are_new() {
        let guests = Guests::new(16);
        let mut places = Vec::new();
        for _ in 0..8 {
            let place = enter(&guests, 1).await;
            place.guest.recognize(&"hog".into());
            places.push(place);
        }
        let now = Instant::now();
        places.push(enter(&guests, 1).await);
        let first = |now| {
            let present = guests.present();
            let next = present.next_to_leave(guests.most, now).unwrap();
            number(&places, next)
        };
        assert_eq!(
            (first(now), first(Instant::now() + MOMENT)),
            (Some(0), Some(8))
        );
        places.truncate(8);
        for _ in 0..5 {
            places.push(enter(&guests, 1).await);
        }
        assert_eq!(order(&guests, &places, now)[..5], [8, 9, 10, 11, 12]);
    }

    #[tokio::test]
    async fn who_gives_nothing_of_its_request_is_idle_after_a_second() {
        let guests = Guests::new(1);
        let place = enter(&guests, 1).await;
        place.guest.recognize(&"hog".into());
        let _at_work = Busy::begin(&place.guest);
        let nothing = axum::body::Body::from_stream(stream::pending::<io::Result<Bytes>>());
        let mut body = Awaited::new(nothing, Arc::clone(&place.guest.giving));
        let start = Instant::now();
        let is_idle = |at| place.guest.is_idle(at);
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
    fn a_network_of_ipv6_is_one_origin_and_an_address_in_disguise_is_itself() {
        let origin = |text: &str| Origin::from(text.parse::<IpAddr>().unwrap());
        assert_eq!(origin("2001:db8:1:2::1"), origin("2001:db8:1:2:ffff::9"));
        assert_ne!(origin("2001:db8:1:2::1"), origin("2001:db8:1:3::1"));
        assert_eq!(origin("::ffff:10.0.0.1"), origin("10.0.0.1"));
        assert_ne!(origin("10.0.0.1"), origin("10.0.0.2"));
    }
}
