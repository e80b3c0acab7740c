-- The storage contract: jobs, the documents that they computed, and the keys of clients that may ask twice.
-- Times are microseconds since 1970-01-01T00:00:00Z; absent is null.

-- Results, kept as the very text that is served. Jobs with the same input share one row, because the same input
-- gives the same text; the row goes with the last job that points to it.
create table documents (
    -- SHA-256 of the body in hexadecimal; also the entity tag on the wire.
    hash text primary key not null,
    -- The results document, JSON.
    body text not null
) strict;

-- A job is its own queue entry: the queue is the rows that are `accepted`, oldest first.
create table jobs (
    -- UUID version 7, the id on the wire.
    id text primary key not null,
    -- Who submitted it; nobody sees the jobs of another client.
    client text not null,
    -- The method of the submission, for lists.
    method text not null,
    -- Short words of the client to find jobs by: a JSON array of strings.
    tags text not null,
    -- The submission with every default filled in, JSON; what is computed and what is shown.
    submission text not null,
    -- Hash of everything in the submission that decides the result.
    input_hash text not null,

    -- accepted:   waits for a worker.
    -- running:    a worker computes it and renews `lease_until`.
    -- successful: `document` holds its results.
    -- failed:     `problem` says why.
    -- dismissed:  the client cancelled it.
    status text not null check (status in ('accepted', 'running', 'successful', 'failed', 'dismissed')),
    -- Number of claims so far. Only the latest claim may report or finish: it fences a worker that was given up.
    attempt integer not null default 0,
    -- Claims that a shutdown gave back; they do not count towards the limit of attempts.
    returned integer not null default 0,
    -- While running: when the worker is to be taken for lost unless it reports before.
    lease_until integer,
    -- Mesh positions solved so far, over all torques.
    positions_done integer not null default 0,
    -- Mesh positions to solve.
    positions_total integer not null,

    submitted_at integer not null,
    -- Start of the latest attempt.
    started_at integer,
    finished_at integer,

    -- Of a failed job: the problem document, JSON.
    problem text,
    -- Of a successful job: its results.
    document text references documents (hash),
    -- The version that computed the results; a later one computes afresh.
    solver_version text,
    -- The earlier job of the same client whose results this one was given.
    same_as text references jobs (id) on delete set null,

    check ((status = 'running') = (lease_until is not null)),
    check ((status = 'successful') = (document is not null)),
    check ((status = 'failed') = (problem is not null)),
    check ((status in ('successful', 'failed', 'dismissed')) = (finished_at is not null))
) strict;

-- The queue, in the order in which it is served.
create index jobs_waiting on jobs (submitted_at, id) where status = 'accepted';
-- Leases to watch.
create index jobs_running on jobs (lease_until) where status = 'running';
-- A client's list, newest first.
create index jobs_of_client on jobs (client, submitted_at desc, id desc);
-- Finished work that an equal submission can be answered with.
create index jobs_done on jobs (client, input_hash) where status = 'successful';
-- Who still needs a document, who points to a job that is deleted.
create index jobs_document on jobs (document) where document is not null;
create index jobs_same_as on jobs (same_as) where same_as is not null;

-- Requests that may be repeated: the same key and body answer with the same job.
create table idempotency_keys (
    client text not null,
    -- The header `Idempotency-Key`.
    key text not null,
    -- Hash of the submission with its defaults filled in; another one under the same key is a conflict.
    body_hash text not null,
    job text not null references jobs (id) on delete cascade,
    -- Keys are forgotten a day later.
    created_at integer not null,
    primary key (client, key)
) strict, without rowid;

create index idempotency_keys_age on idempotency_keys (created_at);
create index idempotency_keys_job on idempotency_keys (job);
