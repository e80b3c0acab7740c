//! Looking at jobs and studies: one, many, how many. Lists go by the order of arrival, newest first, and read no document.

use std::fmt;
use std::str::FromStr;

use jiff::Timestamp;
use uuid::Uuid;

use super::documents::checked;
use super::rows::{Record, job_columns, of_table, study_columns};
use super::statement::{Dialect, Statement, Text, query_as, query_scalar};
use super::{Damaged, Job, Status, Store, StoreError, StudyRecord, dialect};

/// Which jobs of a client to list. An absent part does not select.
#[derive(Debug, Clone, Default)]
pub struct Filter {
    /// Selects jobs in one of these states.
    pub statuses: Option<Vec<Status>>,
    /// Selects jobs with this tag.
    pub tag: Option<String>,
    /// These only.
    pub ids: Option<Vec<Uuid>>,
    /// Selects jobs of designs of this study, or jobs that stand alone.
    pub study: Option<Membership>,
    /// Selects jobs that this user of the client submitted.
    pub submitted_by: Option<String>,
    /// Selects jobs submitted in this time.
    pub span: Span,
    /// Selects jobs behind this place in the list.
    pub after: Option<Cursor>,
}

/// Which studies of a client to list.
#[derive(Debug, Clone, Default)]
pub struct StudyFilter {
    /// Selects studies of this name.
    pub name: Option<String>,
    /// Selects studies with this tag.
    pub tag: Option<String>,
    /// Selects studies that this user of the client submitted.
    pub submitted_by: Option<String>,
    /// Selects studies submitted in this time.
    pub span: Span,
    /// Selects studies behind this place in the list.
    pub after: Option<Cursor>,
}

/// A span of time. Jobs are listed in the order in which they arrived, so that it is a part of the list. It begins with the
/// first that was submitted at `from` or later, and ends before the first that was submitted at `until` or later.
#[derive(Debug, Clone, Copy, Default)]
pub struct Span {
    /// Its begin.
    pub from: Option<Timestamp>,
    /// Its end, which does not belong to it.
    pub until: Option<Timestamp>,
}

/// Membership of a job in a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Membership {
    /// It belongs to this one.
    Of(Uuid),
    /// It stands alone.
    Alone,
}

impl Store {
    /// A job of a client.
    pub async fn find(&self, client: &str, id: Uuid) -> Result<Option<Job>, StoreError> {
        let job = query_as(concat!(
            "select ",
            job_columns!(),
            " from jobs where id = $1 and client = $2"
        ))
        .bind(id.to_string())
        .bind(client)
        .fetch_optional(&self.readers)
        .await?;
        Ok(job)
    }

    /// The client that submitted a job.
    pub async fn owner_of_job(&self, id: Uuid) -> Result<Option<String>, StoreError> {
        let owner = query_scalar("select client from jobs where id = $1").bind(id.to_string());
        Ok(owner.fetch_optional(&self.readers).await?)
    }

    /// The client that submitted a study.
    pub async fn owner_of_study(&self, id: Uuid) -> Result<Option<String>, StoreError> {
        let owner = query_scalar("select client from studies where id = $1").bind(id.to_string());
        Ok(owner.fetch_optional(&self.readers).await?)
    }

    /// The submission of a job, JSON.
    pub async fn submission(
        &self,
        id: Uuid,
    ) -> Result<Option<Result<String, Damaged>>, StoreError> {
        let found = query_as("select body, checksum from submissions where job = $1");
        let found = found
            .bind(id.to_string())
            .fetch_optional(&self.readers)
            .await?;
        Ok(found.map(|found| checked(format_args!("of the job {id}"), found)))
    }

    /// The version of the document of a submission.
    pub async fn document_version(&self, id: Uuid) -> Result<Option<i64>, StoreError> {
        let version = query_scalar("select document_version from jobs where id = $1")
            .bind(id.to_string())
            .fetch_optional(&self.readers)
            .await?;
        Ok(version)
    }

    /// At most `limit` jobs of a client, newest first.
    pub async fn list(
        &self,
        client: &str,
        filter: &Filter,
        limit: u32,
    ) -> Result<Vec<Job>, StoreError> {
        let Some(statuses) = &filter.statuses else {
            return self.list_of(client, filter, None, limit).await;
        };
        // Each state has its stretch of an index; a list of several states in one query would sort all of them.
        let mut jobs = Vec::new();
        for status in statuses {
            jobs.extend(self.list_of(client, filter, Some(*status), limit).await?);
        }
        jobs.sort_by_key(|job: &Job| std::cmp::Reverse(job.sequence));
        jobs.dedup_by_key(|job| job.sequence);
        jobs.truncate(limit as usize);
        Ok(jobs)
    }

    async fn list_of(
        &self,
        client: &str,
        filter: &Filter,
        status: Option<Status>,
        limit: u32,
    ) -> Result<Vec<Job>, StoreError> {
        let query = filter.query(self.readers.dialect(), client, status, limit);
        Ok(query.fetch_all(&self.readers).await?)
    }

    /// A study of a client.
    pub async fn find_study(
        &self,
        client: &str,
        id: Uuid,
    ) -> Result<Option<StudyRecord>, StoreError> {
        let study = query_as(concat!(
            "select ",
            study_columns!(),
            " from studies where id = $1 and client = $2"
        ))
        .bind(id.to_string())
        .bind(client)
        .fetch_optional(&self.readers)
        .await?;
        Ok(study)
    }

    /// A study as it was sent, JSON, if it has no more characters than `most`.
    pub async fn study_text(
        &self,
        id: Uuid,
        most: u64,
    ) -> Result<Option<Result<String, Damaged>>, StoreError> {
        let found: Option<(String, Option<i64>)> = query_as(
            "select body, checksum from study_documents where study = $1 and length(body) <= $2",
        )
        .bind(id.to_string())
        .bind(super::column(most))
        .fetch_optional(&self.readers)
        .await?;
        Ok(found.map(|found| checked(format_args!("of the study {id}"), found)))
    }

    /// The number of bytes of a study as it was sent.
    pub async fn study_text_bytes(&self, id: Uuid) -> Result<Option<i64>, StoreError> {
        let bytes = query_scalar(
            "select cast(octet_length(body) as bigint) from study_documents where study = $1",
        );
        let bytes = bytes.bind(id.to_string()).fetch_optional(&self.readers);
        Ok(bytes.await?)
    }

    /// At most `limit` studies of a client, newest first.
    pub async fn list_studies(
        &self,
        client: &str,
        filter: &StudyFilter,
        limit: u32,
    ) -> Result<Vec<StudyRecord>, StoreError> {
        let query = filter.query(self.readers.dialect(), client, limit);
        Ok(query.fetch_all(&self.readers).await?)
    }

    /// The queue as an operator sees it.
    pub async fn depth(&self) -> Result<Depth, StoreError> {
        let (alone, in_studies, running, oldest) =
            query_as(dialect::depth()).fetch_one(&self.readers).await?;
        let oldest: Option<i64> = oldest;
        Ok(Depth {
            alone,
            in_studies,
            running,
            oldest: oldest.and_then(|at| Timestamp::from_microsecond(at).ok()),
        })
    }
}

/// How many jobs wait and run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Depth {
    /// Jobs that wait and stand alone.
    pub alone: i64,
    /// Jobs of studies that wait.
    pub in_studies: i64,
    /// Jobs that run.
    pub running: i64,
    /// When the job alone that has waited longest was submitted.
    pub oldest: Option<Timestamp>,
}

/// Hints that keep SQLite on the index that has the order of the rows. PostgreSQL decides by its own statistics.
struct Hints {
    /// A join that goes through its left side.
    join: &'static str,
    /// A sign that keeps an index from being used.
    no_index: &'static str,
}

impl Hints {
    fn of(dialect: Dialect) -> Self {
        match dialect {
            Dialect::Sqlite => Self {
                join: "cross join",
                no_index: "+",
            },
            Dialect::Postgres => Self {
                join: "join",
                no_index: "",
            },
        }
    }
}

impl Filter {
    /// The query for jobs of one state or all.
    ///
    /// Where ids or a study are named they are few, and the client has many jobs.
    pub(super) fn query(
        &self,
        dialect: Dialect,
        client: &str,
        status: Option<Status>,
        limit: u32,
    ) -> Statement<Job> {
        let Hints { join, no_index } = Hints::of(dialect);
        let columns = of_table("jobs", job_columns!());
        let named = self.ids.is_some() || matches!(self.study, Some(Membership::Of(_)));
        let mut query = match &self.tag {
            Some(tag) => {
                let mut query = query_as(Text::Made(format!(
                    "select {columns} from job_tags {join} jobs on jobs.id = job_tags.job where job_tags.client = "
                )));
                query.push_bind(client);
                query.push(" and job_tags.tag = ").push_bind(tag);
                query
            }
            None => {
                let sign = if named { no_index } else { "" };
                let mut query = query_as(Text::Made(format!(
                    "select {columns} from jobs where {sign}jobs.client = "
                )));
                query.push_bind(client);
                query
            }
        };
        // The order of the tags is that of the jobs: nothing is sorted.
        let walked = if self.tag.is_some() {
            "job_tags"
        } else {
            "jobs"
        };
        bound_sequence(&mut query, walked, "jobs", client, self.span, self.after);
        if let Some(status) = status {
            query.push(" and jobs.status = ").push_bind(status.as_str());
        }
        if let Some(user) = &self.submitted_by {
            // Designs of one study and named jobs are few.
            let sign = if named || self.tag.is_some() {
                no_index
            } else {
                ""
            };
            query.push(&format!(" and {sign}jobs.submitted_by = "));
            query.push_bind(user);
        }
        if let Some(ids) = &self.ids {
            // A list is not empty in SQL; nothing is equal to null.
            query.push(" and jobs.id in (null");
            for id in ids {
                query.push(", ").push_bind(id.to_string());
            }
            query.push(")");
        }
        match self.study {
            Some(Membership::Of(study)) => {
                let sign = if self.ids.is_some() { no_index } else { "" };
                query.push(&format!(" and {sign}jobs.study = "));
                query.push_bind(study.to_string());
            }
            Some(Membership::Alone) => {
                query.push(" and jobs.study is null");
            }
            None => {}
        }
        query.push(&format!(" order by {walked}.sequence desc limit "));
        query.push_bind(limit);
        query
    }
}

impl StudyFilter {
    fn query(&self, dialect: Dialect, client: &str, limit: u32) -> Statement<StudyRecord> {
        let Hints { join, .. } = Hints::of(dialect);
        let columns = of_table("studies", study_columns!());
        let mut query = match &self.tag {
            Some(tag) => {
                let mut query = query_as(Text::Made(format!(
                    "select {columns} from study_tags {join} studies on studies.id = study_tags.study
                     where study_tags.client = "
                )));
                query.push_bind(client);
                query.push(" and study_tags.tag = ").push_bind(tag);
                query
            }
            None => {
                let mut query = query_as(Text::Made(format!(
                    "select {columns} from studies where studies.client = "
                )));
                query.push_bind(client);
                query
            }
        };
        let walked = if self.tag.is_some() {
            "study_tags"
        } else {
            "studies"
        };
        bound_sequence(&mut query, walked, "studies", client, self.span, self.after);
        if let Some(user) = &self.submitted_by {
            query.push(" and studies.submitted_by = ").push_bind(user);
        }
        if let Some(name) = &self.name {
            query.push(" and studies.name = ").push_bind(name);
        }
        query.push(&format!(" order by {walked}.sequence desc limit "));
        query.push_bind(limit);
        query
    }
}

/// Limits a list to a span of time and to the rows behind a cursor, by the sequence in the table `walked`.
fn bound_sequence<T: Record>(
    query: &mut Statement<T>,
    walked: &str,
    timed: &str,
    client: &str,
    span: Span,
    after: Option<Cursor>,
) {
    let first_since = |query: &mut Statement<T>, at: Timestamp| {
        query.push(&format!(
            "coalesce((select t.sequence from {timed} as t where t.client = "
        ));
        query.push_bind(client);
        query
            .push(" and t.submitted_at >= ")
            .push_bind(at.as_microsecond());
        query.push(" order by t.submitted_at, t.sequence limit 1), 9223372036854775807)");
    };
    if let Some(from) = span.from {
        query.push(&format!(" and {walked}.sequence >= "));
        first_since(query, from);
    }
    if let Some(until) = span.until {
        query.push(&format!(" and {walked}.sequence < "));
        first_since(query, until);
    }
    if let Some(Cursor(sequence)) = after {
        query
            .push(&format!(" and {walked}.sequence < "))
            .push_bind(sequence);
    }
}

/// A place in a list of jobs or studies: behind the one that it names. Clients take it for an opaque word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cursor(
    /// Its place in the order of arrival.
    pub i64,
);

impl fmt::Display for Cursor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "c{:x}", self.0)
    }
}

/// The text is no cursor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("this is not a cursor that a list has given")]
pub struct NoCursor;

impl FromStr for Cursor {
    type Err = NoCursor;

    fn from_str(text: &str) -> Result<Self, NoCursor> {
        let digits = text.strip_prefix('c').ok_or(NoCursor)?;
        let sequence = i64::from_str_radix(digits, 16).map_err(|_| NoCursor)?;
        let cursor = Self(sequence);
        // Another spelling of a number is none that a list has given.
        if sequence > 0 && cursor.to_string() == text {
            Ok(cursor)
        } else {
            Err(NoCursor)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cursor_reads_what_it_writes_and_nothing_else() {
        for sequence in [1, 4711, i64::MAX] {
            let cursor = Cursor(sequence);
            assert_eq!(cursor.to_string().parse(), Ok(cursor));
        }
        for text in [
            "",
            "c",
            "0",
            "c0",
            "c-1",
            "c+1",
            "c01",
            "cG",
            "c8000000000000000",
        ] {
            assert_eq!(text.parse::<Cursor>(), Err(NoCursor), "{text}");
        }
    }
}
