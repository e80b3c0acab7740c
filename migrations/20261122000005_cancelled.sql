-- Studies that were cancelled and whose jobs are being dismissed, some at a time.
create index studies_to_dismiss on studies (sequence) where cancelled_at is not null and ended_at is null;
