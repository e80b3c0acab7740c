-- The storage contract on PostgreSQL: what the third migration of SQLite has come to (../20261121000003_left_alone.sql, which
-- explains the tables and columns that are the same), and what several processes need beside it. Times are microseconds since
-- 1970-01-01T00:00:00Z; absent is null. Whoever adds a migration keeps the version before it able to work on the new tables,
-- so that processes can be renewed one after the other.

-- Whole numbers as SQLite's function of this name compares them, so that statements have one text.
create function max(a bigint, b bigint) returns bigint language sql immutable strict parallel safe
    return greatest(a, b);

-- The clock by which leases run: the database's, whatever the process believes. Tests put one here that asks the process.
create function steady_now(of_the_process bigint) returns bigint language sql volatile
    return cast(extract(epoch from clock_timestamp()) * 1000000 as bigint);

create table documents (
    hash text collate "C" primary key,
    encoding text not null check (encoding in ('identity', 'gzip')),
    -- It is packed already.
    body bytea not null,
    size bigint not null
);
alter table documents alter column body set storage external;

create table studies (
    id text collate "C" primary key,
    sequence bigint not null unique,
    client text collate "C" not null,
    name text,
    tags text not null,
    body_hash text not null,
    gear text not null check (gear in ('driving', 'driven')),
    total bigint not null,
    expanded bigint not null,
    unbuildable bigint not null default 0,
    accepted bigint not null default 0,
    running bigint not null default 0,
    successful bigint not null default 0,
    failed bigint not null default 0,
    dismissed bigint not null default 0,
    version bigint not null default 0,
    submitted_at bigint not null,
    last_end bigint,
    cancelled_at bigint,
    ended_at bigint,
    idempotency_key text collate "C",
    -- Until then a process expands it; beyond, another one goes on. By `steady_now`.
    expanding_until bigint not null default 0,

    check (expanded <= total)
);
-- Counts change with every job: room on the page keeps the row where it is.
alter table studies set (fillfactor = 50);
create sequence studies_arrived owned by studies.sequence;

create index studies_of_client on studies (client, sequence);
create index studies_by_time on studies (client, submitted_at, sequence);
create unique index studies_key on studies (client, idempotency_key) where idempotency_key is not null;
create index studies_key_age on studies (submitted_at) where idempotency_key is not null;
create index studies_to_expand on studies (sequence) where expanded < total and cancelled_at is null;
create index studies_ended on studies (ended_at) where ended_at is not null;

create table study_documents (
    study text collate "C" primary key references studies (id) on delete cascade,
    body text not null
);

create table study_tags (
    client text collate "C" not null,
    tag text collate "C" not null,
    sequence bigint not null,
    study text collate "C" not null references studies (id) on delete cascade,
    primary key (client, tag, sequence)
);
create index study_tags_study on study_tags (study);

create table jobs (
    id text collate "C" primary key,
    sequence bigint not null unique,
    client text collate "C" not null,
    method text not null,
    tags text not null,
    input_hash text collate "C" not null,
    cost bigint not null,
    status text collate "C" not null check (status in ('accepted', 'running', 'successful', 'failed', 'dismissed')),
    attempt bigint not null default 0,
    returned bigint not null default 0,
    -- 1 once a process died while it ran this job and others: it is run alone in a process from then on.
    suspect bigint not null default 0 check (suspect in (0, 1)),
    -- By `steady_now`.
    lease_until bigint,
    -- The process that runs it, or ran it last: an id that is new at each start.
    owner text collate "C",
    positions_done bigint not null default 0,
    positions_total bigint not null,
    submitted_at bigint not null,
    started_at bigint,
    finished_at bigint,
    elapsed bigint,
    problem text,
    document text collate "C" references documents (hash),
    solver_version text collate "C",
    same_as text collate "C" references jobs (id) on delete set null,
    study text collate "C" references studies (id),

    check ((status = 'running') = (lease_until is not null)),
    check (status <> 'running' or owner is not null),
    check ((status = 'successful') = (document is not null)),
    check ((status = 'failed') = (problem is not null)),
    check ((status in ('successful', 'failed', 'dismissed')) = (finished_at is not null))
);
create sequence jobs_arrived owned by jobs.sequence;

create index jobs_waiting on jobs (client, coalesce(study, ''), sequence) where status = 'accepted';
create index jobs_suspect on jobs (sequence) where suspect = 1 and status = 'accepted';
-- Equal work is done once: whatever else went wrong, not at the same time.
create unique index jobs_running on jobs (client, input_hash) where status = 'running';
create index jobs_of_client on jobs (client, sequence);
create index jobs_by_status on jobs (client, status, sequence);
create index jobs_of_study on jobs (study, sequence) where study is not null;
create index jobs_of_study_by_status on jobs (study, status, sequence) where study is not null;
create index jobs_alone on jobs (client, sequence) where study is null;
create index jobs_alone_by_status on jobs (client, status, sequence) where study is null;
create index jobs_by_time on jobs (client, submitted_at, sequence);
create index jobs_done on jobs (client, input_hash, (same_as is not null), sequence) where status = 'successful';
create index jobs_document on jobs (document) where document is not null;
create index jobs_same_as on jobs (same_as) where same_as is not null;
create index jobs_ended on jobs (finished_at) where finished_at is not null and study is null;

create table submissions (
    job text collate "C" primary key references jobs (id) on delete cascade,
    body text not null
);

create table job_tags (
    client text collate "C" not null,
    tag text collate "C" not null,
    sequence bigint not null,
    job text collate "C" not null references jobs (id) on delete cascade,
    primary key (client, tag, sequence)
);
create index job_tags_job on job_tags (job);

create table summaries (
    document text collate "C" primary key references documents (hash) on delete cascade,
    body text not null
);

create table study_rows (
    study text collate "C" not null references studies (id) on delete cascade,
    position bigint not null,
    label text not null,
    changes text not null,
    job text collate "C" references jobs (id) on delete set null,
    problem text,
    primary key (study, position)
);
create index study_rows_job on study_rows (job) where job is not null;

create table idempotency_keys (
    client text collate "C" not null,
    key text collate "C" not null,
    body_hash text not null,
    job text collate "C" not null references jobs (id) on delete cascade,
    created_at bigint not null,
    primary key (client, key)
);
create index idempotency_keys_age on idempotency_keys (created_at);
create index idempotency_keys_job on idempotency_keys (job);

create table shares (
    client text collate "C" not null,
    lane text collate "C" not null,
    due bigint not null,
    active bigint not null check (active in (0, 1)),
    served bigint not null default 0,
    primary key (client, lane)
);
create index shares_active on shares (lane, due) where active = 1;
create table served (
    one bigint primary key check (one = 1),
    due bigint not null
);
insert into served (one, due) values (1, 0);
-- What is written to find out whether something can be written.
create table probed (
    number bigint not null
);
insert into probed (number) values (0);

create table keys (
    id text collate "C" primary key,
    client text not null,
    name text not null,
    role text not null check (role in ('client', 'reader', 'operator')),
    secret_hash text not null,
    requests_per_second bigint,
    queue_limit bigint,
    created_at bigint not null,
    revoked_at bigint
);

create table webhooks (
    id text collate "C" primary key,
    client text collate "C" not null,
    url text not null,
    events text not null,
    secret text not null,
    created_at bigint not null,
    disabled_at bigint,
    problem text
);
create index webhooks_of_client on webhooks (client);

create table messages (
    id text collate "C" primary key,
    webhook text collate "C" not null references webhooks (id) on delete cascade,
    body text not null,
    attempts bigint not null default 0,
    next_at bigint not null,
    created_at bigint not null
);
create index messages_next on messages (next_at);
create index messages_webhook on messages (webhook);

create function count_made_job() returns trigger language plpgsql as $$
begin
    update studies set
        version = version + 1,
        accepted = accepted + cast(new.status = 'accepted' as int),
        successful = successful + cast(new.status = 'successful' as int),
        last_end = greatest(last_end, new.finished_at)
    where id = new.study;
    return null;
end $$;
-- At the end of the transaction, so that a chunk of designs holds the study for a moment only.
create constraint trigger job_of_study_made after insert on jobs deferrable initially deferred
    for each row when (new.study is not null) execute function count_made_job();

create function count_moved_job() returns trigger language plpgsql as $$
begin
    update studies set
        version = version + 1,
        accepted = accepted + cast(new.status = 'accepted' as int) - cast(old.status = 'accepted' as int),
        running = running + cast(new.status = 'running' as int) - cast(old.status = 'running' as int),
        successful = successful + cast(new.status = 'successful' as int),
        failed = failed + cast(new.status = 'failed' as int),
        dismissed = dismissed + cast(new.status = 'dismissed' as int),
        last_end = greatest(last_end, new.finished_at)
    where id = new.study;
    return null;
end $$;
create trigger job_of_study_moved after update of status on jobs
    for each row when (new.study is not null and new.status <> old.status) execute function count_moved_job();

create function count_deleted_job() returns trigger language plpgsql as $$
begin
    update studies set
        version = version + 1,
        accepted = accepted - cast(old.status = 'accepted' as int),
        successful = successful - cast(old.status = 'successful' as int),
        failed = failed - cast(old.status = 'failed' as int),
        dismissed = dismissed + cast(old.status <> 'dismissed' as int)
    where id = old.study;
    return null;
end $$;
create trigger job_of_study_deleted after delete on jobs
    for each row when (old.study is not null) execute function count_deleted_job();

-- News for other processes. `work`: a job waits (said once a transaction). `job STATUS ID` and `study ID`: it has changed.
create function tell_of_waiting() returns trigger language plpgsql as $$
begin
    perform pg_notify('meshwright', 'work');
    return null;
end $$;
create trigger job_waits after insert on jobs
    for each row when (new.status = 'accepted') execute function tell_of_waiting();

create function tell_of_job() returns trigger language plpgsql as $$
begin
    perform pg_notify('meshwright', 'job ' || new.status || ' ' || new.id);
    if new.study is not null then
        perform pg_notify('meshwright', 'study ' || new.study);
    end if;
    if new.status in ('accepted', 'successful', 'failed', 'dismissed') then
        -- What had to wait for this one, or the job itself, may be claimed.
        perform pg_notify('meshwright', 'work');
    end if;
    return null;
end $$;
create trigger job_moved after update of status on jobs
    for each row when (new.status <> old.status) execute function tell_of_job();

create function tell_of_study() returns trigger language plpgsql as $$
begin
    perform pg_notify('meshwright', 'study ' || new.id);
    return null;
end $$;
create trigger study_ended after update of ended_at on studies
    for each row when (new.ended_at is distinct from old.ended_at) execute function tell_of_study();
