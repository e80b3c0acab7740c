//! Projects: documents that a client keeps under a name, each with a revision, so that of two writers the second one is refused.

use jiff::Timestamp;
use uuid::Uuid;

use super::documents::{checked, checksum};
use super::rows::{Record, Row, count, instant, uuid};
use super::statement::{query, query_as};
use super::{Cursor, Damaged, Store, StoreError, column, dialect};

/// A project to be kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewProject {
    /// The id of the project, a UUID of version 7.
    pub id: Uuid,
    /// The client whose project it is.
    pub client: String,
    /// The user of the client who makes it, if the client names one.
    pub submitted_by: Option<String>,
    /// The name of the project.
    pub name: String,
    /// The document, JSON.
    pub document: String,
    /// The word under which the client may ask again and get this project.
    pub idempotency_key: Option<String>,
    /// The hash of name and document.
    pub body_hash: String,
    /// The number of projects that a client may have.
    pub most: i64,
    /// The time of day.
    pub created_at: Timestamp,
}

/// A project as lists show it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProjectRecord {
    /// The id of the project.
    pub id: Uuid,
    /// Its place in the list of its client.
    pub sequence: i64,
    /// The name of the project.
    pub name: String,
    /// The revision, one more with every change.
    pub revision: i64,
    /// When it was changed last.
    pub updated_at: Timestamp,
    /// Bytes of the document.
    pub bytes: u64,
}

/// Outcome of [`Store::add_project`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ProjectOutcome {
    /// The project is kept.
    Made(ProjectRecord),
    /// The same was asked for before under this key: the project of that time, as it stands now.
    Repeated(ProjectRecord),
    /// The key was used for another project.
    KeyConflict,
    /// The client has as many projects as it may.
    TooMany,
}

/// Outcome of a change that names the revision that it was made from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ProjectChange<T> {
    /// The change is kept.
    Done(T),
    /// Somebody else has changed the project since.
    OtherRevision,
    /// The client has no such project.
    Missing,
}

impl Record for ProjectRecord {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        Ok(Self {
            id: uuid(row, "id")?,
            sequence: row.get("sequence")?,
            name: row.get("name")?,
            revision: row.get("revision")?,
            updated_at: instant(row, "updated_at")?,
            bytes: count(row, "bytes")?,
        })
    }
}

/// A project with its document and the checksum of that.
struct WithDocument(ProjectRecord, (String, Option<i64>));

impl Record for WithDocument {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        let written = (row.get("document")?, Some(row.get("checksum")?));
        Ok(Self(ProjectRecord::read(row)?, written))
    }
}

/// The columns of a project that lists read.
macro_rules! project_columns {
    () => {
        "id, sequence, name, revision, updated_at, bytes"
    };
}

impl Store {
    /// Keeps a new project. Keys under which projects were made before `keys_since` are forgotten.
    pub async fn add_project(
        &self,
        new: &NewProject,
        keys_since: Timestamp,
    ) -> Result<ProjectOutcome, StoreError> {
        struct Keyed(ProjectRecord, String);
        impl Record for Keyed {
            fn read(row: &Row) -> Result<Self, sqlx::Error> {
                Ok(Self(ProjectRecord::read(row)?, row.get("body_hash")?))
            }
        }
        let mut write = self.begin().await?;
        query(dialect::lock_projects()).execute(&mut *write).await?;
        query("update projects set idempotency_key = null where client = $1 and idempotency_key is not null and created_at < $2")
            .bind(&new.client)
            .bind(keys_since.as_microsecond())
            .execute(&mut *write)
            .await?;
        if let Some(key) = &new.idempotency_key {
            let earlier: Option<Keyed> = query_as(concat!(
                "select body_hash, ",
                project_columns!(),
                " from projects where client = $1 and idempotency_key = $2"
            ))
            .bind(&new.client)
            .bind(key)
            .fetch_optional(&mut *write)
            .await?;
            if let Some(Keyed(project, body_hash)) = earlier {
                write.rollback().await?;
                return Ok(if body_hash == new.body_hash {
                    ProjectOutcome::Repeated(project)
                } else {
                    ProjectOutcome::KeyConflict
                });
            }
        }
        let (kept, last): (i64, i64) =
            query_as("select count(*), coalesce(max(sequence), 0) from projects where client = $1")
                .bind(&new.client)
                .fetch_one(&mut *write)
                .await?;
        if kept >= new.most {
            write.rollback().await?;
            return Ok(ProjectOutcome::TooMany);
        }
        let made: ProjectRecord = query_as(concat!(
            "insert into projects (id, client, submitted_by, sequence, name, revision, created_at, updated_at,
                                   idempotency_key, body_hash, bytes, checksum, document)
             values ($1, $2, $3, $4, $5, 1, $6, $6, $7, $8, $9, $10, $11) returning ",
            project_columns!()
        ))
        .bind(new.id.to_string())
        .bind(&new.client)
        .bind(&new.submitted_by)
        .bind(last + 1)
        .bind(&new.name)
        .bind(new.created_at.as_microsecond())
        .bind(&new.idempotency_key)
        .bind(&new.body_hash)
        .bind(column(new.document.len() as u64))
        .bind(checksum(new.document.as_bytes()))
        .bind(&new.document)
        .fetch_one(&mut *write)
        .await?;
        write.commit().await?;
        Ok(ProjectOutcome::Made(made))
    }

    /// At most `limit` projects of a client behind the place `after`, newest first.
    pub async fn projects(
        &self,
        client: &str,
        after: Option<Cursor>,
        limit: u32,
    ) -> Result<Vec<ProjectRecord>, StoreError> {
        let projects = query_as(concat!(
            "select ",
            project_columns!(),
            " from projects where client = $1 and sequence < $2 order by sequence desc limit $3"
        ))
        .bind(client)
        .bind(after.map_or(i64::MAX, |Cursor(sequence)| sequence))
        .bind(limit)
        .fetch_all(&self.readers)
        .await?;
        Ok(projects)
    }

    /// A project of a client.
    pub async fn find_project(
        &self,
        client: &str,
        id: Uuid,
    ) -> Result<Option<ProjectRecord>, StoreError> {
        let project = query_as(concat!(
            "select ",
            project_columns!(),
            " from projects where id = $1 and client = $2"
        ));
        let project = project.bind(id.to_string()).bind(client);
        Ok(project.fetch_optional(&self.readers).await?)
    }

    /// A project of a client with its document, both of one revision.
    pub async fn project_document(
        &self,
        client: &str,
        id: Uuid,
    ) -> Result<Option<(ProjectRecord, Result<String, Damaged>)>, StoreError> {
        let found: Option<WithDocument> = query_as(concat!(
            "select document, checksum, ",
            project_columns!(),
            " from projects where id = $1 and client = $2"
        ))
        .bind(id.to_string())
        .bind(client)
        .fetch_optional(&self.readers)
        .await?;
        let checked = |WithDocument(project, written)| {
            let document = checked(format_args!("of the project {id}"), written);
            (project, document)
        };
        Ok(found.map(checked))
    }

    /// Gives a project another name and document, if its revision is still the one that was read.
    pub async fn change_project(
        &self,
        client: &str,
        read: &ProjectRecord,
        name: &str,
        document: &str,
        now: Timestamp,
    ) -> Result<ProjectChange<ProjectRecord>, StoreError> {
        let mut write = self.begin().await?;
        let changed: Option<ProjectRecord> = query_as(concat!(
            "update projects set name = $4, document = $5, bytes = $6, checksum = $7, updated_at = $8, revision = revision + 1
             where id = $1 and client = $2 and revision = $3 returning ",
            project_columns!()
        ))
        .bind(read.id.to_string())
        .bind(client)
        .bind(read.revision)
        .bind(name)
        .bind(document)
        .bind(column(document.len() as u64))
        .bind(checksum(document.as_bytes()))
        .bind(now.as_microsecond())
        .fetch_optional(&mut *write)
        .await?;
        write.commit().await?;
        match changed {
            Some(project) => Ok(ProjectChange::Done(project)),
            None => self.unchanged(client, read.id).await,
        }
    }

    /// Deletes a project, if its revision is still the one that was read.
    pub async fn delete_project(
        &self,
        client: &str,
        read: &ProjectRecord,
    ) -> Result<ProjectChange<()>, StoreError> {
        let mut write = self.begin().await?;
        let deleted = query("delete from projects where id = $1 and client = $2 and revision = $3")
            .bind(read.id.to_string())
            .bind(client)
            .bind(read.revision)
            .execute(&mut *write)
            .await?;
        write.commit().await?;
        if deleted > 0 {
            Ok(ProjectChange::Done(()))
        } else {
            self.unchanged(client, read.id).await
        }
    }

    /// The reason why a change that named a revision was not made.
    async fn unchanged<T>(&self, client: &str, id: Uuid) -> Result<ProjectChange<T>, StoreError> {
        Ok(match self.find_project(client, id).await? {
            Some(_) => ProjectChange::OtherRevision,
            None => ProjectChange::Missing,
        })
    }
}
