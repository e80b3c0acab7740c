//! The messages on their way: signed as Standard Webhooks asks, tried again with growing patience, and never sent to an address that
//! is not public, whatever a name means by the time it is looked up.
//!
//! Each webhook is patient by itself, and each client has its share of what is under way, so that receivers that hang keep nobody
//! waiting but who named them. However many clients name such receivers, those that answer have half of the places for themselves.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::net::IpAddr;
use std::sync::Arc;
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use hmac::{Hmac, KeyInit, Mac};
use reqwest::dns::{Addrs, Name, Resolve, Resolving};
use reqwest::{Client, StatusCode};
use sha2::Sha256;
use tokio::task::{JoinHandle, JoinSet};
use tokio::time::sleep;
use tracing::{info, warn};
use uuid::Uuid;

use super::addresses::HookRules;
use super::store::{Attempt, Message, Refusal, Waiting, Webhooks};
use crate::client::{bounded, told};
use crate::jobs::StoreError;

/// One attempt takes so long at most.
const TIME_OUT: Duration = Duration::from_secs(10);

/// So many messages are on their way at the same time, so many of them of one client, and so many to one webhook.
const AT_ONCE: usize = 32;
const OF_CLIENT: usize = 8;
const TO_WEBHOOK: usize = 4;

/// So many of these, and so many of them of one client, go to webhooks that may hang: their last message did not arrive, or none was
/// sent by this process. Such a one is tried with one message.
const DOUBTFUL: usize = 16;
const DOUBTFUL_OF_CLIENT: usize = 2;

/// So many webhooks that answer are remembered before all of them are in doubt again.
const MOST_REMEMBERED: usize = 10_000;

/// Without any news the messages are looked at so often.
const QUIET: Duration = Duration::from_secs(30);

/// The task that delivers.
pub struct Deliveries(JoinHandle<()>);

impl Deliveries {
    /// Starts to deliver, until the jobs' stop comes. Without hosts to send to, nothing is done.
    ///
    /// # Errors
    ///
    /// When there is no encryption to be had.
    pub fn start(webhooks: Webhooks) -> Result<Self, reqwest::Error> {
        if webhooks.rules.allowed.is_empty() {
            return Ok(Self(tokio::spawn(async {})));
        }
        let courier = Courier {
            client: client(&webhooks.rules)?,
            webhooks,
        };
        Ok(Self(tokio::spawn(Arc::new(courier).work())))
    }

    /// Comes back when the last attempt has ended.
    pub async fn ended(self) {
        // It neither panics nor is aborted.
        let _ = self.0.await;
    }
}

fn client(rules: &HookRules) -> Result<Client, reqwest::Error> {
    bounded(TIME_OUT)
        .dns_resolver(Arc::new(PublicOnly(Arc::clone(&rules.reachable))))
        .build()
}

/// Looks names up, and keeps the addresses that may be connected to. The connection is made to one of these: nobody looks
/// the name up again.
struct PublicOnly(Arc<dyn Fn(IpAddr) -> bool + Send + Sync>);

impl Resolve for PublicOnly {
    fn resolve(&self, name: Name) -> Resolving {
        let reachable = Arc::clone(&self.0);
        Box::pin(async move {
            let found = tokio::net::lookup_host((name.as_str(), 0)).await?;
            let public: Vec<_> = found.filter(|address| reachable(address.ip())).collect();
            if public.is_empty() {
                return Err(format!("{} has no public address", name.as_str()).into());
            }
            Ok(Box::new(public.into_iter()) as Addrs)
        })
    }
}

struct Courier {
    webhooks: Webhooks,
    client: Client,
}

/// The messages under way: to each webhook so many, of this client.
#[derive(Debug, Default)]
struct UnderWay {
    to: BTreeMap<Uuid, (String, usize)>,
    /// The webhooks whose last message arrived.
    answering: HashSet<Uuid>,
}

/// How many of the places are taken.
#[derive(Debug, Clone, Copy, Default)]
struct Taken {
    all: usize,
    /// Of these, by webhooks that may hang.
    doubtful: usize,
}

impl Taken {
    fn add(&mut self, count: usize, is_doubtful: bool) {
        self.all += count;
        self.doubtful += if is_doubtful { count } else { 0 };
    }

    fn leaves_room(self, most: Self, is_doubtful: bool) -> bool {
        self.all < most.all && (!is_doubtful || self.doubtful < most.doubtful)
    }
}

const ALL_TOGETHER: Taken = Taken {
    all: AT_ONCE,
    doubtful: DOUBTFUL,
};

const ONE_CLIENT: Taken = Taken {
    all: OF_CLIENT,
    doubtful: DOUBTFUL_OF_CLIENT,
};

impl UnderWay {
    fn to(&self, webhook: Uuid) -> usize {
        self.to.get(&webhook).map_or(0, |(_, count)| *count)
    }

    fn is_doubtful(&self, webhook: &Waiting) -> bool {
        webhook.is_failing || !self.answering.contains(&webhook.webhook)
    }

    /// The places that are taken, in all and by each client.
    fn taken(&self) -> (Taken, HashMap<&str, Taken>) {
        let mut all = Taken::default();
        let mut of_client: HashMap<&str, Taken> = HashMap::new();
        for (webhook, (client, count)) in &self.to {
            let is_doubtful = !self.answering.contains(webhook);
            all.add(*count, is_doubtful);
            of_client
                .entry(client)
                .or_default()
                .add(*count, is_doubtful);
        }
        (all, of_client)
    }

    fn begin(&mut self, webhook: Uuid, client: &str, count: usize) {
        let entry = self.to.entry(webhook);
        entry.or_insert_with(|| (client.to_owned(), 0)).1 += count;
    }

    fn end(&mut self, webhook: Uuid, has_arrived: bool) {
        if has_arrived {
            if self.answering.len() >= MOST_REMEMBERED {
                self.answering.clear();
            }
            self.answering.insert(webhook);
        } else {
            self.answering.remove(&webhook);
        }
        if let Some((_, count)) = self.to.get_mut(&webhook) {
            *count -= 1;
            if *count == 0 {
                self.to.remove(&webhook);
            }
        }
    }

    /// How many messages to which of the webhooks may begin now: one after the other to the client that has the fewest under way.
    fn shares<'a>(&self, waiting: &'a [Waiting]) -> Vec<(&'a Waiting, usize)> {
        let (mut all, mut of_client) = self.taken();
        let mut shares: Vec<(&Waiting, usize)> = waiting
            .iter()
            .filter(|webhook| webhook.patience.is_zero())
            .map(|webhook| (webhook, 0))
            .collect();
        loop {
            let next = shares
                .iter_mut()
                .filter_map(|entry| {
                    let (webhook, share) = &*entry;
                    let is_doubtful = self.is_doubtful(webhook);
                    let most = if is_doubtful { 1 } else { TO_WEBHOOK };
                    let to = self.to(webhook.webhook) + *share;
                    let own = of_client.get(&*webhook.client).copied().unwrap_or_default();
                    let may = to < most
                        && all.leaves_room(ALL_TOGETHER, is_doubtful)
                        && own.leaves_room(ONE_CLIENT, is_doubtful);
                    may.then_some((own.all, to, is_doubtful, entry))
                })
                .min_by_key(|(own, to, ..)| (*own, *to));
            let Some((_, _, is_doubtful, (webhook, share))) = next else {
                break;
            };
            *share += 1;
            all.add(1, is_doubtful);
            of_client
                .entry(&webhook.client)
                .or_default()
                .add(1, is_doubtful);
        }
        shares.retain(|(_, share)| *share > 0);
        shares
    }
}

impl Courier {
    async fn work(self: Arc<Self>) {
        let jobs = &self.webhooks.jobs;
        let stop = jobs.stop().clone();
        let mut changes = jobs.changes();
        let mut under_way = UnderWay::default();
        let mut attempts = JoinSet::new();
        if let Err(error) = self.webhooks.give_back_all().await {
            warn!(%error, "messages that were under way wait for a while");
        }
        while !stop.is_cancelled() {
            let wait = match self.begin(&mut under_way, &mut attempts).await {
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
                        under_way.end(webhook, has_arrived);
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

    /// Begins what may begin. Gives back how long to wait if nothing happens.
    async fn begin(
        self: &Arc<Self>,
        under_way: &mut UnderWay,
        attempts: &mut JoinSet<(Uuid, bool)>,
    ) -> Result<Duration, StoreError> {
        loop {
            let waiting = self.webhooks.waiting().await?;
            let mut begun = false;
            for (webhook, share) in under_way.shares(&waiting) {
                let messages = self.webhooks.take(webhook.webhook, share).await?;
                begun |= !messages.is_empty();
                under_way.begin(webhook.webhook, &webhook.client, messages.len());
                for message in messages {
                    let courier = Arc::clone(self);
                    attempts.spawn(async move {
                        let has_arrived = courier.attempt(&message).await;
                        (message.webhook, has_arrived)
                    });
                }
            }
            // What one had no use for another one may have.
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

    /// Sends a message, and writes down what came of it. True if it has arrived.
    async fn attempt(&self, message: &Message) -> bool {
        let attempt = self.send(message).await;
        let result = match &attempt.refusal {
            None => "arrived",
            Some(Refusal::Again(_)) => "refused",
            Some(Refusal::Never(_)) => "given_up",
        };
        metrics::counter!("meshwright_webhook_attempts_total", "result" => result).increment(1);
        match self.webhooks.attempted(message, &attempt).await {
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
            return Attempt::not(Refusal::Again(why));
        }
        let timestamp = self.webhooks.jobs.clock().now().as_second();
        let id = message.id.to_string();
        let Some(signature) = signatures(&message.secrets, &id, timestamp, &message.body) else {
            return Attempt::not(Refusal::Never("its secret is damaged".to_owned()));
        };
        let request = self
            .client
            .post(&message.url)
            .header("content-type", "application/json")
            .header("webhook-id", &id)
            .header("webhook-timestamp", timestamp)
            .header("webhook-signature", signature)
            .body(message.body.clone());
        match request.send().await {
            Ok(answer) => Attempt::answered(answer.status()),
            Err(error) => Attempt::not(Refusal::Again(told(&error, TIME_OUT))),
        }
    }
}

impl Attempt {
    /// There was no answer.
    fn not(refusal: Refusal) -> Self {
        Self {
            answered: None,
            refusal: Some(refusal),
        }
    }

    fn answered(status: StatusCode) -> Self {
        let code = status.as_u16();
        let refusal = match status {
            status if status.is_success() => None,
            // Standard Webhooks: the receiver wants no more.
            StatusCode::GONE => Some(Refusal::Never("it answered 410".to_owned())),
            _ => Some(Refusal::Again(format!("it answered {code}"))),
        };
        Self {
            answered: Some(code),
            refusal,
        }
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

    fn of(client: &str, shares: &[(&Waiting, usize)]) -> usize {
        let own = shares
            .iter()
            .filter(|(webhook, _)| webhook.client == client);
        own.map(|(_, share)| share).sum()
    }

    /// What is under way when all of these have answered before.
    fn answered<'a>(waiting: impl IntoIterator<Item = &'a Waiting>) -> UnderWay {
        let answering = waiting.into_iter().map(|webhook| webhook.webhook);
        UnderWay {
            answering: answering.collect(),
            ..UnderWay::default()
        }
    }

    fn begin(under_way: &mut UnderWay, shares: &[(&Waiting, usize)]) {
        for (webhook, share) in shares {
            under_way.begin(webhook.webhook, &webhook.client, *share);
        }
    }

    #[test]
    fn no_client_has_more_under_way_than_its_part_and_no_webhook_more_than_its_own() {
        let mut all = waiting("a", 16, false);
        all.extend(waiting("bb", 1, false));
        let mut under_way = answered(&all);
        let mut shares = under_way.shares(&all);
        assert_eq!(
            (of("a", &shares), of("bb", &shares)),
            (OF_CLIENT, TO_WEBHOOK)
        );
        // Whose webhooks hang waits for them; others do not.
        shares.retain(|(webhook, _)| webhook.client == "a");
        begin(&mut under_way, &shares);
        let shares = under_way.shares(&all);
        assert_eq!((of("a", &shares), of("bb", &shares)), (0, TO_WEBHOOK));
    }

    #[test]
    fn webhooks_that_may_hang_leave_half_of_the_places_to_those_that_answer() {
        let names: Vec<String> = (1..=12).map(|length| "h".repeat(length)).collect();
        let hanging: Vec<Waiting> = (0..)
            .zip(&names)
            .flat_map(|(i, name)| waiting(name, 16, i % 2 == 0))
            .collect();
        let answers = waiting("answers, always", 4, false);
        let mut under_way = answered(&answers);
        let shares = under_way.shares(&hanging);
        // Each with one message, whether it has failed or was never tried.
        assert!(shares.iter().all(|(_, share)| *share == 1));
        assert_eq!(shares.len(), DOUBTFUL);
        assert!(
            names
                .iter()
                .all(|name| of(name, &shares) <= DOUBTFUL_OF_CLIENT)
        );
        begin(&mut under_way, &shares);
        assert!(under_way.shares(&hanging).is_empty());
        let shares = under_way.shares(&answers);
        assert_eq!(of("answers, always", &shares), OF_CLIENT);
        // What has answered once is beyond doubt until it does so no more.
        let first = &hanging[31..32];
        begin(&mut under_way, &[(&first[0], 1)]);
        under_way.end(first[0].webhook, true);
        assert_eq!(of("hh", &under_way.shares(first)), TO_WEBHOOK);
        begin(&mut under_way, &[(&first[0], 1)]);
        under_way.end(first[0].webhook, false);
        assert!(under_way.shares(first).is_empty());
    }

    #[test]
    fn five_clients_whose_webhooks_hang_keep_nobody_from_a_first_message() {
        let names = ["a", "bb", "ccc", "dddd", "eeeee"];
        let hanging: Vec<_> = names
            .into_iter()
            .flat_map(|name| waiting(name, 16, false))
            .collect();
        let mut under_way = UnderWay::default();
        let shares = under_way.shares(&hanging);
        begin(&mut under_way, &shares);
        let new = waiting("somebody else", 1, false);
        assert_eq!(under_way.shares(&new), [(&new[0], 1)]);
    }

    #[test]
    fn the_last_places_go_to_who_has_the_fewest_under_way() {
        let names = ["a", "bb", "ccc", "dddd"];
        let mut all = waiting("dddd", 2, false);
        all.extend(waiting("eeeee", 2, false));
        let mut under_way = answered(&all);
        for (name, count) in names.into_iter().zip([8, 8, 8, 6]) {
            let webhook = Uuid::from_u128(name.len() as u128);
            under_way.begin(webhook, name, count);
        }
        let shares = under_way.shares(&all);
        assert_eq!((of("dddd", &shares), of("eeeee", &shares)), (0, 2));
    }

    #[test]
    fn a_webhook_that_fails_is_tried_with_one_message_when_its_time_has_come() {
        let mut all = waiting("a", 2, true);
        all[1].patience = SignedDuration::from_secs(5);
        let shares = UnderWay::default().shares(&all);
        assert_eq!(shares, [(&all[0], 1)]);
    }
}
