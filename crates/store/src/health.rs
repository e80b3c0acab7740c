//! Checks whether writes reach the database, and the reason if they do not.

use std::sync::Arc;

use tokio::sync::{Notify, watch};
use tracing::{error, info};

use super::error::{StoreError, may_pass};

/// State of the writes to the database.
#[derive(Debug)]
pub(super) struct Health {
    /// Why nothing can be stored, if so.
    pub(super) fault: watch::Sender<Option<String>>,
    /// Rung when a transaction came to no end.
    pub(super) doubt: Notify,
}

impl Health {
    pub(super) fn new() -> Arc<Self> {
        Arc::new(Self {
            fault: watch::Sender::new(None),
            doubt: Notify::new(),
        })
    }

    pub(super) fn found(&self, result: Result<&(), &StoreError>) {
        self.tell(result.err().map(cause));
    }

    /// A transaction did not begin, if that may pass.
    pub(super) fn failed(&self, error: &sqlx::Error) {
        if may_pass(error) {
            self.tell(Some(error.to_string()));
        }
    }

    fn tell(&self, now: Option<String>) {
        self.fault.send_if_modified(|fault| {
            match (&*fault, &now) {
                (None, Some(cause)) => error!(cause, "nothing can be stored"),
                (Some(_), None) => info!("storing works again"),
                _ => {}
            }
            let changed = fault.is_some() != now.is_some();
            *fault = now;
            changed
        });
    }
}

/// The cause as the system words it.
fn cause(error: &StoreError) -> String {
    std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string)
}
