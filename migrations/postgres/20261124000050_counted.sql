-- A study counts its new jobs (../20261124000050_counted.sql). Those that are made together are told once.
drop trigger job_of_study_made on jobs;
drop function count_made_job();
drop trigger job_waits on jobs;
drop function tell_of_waiting();
update compatibility set least_migration = 20261124000050;

create function tell_of_waiting() returns trigger language plpgsql as $$
begin
    if exists (select from made where status = 'accepted') then
        perform pg_notify('meshwright', 'work');
    end if;
    return null;
end $$;
create trigger jobs_wait after insert on jobs referencing new table as made
    for each statement execute function tell_of_waiting();
