-- Designs of which only the statistics are kept (../20261122000004_keep.sql). The version before this one keeps results whole, and
-- may take a design without results for finished work: no study should ask for statistics before all processes are renewed.

alter table jobs add column keep text collate "C" not null default 'results' check (keep in ('results', 'statistics'));
alter table documents add column whole bigint not null default 1 check (whole in (0, 1));
