-- Keys of administrators. Whoever does not know the word of a role lets its bearer look and change nothing (`Role::of_word`), so that no
-- condition lists them any more. The table is made anew for that.
create table new_keys (
    -- The public part of the key.
    id text primary key not null,
    -- Whose jobs it reads and makes.
    client text not null,
    -- What the operator calls it.
    name text not null,
    -- client: everything of its client. reader: looks, and changes nothing. operator: as client, and the numbers of /metrics. administrator: as
    -- client, and sees who uses the service, and ends and removes what others have submitted.
    role text not null,
    -- SHA-256 of the secret part, hexadecimal.
    secret_hash text not null,
    -- Requests a second, and jobs that may wait; null for the usual bounds.
    requests_per_second integer,
    queue_limit integer,
    created_at integer not null,
    revoked_at integer,
    -- From when on it opens nothing any more; null: until it is revoked.
    expires_at integer
) strict;
insert into new_keys (id, client, name, role, secret_hash, requests_per_second, queue_limit, created_at, revoked_at, expires_at)
    select id, client, name, role, secret_hash, requests_per_second, queue_limit, created_at, revoked_at, expires_at from keys;
drop table keys;
alter table new_keys rename to keys;

-- Who dismissed it, if that was not its client: 'administrator'.
alter table jobs add column dismissed_by text;
alter table studies add column dismissed_by text;
