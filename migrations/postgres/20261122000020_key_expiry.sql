-- From when on a key opens nothing any more; null: until it is revoked (../20261122000020_key_expiry.sql).
alter table keys add column expires_at bigint;
