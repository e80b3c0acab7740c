//! Something of which there is a fixed amount, and which clients share: memory, threads, connections, messages under way. Every limit
//! of this program by client is one of these.
//!
//! Who holds least gets the next part, so that a client who asks for everything at once keeps nobody waiting for longer than one
//! of its parts lasts. A part that does not fit yet lets smaller ones of others who hold no more pass, until they come to as much as
//! itself: then it is waited for, because they would keep it waiting for ever.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use tokio::sync::oneshot;

/// The budget; cloning shares it.
#[derive(Debug, Clone)]
pub struct Budget(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    most: u64,
    /// One client holds no more than this.
    most_of_client: u64,
    /// True if a client that holds some gets at most as much as it leaves.
    leaves_as_much: bool,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    free: u64,
    held: HashMap<Arc<str>, u64>,
    /// Waiting clients, by their order of arrival.
    waiting: BTreeMap<u64, Waiting>,
    arrived: u64,
}

#[derive(Debug)]
struct Waiting {
    client: Arc<str>,
    amount: u64,
    /// Amount that may still pass it.
    yields: u64,
    answer: oneshot::Sender<Part>,
}

/// A part of a budget, which is free again when this is dropped.
#[derive(Debug)]
pub struct Part {
    shared: Arc<Shared>,
    client: Arc<str>,
    amount: u64,
}

impl Budget {
    /// A budget of so much.
    pub fn of(most: u64) -> Self {
        Self::new(most, most, false)
    }

    /// A budget of which one client holds no more than `most_of_client`.
    pub fn limited(most: u64, most_of_client: u64) -> Self {
        Self::new(most, most_of_client, false)
    }

    /// A budget of which a client that has some gets at most as much as it leaves: for work that lasts as long as a client likes, or so long that nobody should
    /// wait for it. Whatever one client asks for, the next one finds something.
    pub fn leaving_as_much(most: u64) -> Self {
        Self::new(most, most, true)
    }

    fn new(most: u64, most_of_client: u64, leaves_as_much: bool) -> Self {
        Self(Arc::new(Shared {
            most,
            most_of_client,
            leaves_as_much,
            state: Mutex::new(State {
                free: most,
                held: HashMap::new(),
                waiting: BTreeMap::new(),
                arrived: 0,
            }),
        }))
    }

    /// A part for `client`, once there is one. A request for more than the whole gets all of it, when nobody else has any.
    pub async fn take(&self, client: &str, amount: u64) -> Part {
        let (_place, part) = self.queue(client, amount);
        part.await.expect("who waits is answered")
    }

    /// A part for `client`, if it need not wait for it.
    pub fn try_take(&self, client: &str, amount: u64) -> Option<Part> {
        let (_place, mut part) = self.queue(client, amount);
        part.try_recv().ok()
    }

    /// The same for a thread that has nothing else to do; `None` when it is not wanted any more.
    pub fn take_on_thread(
        &self,
        client: &str,
        amount: u64,
        is_wanted: impl Fn() -> bool,
    ) -> Option<Part> {
        /// A waiter that is stopped ends in this time.
        const BETWEEN_LOOKS: Duration = Duration::from_millis(10);
        let (_place, mut part) = self.queue(client, amount);
        loop {
            if let Ok(part) = part.try_recv() {
                return Some(part);
            }
            if !is_wanted() {
                return None;
            }
            std::thread::sleep(BETWEEN_LOOKS);
        }
    }

    /// Waits for a part: a place in the queue, and the channel of the answer.
    fn queue(&self, client: &str, amount: u64) -> (Queued, oneshot::Receiver<Part>) {
        let (answer, part) = oneshot::channel();
        let amount = amount.min(self.0.most).min(self.0.most_of_client);
        let mut state = self.0.state();
        state.arrived += 1;
        let number = state.arrived;
        let waiting = Waiting {
            client: client.into(),
            amount,
            yields: amount,
            answer,
        };
        state.waiting.insert(number, waiting);
        drop(state);
        Shared::grant(&self.0);
        let shared = Arc::clone(&self.0);
        (Queued { shared, number }, part)
    }

    /// How much there is in all.
    pub fn most(&self) -> u64 {
        self.0.most
    }

    /// How much `client` holds.
    pub fn held(&self, client: &str) -> u64 {
        self.0.state().held.get(client).copied().unwrap_or_default()
    }

    /// How much nobody holds.
    pub fn free(&self) -> u64 {
        self.0.state().free
    }

    /// How many wait.
    pub fn waiting(&self) -> usize {
        self.0.state().waiting.len()
    }
}

/// A place among those who wait: who gives up waiting keeps nobody else from his part.
struct Queued {
    shared: Arc<Shared>,
    number: u64,
}

impl Drop for Queued {
    fn drop(&mut self) {
        if self.shared.state().waiting.remove(&self.number).is_some() {
            Shared::grant(&self.shared);
        }
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().expect("nothing panics with this lock")
    }

    /// Gives parts to those whose turn it is, as long as there are any.
    fn grant(this: &Arc<Self>) {
        let mut granted = Vec::new();
        {
            let mut state = this.state();
            while let Some((waiting, part)) = state.next(this) {
                granted.push((waiting, part));
            }
        }
        // Not under the lock: who has given up waiting gives the part back at once.
        for (answer, part) in granted {
            let _ = answer.send(part);
        }
    }
}

impl State {
    /// Whose turn it is, and his part, if it is free.
    fn next(&mut self, shared: &Arc<Shared>) -> Option<(oneshot::Sender<Part>, Part)> {
        let held = |waiting: &Waiting| self.held.get(&waiting.client).copied().unwrap_or_default();
        let fits = |waiting: &Waiting| {
            let Some(left) = self.free.checked_sub(waiting.amount) else {
                return false;
            };
            let held = held(waiting);
            held + waiting.amount <= shared.most_of_client
                && (!shared.leaves_as_much || held == 0 || held + waiting.amount <= left)
        };
        let first = self
            .waiting
            .iter()
            .min_by_key(|(number, waiting)| (held(waiting), **number));
        let (&first, head) = first?;
        let number = if fits(head) {
            first
        } else {
            let mut others = self.waiting.iter();
            let (&number, passing) = others.find(|(_, waiting)| {
                held(waiting) == held(head) && waiting.amount <= head.yields && fits(waiting)
            })?;
            let amount = passing.amount;
            self.waiting.get_mut(&first)?.yields -= amount;
            number
        };
        let waiting = self.waiting.remove(&number)?;
        let (client, amount) = (waiting.client, waiting.amount);
        self.free -= amount;
        *self.held.entry(Arc::clone(&client)).or_default() += amount;
        let part = Part {
            shared: Arc::clone(shared),
            client,
            amount,
        };
        Some((waiting.answer, part))
    }
}

impl Part {
    /// Gives back all but `amount` of it.
    pub fn shrink(&mut self, amount: u64) {
        let back = self.amount.saturating_sub(amount);
        {
            let mut state = self.shared.state();
            state.free += back;
            if let Some(held) = state.held.get_mut(&self.client) {
                *held -= back;
                if *held == 0 {
                    state.held.remove(&self.client);
                }
            }
        }
        self.amount -= back;
        Shared::grant(&self.shared);
    }
}

impl Drop for Part {
    fn drop(&mut self) {
        self.shrink(0);
    }
}

#[cfg(test)]
mod tests {
    use std::pin::pin;
    use std::task::Poll;

    use futures_util::poll;

    use super::*;

    #[tokio::test]
    async fn who_holds_least_is_next_however_many_others_wait() {
        let budget = Budget::of(2);
        let first = budget.take("hog", 1).await;
        let _second = budget.take("hog", 1).await;
        let mut hogs: Vec<_> = (0..40).map(|_| Box::pin(budget.take("hog", 1))).collect();
        for hog in &mut hogs {
            assert!(poll!(hog).is_pending());
        }
        let mut other = pin!(budget.take("other", 1));
        assert!(poll!(&mut other).is_pending());
        drop(first);
        assert!(poll!(&mut hogs[0]).is_pending());
        assert!(poll!(&mut other).is_ready());
    }

    #[tokio::test]
    async fn a_large_part_lets_small_ones_pass_but_not_for_ever() {
        let budget = Budget::of(10);
        let (one, two) = (budget.take("a", 5).await, budget.take("b", 5).await);
        let mut large = pin!(budget.take("c", 8));
        assert!(poll!(&mut large).is_pending());
        drop(one);
        for _ in 0..2 {
            let Poll::Ready(_) = poll!(pin!(budget.take("d", 4))) else {
                panic!("it fits, and no more than the large one has passed");
            };
        }
        let mut small = pin!(budget.take("d", 1));
        assert!(poll!(&mut small).is_pending() && poll!(&mut large).is_pending());
        drop(two);
        assert!(poll!(&mut large).is_ready());
    }

    #[tokio::test]
    async fn who_holds_more_passes_nobody() {
        let budget = Budget::of(10);
        let _held = budget.take("hog", 5).await;
        let mut large = pin!(budget.take("other", 8));
        let mut small = pin!(budget.take("hog", 1));
        assert!(poll!(&mut large).is_pending() && poll!(&mut small).is_pending());
    }

    #[tokio::test]
    async fn what_leaves_as_much_has_something_for_the_next_client_whatever_one_asks_for() {
        let budget = Budget::leaving_as_much(4);
        let first = budget.take("hog", 1).await;
        let _second = budget.take("hog", 1).await;
        let mut third = pin!(budget.take("hog", 1));
        assert!(poll!(&mut third).is_pending());
        let mut other = pin!(budget.take("other", 1));
        let other = poll!(&mut other);
        assert!(other.is_ready());
        assert!(poll!(pin!(budget.take("somebody else", 1))).is_ready());
        drop((first, other));
        assert!(poll!(&mut third).is_ready());
    }

    #[tokio::test]
    async fn who_gives_up_waiting_keeps_nobody_waiting_and_nothing_is_lost() {
        let budget = Budget::of(10);
        let held = budget.take("a", 5).await;
        // Who holds more than the large one's client passes nobody.
        let other = budget.take("c", 1).await;
        let mut large = Box::pin(budget.take("b", 8));
        assert!(poll!(&mut large).is_pending());
        let mut small = pin!(budget.take("c", 4));
        assert!(poll!(&mut small).is_pending());
        drop(large);
        let Poll::Ready(small) = poll!(&mut small) else {
            panic!("its part is free");
        };
        // A part that was granted and never fetched is free as well.
        let mut unfetched = Box::pin(budget.take("d", 6));
        assert!(poll!(&mut unfetched).is_pending());
        drop((held, other));
        drop(unfetched);
        drop(small);
        assert_eq!((budget.free(), budget.waiting()), (10, 0));
    }

    #[test]
    fn one_client_holds_no_more_than_its_limit_and_what_it_gives_back_is_free_at_once() {
        let budget = Budget::limited(10, 4);
        let mut first = budget.try_take("hog", 3).unwrap();
        assert!(budget.try_take("hog", 2).is_none());
        assert!(budget.try_take("other", 4).is_some());
        first.shrink(1);
        assert_eq!((budget.held("hog"), budget.free()), (1, 9));
        assert!(budget.try_take("hog", 3).is_some());
        drop(first);
        assert_eq!((budget.held("hog"), budget.waiting()), (0, 0));
    }

    #[tokio::test]
    async fn more_than_there_is_means_all_of_it() {
        let budget = Budget::of(10);
        let all = budget.take("a", 1000).await;
        assert_eq!(budget.free(), 0);
        drop(all);
        assert_eq!(budget.free(), 10);
    }
}
