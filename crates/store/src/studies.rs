//! The transitions of a study. Its designs are jobs, whose own transitions stand elsewhere; here are those of many at once: their beginning, chunk after chunk,
//! and their end when the study is cancelled or deleted.

use std::collections::BTreeSet;

use jiff::{SignedDuration, Timestamp};
use serde_json::json;
use uuid::Uuid;

use super::documents::{checksum, forget_document};
use super::endings::note_study;
use super::outbox::{Event, EventKind, tell};
use super::shares::{self, LaneOf};
use super::statement::{Connection, list, query, query_as, query_scalar};
use super::submit::{QueueBounds, find_known, insert_jobs, insert_submissions, words};
use super::{By, NewJob, Status, Store, StoreError, column, dialect, micros};

/// Maximum number of waiting jobs of studies; further studies are refused.
const MOST_WAITING_DESIGNS: i64 = 250_000;

/// Where several processes expand studies, one that has taken a study has it for so long beyond each chunk.
const EXPANDING_FOR: SignedDuration = SignedDuration::from_secs(20);

/// Jobs dismissed in one commit, so that others write in between however large the study is.
const DISMISSED_AT_ONCE: u32 = 500;

/// Jobs deleted in one commit.
const DELETED_AT_ONCE: u32 = 200;

/// A study to be kept.
#[derive(Debug, Clone)]
pub struct NewStudy {
    /// Its id, a UUID of version 7.
    pub id: Uuid,
    /// Who submits it.
    pub client: String,
    /// The client's name for it.
    pub name: Option<String>,
    /// Short words of the client.
    pub tags: Vec<String>,
    /// The study as it was sent, JSON.
    pub document: String,
    /// The version of its base's document.
    pub document_version: i64,
    /// Hash of the sent document.
    pub body_hash: String,
    /// The gear whose mass and holes its table shows, in a word.
    pub gear: String,
    /// Number of designs; of a search, the most that it may come to.
    pub total: u64,
    /// How a search stands before it begins.
    pub search: Option<String>,
    /// The time of day.
    pub submitted_at: Timestamp,
    /// The word under which the client may ask again and get this study.
    pub idempotency_key: Option<String>,
    /// Maximum number of waiting designs of the client.
    pub client_limit: i64,
    /// The user of the client who submits it, if the client says.
    pub submitted_by: Option<String>,
}

/// A row to be kept.
#[derive(Debug, Clone)]
pub struct NewRow {
    /// Label of the design.
    pub label: String,
    /// Changes of the base by the design, JSON.
    pub changes: String,
    /// The job, or the problem document of a design that cannot be built.
    pub job: Result<NewJob, String>,
}

/// How far a search has come with the rows that are added.
#[derive(Debug, Clone)]
pub struct SearchStep {
    /// The rows that it comes to in all, if that is known by now.
    pub total: Option<u64>,
    /// How far the search has come, JSON.
    pub state: String,
}

/// Outcome of the submission of a study.
#[derive(Debug, Clone, PartialEq)]
pub enum StudyOutcome {
    /// The study is stored, with its first rows.
    Taken,
    /// The study that the same key and document got before.
    Repeated(Uuid),
    /// The key was used for another study.
    KeyConflict,
    /// The limit of waiting designs is reached.
    QueueFull {
        /// They.
        waiting: i64,
    },
    /// The limit of waiting designs of this client is reached.
    ClientQueueFull {
        /// They.
        waiting: i64,
    },
}

impl Store {
    /// Nothing -> a study with its first rows.
    pub async fn begin_study(
        &self,
        study: &NewStudy,
        rows: &[NewRow],
        bounds: QueueBounds<'_>,
    ) -> Result<StudyOutcome, StoreError> {
        let mut write = self.begin().await?;
        query(dialect::lock_studies()).execute(&mut *write).await?;
        query(
            "update studies set idempotency_key = null where idempotency_key is not null and submitted_at < $1",
        )
        .bind(bounds.forget_keys_before.as_microsecond())
        .execute(&mut *write)
        .await?;
        if let Some(refusal) = refusal(&mut write, study).await? {
            write.rollback().await?;
            return Ok(refusal);
        }
        insert_study(&mut write, study).await?;
        let lane = LaneOf {
            client: study.client.clone(),
            person: study.submitted_by.clone(),
            study: Some(study.id),
        };
        append(&mut write, &lane, study.id, 0, rows, bounds).await?;
        note_study(&mut write, study.id, study.submitted_at).await?;
        write.commit().await?;
        Ok(StudyOutcome::Taken)
    }

    /// The rows behind the first `expanded` ones. False if the study has not just so many rows, or wants no more.
    pub async fn continue_study(
        &self,
        id: Uuid,
        expanded: u64,
        rows: &[NewRow],
        step: Option<&SearchStep>,
        now: Timestamp,
        bounds: QueueBounds<'_>,
    ) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        let owner: Option<(String, Option<String>)> = query_as(
            "select client, submitted_by from studies where id = $1 and expanded = $2 and cancelled_at is null",
        )
        .bind(id.to_string())
        .bind(column(expanded))
        .fetch_optional(&mut *write)
        .await?;
        let Some((client, person)) = owner else {
            write.rollback().await?;
            return Ok(false);
        };
        let lane = LaneOf {
            client,
            person,
            study: Some(id),
        };
        if let Some(step) = step {
            query("update studies set search = $2, total = coalesce($3, total) where id = $1")
                .bind(id.to_string())
                .bind(&step.state)
                .bind(step.total.map(column))
                .execute(&mut *write)
                .await?;
        }
        if !append(&mut write, &lane, id, expanded, rows, bounds).await? {
            write.rollback().await?;
            return Ok(false);
        }
        note_study(&mut write, id, now).await?;
        write.commit().await?;
        Ok(true)
    }

    /// Holds a study that waits for the outcomes of its rows, so that no other process takes it.
    pub async fn hold_study(&self, id: Uuid, steady: Timestamp) -> Result<(), StoreError> {
        let mut write = self.begin().await?;
        query(dialect::expanding())
            .bind(id.to_string())
            .bind(steady.as_microsecond())
            .bind(micros(EXPANDING_FOR))
            .execute(&mut *write)
            .await?;
        write.commit().await?;
        Ok(())
    }

    /// The studies that do not have all their rows, and that nobody expands: ids and clients. They are this process's now.
    /// Studies whose documents it does not read, of a later version than `reads`, are left to others.
    pub async fn unfinished_expansions(
        &self,
        steady: Timestamp,
        reads: i64,
    ) -> Result<Vec<(Uuid, String)>, StoreError> {
        let mut write = self.begin().await?;
        let found: Vec<(String, String)> = query_as(dialect::unfinished_expansions())
            .bind(steady.as_microsecond())
            .bind(micros(EXPANDING_FOR))
            .bind(reads)
            .fetch_all(&mut *write)
            .await?;
        write.commit().await?;
        Ok(found
            .into_iter()
            .filter_map(|(id, client)| Some((id.parse().ok()?, client)))
            .collect())
    }

    /// Accepted or running -> dismissed, for a study: its designs without row get none. Its jobs follow by
    /// [`Store::dismiss_designs`]. False if the client has no such study in these states.
    pub async fn cancel_study(
        &self,
        client: &str,
        id: Uuid,
        by: By,
        now: Timestamp,
    ) -> Result<bool, StoreError> {
        let mut write = self.begin().await?;
        let cancelled = query(
            "update studies set cancelled_at = max($3, submitted_at), version = version + 1, dismissed_by = $4
             where id = $1 and client = $2 and cancelled_at is null and (expanded < total or accepted + running > 0)",
        )
        .bind(id.to_string())
        .bind(client)
        .bind(now.as_microsecond())
        .bind(by.word())
        .execute(&mut *write)
        .await?;
        if cancelled > 0 {
            // Nobody is to begin a design while the others are being dismissed.
            shares::lock(&mut write, [&client.to_owned()].into()).await?;
            shares::rest(&mut write, client, &id.to_string()).await?;
        }
        write.commit().await?;
        Ok(cancelled > 0)
    }

    /// Accepted or running -> dismissed, for some jobs of a study that was cancelled: their ids, and whether there are more.
    /// With the last of them the study has ended.
    pub async fn dismiss_designs(
        &self,
        id: Uuid,
        now: Timestamp,
    ) -> Result<(Vec<Uuid>, bool), StoreError> {
        // Running jobs are stopped first. In a commit of its own, because jobs are locked before their study.
        let mut write = self.begin().await?;
        let mut dismissed = dismiss(&mut write, id, Status::Running, now).await?;
        write.commit().await?;
        let mut write = self.begin().await?;
        dismissed.extend(dismiss(&mut write, id, Status::Accepted, now).await?);
        let more = query(
            "select 1 from studies where id = $1 and cancelled_at is not null and accepted + running > 0",
        )
        .bind(id.to_string())
        .exists(&mut *write)
        .await?;
        if !more {
            note_study(&mut write, id, now).await?;
        }
        write.commit().await?;
        Ok((dismissed, more))
    }

    /// The studies that were cancelled and whose jobs have not all been dismissed.
    pub async fn unfinished_cancellations(&self) -> Result<Vec<Uuid>, StoreError> {
        let found: Vec<String> = query_scalar(
            "select id from studies where cancelled_at is not null and ended_at is null order by sequence",
        )
        .fetch_all(&self.readers)
        .await?;
        Ok(found.iter().filter_map(|id| id.parse().ok()).collect())
    }

    /// Ended -> nothing, for a study, its jobs, and their results unless another job has the same. False if the client
    /// has no such study, or it has not ended.
    pub async fn delete_study(
        &self,
        client: &str,
        id: Uuid,
        by: By,
        now: Timestamp,
    ) -> Result<bool, StoreError> {
        match self.find_study(client, id).await? {
            Some(study) => {
                let event = Event::of_study(EventKind::StudyDeleted, &study);
                let event = (by == By::Administrator).then_some((client, event, now));
                self.delete_and_tell(id, event).await
            }
            None => Ok(false),
        }
    }

    /// The same, whoever the client is. Commits some jobs at a time, so that others may write meanwhile.
    pub async fn delete_ended_study(&self, id: Uuid) -> Result<bool, StoreError> {
        self.delete_and_tell(id, None).await
    }

    /// The same. The last commit writes the message to its client.
    async fn delete_and_tell(
        &self,
        id: Uuid,
        mut event: Option<(&str, Event<'_>, Timestamp)>,
    ) -> Result<bool, StoreError> {
        loop {
            let mut write = self.begin().await?;
            let ended = query(
                "select 1 from studies where id = $1 and (cancelled_at is not null or expanded = total)
                   and accepted + running = 0",
            )
            .bind(id.to_string())
            .exists(&mut *write)
            .await?;
            if !ended {
                write.rollback().await?;
                return Ok(false);
            }
            let documents: Vec<Option<String>> = query_scalar(
                "delete from jobs where id in (select id from jobs where study = $1 limit $2) returning document",
            )
            .bind(id.to_string())
            .bind(DELETED_AT_ONCE)
            .fetch_all(&mut *write)
            .await?;
            let hashes: BTreeSet<&String> = documents.iter().flatten().collect();
            for hash in hashes {
                forget_document(&mut write, hash).await?;
            }
            let last = documents.is_empty();
            if last {
                query("delete from studies where id = $1")
                    .bind(id.to_string())
                    .execute(&mut *write)
                    .await?;
                query("delete from shares where lane = $1")
                    .bind(id.to_string())
                    .execute(&mut *write)
                    .await?;
                if let Some((client, event, now)) = event.take() {
                    tell(&mut write, client, event, now).await?;
                }
            }
            write.commit().await?;
            if last {
                return Ok(true);
            }
        }
    }
}

/// Dismisses some jobs of a study that are in this state.
async fn dismiss(
    connection: &mut Connection,
    study: Uuid,
    status: Status,
    now: Timestamp,
) -> Result<Vec<Uuid>, sqlx::Error> {
    let jobs: Vec<String> = query_scalar(dialect::dismiss_designs())
        .bind(study.to_string())
        .bind(now.as_microsecond())
        .bind(status.as_str())
        .bind(DISMISSED_AT_ONCE)
        .fetch_all(connection)
        .await?;
    Ok(jobs.iter().filter_map(|id| id.parse().ok()).collect())
}

/// Why the study is not taken, or which one was before.
async fn refusal(
    connection: &mut Connection,
    study: &NewStudy,
) -> Result<Option<StudyOutcome>, sqlx::Error> {
    if let Some(key) = &study.idempotency_key {
        let earlier: Option<(String, String)> = query_as(
            "select id, body_hash from studies where client = $1 and idempotency_key = $2",
        )
        .bind(&study.client)
        .bind(key)
        .fetch_optional(&mut *connection)
        .await?;
        if let Some((id, body_hash)) = earlier {
            return Ok(Some(match id.parse() {
                Ok(id) if body_hash == study.body_hash => StudyOutcome::Repeated(id),
                _ => StudyOutcome::KeyConflict,
            }));
        }
    }
    // Rows that do not exist yet will wait, too.
    let (own, all): (i64, i64) = query_as(
        "select cast(coalesce(sum(case client when $1 then designs else 0 end), 0) as bigint),
                cast(coalesce(sum(designs), 0) as bigint)
         from (select client, accepted + case when cancelled_at is null then total - expanded else 0 end as designs
               from studies where ended_at is null) as unended",
    )
    .bind(&study.client)
    .fetch_one(connection)
    .await?;
    let more = column(study.total);
    Ok(if own.saturating_add(more) > study.client_limit {
        Some(StudyOutcome::ClientQueueFull { waiting: own })
    } else if all.saturating_add(more) > MOST_WAITING_DESIGNS {
        Some(StudyOutcome::QueueFull { waiting: all })
    } else {
        None
    })
}

async fn insert_study(connection: &mut Connection, study: &NewStudy) -> Result<(), sqlx::Error> {
    let id = study.id.to_string();
    let sequence: i64 = query_scalar(dialect::insert_study())
        .bind(&id)
        .bind(&study.client)
        .bind(&study.name)
        .bind(words(&study.tags))
        .bind(&study.body_hash)
        .bind(&study.gear)
        .bind(column(study.total))
        .bind(study.submitted_at.as_microsecond())
        .bind(&study.idempotency_key)
        .bind(study.document_version)
        .bind(&study.submitted_by)
        .fetch_one(&mut *connection)
        .await?;
    query("insert into study_documents (study, body, checksum) values ($1, $2, $3)")
        .bind(&id)
        .bind(&study.document)
        .bind(checksum(study.document.as_bytes()))
        .execute(&mut *connection)
        .await?;
    if let Some(state) = &study.search {
        query("update studies set search = $2 where id = $1")
            .bind(&id)
            .bind(state)
            .execute(&mut *connection)
            .await?;
    }
    for tag in &study.tags {
        query("insert into study_tags (client, tag, sequence, study) values ($1, $2, $3, $4) on conflict do nothing")
            .bind(&study.client)
            .bind(tag)
            .bind(sequence)
            .bind(&id)
            .execute(&mut *connection)
            .await?;
    }
    Ok(())
}

/// Adds rows behind the first `expanded` ones, with their jobs, which wait in `lane`. False if the study has not just so many, or wants no more:
/// somebody was faster.
async fn append(
    connection: &mut Connection,
    lane: &LaneOf,
    study: Uuid,
    expanded: u64,
    rows: &[NewRow],
    bounds: QueueBounds<'_>,
) -> Result<bool, sqlx::Error> {
    let jobs: Vec<&NewJob> = rows
        .iter()
        .filter_map(|row| row.job.as_ref().ok())
        .collect();
    let inputs: Vec<&str> = jobs.iter().map(|new| new.input_hash.as_str()).collect();
    let computed: Vec<String> = query_scalar(dialect::known_among())
        .bind(&lane.client)
        .bind(bounds.solver_version)
        .bind(list(&inputs))
        .fetch_all(&mut *connection)
        .await?;
    let computed: BTreeSet<&str> = computed.iter().map(String::as_str).collect();
    let mut listed = Vec::with_capacity(jobs.len());
    for new in &jobs {
        let known = if computed.contains(new.input_hash.as_str()) {
            find_known(
                connection,
                &lane.client,
                &new.input_hash,
                new.keep,
                bounds.solver_version,
            )
            .await?
        } else {
            None
        };
        listed.push((*new, known));
    }
    let made = insert_jobs(connection, &listed, bounds.solver_version).await?;
    insert_submissions(connection, &jobs).await?;
    let unbuildable = rows.len() - jobs.len();
    let of_study: Vec<_> = (expanded..)
        .zip(rows)
        .map(|(position, row)| {
            json!({
                "position": column(position),
                "label": row.label,
                "changes": row.changes,
                "job": row.job.as_ref().ok().map(|new| new.id),
                "problem": row.job.as_ref().err(),
            })
        })
        .collect();
    let insert = query(dialect::insert_study_rows()).bind(list(&of_study));
    connection.later(insert.bind(study.to_string())).await?;
    // They are counted here, all at once and late: whoever claims or ends a job of the study waits from here on.
    let ends = made.iter().filter_map(|job| job.finished_at);
    let (successful, last_end) = (ends.clone().count(), ends.max());
    let waiting = made.len() - successful;
    let id = study.to_string();
    let updated = query(
        "update studies set expanded = $2, unbuildable = unbuildable + $3, accepted = accepted + $5, successful = successful + $6,
                last_end = max(coalesce(last_end, $7), coalesce($7, last_end)), version = version + 1
         where id = $1 and expanded = $4 and cancelled_at is null",
    )
    .bind(&id)
    .bind(column(expanded + rows.len() as u64))
    .bind(column(unbuildable as u64))
    .bind(column(expanded))
    .bind(column(waiting as u64))
    .bind(column(successful as u64))
    .bind(last_end.map(Timestamp::as_microsecond))
    .execute(&mut *connection)
    .await?;
    if updated == 0 {
        return Ok(false);
    }
    let expanding = query(dialect::expanding())
        .bind(&id)
        .bind(bounds.steady.as_microsecond())
        .bind(micros(EXPANDING_FOR));
    connection.later(expanding).await?;
    if waiting > 0 {
        shares::activate(connection, lane).await?;
    }
    Ok(true)
}
