-- Projects: documents of the page, with a name, that a client keeps until it deletes them.
create table projects (
    -- UUID version 7, the id on the wire.
    id text primary key not null,
    -- Whose it is.
    client text not null,
    -- The user of the client who made it; null where the client names none.
    submitted_by text,
    -- Its place in the list of the client.
    sequence integer not null,
    name text not null,
    -- One more with every change: who changes or deletes it says which one was read.
    revision integer not null,
    created_at integer not null,
    updated_at integer not null,
    -- The header `Idempotency-Key` of the request that made it, for a day, and the hash of its body.
    idempotency_key text,
    body_hash text not null,
    -- Bytes of the document, and its CRC-32.
    bytes integer not null,
    checksum integer not null,
    -- JSON, as it was sent. It stands last, so that lists read none of it.
    document text not null,
    unique (client, sequence)
) strict;
create unique index projects_key on projects (client, idempotency_key) where idempotency_key is not null;
