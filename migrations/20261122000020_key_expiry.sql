-- From when on a key opens nothing any more; null: until it is revoked. A program of the version before does not look at it.
alter table keys add column expires_at integer;
