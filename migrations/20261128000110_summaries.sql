-- Summaries as an ordinary table. A row without rowid keeps at most 1,002 bytes within its page of 4,096, and the summary of one curve has 1,300: each took a
-- page of its own, and two share one now.
create table new_summaries (
    document text primary key not null references documents (hash) on delete cascade,
    -- JSON.
    body text not null,
    -- CRC-32 of the body; null in rows of earlier versions, which are not checked.
    checksum integer
) strict;
insert into new_summaries (document, body, checksum) select document, body, checksum from summaries;
drop table summaries;
alter table new_summaries rename to summaries;
