-- Jobs that move together are counted and told together: once a statement instead of once a row, which was most of what a small job cost the
-- server. A program of the version before does not know the word `jobs`, and looks at everything when it hears it.

drop trigger job_of_study_moved on jobs;
drop function count_moved_job();
drop trigger job_moved on jobs;
drop function tell_of_job();

-- `jobs STATUS ID ID ...`: these have changed.
create function follow_moved_jobs() returns trigger language plpgsql as $$
declare
    moved record;
begin
    for moved in
        select study, status, count(*) as number, sum(was_accepted) as were_accepted, sum(was_running) as were_running,
               max(finished_at) as last_end, string_agg(id, ' ') as ids
        -- As many as fit into one message.
        from (select new_jobs.id, new_jobs.study, new_jobs.status, new_jobs.finished_at,
                     cast(old_jobs.status = 'accepted' as int) as was_accepted, cast(old_jobs.status = 'running' as int) as was_running,
                     (row_number() over () - 1) / 200 as part
              from new_jobs join old_jobs on old_jobs.id = new_jobs.id
              where new_jobs.status <> old_jobs.status) as jobs
        group by study, status, part
        order by study, status
    loop
        if moved.study is not null then
            update studies set
                version = version + moved.number,
                accepted = accepted + moved.number * cast(moved.status = 'accepted' as int) - moved.were_accepted,
                running = running + moved.number * cast(moved.status = 'running' as int) - moved.were_running,
                successful = successful + moved.number * cast(moved.status = 'successful' as int),
                failed = failed + moved.number * cast(moved.status = 'failed' as int),
                dismissed = dismissed + moved.number * cast(moved.status = 'dismissed' as int),
                last_end = greatest(last_end, moved.last_end)
            where id = moved.study;
            perform pg_notify('meshwright', 'study ' || moved.study);
        end if;
        perform pg_notify('meshwright', 'jobs ' || moved.status || ' ' || moved.ids);
        if moved.status <> 'running' then
            -- What had to wait for these, or they themselves, may be claimed.
            perform pg_notify('meshwright', 'work');
        end if;
    end loop;
    return null;
end $$;
create trigger jobs_moved after update on jobs
    referencing old table as old_jobs new table as new_jobs
    for each statement execute function follow_moved_jobs();
