-- Designs of which only the statistics are kept.

-- How much of what the job computes is kept: its results, or what the table of its study shows.
alter table jobs add column keep text not null default 'results' check (keep in ('results', 'statistics'));

-- 0 where no body is kept, only the name that the summary hangs on; an equal job that wants results makes it 1.
alter table documents add column whole integer not null default 1 check (whole in (0, 1));
