//! Other processes on the same database: their reports reach the requests that wait here, and jobs cancelled there stop here.

use std::sync::Arc;
use std::time::Duration;

use meshwright_store::{Listener, Notice, Status, Store, StoreError};
use tokio::time::{interval, sleep};
use tokio_util::sync::CancellationToken;
use tracing::warn;

use super::live::Live;

/// Interval at which every process looks even without a notification: one may be lost, and progress is never notified.
const LOOK: Duration = Duration::from_secs(2);

/// Before it is tried to listen again.
const PAUSE: Duration = Duration::from_millis(500);

/// Hears other processes until the stop.
pub(super) async fn hear(store: Store, live: Arc<Live>, stop: CancellationToken) {
    let look = async {
        let mut tick = interval(LOOK);
        loop {
            tick.tick().await;
            live.look();
        }
    };
    tokio::select! {
        () = stop.cancelled() => {}
        () = look => {}
        () = listen(&store, &live) => {}
    }
}

/// Listens until the store is closed.
async fn listen(store: &Store, live: &Live) {
    let mut listener = None;
    loop {
        match next(store, &mut listener).await {
            Ok(told) => pass_on(told, live),
            Err(_) if store.is_closed() => return,
            Err(error) => {
                warn!(%error, "other processes cannot be heard; looking every two seconds instead");
                listener = None;
                sleep(PAUSE).await;
            }
        }
    }
}

async fn next(store: &Store, listener: &mut Option<Listener>) -> Result<Notice, StoreError> {
    match listener {
        Some(listener) => listener.next().await,
        None => {
            *listener = store.listen().await?;
            Ok(Notice::Missed)
        }
    }
}

fn pass_on(told: Notice, live: &Live) {
    match told {
        Notice::Work => live.ring(),
        Notice::Jobs(status, ids) => {
            for id in ids {
                if status == Status::Dismissed
                    && let Some(running) = live.running(id)
                {
                    running.stop();
                }
                if status.has_ended() {
                    live.changed(id);
                } else {
                    live.goes_on(id);
                }
            }
        }
        Notice::Message => live.mail.notify_one(),
        Notice::Study(id) => live.changed(id),
        Notice::Missed => live.look(),
    }
}
