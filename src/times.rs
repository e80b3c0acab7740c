//! Timeouts of the service, in one place.

use std::time::Duration;

/// Timeouts of the service.
///
/// `meshwright serve` has [`Times::USUAL`]. A test that would wait for one of them shortens it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Times {
    /// Time for one document of the identity provider.
    pub provider: Duration,
    /// Time for one attempt to send a message to a webhook.
    pub webhook: Duration,
    /// Time for the body of a request to arrive, from when there is memory for it.
    pub body: Duration,
    /// Time for a request until the head of its answer. Longer than the longest wait that a client may ask for.
    pub request: Duration,
    /// Time that a request waits for a file that is computed anew, before it is answered 202.
    pub file: Duration,
    /// Time that such a file is kept, once a client was answered 202.
    pub keep_file: Duration,
    /// Time between two looks at the jobs of such a file, which ends with the last of them.
    pub look_at_jobs: Duration,
    /// Time between two looks at the key of an open stream of events, which ends with its key.
    pub look_at_keys: Duration,
    /// Time that running work and open answers have to end at a shutdown. The database has one second more, see [`END`](crate::serve::END).
    pub shutdown: Duration,
}

impl Times {
    /// The timeouts of `meshwright serve`; its help and docs/operations.md list them.
    pub const USUAL: Self = Self {
        provider: Duration::from_secs(5),
        webhook: Duration::from_secs(10),
        body: Duration::from_secs(30),
        request: Duration::from_secs(90),
        file: Duration::from_secs(10),
        keep_file: Duration::from_secs(300),
        look_at_jobs: Duration::from_secs(1),
        look_at_keys: Duration::from_secs(1),
        shutdown: Duration::from_secs(8),
    };

    /// The timeouts in words, for the help of `meshwright serve`.
    pub(crate) fn help(self) -> String {
        let Self {
            provider,
            webhook,
            body,
            request,
            file,
            keep_file,
            look_at_jobs,
            look_at_keys,
            shutdown,
        } = self;
        let lines = [
            (
                body,
                "the body of a request, from when there is memory for it",
            ),
            (request, "a request, until the head of its answer"),
            (
                file,
                "a request for a file that is computed, until it is answered 202",
            ),
            (
                keep_file,
                "a file that was answered with 202, until it is removed",
            ),
            (look_at_jobs, "between two looks at the jobs of such a file"),
            (
                look_at_keys,
                "between two looks at the key of an open stream",
            ),
            (provider, "one document of the identity provider"),
            (webhook, "one attempt to send a message to a webhook"),
            (shutdown, "running work and open answers at a shutdown"),
        ];
        let lines = lines.map(|(time, what)| format!("\n  {:>3} s  {what}", time.as_secs_f64()));
        format!("Timeouts without an option:{}", lines.concat())
    }
}
