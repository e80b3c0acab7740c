//! Answers to a submission and to a list, of jobs and of studies.

use meshwright_store::Cursor;

/// A job or a study that answers a submission.
#[derive(Debug, Clone, PartialEq)]
pub struct Submitted<T> {
    /// As it stands now.
    pub record: T,
    /// True if an earlier request with the same key made it.
    pub repeated: bool,
}

/// Some jobs or studies of a list.
#[derive(Debug)]
pub struct Listed<T> {
    /// The items, newest first.
    pub items: Vec<T>,
    /// Where the list goes on.
    pub next: Option<Cursor>,
}

impl<T> Listed<T> {
    /// The first `limit` of `found`, which holds one more than asked for if the list goes on.
    pub(super) fn first(mut found: Vec<T>, limit: u32, sequence: impl Fn(&T) -> i64) -> Self {
        let goes_on = found.len() > limit as usize;
        found.truncate(limit as usize);
        let last = found.last().filter(|_| goes_on);
        let next = last.map(|item| Cursor(sequence(item)));
        Self { items: found, next }
    }
}
