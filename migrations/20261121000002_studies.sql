-- Studies: one submission in many variants, whose jobs wait in the same queue behind the jobs that stand alone.

create table studies (
    -- UUID version 7, the id on the wire.
    id text primary key not null,
    -- Who submitted it.
    client text not null,
    -- The study as it was sent, JSON; its designs are expanded from it.
    document text not null,
    -- SHA-256 of it; another one under the same idempotency key is a conflict.
    body_hash text not null,
    -- The gear whose mass and holes the table tells.
    gear text not null check (gear in ('driving', 'driven')),
    -- Number of designs.
    total integer not null,
    -- Designs that have their row: the first so many. The others follow in chunks, also after a restart.
    expanded integer not null,
    submitted_at integer not null,
    -- When the client cancelled it; the designs without row get none then.
    cancelled_at integer,
    -- The header `Idempotency-Key`; null a day later.
    idempotency_key text,

    check (expanded <= total)
) strict;

-- A client's list, newest first.
create index studies_of_client on studies (client, submitted_at desc, id desc);
-- Requests that may be repeated, and those to forget.
create unique index studies_key on studies (client, idempotency_key) where idempotency_key is not null;
create index studies_key_age on studies (submitted_at) where idempotency_key is not null;
-- What is to be expanded.
create index studies_to_expand on studies (id) where expanded < total and cancelled_at is null;

-- The rows of the tables of studies.
create table study_rows (
    study text not null references studies (id) on delete cascade,
    -- Place in the table, from 0.
    position integer not null,
    label text not null,
    -- What the design changes in the base: JSON object of pointers and values.
    changes text not null,
    -- The job that computes it; null if it cannot be built, or the client deleted the job.
    job text references jobs (id) on delete set null,
    -- Why it cannot be built: the problem document, JSON.
    problem text,
    primary key (study, position)
) strict, without rowid;

create index study_rows_job on study_rows (job) where job is not null;
-- Designs that come to an end without a job.
create index study_rows_without_job on study_rows (study) where job is null;

-- The study that the job computes a design of; null for a job that stands alone.
alter table jobs add column study text references studies (id);
-- Jobs of a smaller number are served first: 0 alone, 1 in a study.
alter table jobs add column priority integer not null default 0;

-- How far a study has come, told from the index alone.
create index jobs_of_study on jobs (study, status, finished_at) where study is not null;
drop index jobs_waiting;
-- The queue, in the order in which it is served.
create index jobs_waiting on jobs (priority, submitted_at, id) where status = 'accepted';

-- What a study's table shows of a results document. In a table of its own, because a row is read past its long columns.
create table summaries (
    document text primary key not null references documents (hash) on delete cascade,
    -- JSON.
    body text not null
) strict, without rowid;
