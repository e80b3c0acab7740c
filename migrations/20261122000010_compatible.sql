-- Which programs can work on these tables, so that a fleet is upgraded, and taken back, while it works.

-- A program that does not know the latest migration works on the tables all the same if it knows this one. A migration that the
-- programs before it cannot live with puts its own number here; any other one leaves it as it is.
create table compatibility (
    one integer primary key check (one = 1),
    least_migration integer not null
) strict;
insert into compatibility (one, least_migration) values (1, 20261122000010);

-- The version of the document of the submission, which grows with every field: who reads only earlier ones leaves the job to others.
alter table jobs add column document_version integer not null default 1;
-- The same of the base of a study, for who expands it.
alter table studies add column document_version integer not null default 1;
