//! The messages on their way: signed as Standard Webhooks asks, tried again with growing patience, and never sent to an address that
//! is not public, whatever a name means by the time it is looked up.
//!
//! Each webhook has its own retries, and each client its share of the messages being sent. Receivers that hang delay only the client that named them. However
//! many clients name such receivers, receivers that answer have half of the places for themselves.

use std::collections::HashSet;
use std::sync::Arc;
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use hmac::{Hmac, KeyInit, Mac};
use hyper::{Request, StatusCode};
use meshwright_connections::{Budget, Part, spawn};
use meshwright_store::webhooks::{Attempt, Message, Refusal, Waiting};
use reqwest::Body;
use reqwest::Url;
use sha2::Sha256;
use tokio::task::{JoinHandle, JoinSet};
use tokio::time::sleep;
use tracing::{info, warn};
use uuid::Uuid;

use super::hooks::Webhooks;
use super::send::Sender;
use crate::jobs::StoreError;

/// Maximum number of messages being sent at the same time, of one client, and to one webhook.
const AT_ONCE: u64 = 32;
const OF_CLIENT: u64 = 8;
const TO_WEBHOOK: u64 = 4;

/// Maximum number of messages, and of one client, to webhooks that may hang: their last message did not arrive, or this process has sent none. Such a webhook
/// is tried with one message.
const DOUBTFUL: u64 = 16;
const DOUBTFUL_OF_CLIENT: u64 = 2;

/// Number of webhooks that are remembered as answering; beyond it all of them count as unknown again.
const MOST_REMEMBERED: usize = 10_000;

/// Without any news the messages are looked at so often.
const QUIET: Duration = Duration::from_secs(30);

/// The task that delivers.
pub struct Deliveries(JoinHandle<()>);

impl Deliveries {
    /// Starts to deliver, until the jobs' stop comes. Without hosts to send to, nothing is done. One attempt has `time`.
    ///
    /// # Errors
    ///
    /// When there is no encryption to be had.
    pub fn start(webhooks: Webhooks, time: Duration) -> Result<Self, rustls::Error> {
        if webhooks.rules.allowed.is_empty() {
            return Ok(Self(spawn(async {})));
        }
        let courier = Courier {
            sender: Sender::to(&webhooks.rules.reachable, time)?,
            webhooks,
        };
        Ok(Self(spawn(Arc::new(courier).work())))
    }

    /// Comes back when the last attempt has ended.
    pub async fn ended(self) {
        // The task neither panics nor is aborted.
        let _ = self.0.await;
    }
}

struct Courier {
    webhooks: Webhooks,
    sender: Sender,
}

/// The places of messages under way, and which webhooks answer.
#[derive(Debug)]
struct Places {
    /// By client.
    all: Budget,
    /// Of these, those of webhooks that may hang.
    doubtful: Budget,
    /// By webhook.
    to_webhook: Budget,
    /// The webhooks whose last message arrived.
    answering: HashSet<Uuid>,
}

/// Resources of one message being sent.
type Held = Vec<Part>;

impl Places {
    fn new() -> Self {
        Self {
            all: Budget::limited(AT_ONCE, OF_CLIENT),
            doubtful: Budget::limited(DOUBTFUL, DOUBTFUL_OF_CLIENT),
            to_webhook: Budget::limited(AT_ONCE, TO_WEBHOOK),
            answering: HashSet::new(),
        }
    }

    /// The places for one more message to `webhook`; none where it has to wait.
    fn take(&self, webhook: &Waiting) -> Option<Held> {
        let id = webhook.webhook.to_string();
        let is_doubtful = webhook.is_failing || !self.answering.contains(&webhook.webhook);
        if is_doubtful && self.to_webhook.held(&id) > 0 {
            return None;
        }
        let mut held = vec![
            self.to_webhook.try_take(&id, 1)?,
            self.all.try_take(&webhook.client, 1)?,
        ];
        if is_doubtful {
            held.push(self.doubtful.try_take(&webhook.client, 1)?);
        }
        Some(held)
    }

    /// The places for messages that may begin now: one after the other to the client that has the fewest under way.
    fn shares<'a>(&self, waiting: &'a [Waiting]) -> Vec<(&'a Waiting, Vec<Held>)> {
        let ready = waiting.iter().filter(|webhook| webhook.patience.is_zero());
        let mut open: Vec<_> = ready.map(|webhook| (webhook, Vec::new())).collect();
        let mut shares = Vec::new();
        let under_way = |(webhook, _): &(&Waiting, _)| {
            let to = self.to_webhook.held(&webhook.webhook.to_string());
            (self.all.held(&webhook.client), to)
        };
        while let Some(next) = (0..open.len()).min_by_key(|at| under_way(&open[*at])) {
            match self.take(open[next].0) {
                Some(held) => open[next].1.push(held),
                // The number of messages being sent only grows meanwhile.
                None => shares.push(open.remove(next)),
            }
        }
        shares.retain(|(_, held)| !held.is_empty());
        shares
    }

    /// Records the outcome of the last message to `webhook`.
    fn note(&mut self, webhook: Uuid, has_arrived: bool) {
        if !has_arrived {
            self.answering.remove(&webhook);
            return;
        }
        if self.answering.len() >= MOST_REMEMBERED {
            self.answering.clear();
        }
        self.answering.insert(webhook);
    }
}

impl Courier {
    async fn work(self: Arc<Self>) {
        let jobs = &self.webhooks.jobs;
        let stop = jobs.stop().clone();
        let mut changes = jobs.changes();
        let mut places = Places::new();
        let mut attempts = JoinSet::new();
        if let Err(error) = jobs.store().give_back_messages().await {
            warn!(%error, "messages that were under way wait for a while");
        }
        while !stop.is_cancelled() {
            let wait = match self.begin(&places, &mut attempts).await {
                Ok(wait) => wait,
                Err(error) => {
                    warn!(%error, "messages cannot be read");
                    jobs.wait_for_storage().await;
                    QUIET
                }
            };
            tokio::select! {
                Some(ended) = attempts.join_next() => {
                    // An attempt neither panics nor is aborted before the end of all.
                    if let Ok((webhook, has_arrived)) = ended {
                        places.note(webhook, has_arrived);
                    }
                }
                () = changes.end() => {}
                () = jobs.mail().notified() => {}
                () = sleep(wait) => {}
                () = stop.cancelled() => {}
            }
        }
        // An attempt that a shutdown interrupts is repeated by the next process; the receiver knows it by its id.
        attempts.shutdown().await;
    }

    /// Starts all messages that may start. Returns the time to wait if nothing happens.
    async fn begin(
        self: &Arc<Self>,
        places: &Places,
        attempts: &mut JoinSet<(Uuid, bool)>,
    ) -> Result<Duration, StoreError> {
        let (store, clock) = (self.webhooks.jobs.store(), self.webhooks.jobs.clock());
        loop {
            let waiting = store.waiting_webhooks(clock.steady()).await?;
            let mut begun = false;
            for (webhook, held) in places.shares(&waiting) {
                let messages = store
                    .take_messages(webhook.webhook, held.len(), clock.steady())
                    .await?;
                begun |= !messages.is_empty();
                for (message, held) in messages.into_iter().zip(held) {
                    let courier = Arc::clone(self);
                    attempts.spawn(async move {
                        let has_arrived = courier.attempt(&message).await;
                        drop(held);
                        (message.webhook, has_arrived)
                    });
                }
            }
            // Another webhook may have the place that one did not use.
            if !begun {
                let patience = waiting.iter().filter_map(|webhook| {
                    let patience = webhook.patience;
                    Duration::try_from(patience)
                        .ok()
                        .filter(|_| patience.is_positive())
                });
                let next = patience.min().unwrap_or(QUIET);
                return Ok(next.clamp(Duration::from_millis(10), QUIET));
            }
        }
    }

    /// Sends a message, and writes the outcome. True if it has arrived.
    async fn attempt(&self, message: &Message) -> bool {
        let attempt = self.send(message).await;
        let result = match &attempt.refusal {
            None => "arrived",
            Some(Refusal::Again(_)) => "refused",
            Some(Refusal::Never(_)) => "given_up",
        };
        metrics::counter!("meshwright_webhook_attempts_total", "result" => result).increment(1);
        let (store, clock) = (self.webhooks.jobs.store(), self.webhooks.jobs.clock());
        let noted = store.attempted(message, &attempt, clock.steady(), clock.now());
        match noted.await {
            Ok(true) => info!(webhook = %message.webhook, "a webhook is given up"),
            Ok(false) => {}
            Err(error) => {
                warn!(message = %message.id, %error, "the fate of a message cannot be written; it is sent again");
                self.webhooks.jobs.wait_for_storage().await;
            }
        }
        attempt.refusal.is_none()
    }

    async fn send(&self, message: &Message) -> Attempt {
        // The list may be another one than when the webhook was made.
        if let Err(why) = self.webhooks.rules.check(&message.url) {
            return unanswered(Refusal::Again(why));
        }
        let timestamp = self.webhooks.jobs.clock().now().as_second();
        let id = message.id.to_string();
        let Some(signature) = signatures(&message.secrets, &id, timestamp, &message.body) else {
            return unanswered(Refusal::Never("its secret is damaged".to_owned()));
        };
        // As the list has read it, and without the part that is the client's own.
        let address = Url::parse(&message.url).map(|mut url| {
            url.set_fragment(None);
            url
        });
        let request = address.ok().and_then(|address| {
            let request = Request::post(address.as_str())
                .header("content-type", "application/json")
                .header("webhook-id", &id)
                .header("webhook-timestamp", timestamp)
                .header("webhook-signature", signature);
            request.body(Body::from(message.body.clone())).ok()
        });
        let Some(request) = request else {
            let why = "its address is not one that can be sent to";
            return unanswered(Refusal::Again(why.to_owned()));
        };
        match self.sender.send(request).await {
            Ok(status) => answered(status),
            Err(why) => unanswered(Refusal::Again(why)),
        }
    }
}

/// There was no answer.
fn unanswered(refusal: Refusal) -> Attempt {
    Attempt {
        answered: None,
        refusal: Some(refusal),
    }
}

fn answered(status: StatusCode) -> Attempt {
    let code = status.as_u16();
    let refusal = match status {
        status if status.is_success() => None,
        // Standard Webhooks: the receiver wants no more.
        StatusCode::GONE => Some(Refusal::Never("it answered 410".to_owned())),
        _ => Some(Refusal::Again(format!("it answered {code}"))),
    };
    Attempt {
        answered: Some(code),
        refusal,
    }
}

/// The signatures of a message, one by each secret. None by a secret that is none: anybody could forge that.
fn signatures(secrets: &[String], id: &str, timestamp: i64, body: &str) -> Option<String> {
    let signatures = secrets
        .iter()
        .map(|secret| signature(secret, id, timestamp, body));
    let signatures: Option<Vec<String>> = signatures.collect();
    Some(signatures?.join(" "))
}

/// The signature of a message: HMAC-SHA-256 of id, time and body.
fn signature(secret: &str, id: &str, timestamp: i64, body: &str) -> Option<String> {
    let key = BASE64.decode(secret).ok().filter(|key| !key.is_empty())?;
    let mut mac = Hmac::<Sha256>::new_from_slice(&key).expect("a key of any length will do");
    mac.update(format!("{id}.{timestamp}.{body}").as_bytes());
    Some(format!("v1,{}", BASE64.encode(mac.finalize().into_bytes())))
}

#[cfg(test)]
mod tests {
    use jiff::SignedDuration;

    use super::*;

    #[test]
    fn the_signature_is_that_of_the_standard() {
        // The example of the specification (standard-webhooks, "Signature scheme"), as its reference libraries test it.
        let signed = signature(
            "MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw",
            "msg_p5jXN8AQM9LWM0D4loKWxJek",
            1_614_265_330,
            r#"{"test": 2432232314}"#,
        );
        let expected = "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=";
        assert_eq!(signed.as_deref(), Some(expected));
        assert_eq!(signature("", "id", 0, "body"), None);
    }

    fn waiting(client: &str, count: u128, is_failing: bool) -> Vec<Waiting> {
        let webhook = |i| Waiting {
            webhook: Uuid::from_u128(i + client.len() as u128 * 1000),
            client: client.to_owned(),
            is_failing,
            patience: SignedDuration::ZERO,
        };
        (0..count).map(webhook).collect()
    }

    fn of(client: &str, shares: &[(&Waiting, Vec<Held>)]) -> u64 {
        let own = shares
            .iter()
            .filter(|(webhook, _)| webhook.client == client);
        own.map(|(_, held)| held.len() as u64).sum()
    }

    /// Places where all of these have answered before.
    fn answered<'a>(waiting: impl IntoIterator<Item = &'a Waiting>) -> Places {
        let mut places = Places::new();
        for webhook in waiting {
            places.note(webhook.webhook, true);
        }
        places
    }

    #[test]
    fn no_client_has_more_under_way_than_its_part_and_no_webhook_more_than_its_own() {
        let mut all = waiting("a", 16, false);
        all.extend(waiting("bb", 1, false));
        let places = answered(&all);
        let mut shares = places.shares(&all);
        assert_eq!(
            (of("a", &shares), of("bb", &shares)),
            (OF_CLIENT, TO_WEBHOOK)
        );
        // Whose webhooks hang waits for them; others do not.
        shares.retain(|(webhook, _)| webhook.client == "a");
        let more = places.shares(&all);
        assert_eq!((of("a", &more), of("bb", &more)), (0, TO_WEBHOOK));
    }

    #[test]
    fn webhooks_that_may_hang_leave_half_of_the_places_to_those_that_answer() {
        let names: Vec<String> = (1..=12).map(|length| "h".repeat(length)).collect();
        let hanging: Vec<Waiting> = (0..)
            .zip(&names)
            .flat_map(|(i, name)| waiting(name, 16, i % 2 == 0))
            .collect();
        let answers = waiting("answers, always", 4, false);
        let mut places = answered(&answers);
        let held = places.shares(&hanging);
        // Each with one message, whether it has failed or was never tried.
        assert!(held.iter().all(|(_, share)| share.len() == 1));
        assert_eq!(held.len() as u64, DOUBTFUL);
        assert!(
            names
                .iter()
                .all(|name| of(name, &held) <= DOUBTFUL_OF_CLIENT)
        );
        assert!(places.shares(&hanging).is_empty());
        assert_eq!(of("answers, always", &places.shares(&answers)), OF_CLIENT);
        // A webhook that has answered counts as answering until it fails.
        let first = &hanging[31..32];
        places.note(first[0].webhook, true);
        assert_eq!(of("hh", &places.shares(first)), TO_WEBHOOK);
        places.note(first[0].webhook, false);
        assert!(places.shares(first).is_empty());
    }

    #[test]
    fn five_clients_whose_webhooks_hang_keep_nobody_from_a_first_message() {
        let names = ["a", "bb", "ccc", "dddd", "eeeee"];
        let hanging: Vec<_> = names
            .into_iter()
            .flat_map(|name| waiting(name, 16, false))
            .collect();
        let places = Places::new();
        let _held = places.shares(&hanging);
        let new = waiting("somebody else", 1, false);
        assert_eq!(of("somebody else", &places.shares(&new)), 1);
    }

    #[test]
    fn the_last_places_go_to_who_has_the_fewest_under_way() {
        let names = ["a", "bb", "ccc", "dddd"];
        let mut all = waiting("dddd", 2, false);
        all.extend(waiting("eeeee", 2, false));
        let places = answered(&all);
        let mut held = Vec::new();
        for (name, count) in names.into_iter().zip([8, 8, 8, 6]) {
            held.extend((0..count).map(|_| places.all.try_take(name, 1).unwrap()));
        }
        let shares = places.shares(&all);
        assert_eq!((of("dddd", &shares), of("eeeee", &shares)), (0, 2));
    }

    #[test]
    fn a_webhook_that_fails_is_tried_with_one_message_when_its_time_has_come() {
        let mut all = waiting("a", 2, true);
        all[1].patience = SignedDuration::from_secs(5);
        let places = Places::new();
        let shares = places.shares(&all);
        assert_eq!(shares.len(), 1);
        assert_eq!((shares[0].0, shares[0].1.len()), (&all[0], 1));
    }
}
