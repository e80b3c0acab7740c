//! Work of some milliseconds or more that no request should hold others up with.

use std::sync::LazyLock;

use meshwright_connections::{Budget, Part};
use meshwright_engine::run::Run;
use meshwright_wire::{Code, Problem};

use super::problem::internal;

/// Maximum number of tables read at the same time. Each takes a connection to the database. There are twice as many connections, so that short queries never
/// wait for long ones.
static READERS: LazyLock<Budget> = LazyLock::new(|| Budget::of(2));

/// The turn of `client` to read some of a table.
pub(super) async fn turn_to_read(client: &str) -> Part {
    READERS.take(client, 1).await
}

/// That somebody still waits for the work of `run`.
///
/// # Errors
///
/// `stopped`, which nobody reads.
pub(super) fn goes_on(run: &Run) -> Result<(), Problem> {
    let stopped = |_| Problem::new(Code::Stopped, "Nobody waits for this any more.");
    run.check().map_err(stopped)
}

/// Does work for `client` where it holds nobody up. The work is stopped when nobody waits for it any more.
///
/// # Errors
///
/// `internal_error` where the work panics.
pub(super) async fn blocking<T: Send + 'static>(
    client: &str,
    work: impl FnOnce(&Run) -> T + Send + 'static,
) -> Result<T, Problem> {
    let work = |stop| work(&Run::new(stop, |_, _| {}));
    let done = meshwright_connections::blocking(client, work).await;
    done.map_err(|error| {
        tracing::error!(%error, "work beside the requests failed");
        internal()
    })
}

#[cfg(test)]
mod tests {
    use futures_util::poll;

    use super::*;

    #[tokio::test]
    async fn however_many_tables_a_client_reads_two_are_made_at_a_time_and_another_client_is_next()
    {
        let first = turn_to_read("reader").await;
        let _second = turn_to_read("reader").await;
        let mut others: Vec<_> = (0..40).map(|_| Box::pin(turn_to_read("reader"))).collect();
        for other in &mut others {
            assert!(poll!(other).is_pending());
        }
        let mut late = Box::pin(turn_to_read("somebody else"));
        assert!(poll!(&mut late).is_pending());
        drop(first);
        // Kept, so that nobody else has it.
        let turn = poll!(&mut late);
        assert!(turn.is_ready());
        for other in &mut others {
            assert!(poll!(other).is_pending());
        }
    }
}
