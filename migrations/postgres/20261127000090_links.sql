-- Links to results (../20261127000090_links.sql).
create table links (
    id text collate "C" primary key,
    job text collate "C" not null references jobs (id) on delete cascade,
    key text collate "C",
    secret_hash text collate "C" not null unique,
    created_at bigint not null,
    ends_at bigint not null
);
create index links_of_job on links (job, created_at);
create index links_ended on links (ends_at);
