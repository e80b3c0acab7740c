-- Administrators (../20261127000080_administrators.sql).
alter table keys drop constraint keys_role_check;
alter table jobs add column dismissed_by text;
alter table studies add column dismissed_by text;
