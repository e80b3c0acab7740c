-- Users of clients (../20261127000070_users.sql). A program of the version before goes on with the lanes of no user, and leaves those of users
-- (`active` 2) to others.
alter table jobs add column submitted_by text collate "C";
alter table studies add column submitted_by text collate "C";
create index jobs_of_user on jobs (client, submitted_by, sequence) where submitted_by is not null;
create index jobs_of_user_by_status on jobs (client, submitted_by, status, sequence) where submitted_by is not null;
create index studies_of_user on studies (client, submitted_by, sequence) where submitted_by is not null;
create index jobs_of_lane on jobs (client, coalesce(study, '!' || submitted_by, ''), sequence) where status = 'accepted';

alter table shares add column person text collate "C" not null default '';
alter table shares drop constraint shares_active_check;
alter table shares add constraint shares_active_check check (active in (0, 1, 2));
insert into shares (client, lane, due, active, served) select client, '@', served, 2 * active, served from shares where lane = '*';
create index shares_working on shares (lane, client) where active > 0;
