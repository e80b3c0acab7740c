-- The user of a client who submitted a job or a study, as the client names it; null where it names none. All of a client see all of its jobs.
alter table jobs add column submitted_by text;
alter table studies add column submitted_by text;
-- What one user has submitted, newest first.
create index jobs_of_user on jobs (client, submitted_by, sequence) where submitted_by is not null;
create index jobs_of_user_by_status on jobs (client, submitted_by, status, sequence) where submitted_by is not null;
create index studies_of_user on studies (client, submitted_by, sequence) where submitted_by is not null;
-- The queue: each lane in order of arrival. A lane is a study, or the jobs of a user that stand alone.
create index jobs_of_lane on jobs (client, coalesce(study, '!' || submitted_by, ''), sequence) where status = 'accepted';

-- Shares have a level more: clients, the users of a client, the lanes of a user. The table is made anew for the sake of a condition.
create table new_shares (
    client text not null,
    -- '*' for the client as a whole; '@USER' for one of its users, '@' for who is none. The others are lanes: a study, '!USER' for a user's
    -- jobs that stand alone, '' for those of no user.
    lane text not null,
    -- What it has had, as a time at which its next job is due: the least is served next.
    due integer not null,
    -- 0: no job of it waits. 1 or 2: jobs wait; 2 for what programs from before there were users do not take for a lane.
    active integer not null check (active in (0, 1, 2)),
    -- The due time of what was served last: in the row of a client among its users, in the row of a user among its lanes.
    served integer not null default 0,
    -- The user whose row or lane it is; '' for none.
    person text not null default '',
    primary key (client, lane)
) strict, without rowid;
insert into new_shares (client, lane, due, active, served) select client, lane, due, active, served from shares;
-- Lanes had their time from the row of their client.
insert into new_shares (client, lane, due, active, served) select client, '@', served, 2 * active, served from shares where lane = '*';
drop table shares;
alter table new_shares rename to shares;
create index shares_working on shares (lane, client) where active > 0;
