//! Consequences of a job's end: its study may have ended with it, and a webhook may need a message.

use std::collections::BTreeMap;

use jiff::Timestamp;
use uuid::Uuid;

use super::outbox::{Event, EventKind, tell};
use super::rows::study_columns;
use super::statement::{Connection, query_as, query_scalar};
use super::{Job, StudyRecord};

/// Notes that `job` has ended, in the same transaction.
pub(super) async fn tell_end(
    connection: &mut Connection,
    job: &Job,
    now: Timestamp,
) -> Result<(), sqlx::Error> {
    match job.study {
        // The designs of a study end by the thousand; its client waits for the study.
        Some(study) => note_study(connection, study, now).await,
        None if job.status.has_ended() => {
            let event = Event::of_job(EventKind::JobEnded, job);
            tell(connection, &job.client, event, now).await
        }
        None => Ok(()),
    }
}

/// The same of several jobs with their times, the latest last: a study is looked at once.
pub(super) async fn tell_ends(
    connection: &mut Connection,
    ended: impl Iterator<Item = (&'_ Job, Timestamp)>,
) -> Result<(), sqlx::Error> {
    let mut studies = BTreeMap::new();
    for (job, at) in ended {
        match job.study {
            Some(study) => {
                studies.insert(study, at);
            }
            None => tell_end(connection, job, at).await?,
        }
    }
    for (study, at) in studies {
        note_study(connection, study, at).await?;
    }
    Ok(())
}

/// Notes that a study has ended, if it has, once.
pub(super) async fn note_study(
    connection: &mut Connection,
    id: Uuid,
    now: Timestamp,
) -> Result<(), sqlx::Error> {
    let ended: Option<StudyRecord> = query_as(concat!(
        "update studies set ended_at = max(coalesce(cancelled_at, last_end, submitted_at), submitted_at)
         where id = $1 and ended_at is null
           and (cancelled_at is not null and accepted + running = 0 or unbuildable + successful + failed + dismissed = total)
         returning ",
        study_columns!()
    ))
    .bind(id.to_string())
    .fetch_optional(&mut *connection)
    .await?;
    if let Some(study) = ended {
        let client: String = query_scalar("select client from studies where id = $1")
            .bind(id.to_string())
            .fetch_one(&mut *connection)
            .await?;
        let event = Event::of_study(EventKind::StudyEnded, &study);
        tell(connection, &client, event, now).await?;
    }
    Ok(())
}
