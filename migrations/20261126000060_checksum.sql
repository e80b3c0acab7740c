-- A checksum beside each document, CRC-32 of its body as it is kept, looked at when it is read; null in rows of earlier versions, which are
-- not looked at, and where there is no more than a name.
alter table documents add column checksum integer;
-- The same of the text of a submission, of a study, and of what a study's table shows.
alter table submissions add column checksum integer;
alter table study_documents add column checksum integer;
alter table summaries add column checksum integer;
