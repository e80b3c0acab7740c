//! As PostgreSQL says it. Many processes write at the same time, at the isolation `read committed`, so each decision that
//! needs to be the only one of its kind takes a lock first. Locks are taken in one order, which excludes deadlocks: a kind
//! of decision, documents and jobs, studies (by the triggers), shares: clients by their names, each before its lanes.
//!
//! Leases run by the database's clock (`steady_now`), so that the clocks of the machines need not agree.

use crate::rows::{job_columns, lane_of_job};

type Words = Option<&'static str>;

pub(crate) const BEGIN: Words = Some("begin");

pub(crate) const BEGIN_RELAXED: Words = Some("begin; set local synchronous_commit = off");

pub(crate) const COMMIT_RELAXED: Words = Some("commit");

// Who has locked one of the tables that a submission needs keeps everybody from submitting.
pub(crate) const PROBE: Words = Some(
    "with no_jobs as (update jobs set attempt = attempt where false),
          no_submissions as (update submissions set body = body where false),
          no_documents as (update documents set size = size where false),
          no_studies as (update studies set version = version where false),
          no_rows as (update study_rows set label = label where false),
          no_study_documents as (update study_documents set body = body where false),
          no_tags as (update job_tags set tag = tag where false),
          no_study_tags as (update study_tags set tag = tag where false),
          no_idempotency_keys as (update idempotency_keys set key = key where false),
          no_shares as (update shares set due = due where false),
          no_served as (update served set due = due where false),
          no_summaries as (update summaries set body = body where false),
          no_messages as (update messages set next_at = next_at where false),
          no_webhooks as (update webhooks set url = url where false),
          no_projects as (update projects set name = name where false),
          no_links as (update links set ends_at = ends_at where false),
          no_keys as (select 1 from keys where false)
     update probed set number = number + 1",
);

// The bound of the queue is a count, and equal keys are looked for before they are written.
pub(crate) const LOCK_QUEUE: Words =
    Some("select 1 from pg_advisory_xact_lock(hashtext('meshwright'), 1)");

pub(crate) const LOCK_STUDIES: Words =
    Some("select 1 from pg_advisory_xact_lock(hashtext('meshwright'), 2)");

pub(crate) const LOCK_WEBHOOKS: Words =
    Some("select 1 from pg_advisory_xact_lock(hashtext('meshwright'), 3)");

pub(crate) const LOCK_LINKS: Words =
    Some("select 1 from pg_advisory_xact_lock(hashtext('meshwright'), 6)");

pub(crate) const LOCK_PROJECTS: Words =
    Some("select 1 from pg_advisory_xact_lock(hashtext('meshwright'), 7)");

// The turn depends on the lanes served before. Claimed rows are skipped by other claims.
// The turn depends on the lanes served before. Claimed rows are skipped by other claims.
pub(crate) const LOCK_TURN: Words =
    Some("select 1 from pg_advisory_xact_lock(hashtext('meshwright'), 4)");

pub(crate) const LOCK_SHARES: Words =
    Some("select 1 from shares where client = $1 and lane = '*' for update");

pub(crate) const LANES: Words = Some(lanes!(
    "select count(*) as running, cast(coalesce(sum(suspect), 0) as bigint) as alone,
            (select count(*) from (select 1 from jobs where suspect = 1 and status = 'accepted' limit 1) as one) as waiting
     from jobs where status = 'running' and owner = $1"
));

pub(crate) const NEXT_SUSPECT: Words = Some(
    "select id from jobs as waiting
     where suspect = 1 and status = 'accepted' and document_version <= $1
       and not exists (select 1 from jobs as equal
                       where equal.status = 'running' and equal.client = waiting.client
                         and equal.input_hash = waiting.input_hash)
     order by sequence limit 1 for update of waiting skip locked",
);

// The offsets have each equal one looked up by its input; joined, all that run, ran lately or have ended would be read.
pub(crate) const NEXT_WAITING: Words = Some(concat!(
    "select id, sequence, input_hash, cost, keep,
            cast(cast(exists (select 1 from jobs as equal
                              where equal.status = 'successful' and equal.client = waiting.client
                                and equal.input_hash = waiting.input_hash and equal.solver_version = $6 offset 0) as int) as bigint)
     from jobs as waiting
     where status = 'accepted' and client = $1 and ",
    lane_of_job!(),
    " = $2 and document_version <= $3 and sequence > $4
       and not exists (select 1 from jobs as equal
                       where equal.status = 'running' and equal.client = waiting.client
                         and equal.input_hash = waiting.input_hash offset 0)
     order by sequence limit $5 for update of waiting skip locked"
));

// Nobody removes a document to which a row is about to point.
pub(crate) const KNOWN: Words = Some(
    "select j.id, j.document, j.positions_total from jobs j join documents d on d.hash = j.document
     where j.client = $1 and j.input_hash = $2 and j.solver_version = $3 and j.status = 'successful' and d.whole >= $4
     order by j.same_as is not null, j.sequence limit 1 for key share",
);

pub(crate) const KNOWN_AMONG: Words = Some(
    "select distinct input_hash from jobs
     where client = $1 and solver_version = $2 and status = 'successful'
       and input_hash = any(array(select json_array_elements_text(cast($3 as json))))",
);

pub(crate) const INSERT_SUBMISSIONS: Words = Some(
    "insert into submissions (job, body, checksum)
     select job, body, checksum from json_to_recordset(cast($1 as json)) as given(job text, body text, checksum bigint)",
);

pub(crate) const INSERT_STUDY_ROWS: Words = Some(
    "insert into study_rows (study, position, label, changes, job, problem)
     select $2, position, label, changes, job, problem from json_to_recordset(cast($1 as json))
       as given(position bigint, label text, changes text, job text, problem text)
     on conflict do nothing",
);

// They are locked since they were found waiting. Were that said again, the server might read through all that wait.
pub(crate) const START: Words = Some(concat!(
    "update jobs
     set status = 'running', attempt = attempt + 1, started_at = max($2, submitted_at),
         lease_until = steady_now($3) + $4, owner = $5, positions_done = 0
     where id = any(array(select json_array_elements_text(cast($1 as json))))
     returning ",
    job_columns!(),
    ", (select body from submissions where job = jobs.id) as submission,
     (select checksum from submissions where job = jobs.id) as checksum"
));

pub(crate) const STATES: Words = Some(
    "select id, attempt, status from jobs where id = any(array(select json_array_elements_text(cast($1 as json))))",
);

// They are locked in one order, and looked at as they are then.
pub(crate) const END: Words = Some(end_jobs!(
    "with listed as (
       select job, claimed, at, took, word, results, fault from json_to_recordset(cast($1 as json))
         as listed(job text, claimed bigint, at bigint, took bigint, word text, results text, fault text)),
     held as materialized (
       select id as held_job, attempt as held_attempt, status as held_status from jobs
       where id = any(array(select job from listed)) order by sequence for update) ",
    "listed as ended join held on held_job = ended.job and held_attempt = ended.claimed and held_status = 'running'
     where id = held_job"
));

pub(crate) const REPORT: Words = Some(
    "update jobs set positions_done = reported.solved, positions_total = reported.total, lease_until = steady_now($2) + $3
     from json_to_recordset(cast($1 as json)) as reported(job text, claimed bigint, solved bigint, total bigint)
     where id = reported.job and attempt = reported.claimed and status = 'running'
     returning id, attempt",
);

pub(crate) const RUNNING: Words = Some(
    "select id, owner,
            cast(cast(lease_until < steady_now($1) as int) + cast(lease_until + $2 < steady_now($1) as int) as bigint)
     from jobs where status = 'running' order by study, id for update skip locked",
);

pub(crate) const INSERT_JOBS: Words = Some(insert_jobs!(
    "nextval('jobs_arrived')",
    "json_to_recordset(cast($1 as json))
       as made(job text, owner text, method text, tags text, input text, cost bigint, positions bigint, at bigint, results text, equal text,
               study text, keep text, version bigint, person text)"
));

pub(crate) const INSERT_STUDY: Words = Some(insert_study!("nextval('studies_arrived')"));

// One that is kept is locked, so that it is not removed before a job points to it.
pub(crate) const INSERT_DOCUMENTS: Words = Some(
    "insert into documents (hash, encoding, body, size, whole, checksum)
     select hash, 'gzip', substr($2, starts, takes), size, whole, checksum
     from json_to_recordset(cast($1 as json)) as given(hash text, starts int, takes int, size bigint, whole bigint, checksum bigint)
     order by hash collate \"C\"
     on conflict (hash) do update set size = excluded.size, whole = greatest(documents.whole, excluded.whole),
       checksum = case when documents.whole < excluded.whole then excluded.checksum else documents.checksum end,
       body = case when documents.whole < excluded.whole then excluded.body else documents.body end",
);

pub(crate) const INSERT_SUMMARIES: Words = Some(
    "insert into summaries (document, body, checksum)
     select hash, body, checksum from json_to_recordset(cast($1 as json)) as given(hash text, body text, checksum bigint) order by hash collate \"C\"
     on conflict (document) do nothing",
);

pub(crate) const LOCK_DOCUMENT: Words = Some("select 1 from documents where hash = $1 for update");

// Jobs are locked before their study, which the triggers change.
pub(crate) const DISMISS_DESIGNS: Words = Some(
    "update jobs set status = 'dismissed', finished_at = max(max($2, submitted_at), coalesce(started_at, 0)), lease_until = null
     where id in (select id from jobs where study = $1 and status = $3 order by sequence limit $4 for update)
     returning id",
);

pub(crate) const KEEP_ALONE: Words =
    Some("select 1 from pg_advisory_xact_lock(hashtext('meshwright'), 5)");

pub(crate) const UNFINISHED_EXPANSIONS: Words = Some(
    "update studies set expanding_until = steady_now($1) + $2
     where id in (select id from studies
                  where expanded < total and cancelled_at is null and expanding_until < steady_now($1) and document_version <= $3
                  order by sequence for update skip locked)
     returning id, client",
);

pub(crate) const EXPANDING: Words =
    Some("update studies set expanding_until = steady_now($2) + $3 where id = $1");

pub(crate) const DEPTH: Words = Some(
    "select (select count(*) from jobs where status = 'accepted' and coalesce(study, '') = ''),
            (select count(*) from jobs where status = 'accepted' and coalesce(study, '') <> ''),
            (select count(*) from jobs where status = 'running'),
            (select min(submitted_at) from jobs where status = 'accepted' and coalesce(study, '') = '')",
);

pub(crate) const STEADY_NOW: Words = Some("select steady_now($1)");

// Several processes deliver: who takes a message has it for a while, and another one takes it if that was in vain.
pub(crate) const TAKE_PINGS: Words = Some(take_messages!(
    "and kind = 'webhook.ping'",
    "for update skip locked"
));

pub(crate) const TAKE_MESSAGES: Words = Some(take_messages!("", "for update skip locked"));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readiness_looks_at_every_table_that_a_request_writes() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../migrations/postgres");
        let files = std::fs::read_dir(folder).expect("the migrations");
        let texts = files.map(|file| {
            let path = file.expect("a migration").path();
            std::fs::read_to_string(path).expect("a text")
        });
        let texts: Vec<String> = texts.collect();
        let tables = texts.iter().flat_map(|text| {
            let begun = text
                .lines()
                .filter_map(|line| line.strip_prefix("create table "));
            begun.filter_map(|rest| rest.split([' ', '(']).next())
        });
        // `compatibility` is read when a process begins.
        let tables: Vec<&str> = tables.filter(|table| *table != "compatibility").collect();
        assert!(tables.len() > 15, "{tables:?}");
        let words = PROBE.expect("words");
        for table in tables {
            let is_named = ["update", "from"]
                .iter()
                .any(|verb| words.contains(&format!("{verb} {table} ")));
            assert!(is_named, "{table}");
        }
    }
}
