-- How far a search has come, JSON; null for other studies. It is told from here; what the search goes on from are its rows.
alter table studies add column search text;
