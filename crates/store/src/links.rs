//! Links by which somebody without a key reads the results of a job. Of the secret in their address only the hash is kept.

use jiff::Timestamp;
use uuid::Uuid;

use super::rows::{Record, Row, instant, uuid};
use super::statement::{query, query_as, query_scalar};
use super::{Store, StoreError, dialect};

/// A link to be kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewLink {
    /// Its id, a UUID of version 7.
    pub id: Uuid,
    /// The job whose results it opens.
    pub job: Uuid,
    /// The public part of the key that makes it, if one does.
    pub key: Option<String>,
    /// SHA-256 of its secret, in hexadecimal.
    pub secret_hash: String,
    /// The time of day.
    pub created_at: Timestamp,
    /// From when on it opens nothing.
    pub ends_at: Timestamp,
}

/// A link as it is kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinkRecord {
    /// Its id.
    pub id: Uuid,
    /// The job whose results it opens.
    pub job: Uuid,
    /// When it was made.
    pub created_at: Timestamp,
    /// From when on it opens nothing.
    pub ends_at: Timestamp,
}

/// Outcome of making a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkOutcome {
    /// The link opens the results.
    Made,
    /// The client has no such job.
    NoJob,
    /// The job has as many as it may have.
    TooMany,
}

impl Record for LinkRecord {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        Ok(Self {
            id: uuid(row, "id")?,
            job: uuid(row, "job")?,
            created_at: instant(row, "created_at")?,
            ends_at: instant(row, "ends_at")?,
        })
    }
}

/// A link that a lookup at the time $2 finds: it has not ended, nor has the key that made it.
macro_rules! holds {
    () => {
        "links.ends_at > $2 and (links.key is null or exists (select 1 from keys
           where keys.id = links.key and keys.revoked_at is null and (keys.expires_at is null or keys.expires_at > $2)))"
    };
}

impl Store {
    /// Keeps a link to the results of a job of a client, if the job has fewer than `most` that have not ended.
    pub async fn add_link(
        &self,
        client: &str,
        link: &NewLink,
        most: i64,
    ) -> Result<LinkOutcome, StoreError> {
        let mut write = self.begin().await?;
        query(dialect::lock_links()).execute(&mut *write).await?;
        let is_own = query("select 1 from jobs where id = $1 and client = $2")
            .bind(link.job.to_string())
            .bind(client)
            .exists(&mut *write)
            .await?;
        if !is_own {
            write.rollback().await?;
            return Ok(LinkOutcome::NoJob);
        }
        let count: i64 = query_scalar(concat!(
            "select count(*) from links where job = $1 and ",
            holds!()
        ))
        .bind(link.job.to_string())
        .bind(link.created_at.as_microsecond())
        .fetch_one(&mut *write)
        .await?;
        if count >= most {
            write.rollback().await?;
            return Ok(LinkOutcome::TooMany);
        }
        query("insert into links (id, job, key, secret_hash, created_at, ends_at) values ($1, $2, $3, $4, $5, $6)")
            .bind(link.id.to_string())
            .bind(link.job.to_string())
            .bind(&link.key)
            .bind(&link.secret_hash)
            .bind(link.created_at.as_microsecond())
            .bind(link.ends_at.as_microsecond())
            .execute(&mut *write)
            .await?;
        write.commit().await?;
        Ok(LinkOutcome::Made)
    }

    /// The links to the results of a job that open them at `now`, the oldest first.
    pub async fn links_of(&self, job: Uuid, now: Timestamp) -> Result<Vec<LinkRecord>, StoreError> {
        let links = query_as(concat!(
            "select id, job, created_at, ends_at from links where job = $1 and ",
            holds!(),
            " order by created_at, id"
        ));
        let links = links.bind(job.to_string()).bind(now.as_microsecond());
        Ok(links.fetch_all(&self.readers).await?)
    }

    /// The link that opens results at `now`, by the hash of its secret, and the client of its job.
    pub async fn find_link(
        &self,
        secret_hash: &str,
        now: Timestamp,
    ) -> Result<Option<(LinkRecord, String)>, StoreError> {
        struct Found(LinkRecord, String);
        impl Record for Found {
            fn read(row: &Row) -> Result<Self, sqlx::Error> {
                Ok(Self(LinkRecord::read(row)?, row.get("client")?))
            }
        }
        let found: Option<Found> = query_as(concat!(
            "select links.id, links.job, links.created_at, links.ends_at, jobs.client
             from links join jobs on jobs.id = links.job where links.secret_hash = $1 and ",
            holds!()
        ))
        .bind(secret_hash)
        .bind(now.as_microsecond())
        .fetch_optional(&self.readers)
        .await?;
        Ok(found.map(|Found(link, client)| (link, client)))
    }

    /// Ends a link. False if the client has none of this id.
    pub async fn end_link(&self, client: &str, id: Uuid) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        let ended = query(
            "delete from links where id = $1 and job in (select id from jobs where id = links.job and client = $2)",
        )
        .bind(id.to_string())
        .bind(client)
        .execute(&mut *write)
        .await?;
        write.commit().await?;
        Ok(ended > 0)
    }

    /// Removes the links that ended before.
    pub async fn forget_links(&self, before: Timestamp) -> Result<(), StoreError> {
        let mut write = self.begin().await?;
        query("delete from links where ends_at <= $1")
            .bind(before.as_microsecond())
            .execute(&mut *write)
            .await?;
        write.commit().await
    }
}
