//! Links by which somebody without a key reads the results of a job.

use std::fmt;

use jiff::{SignedDuration, Timestamp};
use meshwright_store::{Job, LinkOutcome, LinkRecord, NewLink};
use meshwright_wire::hash::sha256_hex;
use uuid::Uuid;

use super::error::JobError;
use super::queue::Jobs;
use super::resource::Resource as _;

/// Maximum number of open links to the results of one job.
pub const MOST_LINKS: i64 = 20;

/// The longest time that a link is open, in days.
pub const LONGEST_LINK_DAYS: i64 = 90;

/// Prefix of the secret of every link, by which scanners for leaked secrets know it, and logs leave it out.
const PREFIX: &str = "mws_";

const SECRET_BYTES: usize = 32;

/// The secret of a link, which stands in its address. It shows itself to nobody by accident.
pub struct LinkSecret(String);

impl fmt::Debug for LinkSecret {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LinkSecret")
    }
}

impl LinkSecret {
    /// A new secret, from the system's source of chance: 256 bits.
    fn random() -> Result<Self, getrandom::Error> {
        let mut secret = [0; SECRET_BYTES];
        getrandom::fill(&mut secret)?;
        let digits: String = secret.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self(format!("{PREFIX}{digits}")))
    }

    /// Reads a secret; `None` if it has not the form of one.
    pub fn parse(text: &str) -> Option<Self> {
        let digits = text.strip_prefix(PREFIX)?;
        let is_digit = |byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f');
        let has_form = digits.len() == 2 * SECRET_BYTES && digits.bytes().all(is_digit);
        has_form.then(|| Self(text.to_owned()))
    }

    /// The whole secret, to be shown once.
    pub fn reveal(&self) -> &str {
        &self.0
    }

    fn hash(&self) -> String {
        sha256_hex(&self.0)
    }
}

/// A text without the secrets of links in it, as logs and spans have it.
pub fn without_secrets(text: &str) -> String {
    let mut parts = text.split(PREFIX);
    let mut shown = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let rest = part.trim_start_matches(|c: char| c.is_ascii_alphanumeric());
        shown.extend([PREFIX, "...", rest]);
    }
    shown
}

/// Why there is no link.
#[derive(Debug, Clone, thiserror::Error)]
pub enum LinkError {
    /// The end lies in the past or too far ahead.
    #[error(
        "{given} is not within the next {LONGEST_LINK_DAYS} days; a link can end after {now}, and at the latest at {latest}"
    )]
    Time {
        /// The end that was asked for.
        given: Timestamp,
        /// The present time.
        now: Timestamp,
        /// The latest end.
        latest: Timestamp,
    },
    /// As many links to the results of the job are open as may be.
    #[error("{MOST_LINKS} links to the results of this job are open, which is the limit")]
    TooMany,
    /// The client has no link of this id.
    #[error("there is no link {0}")]
    NotFound(Uuid),
    /// The system has no source of chance.
    #[error("the system has no source of chance")]
    NoChance,
    /// The job or the store is why.
    #[error(transparent)]
    Job(#[from] JobError),
}

impl Jobs {
    /// Makes a link to the results of a job of `client`, open until `ends_at`, or until its `key` ends.
    ///
    /// # Errors
    ///
    /// [`LinkError`].
    pub async fn make_link(
        &self,
        client: &str,
        job: Uuid,
        key: Option<String>,
        ends_at: Timestamp,
    ) -> Result<(LinkRecord, LinkSecret), LinkError> {
        let now = self.clock.now();
        let longest = SignedDuration::from_hours(24 * LONGEST_LINK_DAYS);
        let latest = now.saturating_add(longest).unwrap_or(Timestamp::MAX);
        if ends_at <= now || ends_at > latest {
            return Err(LinkError::Time {
                given: ends_at,
                now,
                latest,
            });
        }
        let secret = LinkSecret::random().map_err(|_| LinkError::NoChance)?;
        let link = NewLink {
            id: Uuid::now_v7(),
            job,
            key,
            secret_hash: secret.hash(),
            created_at: now,
            ends_at,
        };
        let outcome = self.store.add_link(client, &link, MOST_LINKS).await;
        match outcome.map_err(JobError::from)? {
            LinkOutcome::Made => {}
            LinkOutcome::NoJob => return Err(JobError::NotFound(job).into()),
            LinkOutcome::TooMany => return Err(LinkError::TooMany),
        }
        let record = LinkRecord {
            id: link.id,
            job,
            created_at: now,
            ends_at,
        };
        Ok((record, secret))
    }

    /// The open links to the results of a job of `client`, the oldest first.
    ///
    /// # Errors
    ///
    /// [`JobError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn links(&self, client: &str, job: Uuid) -> Result<Vec<LinkRecord>, JobError> {
        let job = Job::find(self, client, job).await?;
        Ok(self.store.links_of(job.id, self.clock.now()).await?)
    }

    /// The open link with this secret and the job whose results it opens; none if it is not known or has ended.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn open_link(
        &self,
        secret: &LinkSecret,
    ) -> Result<Option<(LinkRecord, Job)>, JobError> {
        let (hash, now) = (secret.hash(), self.clock.now());
        let Some((link, client)) = self.store.find_link(&hash, now).await? else {
            return Ok(None);
        };
        let job = self.store.find(&client, link.job).await?;
        Ok(job.map(|job| (link, job)))
    }

    /// Ends a link of `client`.
    ///
    /// # Errors
    ///
    /// [`LinkError::NotFound`], [`LinkError::Job`].
    pub async fn end_link(&self, client: &str, id: Uuid) -> Result<(), LinkError> {
        let ended = self.store.end_link(client, id).await;
        match ended.map_err(JobError::from)? {
            true => Ok(()),
            false => Err(LinkError::NotFound(id)),
        }
    }

    /// Forgets links that have ended.
    pub(super) async fn forget_links(&self) -> Result<(), meshwright_store::StoreError> {
        // The earlier of the two clocks decides, as of all that is removed.
        let now = self.clock.now().min(self.clock.steady());
        self.store.forget_links(now).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_secret_reads_what_it_reveals_and_stands_in_no_log() {
        let secret = LinkSecret::random().unwrap();
        let text = secret.reveal();
        assert_eq!(LinkSecret::parse(text).unwrap().hash(), secret.hash());
        assert_ne!(LinkSecret::random().unwrap().reveal(), text);
        for other in [
            "",
            "mws_",
            &text[1..],
            &text[..67],
            &text.to_uppercase(),
            &format!("{text}0"),
        ] {
            assert!(LinkSecret::parse(other).is_none(), "{other}");
        }
        let path = format!("/shared/{text}/results/ste.svg");
        assert_eq!(without_secrets(&path), "/shared/mws_.../results/ste.svg");
        assert_eq!(
            without_secrets(&format!("/{text}/{text}")),
            "/mws_.../mws_..."
        );
        assert_eq!(without_secrets("/v1/jobs"), "/v1/jobs");
        assert_eq!(format!("{secret:?}"), "LinkSecret");
    }
}
