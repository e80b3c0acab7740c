-- Webhooks that are patient each by itself, and messages that leave a trace. Times of attempts go by the store's clock: that of the
-- server where there is one, else the steady clock of the process.

-- Attempts that have failed since the last one that did not.
alter table webhooks add column failures integer not null default 0;
-- Until then nothing is sent to it.
alter table webhooks add column retry_at integer not null default 0;
-- What messages are signed with besides, until then: the secret before the last rotation.
alter table webhooks add column previous_secret text;
alter table webhooks add column previous_until integer not null default 0;
-- The header `Idempotency-Key`, the hash of what it came with, and when that was.
alter table webhooks add column idempotency_key text;
alter table webhooks add column body_hash text;
alter table webhooks add column keyed_at integer not null default 0;
create unique index webhooks_key on webhooks (client, idempotency_key) where idempotency_key is not null;

-- What it tells, and of whom: the id of the job, the study or the webhook.
alter table messages add column kind text not null default 'job.ended';
alter table messages add column subject text;
-- When it was last sent, what the receiver answered, and why it was not taken.
alter table messages add column attempted_at integer;
alter table messages add column answered integer;
alter table messages add column problem text;
-- When it arrived; null while it waits.
alter table messages add column arrived_at integer;
-- `next_at` is until when somebody is sending it; when it is tried again its webhook decides.
update messages set next_at = 0;

drop index messages_next;
drop index messages_webhook;
-- What waits, in the order in which it is sent; a ping goes first.
create index messages_waiting on messages (webhook, id) where arrived_at is null;
create index messages_pings on messages (webhook) where arrived_at is null and kind = 'webhook.ping';
-- The list of deliveries, and what is old.
create index messages_of_webhook on messages (webhook, id);
create index messages_age on messages (created_at);
