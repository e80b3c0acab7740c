-- A study counts its new jobs in the statement that adds their rows to it, once for all of them (jobs::store::studies). A program that leaves
-- this to the trigger cannot work on these tables.
drop trigger job_of_study_made;
update compatibility set least_migration = 20261124000050;
