//! Writing: one transaction after the other, on one connection that is given up when anything about it is in doubt.

use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use std::time::Duration;

use super::database_files::DatabaseFiles;
use super::health::Health;
use super::statement::{Connection, Pool, Text, query};
use super::{Store, StoreError, dialect};

/// While nothing can be stored, it is tried so often.
const BETWEEN_TRIES: Duration = Duration::from_millis(500);

/// A look that takes longer says that nothing can be stored now.
const LOOKING: Duration = Duration::from_secs(2);

/// A transaction that has the write lock from its first statement on. Dropped without an end, it closes its connection: after an error the database, the driver
/// and this program may disagree about the transaction.
pub(crate) struct Write {
    connection: Connection,
    health: Arc<Health>,
    /// Statement of the commit.
    commit: Text,
    /// True if the commit does not wait for the disk.
    relaxed: bool,
    ended: bool,
}

impl Store {
    /// Begins a transaction whose commit does not wait for the disk: for changes that a power failure may lose, because the lost work is then done again. A
    /// crash of the process loses nothing of it, and every later commit that waits includes it.
    pub(super) async fn begin_relaxed(&self) -> Result<Write, StoreError> {
        let begun = begin_with(
            &self.writer,
            &self.health,
            self.files.as_ref(),
            dialect::begin_relaxed(),
            Some(dialect::commit_relaxed()),
        );
        let begun = begun.await;
        if let Err(error) = &begun {
            self.health.found(Err(error));
        }
        begun
    }

    /// Begins a transaction that writes.
    pub(crate) async fn begin(&self) -> Result<Write, StoreError> {
        let begun = begin(&self.writer, &self.health, self.files.as_ref()).await;
        if let Err(error) = &begun {
            self.health.found(Err(error));
        }
        begun
    }

    /// Why nothing can be stored now; `None` if it can.
    pub fn fault(&self) -> Option<String> {
        self.health.fault.borrow().clone()
    }

    /// Comes back when something can be stored, as far as is known.
    pub async fn writable(&self) {
        let mut fault = self.health.fault.subscribe();
        // The sender lives as long as the store.
        let _ = fault.wait_for(Option::is_none).await;
    }

    /// Finds out whether something can be stored, by storing something.
    ///
    /// # Errors
    ///
    /// [`StoreError`] if not.
    pub async fn probe(&self) -> Result<(), StoreError> {
        let mut write = self.begin().await?;
        query(dialect::probe()).execute(&mut *write).await?;
        write.commit().await
    }

    /// Checks whether the next write can be stored: it writes a value, and checks the room on the disk.
    ///
    /// # Errors
    ///
    /// [`StoreError`] if not.
    pub async fn look(&self) -> Result<(), StoreError> {
        if let Some(files) = &self.files {
            files.check_room().map_err(sqlx::Error::Io)?;
        }
        let probe = tokio::time::timeout(LOOKING, self.probe()).await;
        probe.unwrap_or_else(|_| Err(sqlx::Error::PoolTimedOut.into()))
    }

    /// Watches over the writing: where it failed it is tried again, until the store is dropped or closed.
    pub(super) fn watch_writing(&self) {
        let (health, writer) = (Arc::downgrade(&self.health), self.writer.clone());
        let files = self.files.clone();
        let mut fault = self.health.fault.subscribe();
        tokio::spawn(async move {
            loop {
                let failing = fault.borrow_and_update().is_some();
                let Some(held) = health.upgrade() else {
                    return;
                };
                if failing {
                    tokio::time::sleep(BETWEEN_TRIES).await;
                } else {
                    tokio::select! {
                        changed = fault.changed() => {
                            if changed.is_err() { return; }
                        }
                        () = held.doubt.notified() => {}
                        () = writer.closed() => return,
                    }
                }
                if writer.is_closed() {
                    return;
                }
                try_out(&writer, &held, files.as_ref()).await;
            }
        });
    }
}

async fn try_out(writer: &Pool, health: &Arc<Health>, files: Option<&DatabaseFiles>) {
    let tried = async {
        if let Some(files) = files {
            files.check_room().map_err(sqlx::Error::Io)?;
        }
        let mut write = begin(writer, health, files).await?;
        query(dialect::probe()).execute(&mut *write).await?;
        write.commit().await
    };
    let result = tried.await;
    // Damage is no matter of trying again; whoever meets it says so.
    if !matches!(result, Err(StoreError::Broken(_))) {
        health.found(result.as_ref());
    }
}

async fn begin(
    writer: &Pool,
    health: &Arc<Health>,
    files: Option<&DatabaseFiles>,
) -> Result<Write, StoreError> {
    begin_with(writer, health, files, dialect::begin(), None).await
}

async fn begin_with(
    writer: &Pool,
    health: &Arc<Health>,
    files: Option<&DatabaseFiles>,
    words: Text,
    relaxed: Option<Text>,
) -> Result<Write, StoreError> {
    if let Some(files) = files {
        files.check_names().map_err(sqlx::Error::Io)?;
    }
    let mut connection = writer.acquire().await?;
    // In plain SQL, because the driver's count of open transactions survives an error that SQLite's does not.
    if let Err(error) = connection.begin(words, health).await {
        connection.close_on_drop();
        return Err(error.into());
    }
    Ok(Write {
        connection,
        health: Arc::clone(health),
        relaxed: relaxed.is_some(),
        commit: relaxed.unwrap_or_else(|| "commit".into()),
        ended: false,
    })
}

impl Write {
    /// Makes the changes last.
    pub(crate) async fn commit(mut self) -> Result<(), StoreError> {
        let committed = self.connection.say(self.commit.clone()).await;
        let committed = committed.map_err(StoreError::from);
        self.health.found(committed.as_ref());
        committed?;
        let waits = if self.relaxed { "no" } else { "yes" };
        metrics::counter!("meshwright_commits_total", "waits" => waits).increment(1);
        self.ended = true;
        Ok(())
    }

    /// Takes the changes back.
    pub(crate) async fn rollback(mut self) -> Result<(), StoreError> {
        self.connection.say("rollback").await?;
        // One that does not wait for the disk goes.
        self.ended = !self.relaxed;
        Ok(())
    }
}

impl Deref for Write {
    type Target = Connection;

    fn deref(&self) -> &Connection {
        &self.connection
    }
}

impl DerefMut for Write {
    fn deref_mut(&mut self) -> &mut Connection {
        &mut self.connection
    }
}

impl Drop for Write {
    fn drop(&mut self) {
        if !self.ended {
            self.connection.close_on_drop();
            self.health.doubt.notify_one();
        }
    }
}
