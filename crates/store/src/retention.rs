//! Retention, and the return of space.

use std::collections::BTreeSet;

use jiff::Timestamp;
use uuid::Uuid;

use super::documents::forget_document;
use super::rows::job_columns;
use super::statement::{Pool, query, query_as, query_scalar};
use super::{DatabaseAddress, Job, Store, StoreError, dialect};

/// Jobs removed in one commit.
const REMOVED_AT_ONCE: u32 = 100;

/// Pages of the file returned in one commit.
const PAGES_AT_ONCE: u32 = 1000;

/// Content of the file in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Space {
    /// Bytes of the file, the journal aside.
    pub file: u64,
    /// Of these, bytes that nothing occupies.
    pub free: u64,
}

impl Space {
    /// Bytes that something occupies.
    pub fn used(self) -> u64 {
        self.file.saturating_sub(self.free)
    }
}

/// Numbers of removed rows.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Removed {
    /// Jobs that stood alone.
    pub jobs: u64,
    /// Studies, with all their jobs.
    pub studies: u64,
}

impl Removed {
    /// True if there was nothing to remove.
    pub fn is_nothing(self) -> bool {
        self == Self::default()
    }
}

impl Store {
    /// Removes some of the jobs and studies that ended before `before`, the oldest first: a hundred jobs, or one study.
    pub async fn remove_old(&self, before: Timestamp) -> Result<Removed, StoreError> {
        let before = before.as_microsecond();
        let study: Option<(String, i64)> = query_as(
            "select id, ended_at from studies where ended_at < $1 order by ended_at limit 1",
        )
        .bind(before)
        .fetch_optional(&self.readers)
        .await?;
        // A study that is older than the oldest jobs goes first.
        let oldest_job: Option<i64> = query_scalar(
            "select finished_at from jobs where study is null and finished_at < $1 order by finished_at limit 1",
        )
        .bind(before)
        .fetch_optional(&self.readers)
        .await?;
        match (study, oldest_job) {
            (Some((id, ended_at)), oldest) if oldest.is_none_or(|oldest| ended_at <= oldest) => {
                let id: Option<Uuid> = id.parse().ok();
                let removed = match id {
                    Some(id) => self.delete_ended_study(id).await?,
                    None => false,
                };
                Ok(Removed {
                    jobs: 0,
                    studies: removed.into(),
                })
            }
            (study, Some(_)) => {
                let until = study.map_or(before, |(_, ended_at)| ended_at.min(before));
                let jobs = self.remove_old_jobs(until.max(1)).await?;
                Ok(Removed { jobs, studies: 0 })
            }
            (_, None) => Ok(Removed::default()),
        }
    }

    async fn remove_old_jobs(&self, before: i64) -> Result<u64, StoreError> {
        let mut write = self.begin().await?;
        query(dialect::keep_alone()).execute(&mut *write).await?;
        let jobs: Vec<Job> = query_as(
            concat!(
            "delete from jobs where id in
               (select id from jobs where study is null and finished_at < $1 order by finished_at limit $2)
             returning ",
            job_columns!()
        ),
        )
        .bind(before)
        .bind(REMOVED_AT_ONCE)
        .fetch_all(&mut *write)
        .await?;
        let hashes: BTreeSet<&str> = jobs
            .iter()
            .filter_map(|job| job.document.as_deref())
            .collect();
        for hash in hashes {
            forget_document(&mut write, hash).await?;
        }
        write.commit().await?;
        Ok(jobs.len() as u64)
    }

    /// Content of the database. A server reuses the space of removed rows, and does not say how much of it is free.
    pub async fn space(&self) -> Result<Space, StoreError> {
        let count = |number: i64| u64::try_from(number).unwrap_or(0);
        if self.is_shared() {
            let bytes = query_scalar("select pg_database_size(current_database())");
            let file = count(bytes.fetch_one(&self.readers).await?);
            return Ok(Space { file, free: 0 });
        }
        let (page, pages, free): (i64, i64, i64) = query_as(
            "select (select page_size from pragma_page_size), (select page_count from pragma_page_count),
                    (select freelist_count from pragma_freelist_count)",
        )
        .fetch_one(&self.readers)
        .await?;
        Ok(Space {
            file: count(pages.saturating_mul(page)),
            free: count(free.saturating_mul(page)),
        })
    }

    /// Gives some of the space back that nothing occupies. False if there is none left.
    pub async fn shrink(&self) -> Result<bool, StoreError> {
        let before = self.space().await?;
        let Pool::Sqlite(writer) = &self.writer else {
            return Ok(false);
        };
        if before.free == 0 {
            return Ok(false);
        }
        sqlx::raw_sql(sqlx::AssertSqlSafe(format!(
            "pragma incremental_vacuum({PAGES_AT_ONCE})"
        )))
        .execute(writer)
        .await?;
        // A file of an earlier version cannot shrink page by page.
        Ok(self.space().await?.file < before.file)
    }

    /// Bytes of the journal. That of a server is none of ours.
    pub fn journal_bytes(&self) -> u64 {
        let DatabaseAddress::File(path) = &self.place else {
            return 0;
        };
        let mut name = path.as_os_str().to_owned();
        name.push("-wal");
        std::fs::metadata(name).map_or(0, |data| data.len())
    }

    /// Moves the content of the journal to the file, and empties the journal, if no reader needs it.
    pub async fn empty_journal(&self) -> Result<(), StoreError> {
        if let Pool::Sqlite(writer) = &self.writer {
            sqlx::raw_sql("pragma wal_checkpoint(truncate)")
                .execute(writer)
                .await?;
        }
        Ok(())
    }

    /// Forgets the word under which a study was submitted, and those of jobs, if they are older.
    pub async fn forget_keys(&self, before: Timestamp) -> Result<(), StoreError> {
        let mut write = self.begin().await?;
        query("delete from idempotency_keys where created_at < $1")
            .bind(before.as_microsecond())
            .execute(&mut *write)
            .await?;
        write.commit().await
    }
}
