//! The rows of studies, some at a time: a table of any length is read by short looks, each of which sees the last commit.

use uuid::Uuid;

use super::documents::checked;
use super::rows::{Record, Row};
use super::statement::{query_as, query_scalar};
use super::{Damaged, Document, Store, StoreError};

/// A row as it is read.
#[derive(Debug, Clone)]
pub struct StoredRow {
    /// Label of the design.
    pub label: String,
    /// Changes of the base, JSON.
    pub changes: String,
    /// Its job, if there was one.
    pub job: Option<String>,
    /// Where the job stands, unless it was deleted.
    pub status: Option<String>,
    /// Summary of its results, JSON, unless that is damaged.
    pub summary: Option<Result<String, Damaged>>,
    /// Why there are no results, a problem document, JSON.
    pub problem: Option<String>,
}

impl Record for StoredRow {
    fn read(row: &Row) -> Result<Self, sqlx::Error> {
        let job: Option<String> = row.get("job")?;
        let (summary, written): (Option<String>, _) = (row.get("summary")?, row.get("checksum")?);
        let summary = summary.map(|summary| {
            let job = job.as_deref().unwrap_or_default();
            checked(
                format_args!("that tables show of the job {job}"),
                (summary, written),
            )
        });
        Ok(Self {
            label: row.get("label")?,
            changes: row.get("changes")?,
            summary,
            job,
            status: row.get("status")?,
            problem: row.get("problem")?,
        })
    }
}

/// The results of a design.
#[derive(Debug, Clone)]
pub struct DocumentLine {
    /// Its place in the table, from 0.
    pub position: i64,
    /// Label of the design.
    pub label: String,
    /// The job that computed it.
    pub job: String,
    /// Its results.
    pub document: Document,
}

/// Position, label and job; columns of its document.
type StoredDocument = (i64, String, String, String, String, Vec<u8>, Option<i64>);

impl Store {
    /// At most `limit` rows of a study behind the position `after`, in their order.
    pub async fn study_rows(
        &self,
        id: Uuid,
        after: i64,
        limit: u32,
    ) -> Result<Vec<StoredRow>, StoreError> {
        let rows = query_as(
            "select r.label, r.changes, r.job, j.status, s.body as summary, s.checksum,
                    coalesce(r.problem, j.problem) as problem
             from study_rows r
             left join jobs j on j.id = r.job
             left join summaries s on s.document = j.document
             where r.study = $1 and r.position > $2
             order by r.position limit $3",
        )
        .bind(id.to_string())
        .bind(after)
        .bind(limit)
        .fetch_all(&self.readers)
        .await?;
        Ok(rows)
    }

    /// At most `limit` rows of a study that have results, behind the position `after`, with their documents.
    pub async fn study_documents(
        &self,
        id: Uuid,
        after: i64,
        limit: u32,
    ) -> Result<Vec<DocumentLine>, StoreError> {
        let rows: Vec<StoredDocument> = query_as(
            "select r.position, r.label, r.job, d.hash, d.encoding, d.body, d.checksum
             from study_rows r
             join jobs j on j.id = r.job
             join documents d on d.hash = j.document and d.whole = 1
             where r.study = $1 and r.position > $2
             order by r.position limit $3",
        )
        .bind(id.to_string())
        .bind(after)
        .bind(limit)
        .fetch_all(&self.readers)
        .await?;
        let row =
            |(position, label, job, hash, encoding, body, sum): StoredDocument| DocumentLine {
                position,
                label,
                job,
                document: Document::kept((hash, encoding, body, sum)),
            };
        Ok(rows.into_iter().map(row).collect())
    }

    /// The bytes of the text of each of these.
    pub async fn study_document_bytes(
        &self,
        id: Uuid,
        after: i64,
        limit: u32,
    ) -> Result<Vec<i64>, StoreError> {
        let bytes = query_scalar(
            "select d.size
             from study_rows r
             join jobs j on j.id = r.job
             join documents d on d.hash = j.document and d.whole = 1
             where r.study = $1 and r.position > $2
             order by r.position limit $3",
        );
        let bytes = bytes.bind(id.to_string()).bind(after).bind(limit);
        Ok(bytes.fetch_all(&self.readers).await?)
    }
}
