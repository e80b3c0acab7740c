//! The messages to webhooks on their way: signed as Standard Webhooks asks, tried again with growing patience, and never
//! sent to an address that is not public, whatever a name means by the time it is looked up.

use std::sync::Arc;
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use futures_util::{StreamExt, stream};
use hmac::{Hmac, KeyInit, Mac};
use jiff::{SignedDuration, Timestamp};
use reqwest::dns::{Addrs, Name, Resolve, Resolving};
use reqwest::redirect::Policy;
use reqwest::{Client, StatusCode};
use sha2::Sha256;
use tokio::task::JoinHandle;
use tokio::time::sleep;
use tracing::{info, warn};

use super::hooks::HookRules;
use super::queue::Jobs;
use super::store::Delivery;

/// After so many seconds an attempt is repeated; behind the last one the webhook is given up. A day and a half in all.
const PATIENCE_S: [i64; 9] = [
    5,
    30,
    120,
    600,
    3600,
    3 * 3600,
    6 * 3600,
    12 * 3600,
    12 * 3600,
];

/// One attempt takes so long at most.
const TIME_OUT: Duration = Duration::from_secs(10);

/// So many messages are on their way at the same time.
const AT_ONCE: usize = 8;

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
    pub fn start(jobs: Jobs, rules: HookRules) -> Result<Self, reqwest::Error> {
        if rules.allowed.is_empty() {
            return Ok(Self(tokio::spawn(async {})));
        }
        let rules = Arc::new(rules);
        let courier = Courier {
            client: client(&rules)?,
            jobs,
            rules,
        };
        Ok(Self(tokio::spawn(courier.work())))
    }

    /// Comes back when the last attempt has ended.
    pub async fn ended(self) {
        // It neither panics nor is aborted.
        let _ = self.0.await;
    }
}

fn client(rules: &Arc<HookRules>) -> Result<Client, reqwest::Error> {
    crate::client()
        .timeout(TIME_OUT)
        .redirect(Policy::none())
        .no_proxy()
        .dns_resolver(Arc::new(PublicOnly(Arc::clone(rules))))
        .user_agent(concat!("Meshwright/", env!("CARGO_PKG_VERSION")))
        .build()
}

/// Looks names up, and keeps the addresses that may be connected to. The connection is made to one of these: nobody looks
/// the name up again.
struct PublicOnly(Arc<HookRules>);

impl Resolve for PublicOnly {
    fn resolve(&self, name: Name) -> Resolving {
        let rules = Arc::clone(&self.0);
        Box::pin(async move {
            let found = tokio::net::lookup_host((name.as_str(), 0)).await?;
            let public: Vec<_> = found
                .filter(|address| (rules.reachable)(address.ip()))
                .collect();
            if public.is_empty() {
                return Err(format!("{} has no public address", name.as_str()).into());
            }
            Ok(Box::new(public.into_iter()) as Addrs)
        })
    }
}

struct Courier {
    jobs: Jobs,
    rules: Arc<HookRules>,
    client: Client,
}

impl Courier {
    async fn work(self) {
        let stop = self.jobs.stop().clone();
        let mut news = self.jobs.live.changes();
        while !stop.is_cancelled() {
            let delivered = self.deliver_due().await;
            if delivered > 0 {
                continue;
            }
            let next = self.until_next().await;
            tokio::select! {
                // Whoever lags has missed news, which is news.
                _ = news.recv() => {}
                () = sleep(next) => {}
                () = stop.cancelled() => {}
            }
        }
    }

    /// Delivers what is due. Gives back how many messages that were.
    async fn deliver_due(&self) -> usize {
        let now = self.jobs.clock.steady();
        let due = match self.jobs.store.due_messages(now, AT_ONCE as u32).await {
            Ok(due) => due,
            Err(error) => {
                warn!(%error, "messages cannot be read");
                self.jobs.wait_for_storage().await;
                return 0;
            }
        };
        let count = due.len();
        let attempts = stream::iter(due).for_each_concurrent(AT_ONCE, |delivery| async move {
            self.attempt(delivery).await;
        });
        // An attempt that a shutdown interrupts is repeated by the next process; the receiver knows it by its id.
        tokio::select! {
            () = attempts => count,
            () = self.jobs.stop().cancelled() => 0,
        }
    }

    async fn until_next(&self) -> Duration {
        let now = self.jobs.clock.steady();
        match self.jobs.store.next_message().await {
            Ok(Some(next)) => {
                let wait = Duration::try_from(now.duration_until(next)).unwrap_or(Duration::ZERO);
                wait.clamp(Duration::from_millis(100), QUIET)
            }
            _ => QUIET,
        }
    }

    async fn attempt(&self, delivery: Delivery) {
        let outcome = self.send(&delivery).await;
        let result = match &outcome {
            Ok(()) => "arrived",
            Err(Refusal::Again(_)) => "refused",
            Err(Refusal::Never(_)) => "given_up",
        };
        metrics::counter!("meshwright_webhook_attempts_total", "result" => result).increment(1);
        let (now, steady) = (self.jobs.clock.now(), self.jobs.clock.steady());
        let store = &self.jobs.store;
        let written = match outcome {
            Ok(()) => store.message_arrived(delivery.message).await,
            Err(Refusal::Again(why)) => {
                let next = next_attempt(delivery.attempts, steady);
                if next.is_none() {
                    warn!(webhook = %delivery.webhook, why, "a webhook is given up");
                }
                store.message_refused(&delivery, &why, next, now).await
            }
            Err(Refusal::Never(why)) => {
                info!(webhook = %delivery.webhook, why, "a webhook is given up");
                store.message_refused(&delivery, &why, None, now).await
            }
        };
        if let Err(error) = written {
            warn!(message = %delivery.message, %error, "the fate of a message cannot be written; it is sent again");
            self.jobs.wait_for_storage().await;
        }
    }

    async fn send(&self, delivery: &Delivery) -> Result<(), Refusal> {
        // The list may be another one than when the webhook was made.
        self.rules.check(&delivery.url).map_err(Refusal::Again)?;
        let timestamp = self.jobs.clock.now().as_second();
        let id = delivery.message.to_string();
        let signature = signature(&delivery.secret, &id, timestamp, &delivery.body)
            .ok_or_else(|| Refusal::Never("its secret is damaged".to_owned()))?;
        let request = self
            .client
            .post(&delivery.url)
            .header("content-type", "application/json")
            .header("webhook-id", &id)
            .header("webhook-timestamp", timestamp)
            .header("webhook-signature", signature)
            .body(delivery.body.clone());
        let answer = request.send().await;
        let answer = answer.map_err(|error| Refusal::Again(told(&error)))?;
        match answer.status() {
            status if status.is_success() => Ok(()),
            // Standard Webhooks: the receiver wants no more.
            StatusCode::GONE => Err(Refusal::Never("it answered 410".to_owned())),
            status => Err(Refusal::Again(format!("it answered {}", status.as_u16()))),
        }
    }
}

/// Why a message was not taken.
enum Refusal {
    /// It may be the next time.
    Again(String),
    /// It will not be.
    Never(String),
}

/// When to try again after so many attempts that failed before this one.
fn next_attempt(attempts: u32, now: Timestamp) -> Option<Timestamp> {
    let seconds = PATIENCE_S.get(attempts as usize)?;
    now.checked_add(SignedDuration::from_secs(*seconds)).ok()
}

/// The signature of a message: HMAC-SHA-256 of id, time and body. None by a secret that is none: anybody could forge that.
fn signature(secret: &str, id: &str, timestamp: i64, body: &str) -> Option<String> {
    let key = BASE64.decode(secret).ok().filter(|key| !key.is_empty())?;
    let mut mac = Hmac::<Sha256>::new_from_slice(&key).expect("a key of any length will do");
    mac.update(format!("{id}.{timestamp}.{body}").as_bytes());
    Some(format!("v1,{}", BASE64.encode(mac.finalize().into_bytes())))
}

/// An error with its causes, without the address, which may have a secret in it.
fn told(error: &reqwest::Error) -> String {
    let mut causes = Vec::new();
    let mut cause = std::error::Error::source(error);
    while let Some(error) = cause {
        causes.push(error.to_string());
        cause = error.source();
    }
    if error.is_timeout() {
        format!("no answer within {} s", TIME_OUT.as_secs())
    } else if causes.is_empty() {
        "it cannot be reached".to_owned()
    } else {
        format!("it cannot be reached: {}", causes.join(": "))
    }
}

#[cfg(test)]
mod tests {
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

    #[test]
    fn patience_grows_and_ends_after_a_day_and_a_half() {
        let now = Timestamp::UNIX_EPOCH;
        let waits: Vec<i64> = (0..)
            .map_while(|attempts| next_attempt(attempts, now))
            .map(|next| next.as_second())
            .collect();
        assert_eq!(waits, PATIENCE_S);
        assert!(waits.is_sorted());
        assert!((33 * 3600..37 * 3600).contains(&waits.iter().sum::<i64>()));
    }
}
