-- How far a search has come (../20261122000030_search.sql).
alter table studies add column search text;
