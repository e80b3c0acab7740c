//! A request that is being answered, and the limits for which it counts.

use std::sync::{Arc, Mutex, MutexGuard};

use super::budget::Part;
use super::connection::{Connection, Owner};
use super::limit::{Connections, Overloaded};

/// A request that is being answered, until the last byte of its answer was handed over to be written.
#[derive(Debug)]
pub struct ActiveRequest {
    connection: Arc<Connection>,
    limit: Arc<Connections>,
    /// Its part of the active connections of its client or of its address.
    part: Mutex<Option<Part>>,
}

impl ActiveRequest {
    pub(super) fn begin(connection: &Arc<Connection>, limit: &Arc<Connections>) -> Self {
        connection.request_begins();
        Self {
            connection: Arc::clone(connection),
            limit: Arc::clone(limit),
            part: Mutex::default(),
        }
    }

    /// Waits for a regular place, where its connection has none.
    ///
    /// # Errors
    ///
    /// [`Overloaded::Connections`], after a while.
    pub async fn leave_reserve(&self) -> Result<(), Overloaded> {
        self.limit.leave_reserve(&self.connection).await
    }

    /// Counts it for its address, unless it is counted already.
    ///
    /// # Errors
    ///
    /// [`Overloaded::Client`], where as many are active as may be.
    pub fn count_for_address(&self) -> Result<(), Overloaded> {
        if self.part().is_some() {
            return Ok(());
        }
        self.count_for(&Owner::Address(self.connection.address))
    }

    /// Counts the connection for this client, whose key it has, from now on.
    ///
    /// # Errors
    ///
    /// [`Overloaded::Client`], where as many of it are active as may be.
    pub fn authenticated(&self, client: &Arc<str>) -> Result<(), Overloaded> {
        self.connection.authenticated(client);
        self.count_for(&Owner::Client(Arc::clone(client)))
    }

    fn count_for(&self, owner: &Owner) -> Result<(), Overloaded> {
        *self.part() = None;
        *self.part() = Some(self.limit.count_active(&owner.name())?);
        Ok(())
    }

    fn part(&self) -> MutexGuard<'_, Option<Part>> {
        self.part.lock().expect("nothing panics with this lock")
    }
}

impl Drop for ActiveRequest {
    fn drop(&mut self) {
        self.connection.request_ends();
    }
}
