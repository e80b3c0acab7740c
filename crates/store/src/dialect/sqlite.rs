//! As SQLite says it. A transaction that writes has the file to itself, so that it needs no further locks; leases run by the
//! steady clock of the one process that there is.

use crate::rows::{job_columns, lane_of_job};

type Words = Option<&'static str>;

pub(crate) const BEGIN: Words = Some("begin immediate");

// In this journal mode, a power failure loses a commit that has not reached the disk; a crash of the process does not.
pub(crate) const BEGIN_RELAXED: Words = Some("pragma synchronous = normal; begin immediate");

pub(crate) const COMMIT_RELAXED: Words = Some("commit; pragma synchronous = full");

pub(crate) const PROBE: Words = Some("update served set due = due");

pub(crate) const LOCK_QUEUE: Words = None;

pub(crate) const LOCK_STUDIES: Words = None;

pub(crate) const LOCK_WEBHOOKS: Words = None;

pub(crate) const LOCK_LINKS: Words = None;

pub(crate) const LOCK_TURN: Words = None;

pub(crate) const LOCK_SHARES: Words = None;

pub(crate) const LANES: Words = Some(lanes!(
    "select count(*) as running, coalesce(sum(suspect), 0) as alone,
            (select count(*) from (select 1 from jobs where suspect = 1 and status = 'accepted' limit 1)) as waiting
     from jobs indexed by jobs_running where status = 'running'"
));

pub(crate) const NEXT_SUSPECT: Words = Some(
    "select id from jobs where suspect = 1 and status = 'accepted' and document_version <= $1 order by sequence limit 1",
);

pub(crate) const NEXT_WAITING: Words = Some(concat!(
    "select id, sequence, input_hash, cost, keep,
            exists (select 1 from jobs as equal
                    where equal.status = 'successful' and equal.client = waiting.client
                      and equal.input_hash = waiting.input_hash and equal.solver_version = $6)
     from jobs as waiting
     where status = 'accepted' and client = $1 and ",
    lane_of_job!(),
    " = $2 and document_version <= $3 and sequence > $4
       and not exists (select 1 from jobs as equal indexed by jobs_running
                       where equal.status = 'running' and equal.client = waiting.client
                         and equal.input_hash = waiting.input_hash)
     order by sequence limit $5"
));

// The one that was computed comes before those that were given its results.
pub(crate) const KNOWN: Words = Some(
    "select id, document, positions_total from jobs
     where client = $1 and input_hash = $2 and solver_version = $3 and status = 'successful'
       and (select whole from documents where hash = document) >= $4
     order by same_as is not null, sequence limit 1",
);

pub(crate) const KNOWN_AMONG: Words = Some(
    "select distinct input_hash from jobs
     where client = $1 and solver_version = $2 and status = 'successful' and input_hash in (select value from json_each($3))",
);

pub(crate) const INSERT_SUBMISSIONS: Words = Some(
    "insert into submissions (job, body, checksum)
     select value ->> 'job', value ->> 'body', value ->> 'checksum' from json_each($1)",
);

pub(crate) const INSERT_STUDY_ROWS: Words = Some(
    "insert into study_rows (study, position, label, changes, job, problem)
     select $2, value ->> 'position', value ->> 'label', value ->> 'changes', value ->> 'job', value ->> 'problem'
     from json_each($1) where true
     on conflict do nothing",
);

pub(crate) const START: Words = Some(concat!(
    "update jobs
     set status = 'running', attempt = attempt + 1, started_at = max($2, submitted_at), lease_until = $3 + $4,
         positions_done = 0
     where id in (select value from json_each($1)) and status = 'accepted'
     returning ",
    job_columns!(),
    ", (select body from submissions where job = jobs.id) as submission,
     (select checksum from submissions where job = jobs.id) as checksum"
));

pub(crate) const STATES: Words =
    Some("select id, attempt, status from jobs where id in (select value from json_each($1))");

pub(crate) const END: Words = Some(end_jobs!(
    "",
    "(select value ->> 'job' as job, value ->> 'claimed' as claimed, value ->> 'at' as at, value ->> 'took' as took,
             value ->> 'word' as word, value ->> 'results' as results, value ->> 'fault' as fault
      from json_each($1)) as ended
     where id = ended.job and attempt = ended.claimed and status = 'running'"
));

pub(crate) const REPORT: Words = Some(
    "update jobs set positions_done = reported.solved, positions_total = reported.total, lease_until = $2 + $3
     from (select value ->> 'job' as job, value ->> 'claimed' as claimed, value ->> 'solved' as solved, value ->> 'total' as total
           from json_each($1)) as reported
     where id = reported.job and attempt = reported.claimed and status = 'running'
     returning id, attempt",
);

// One process: there is nobody else to have lost.
pub(crate) const RUNNING: Words = Some(
    "select id, '', (lease_until < $1) + (lease_until + $2 < $1) from jobs indexed by jobs_running where status = 'running'",
);

pub(crate) const INSERT_JOBS: Words = Some(insert_jobs!(
    "latest.place + 1 + made.behind",
    "(select coalesce(max(sequence), 0) as place from jobs) as latest,
     (select key as behind, value ->> 'job' as job, value ->> 'owner' as owner, value ->> 'method' as method, value ->> 'tags' as tags,
             value ->> 'input' as input, value ->> 'cost' as cost, value ->> 'positions' as positions, value ->> 'at' as at,
             value ->> 'results' as results, value ->> 'equal' as equal, value ->> 'study' as study, value ->> 'keep' as keep,
             value ->> 'version' as version, value ->> 'person' as person
      from json_each($1)) as made"
));

pub(crate) const INSERT_STUDY: Words = Some(insert_study!(
    "(select coalesce(max(sequence), 0) + 1 from studies)"
));

pub(crate) const INSERT_DOCUMENTS: Words = Some(
    "insert into documents (hash, encoding, body, size, whole, checksum)
     select value ->> 'hash', 'gzip', coalesce(substr($2, value ->> 'starts', value ->> 'takes'), x''), value ->> 'size', value ->> 'whole',
            value ->> 'checksum'
     from json_each($1) where true
     on conflict (hash) do update set body = excluded.body, checksum = excluded.checksum, size = excluded.size, whole = 1
       where documents.whole < excluded.whole",
);

pub(crate) const INSERT_SUMMARIES: Words = Some(
    "insert into summaries (document, body, checksum)
     select value ->> 'hash', value ->> 'body', value ->> 'checksum' from json_each($1) where true
     on conflict (document) do nothing",
);

pub(crate) const LOCK_DOCUMENT: Words = None;

pub(crate) const DISMISS_DESIGNS: Words = Some(
    "update jobs set status = 'dismissed', finished_at = max(max($2, submitted_at), coalesce(started_at, 0)), lease_until = null
     where id in (select id from jobs where study = $1 and status = $3 order by sequence limit $4)
     returning id",
);

pub(crate) const KEEP_ALONE: Words = None;

// Only the start asks: this process expands all studies that it has accepted since.
pub(crate) const UNFINISHED_EXPANSIONS: Words = Some(
    "select id, client from studies where expanded < total and cancelled_at is null and document_version <= $3 order by sequence",
);

pub(crate) const EXPANDING: Words = None;

pub(crate) const DEPTH: Words = Some(
    "select (select count(*) from jobs where status = 'accepted' and coalesce(study, '') = ''),
            (select count(*) from jobs where status = 'accepted' and coalesce(study, '') <> ''),
            (select count(*) from jobs indexed by jobs_running where status = 'running'),
            (select min(submitted_at) from jobs where status = 'accepted' and coalesce(study, '') = '')",
);

pub(crate) const STEADY_NOW: Words = Some("select cast($1 as integer)");

pub(crate) const TAKE_PINGS: Words = Some(take_messages!("and kind = 'webhook.ping'", ""));

pub(crate) const TAKE_MESSAGES: Words = Some(take_messages!("", ""));
