//! Connections that there are, and which of them goes when there is no room for a new one.

use std::collections::{BTreeMap, HashMap};
use std::net::{IpAddr, Ipv6Addr};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;
use tokio_util::sync::CancellationToken;

use super::taking::Taking;

/// A client with a key that has taken nothing of its answer for so long counts as idle; one without a key at once.
const STALLED: Duration = Duration::from_secs(1);

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

/// A connection.
#[derive(Debug)]
pub(super) struct Guest {
    pub(super) origin: Origin,
    /// Whether a request on it had a key that is known.
    recognized: AtomicBool,
    /// Requests that are being answered.
    busy: AtomicUsize,
    pub(super) taking: Arc<Taking>,
    /// Comes when its place is needed.
    pub(super) leave: CancellationToken,
}

impl Guest {
    pub(super) fn from(origin: Origin) -> Self {
        Self {
            origin,
            recognized: AtomicBool::new(false),
            busy: AtomicUsize::new(0),
            taking: Arc::default(),
            leave: CancellationToken::new(),
        }
    }

    /// A request on it had a key that is known.
    pub(super) fn recognize(&self) {
        self.recognized.store(true, Ordering::Relaxed);
    }

    /// Whether nobody would miss it: no request is under way, or its client takes nothing of the answer.
    pub(super) fn is_idle(&self) -> bool {
        let patience = if self.is_stranger() {
            Duration::ZERO
        } else {
            STALLED
        };
        let stalled = self.taking.stalled_for();
        !self.is_busy() || stalled.is_some_and(|since| since >= patience)
    }

    /// Whether a request is being answered, or its answer is not sent.
    pub(super) fn is_busy(&self) -> bool {
        self.busy.load(Ordering::Relaxed) > 0 || !self.taking.is_empty()
    }

    fn is_stranger(&self) -> bool {
        !self.recognized.load(Ordering::Relaxed)
    }
}

/// Counts a request as long as it is being answered.
pub(super) struct Busy(Arc<Guest>);

impl Busy {
    pub(super) fn begin(guest: &Arc<Guest>) -> Self {
        guest.busy.fetch_add(1, Ordering::Relaxed);
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
    room: Arc<Semaphore>,
    present: Mutex<Present>,
}

#[derive(Default)]
struct Present {
    last: u64,
    /// By their order of arrival.
    guests: BTreeMap<u64, Arc<Guest>>,
}

impl Guests {
    pub(super) fn new(most: usize) -> Arc<Self> {
        Arc::new(Self {
            room: Arc::new(Semaphore::new(most.max(1))),
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

    /// Asks one of the idle guests to leave: strangers first, of the origin that has most of them, and the one that came first.
    pub(super) fn send_one_away(&self) {
        let present = self.present();
        let mut of_origin: HashMap<Origin, usize> = HashMap::new();
        for guest in present.guests.values().filter(|guest| guest.is_stranger()) {
            *of_origin.entry(guest.origin).or_default() += 1;
        }
        let idle = present
            .guests
            .iter()
            .filter(|(_, guest)| guest.is_idle() && !guest.leave.is_cancelled());
        let chosen = idle.max_by_key(|(number, guest)| {
            let strangers = of_origin.get(&guest.origin).filter(|_| guest.is_stranger());
            (strangers.copied(), std::cmp::Reverse(**number))
        });
        if let Some((_, guest)) = chosen {
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
    use super::*;

    fn origin(last: u8) -> Origin {
        Origin::from(IpAddr::from([127, 0, 0, last]))
    }

    async fn enter(guests: &Arc<Guests>, last: u8) -> Place {
        guests.place(Guest::from(origin(last))).await
    }

    /// Who of these leaves next, by its number.
    fn next(guests: &Guests, places: &[Place]) -> Option<usize> {
        let before: Vec<bool> = places
            .iter()
            .map(|at| at.guest.leave.is_cancelled())
            .collect();
        guests.send_one_away();
        (0..places.len()).find(|at| places[*at].guest.leave.is_cancelled() && !before[*at])
    }

    #[tokio::test]
    async fn strangers_leave_first_and_those_of_the_most_crowded_origin_before_others() {
        let guests = Guests::new(16);
        let mut places = Vec::new();
        for last in [1, 1, 2, 3, 3, 3] {
            places.push(enter(&guests, last).await);
        }
        places[0].guest.recognize();
        let _at_work = Busy::begin(&places[3].guest);
        let order: Vec<_> = std::iter::from_fn(|| next(&guests, &places)).collect();
        // Two of the third origin idle, then single ones by age; who has a key goes last, who is at work not at all.
        assert_eq!(order, [4, 5, 1, 2, 0]);
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
