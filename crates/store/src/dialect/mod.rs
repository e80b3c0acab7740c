//! Statements with a text for each database, and statements of only one of them.
//!
//! Lists are parameters as JSON, so that one statement serves many jobs. Everything else in this folder is one text for both. [`sqlite`] and [`postgres`] have
//! the same names in the same order; a statement that one of them does not need is `None`.

/// New jobs: those that have a document are successful at once, the others wait. How a list is read and how the next places in the order
/// of arrival are found differs.
macro_rules! insert_jobs {
    ($next:literal, $list:literal) => {
        concat!(
            "insert into jobs (id, sequence, client, method, tags, input_hash, cost, status, positions_done, positions_total,
                               submitted_at, started_at, finished_at, elapsed, document, solver_version, same_as, study, keep, document_version,
                               submitted_by)
             select made.job, ",
            $next,
            ", made.owner, made.method, made.tags, made.input, made.cost,
                    case when made.results is null then 'accepted' else 'successful' end,
                    case when made.results is null then 0 else made.positions end, made.positions, made.at,
                    case when made.results is not null then made.at end, case when made.results is not null then made.at end,
                    case when made.results is not null then 0 end, made.results, case when made.results is not null then $2 end,
                    made.equal, made.study, made.keep, made.version, made.person
             from ",
            $list,
            " returning ",
            $crate::rows::job_columns!()
        )
    };
}

/// Outcomes of running jobs; the two differ in reading a list.
macro_rules! end_jobs {
    ($before:literal, $list:literal) => {
        concat!(
            $before,
            "update jobs
             set status = ended.word, finished_at = max(ended.at, started_at), elapsed = ended.took, lease_until = null,
                 document = ended.results, problem = ended.fault,
                 solver_version = case ended.word when 'successful' then $2 end,
                 positions_done = case ended.word when 'successful' then positions_total else positions_done end
             from ",
            $list,
            " returning ",
            $crate::rows::job_columns!()
        )
    };
}

/// The lanes with work to do, and the jobs that run here beside each of them; the two differ in finding these.
macro_rules! lanes {
    ($here:literal) => {
        concat!(
            "select own.client, own.person, own.lane, whole.due as client_due, coalesce(level.due, whole.served) as person_due,
                    own.due as lane_due, here.running, here.alone, here.waiting
             from shares as own join shares as whole on whole.client = own.client and whole.lane = '*'
             left join shares as level on level.client = own.client and level.lane = '@' || own.person
             cross join (",
            $here,
            ") as here
             where own.active > 0 and own.lane <> '*' and own.lane not like '@%'
             order by whole.due, whole.client, coalesce(level.due, whole.served), own.person, own.due, own.lane"
        )
    };
}

/// A study without rows.
macro_rules! insert_study {
    ($next:literal) => {
        concat!(
            "insert into studies (id, sequence, client, name, tags, body_hash, gear, total, expanded, submitted_at,
                                  idempotency_key, document_version, submitted_by)
             values ($1, ",
            $next,
            ", $2, $3, $4, $5, $6, $7, 0, $8, $9, $10, $11)
             returning sequence"
        )
    };
}

/// Messages to a webhook that nobody sends now.
macro_rules! take_messages {
    ($which:literal, $locked:literal) => {
        concat!(
            "update messages set next_at = $3 where id in (
               select id from messages where webhook = $1 and arrived_at is null and next_at <= $2
                 and exists (select 1 from webhooks w where w.id = $1 and w.disabled_at is null and w.retry_at <= $2) ",
            $which,
            " order by id limit $4 ",
            $locked,
            ")
             returning id, body"
        )
    };
}

pub(super) mod postgres;
pub(super) mod sqlite;

use super::statement::Text;

/// Makes a function for each name that gives the statement of both dialects.
macro_rules! pairs {
    ($($(#[$doc:meta])* $function:ident = $name:ident;)*) => {
        $(
            $(#[$doc])*
            pub(crate) fn $function() -> Text {
                Text::Differing { sqlite: sqlite::$name, postgres: postgres::$name }
            }
        )*
    };
}

pairs! {
    /// Begins a transaction that writes.
    begin = BEGIN;
    /// Begins a transaction whose commit does not wait for the disk.
    begin_relaxed = BEGIN_RELAXED;
    /// Ends such a one.
    commit_relaxed = COMMIT_RELAXED;
    /// Writes something, to find out whether that works.
    probe = PROBE;
    /// From here to its end, no other transaction measures a job against the bounds of the queue.
    lock_queue = LOCK_QUEUE;
    /// The same of studies.
    lock_studies = LOCK_STUDIES;
    /// The same of webhooks.
    lock_webhooks = LOCK_WEBHOOKS;
    /// The same of links.
    lock_links = LOCK_LINKS;
    /// From here to its end, no other transaction decides whose turn it is.
    lock_turn = LOCK_TURN;
    /// From here to its end, no other transaction changes the shares of the client $1.
    lock_shares = LOCK_SHARES;
    /// The lanes with work to do, in the order in which they are due. Beside each: how many jobs run here, how many of those are to run alone,
    /// and 1 if one that is to run alone waits. $1: the process.
    lanes = LANES;
    /// The next job that is to be run alone. $1: the latest version of documents that is read.
    next_suspect = NEXT_SUSPECT;
    /// The jobs of a lane whose turn it is, in their order, but for those of which an equal one is running. $1: client, $2: lane, $3: the
    /// latest version of documents that is read, $4: behind this place in the order of arrival, $5: how many,
    /// $6: solver version, for whether an equal one may have been computed.
    next_waiting = NEXT_WAITING;
    /// Earlier results of a client. $1: client, $2: input hash, $3: solver version, $4: 1 if the whole results have to be stored.
    known = KNOWN;
    /// Which inputs a client may have had computed. $1: client, $2: solver version, $3: a list of input hashes.
    known_among = KNOWN_AMONG;
    /// The submissions of new jobs. $1: a list.
    insert_submissions = INSERT_SUBMISSIONS;
    /// Rows of a study. $1: a list, $2: the study.
    insert_study_rows = INSERT_STUDY_ROWS;
    /// Accepted -> running. $1: a list of ids, $2: now, $3: the steady clock, $4: how long the lease lasts, $5: the process.
    start = START;
    /// Where jobs stand: id, attempt, status. $1: a list of ids.
    states = STATES;
    /// Running -> successful or failed. $1: a list of outcomes, $2: the solver's version.
    end = END;
    /// Running -> running. $1: a list of how far each has come, $2: the steady clock, $3: how long the lease lasts.
    report = REPORT;
    /// The jobs that run: id, process, and whether the lease is over (1), and since another one (2). $1: the steady clock, $2:
    /// how long a lease lasts.
    running = RUNNING;
    /// New jobs. $1: a list, $2: the solver's version for those that have results. See `insert_jobs`.
    insert_jobs = INSERT_JOBS;
    /// A study. $1 to $11: see `insert_study`.
    insert_study = INSERT_STUDY;
    /// Keeps documents, unless they are kept already. $1: a list of them, $2: their bodies, one behind the other.
    insert_documents = INSERT_DOCUMENTS;
    /// Stores summaries of documents for the tables of studies. $1: a list.
    insert_summaries = INSERT_SUMMARIES;
    /// From here to its end, no other transaction begins or ceases to need the document $1.
    lock_document = LOCK_DOCUMENT;
    /// Accepted or running -> dismissed. $1: study, $2: now, $3: accepted or running, $4: how many.
    dismiss_designs = DISMISS_DESIGNS;
    /// Prevents other transactions from removing old rows until its end.
    keep_alone = KEEP_ALONE;
    /// Studies without all their rows, which nobody expands. $1: the steady clock, $2: for how long they are taken, $3: the
    /// latest version of documents that is read.
    unfinished_expansions = UNFINISHED_EXPANSIONS;
    /// The study $1 is being expanded. $2: the steady clock, $3: for how long.
    expanding = EXPANDING;
    /// How many jobs wait and run.
    depth = DEPTH;
    /// Now, by the clock that all processes share. $1: the steady clock.
    steady_now = STEADY_NOW;
    /// Takes pings that wait. $1: webhook, $2: now, $3: until when, $4: how many.
    take_pings = TAKE_PINGS;
    /// Takes messages that wait, the oldest first. Parameters as above.
    take_messages = TAKE_MESSAGES;
}
