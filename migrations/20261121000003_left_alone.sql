-- A service that is left alone: order of arrival that no clock decides, a fair queue, counts that need no counting,
-- documents that are packed, keys, webhooks. Tables that change are made anew; foreign keys are not enforced meanwhile.
-- Times are microseconds since 1970-01-01T00:00:00Z; absent is null.

-- Results. Equal input gives the same text, so jobs share a row; it goes with the last job that points to it.
create table new_documents (
    -- SHA-256 in hexadecimal of the text that is served; also its entity tag on the wire.
    hash text primary key not null,
    -- How `body` is packed, in the words of Content-Encoding.
    encoding text not null check (encoding in ('identity', 'gzip')),
    -- The results document.
    body blob not null,
    -- Bytes of the text.
    size integer not null
) strict;
insert into new_documents (hash, encoding, body, size)
    select hash, 'identity', cast(body as blob), length(cast(body as blob)) from documents;
drop table documents;
alter table new_documents rename to documents;

-- A job is its own queue entry: the queue is the rows that are `accepted`. The text of a submission stands in a table of
-- its own, so that looking at a job reads no page for it.
create table new_jobs (
    -- UUID version 7, the id on the wire.
    id text primary key not null,
    -- The order in which jobs arrived, whatever the clock said.
    sequence integer not null unique,
    -- Who submitted it; nobody sees the jobs of another client.
    client text not null,
    -- The method of the submission, for lists.
    method text not null,
    -- Short words of the client: a JSON array of strings, for showing; `job_tags` is for finding.
    tags text not null,
    -- Hash of everything in the submission that decides the result.
    input_hash text not null,
    -- What it is estimated to take of a core, in microseconds; what its client's share of the service is charged with.
    cost integer not null,

    -- accepted:   waits for a worker.
    -- running:    a worker computes it and renews `lease_until`.
    -- successful: `document` holds its results.
    -- failed:     `problem` says why.
    -- dismissed:  the client cancelled it.
    status text not null check (status in ('accepted', 'running', 'successful', 'failed', 'dismissed')),
    -- Number of claims so far. Only the latest claim may report or finish: it fences a worker that was given up.
    attempt integer not null default 0,
    -- Claims that a shutdown gave back, or that ended with the process while other jobs ran: they are nobody's fault, or
    -- nobody knows whose, and do not count towards the limit of attempts.
    returned integer not null default 0,
    -- 1 once the process died while this job and others ran: it is run alone from then on, so that the next time the
    -- process dies it is known which job did it.
    suspect integer not null default 0 check (suspect in (0, 1)),
    -- While running: when the worker is to be taken for lost unless it reports before. By the steady clock of the process.
    lease_until integer,
    -- Mesh positions solved so far, over all torques.
    positions_done integer not null default 0,
    -- Mesh positions to solve.
    positions_total integer not null,

    submitted_at integer not null,
    -- Start of the latest attempt.
    started_at integer,
    finished_at integer,
    -- What the latest attempt took, in microseconds of a clock that is never set.
    elapsed integer,

    -- Of a failed job: the problem document, JSON.
    problem text,
    -- Of a successful job: its results.
    document text references documents (hash),
    -- The version that computed the results; a later one computes afresh.
    solver_version text,
    -- The earlier job of the same client whose results this one was given.
    same_as text references jobs (id) on delete set null,
    -- The study that the job computes a design of; null for a job that stands alone.
    study text references studies (id),

    check ((status = 'running') = (lease_until is not null)),
    check ((status = 'successful') = (document is not null)),
    check ((status = 'failed') = (problem is not null)),
    check ((status in ('successful', 'failed', 'dismissed')) = (finished_at is not null))
) strict;
insert into new_jobs (id, sequence, client, method, tags, input_hash, cost, status, attempt, returned, lease_until,
                      positions_done, positions_total, submitted_at, started_at, finished_at, elapsed, problem, document,
                      solver_version, same_as, study)
    select id, row_number() over (order by submitted_at, id), client, method, tags, input_hash, 100 * positions_total,
           status, attempt, returned, lease_until, positions_done, positions_total, submitted_at, started_at, finished_at,
           max(0, finished_at - started_at), problem, document, solver_version, same_as, study
    from jobs;

-- The submission with every default filled in, JSON; what is computed and what is shown.
create table submissions (
    job text primary key not null references jobs (id) on delete cascade,
    body text not null
) strict;
insert into submissions (job, body) select id, submission from jobs;

drop table jobs;
alter table new_jobs rename to jobs;

-- The queue: each lane, a client's study or the jobs that stand alone, in order of arrival.
create index jobs_waiting on jobs (client, coalesce(study, ''), sequence) where status = 'accepted';
-- Jobs that are to be run alone.
create index jobs_suspect on jobs (sequence) where suspect = 1 and status = 'accepted';
-- Leases to watch, and equal jobs that run.
create index jobs_running on jobs (client, input_hash) where status = 'running';
-- A client's lists, newest first: all, of one state, of one study, since a time.
create index jobs_of_client on jobs (client, sequence);
create index jobs_by_status on jobs (client, status, sequence);
create index jobs_of_study on jobs (study, sequence) where study is not null;
create index jobs_of_study_by_status on jobs (study, status, sequence) where study is not null;
create index jobs_alone on jobs (client, sequence) where study is null;
create index jobs_alone_by_status on jobs (client, status, sequence) where study is null;
create index jobs_by_time on jobs (client, submitted_at, sequence);
-- Finished work that an equal submission can be answered with: the one that was computed before those that were given it.
create index jobs_done on jobs (client, input_hash, (same_as is not null), sequence) where status = 'successful';
-- Who still needs a document, who points to a job that is deleted.
create index jobs_document on jobs (document) where document is not null;
create index jobs_same_as on jobs (same_as) where same_as is not null;
-- What has been kept longest, of jobs that stand alone; those of a study go with it.
create index jobs_ended on jobs (finished_at) where finished_at is not null and study is null;

-- The tags of jobs, to find them by.
create table job_tags (
    client text not null,
    tag text not null,
    sequence integer not null,
    job text not null references jobs (id) on delete cascade,
    primary key (client, tag, sequence)
) strict, without rowid;
create index job_tags_job on job_tags (job);
insert or ignore into job_tags (client, tag, sequence, job)
    select jobs.client, word.value, jobs.sequence, jobs.id from jobs, json_each(jobs.tags) as word;

-- Studies, with the counts of their jobs, which triggers keep.
create table new_studies (
    -- UUID version 7, the id on the wire.
    id text primary key not null,
    -- The order in which studies arrived.
    sequence integer not null unique,
    -- Who submitted it.
    client text not null,
    -- What the client calls it.
    name text,
    -- Short words of the client: a JSON array of strings, for showing; `study_tags` is for finding.
    tags text not null,
    -- SHA-256 of the document; another one under the same idempotency key is a conflict.
    body_hash text not null,
    -- The gear whose mass and holes the table tells.
    gear text not null check (gear in ('driving', 'driven')),
    -- Number of designs.
    total integer not null,
    -- Designs that have their row: the first so many. The others follow in chunks, also after a restart.
    expanded integer not null,
    -- Designs that could not be built.
    unbuildable integer not null default 0,
    -- Designs by the state of their job. A design whose job was deleted counts as dismissed.
    accepted integer not null default 0,
    running integer not null default 0,
    successful integer not null default 0,
    failed integer not null default 0,
    dismissed integer not null default 0,
    -- Grows with every change of the study, its rows or its jobs: what was answered for one version is good as long as it
    -- stands.
    version integer not null default 0,
    submitted_at integer not null,
    -- When the last of its jobs ended, of those that have.
    last_end integer,
    -- When the client cancelled it; the designs without row get none then.
    cancelled_at integer,
    -- When it was found to have ended, whichever way; null until then.
    ended_at integer,
    -- The header `Idempotency-Key`; null a day later.
    idempotency_key text,

    check (expanded <= total)
) strict;
insert into new_studies (id, sequence, client, tags, body_hash, gear, total, expanded, submitted_at, cancelled_at,
                         idempotency_key, unbuildable, accepted, running, successful, failed, dismissed, last_end)
    select id, row_number() over (order by submitted_at, id), client, '[]', body_hash, gear, total, expanded, submitted_at,
           cancelled_at, idempotency_key,
           (select count(*) from study_rows where study = studies.id and job is null and problem is not null),
           (select count(*) from jobs where study = studies.id and status = 'accepted'),
           (select count(*) from jobs where study = studies.id and status = 'running'),
           (select count(*) from jobs where study = studies.id and status = 'successful'),
           (select count(*) from jobs where study = studies.id and status = 'failed'),
           (select count(*) from jobs where study = studies.id and status = 'dismissed')
             + (select count(*) from study_rows where study = studies.id and job is null and problem is null),
           (select max(finished_at) from jobs where study = studies.id)
    from studies;

-- The study as it was sent, JSON; its designs are expanded from it.
create table study_documents (
    study text primary key not null references studies (id) on delete cascade,
    body text not null
) strict;
insert into study_documents (study, body) select id, document from studies;

drop table studies;
alter table new_studies rename to studies;
update studies set ended_at = coalesce(cancelled_at, last_end, submitted_at)
    where cancelled_at is not null or unbuildable + successful + failed + dismissed = total;

-- A client's list, newest first, and since a time.
create index studies_of_client on studies (client, sequence);
create index studies_by_time on studies (client, submitted_at, sequence);
-- Requests that may be repeated, and those to forget.
create unique index studies_key on studies (client, idempotency_key) where idempotency_key is not null;
create index studies_key_age on studies (submitted_at) where idempotency_key is not null;
-- What is to be expanded.
create index studies_to_expand on studies (sequence) where expanded < total and cancelled_at is null;
-- What has been kept longest.
create index studies_ended on studies (ended_at) where ended_at is not null;

-- The tags of studies, to find them by.
create table study_tags (
    client text not null,
    tag text not null,
    sequence integer not null,
    study text not null references studies (id) on delete cascade,
    primary key (client, tag, sequence)
) strict, without rowid;
create index study_tags_study on study_tags (study);

-- Rows whose design could not be built, or whose job was deleted, are counted when it happens.
drop index study_rows_without_job;

create trigger job_of_study_made after insert on jobs when new.study is not null begin
    update studies set
        version = version + 1,
        accepted = accepted + (new.status = 'accepted'),
        successful = successful + (new.status = 'successful'),
        last_end = max(coalesce(last_end, new.finished_at), coalesce(new.finished_at, last_end))
    where id = new.study;
end;
create trigger job_of_study_moved after update of status on jobs when new.study is not null and new.status <> old.status begin
    update studies set
        version = version + 1,
        accepted = accepted + (new.status = 'accepted') - (old.status = 'accepted'),
        running = running + (new.status = 'running') - (old.status = 'running'),
        successful = successful + (new.status = 'successful'),
        failed = failed + (new.status = 'failed'),
        dismissed = dismissed + (new.status = 'dismissed'),
        last_end = max(coalesce(last_end, new.finished_at), coalesce(new.finished_at, last_end))
    where id = new.study;
end;
create trigger job_of_study_deleted after delete on jobs when old.study is not null begin
    update studies set
        version = version + 1,
        accepted = accepted - (old.status = 'accepted'),
        successful = successful - (old.status = 'successful'),
        failed = failed - (old.status = 'failed'),
        dismissed = dismissed + (old.status <> 'dismissed')
    where id = old.study;
end;

-- How much of the service clients and lanes have had, so that each gets its share. A lane is a study, or the jobs of a
-- client that stand alone (study ''). Time here is the service that was given, not the clock's.
create table shares (
    client text not null,
    -- '' for the client's jobs that stand alone; '*' for the client as a whole.
    lane text not null,
    -- What it has had, as a time at which its next job is due: the least is served next.
    due integer not null,
    -- Whether jobs of it wait.
    active integer not null check (active in (0, 1)),
    -- The due time of what was served last: among the lanes of this client, in the row of the client.
    served integer not null default 0,
    primary key (client, lane)
) strict, without rowid;
create index shares_active on shares (lane, due) where active = 1;
-- The same among clients: one row.
create table served (
    one integer primary key not null check (one = 1),
    due integer not null
) strict;
insert into served (one, due) values (1, 0);
insert into shares (client, lane, due, active) select distinct client, '*', 0, 1 from jobs where status = 'accepted';
insert into shares (client, lane, due, active)
    select distinct client, coalesce(study, ''), 0, 1 from jobs where status = 'accepted';

-- API keys. The secret part is kept nowhere, only its hash.
create table keys (
    -- The public part of the key.
    id text primary key not null,
    -- Whose jobs it reads and makes.
    client text not null,
    -- What the operator calls it.
    name text not null,
    -- client: everything of its client. reader: looks, and changes nothing. operator: as client, and the numbers of /metrics.
    role text not null check (role in ('client', 'reader', 'operator')),
    -- SHA-256 of the secret part, hexadecimal.
    secret_hash text not null,
    -- Requests a second, and jobs that may wait; null for the usual bounds.
    requests_per_second integer,
    queue_limit integer,
    created_at integer not null,
    revoked_at integer
) strict;

-- Where clients are told of the end of their jobs and studies.
create table webhooks (
    -- UUID version 7, the id on the wire.
    id text primary key not null,
    client text not null,
    url text not null,
    -- The kinds of events that are told: a JSON array of strings.
    events text not null,
    -- What messages are signed with: base64. It has to be known to sign, so it is kept as it is.
    secret text not null,
    created_at integer not null,
    -- When messages were given up because nobody took them; null while it works.
    disabled_at integer,
    problem text
) strict;
create index webhooks_of_client on webhooks (client);

-- Messages to be delivered. They are written with the change that they tell, and deleted when they have arrived.
create table messages (
    -- UUID version 7; the header `webhook-id`, the same in every attempt.
    id text primary key not null,
    webhook text not null references webhooks (id) on delete cascade,
    body text not null,
    attempts integer not null default 0,
    -- When to try next, by the steady clock of the process.
    next_at integer not null,
    created_at integer not null
) strict;
create index messages_next on messages (next_at);
create index messages_webhook on messages (webhook);
