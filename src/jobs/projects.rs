//! Projects: documents that a client keeps under a name until it deletes them. The service reads nothing of a document.

use jiff::Timestamp;
use meshwright_store::{NewProject, ProjectChange, ProjectOutcome, ProjectRecord};
use meshwright_wire::hash::sha256_hex_of;
use uuid::Uuid;

use super::Cursor;
use super::error::JobError;
use super::listed::Listed;
use super::queue::{Jobs, KEY_LIFETIME, Member};

/// The number of projects that a client may have.
pub const MOST_PROJECTS: i64 = 200;

/// The number of bytes that the document of a project may have.
pub const MOST_PROJECT_BYTES: usize = 1_000_000;

/// The number of characters that the name of a project may have.
const LONGEST_PROJECT_NAME: usize = 200;

/// A name and a document that may be kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProjectContent {
    name: String,
    document: String,
}

/// Why something cannot be done with a project.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ProjectError {
    /// The name, of so many characters, is empty, too long, or has a control character.
    #[error(
        "the name of a project has 1 to {LONGEST_PROJECT_NAME} characters, none of them a control character, and not only spaces; this one has {0}"
    )]
    Name(usize),
    /// The document has so many bytes, which are too many.
    #[error("the document has {0} bytes; it may have {MOST_PROJECT_BYTES}")]
    TooLarge(usize),
    /// The client has as many projects as it may.
    #[error("you have {MOST_PROJECTS} projects, which is the limit; delete one first")]
    TooMany,
    /// The client has no project of this id.
    #[error("there is no project {0}")]
    NotFound(Uuid),
    /// Somebody has changed the project since it was read.
    #[error("the project was changed since it was read")]
    Changed,
    /// The store is why.
    #[error(transparent)]
    Job(#[from] JobError),
}

impl From<meshwright_store::StoreError> for ProjectError {
    fn from(error: meshwright_store::StoreError) -> Self {
        Self::Job(error.into())
    }
}

impl ProjectContent {
    /// A name and a document, JSON.
    ///
    /// # Errors
    ///
    /// [`ProjectError::Name`], [`ProjectError::TooLarge`].
    pub fn new(name: String, document: String) -> Result<Self, ProjectError> {
        let length = name.chars().count();
        let is_name = !name.trim().is_empty()
            && length <= LONGEST_PROJECT_NAME
            && !name.chars().any(char::is_control);
        if !is_name {
            return Err(ProjectError::Name(length));
        }
        if document.len() > MOST_PROJECT_BYTES {
            return Err(ProjectError::TooLarge(document.len()));
        }
        Ok(Self { name, document })
    }
}

impl Jobs {
    /// Keeps a new project of a client. True beside one that an earlier request with the same key has made.
    ///
    /// # Errors
    ///
    /// [`ProjectError::TooMany`], [`JobError::KeyConflict`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn add_project(
        &self,
        member: &Member,
        content: ProjectContent,
        idempotency_key: Option<String>,
    ) -> Result<(ProjectRecord, bool), ProjectError> {
        self.refuse_if_failing()?;
        let now = self.clock.now();
        let new = NewProject {
            id: Uuid::now_v7(),
            client: member.client.clone(),
            submitted_by: member.user.clone(),
            body_hash: sha256_hex_of(&[&content.name, &content.document]),
            name: content.name,
            document: content.document,
            idempotency_key,
            most: MOST_PROJECTS,
            created_at: now,
        };
        let keys_since = now.saturating_sub(KEY_LIFETIME).unwrap_or(Timestamp::MIN);
        match self.store.add_project(&new, keys_since).await? {
            ProjectOutcome::Made(project) => Ok((project, false)),
            ProjectOutcome::Repeated(project) => Ok((project, true)),
            ProjectOutcome::KeyConflict => Err(JobError::KeyConflict.into()),
            ProjectOutcome::TooMany => Err(ProjectError::TooMany),
        }
    }

    /// The projects of a client, newest first, `limit` of them behind the place `after`.
    ///
    /// # Errors
    ///
    /// [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn projects(
        &self,
        client: &str,
        after: Option<Cursor>,
        limit: u32,
    ) -> Result<Listed<ProjectRecord>, ProjectError> {
        let found = self.store.projects(client, after, limit + 1).await?;
        Ok(Listed::first(found, limit, |project| project.sequence))
    }

    /// A project of a client.
    ///
    /// # Errors
    ///
    /// [`ProjectError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn project(&self, client: &str, id: Uuid) -> Result<ProjectRecord, ProjectError> {
        let found = self.store.find_project(client, id).await?;
        found.ok_or(ProjectError::NotFound(id))
    }

    /// A project of a client with its document.
    ///
    /// # Errors
    ///
    /// [`ProjectError::NotFound`], [`JobError::Damaged`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn project_document(
        &self,
        client: &str,
        id: Uuid,
    ) -> Result<(ProjectRecord, String), ProjectError> {
        let found = self.store.project_document(client, id).await?;
        let (project, document) = found.ok_or(ProjectError::NotFound(id))?;
        Ok((project, document.map_err(JobError::from)?))
    }

    /// Gives a project of a client another content, unless somebody has changed it since it was `read`.
    ///
    /// # Errors
    ///
    /// [`ProjectError::Changed`], [`ProjectError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn change_project(
        &self,
        client: &str,
        read: &ProjectRecord,
        content: &ProjectContent,
    ) -> Result<ProjectRecord, ProjectError> {
        self.refuse_if_failing()?;
        let (store, now) = (&self.store, self.clock.now());
        let changed = store.change_project(client, read, &content.name, &content.document, now);
        done(read.id, changed.await?)
    }

    /// Deletes a project of a client, unless somebody has changed it since it was `read`.
    ///
    /// # Errors
    ///
    /// [`ProjectError::Changed`], [`ProjectError::NotFound`], [`JobError::Unavailable`], [`JobError::Database`].
    pub async fn delete_project(
        &self,
        client: &str,
        read: &ProjectRecord,
    ) -> Result<(), ProjectError> {
        done(read.id, self.store.delete_project(client, read).await?)
    }
}

fn done<T>(id: Uuid, change: ProjectChange<T>) -> Result<T, ProjectError> {
    match change {
        ProjectChange::Done(made) => Ok(made),
        ProjectChange::OtherRevision => Err(ProjectError::Changed),
        ProjectChange::Missing => Err(ProjectError::NotFound(id)),
    }
}
