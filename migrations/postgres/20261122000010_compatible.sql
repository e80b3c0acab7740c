-- Which programs can work on these tables (../20261122000010_compatible.sql). What a migration has to keep, so that programs of the version
-- before go on beside it: no column goes or changes its type, a new one has a default, a new check holds for what they write. One that
-- cannot do so puts its own number into `compatibility`.

create table compatibility (
    one bigint primary key check (one = 1),
    least_migration bigint not null
);
insert into compatibility (one, least_migration) values (1, 20261122000010);

alter table jobs add column document_version bigint not null default 1;
alter table studies add column document_version bigint not null default 1;
