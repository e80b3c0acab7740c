-- Links by which somebody without a key reads the results of a job, until they end.
create table links (
    -- UUID version 7, the id on the wire.
    id text primary key not null,
    job text not null references jobs (id) on delete cascade,
    -- The key that made it, with which it ends; null if none was needed, or a token made it.
    key text,
    -- SHA-256 of the secret in its address, hexadecimal. The secret is kept nowhere.
    secret_hash text not null unique,
    created_at integer not null,
    ends_at integer not null
) strict;
create index links_of_job on links (job, created_at);
create index links_ended on links (ends_at);
