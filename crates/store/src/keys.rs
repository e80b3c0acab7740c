//! Stored API keys: owner and role. Of the secret part only the hash is stored.

use jiff::Timestamp;

use super::rows::{Record, Row, instant, optional_instant, small};
use super::statement::{query, query_as};
use super::{Store, StoreError};

/// Rights of the bearer of a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Everything with the jobs of its client.
    Client,
    /// Look at the jobs of its client, and change nothing.
    Reader,
    /// As client, and read the numbers of the whole service.
    Operator,
    /// As client; also sees the usage of all clients, and cancels and deletes their jobs and studies.
    Administrator,
}

impl Role {
    /// Its word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Client => "client",
            Self::Reader => "reader",
            Self::Operator => "operator",
            Self::Administrator => "administrator",
        }
    }

    /// The role of a word.
    pub fn of_word(word: &str) -> Self {
        match word {
            "client" => Self::Client,
            "operator" => Self::Operator,
            "administrator" => Self::Administrator,
            // A word of a later version gives the least that there is.
            _ => Self::Reader,
        }
    }
}

/// A key as it is kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyRecord {
    /// Its public part.
    pub id: String,
    /// Whose jobs it reads and makes.
    pub client: String,
    /// The operator's name for it.
    pub name: String,
    /// Rights of its bearer.
    pub role: Role,
    /// SHA-256 of its secret part, in hexadecimal.
    pub secret_hash: String,
    /// Requests a second, where they are not the usual ones.
    pub requests_per_second: Option<u32>,
    /// Jobs that may wait, where they are not the usual ones.
    pub queue_limit: Option<u32>,
    /// When it was made.
    pub created_at: Timestamp,
    /// From when on it opens nothing any more.
    pub expires_at: Option<Timestamp>,
    /// When it was revoked.
    pub revoked_at: Option<Timestamp>,
}

impl Record for KeyRecord {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        Ok(Self {
            id: row.get("id")?,
            client: row.get("client")?,
            name: row.get("name")?,
            role: Role::of_word(&row.get::<String>("role")?),
            secret_hash: row.get("secret_hash")?,
            requests_per_second: small(row, "requests_per_second")?,
            queue_limit: small(row, "queue_limit")?,
            created_at: instant(row, "created_at")?,
            expires_at: optional_instant(row, "expires_at")?,
            revoked_at: optional_instant(row, "revoked_at")?,
        })
    }
}

/// The columns of a key.
macro_rules! key_columns {
    () => {
        "id, client, name, role, secret_hash, requests_per_second, queue_limit, created_at, expires_at, revoked_at"
    };
}

impl Store {
    /// Keeps a key.
    pub async fn add_key(&self, key: &KeyRecord) -> Result<(), StoreError> {
        let mut write = self.begin().await?;
        query(
            "insert into keys (id, client, name, role, secret_hash, requests_per_second, queue_limit, created_at, expires_at)
             values ($1, $2, $3, $4, $5, $6, $7, $8, $9)",
        )
        .bind(&key.id)
        .bind(&key.client)
        .bind(&key.name)
        .bind(key.role.word())
        .bind(&key.secret_hash)
        .bind(key.requests_per_second)
        .bind(key.queue_limit)
        .bind(key.created_at.as_microsecond())
        .bind(key.expires_at.map(Timestamp::as_microsecond))
        .execute(&mut *write)
        .await?;
        write.commit().await
    }

    /// Revokes a key. False if there is none of this id that was not revoked before.
    pub async fn revoke_key(&self, id: &str, now: Timestamp) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        let revoked = query("update keys set revoked_at = $2 where id = $1 and revoked_at is null")
            .bind(id)
            .bind(now.as_microsecond())
            .execute(&mut *write)
            .await?;
        write.commit().await?;
        Ok(revoked == 1)
    }

    /// A key that was not revoked and has not expired at `now`.
    pub async fn find_key(
        &self,
        id: &str,
        now: Timestamp,
    ) -> Result<Option<KeyRecord>, StoreError> {
        let key = query_as(concat!(
            "select ",
            key_columns!(),
            " from keys where id = $1 and revoked_at is null and (expires_at is null or expires_at > $2)"
        ))
        .bind(id)
        .bind(now.as_microsecond())
        .fetch_optional(&self.readers)
        .await?;
        Ok(key)
    }

    /// All keys, the oldest first.
    pub async fn list_keys(&self) -> Result<Vec<KeyRecord>, StoreError> {
        let keys = query_as(concat!(
            "select ",
            key_columns!(),
            " from keys order by created_at, id"
        ))
        .fetch_all(&self.readers)
        .await?;
        Ok(keys)
    }

    /// True if a key was ever made. A revoked key does not open the service to everybody again.
    pub async fn has_keys(&self) -> Result<bool, StoreError> {
        let found = query("select 1 from keys limit 1")
            .exists(&self.readers)
            .await?;
        Ok(found)
    }
}
