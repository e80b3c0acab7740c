-- Projects (../20261127000100_projects.sql).
create table projects (
    id text collate "C" primary key,
    client text collate "C" not null,
    submitted_by text collate "C",
    sequence bigint not null,
    name text collate "C" not null,
    revision bigint not null,
    created_at bigint not null,
    updated_at bigint not null,
    idempotency_key text collate "C",
    body_hash text collate "C" not null,
    bytes bigint not null,
    checksum bigint not null,
    document text collate "C" not null,
    unique (client, sequence)
);
create unique index projects_key on projects (client, idempotency_key) where idempotency_key is not null;
