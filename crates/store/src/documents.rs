//! Results documents: packed, and named by the hash of their text.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{Read, Write};

use bytes::Bytes;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use flate2::{Compression, Crc};
use serde_json::json;
use uuid::Uuid;

use super::hash::sha256_hex;
use super::statement::{Connection, list, query, query_as, query_scalar};
use super::{Store, StoreError, dialect};

/// Level of compression. Documents are numbers in decimal, and every job waits for their compression: one of 200 positions (55 kB) becomes 17.4, 16.2 or
/// 15.8 kB at the levels 1, 3 and 9, one of 2,000 positions (400 kB) 116, 100 or 97 kB. The levels take 1.3, 3.4 and 11.5 ms for a mean document of 240 kB,
/// which takes 100 ms or more to compute.
const LEVEL: Compression = Compression::new(3);

/// A text, packed.
#[derive(Debug, Clone)]
pub struct Packed {
    hash: String,
    body: Vec<u8>,
    size: u64,
    whole: bool,
}

impl Packed {
    /// Packs a text. It takes a core for some milliseconds.
    pub fn of(text: &str) -> Self {
        let mut encoder = GzEncoder::new(Vec::with_capacity(text.len() / 2), LEVEL);
        let written = encoder.write_all(text.as_bytes());
        let body = written.and_then(|()| encoder.finish());
        Self {
            hash: sha256_hex(text),
            body: body.expect("memory takes every byte"),
            size: text.len() as u64,
            whole: true,
        }
    }

    /// The name of a text, which itself is not kept.
    pub fn name_of(text: &str) -> Self {
        Self {
            hash: sha256_hex(text),
            body: Vec::new(),
            size: text.len() as u64,
            whole: false,
        }
    }

    #[cfg(test)]
    pub(super) fn for_tests(&self) -> &[u8] {
        &self.body
    }

    /// The hash of the text.
    pub(super) fn hash(&self) -> &str {
        &self.hash
    }
}

/// Stores documents that are not stored yet, each with its summary for the tables of studies. A document of which only the name was stored becomes whole.
pub(super) async fn insert_documents(
    connection: &mut Connection,
    documents: impl Iterator<Item = (&Packed, Option<&str>)>,
) -> Result<(), sqlx::Error> {
    // Equal ones once, and in one order for all who write several.
    let mut by_hash: BTreeMap<&str, (&Packed, Option<&str>)> = BTreeMap::new();
    for (document, summary) in documents {
        let kept = by_hash
            .entry(document.hash())
            .or_insert((document, summary));
        if document.whole && !kept.0.whole {
            kept.0 = document;
        }
    }
    let mut bodies = Vec::new();
    let mut rows = Vec::with_capacity(by_hash.len());
    let mut summaries = Vec::new();
    for (hash, (document, summary)) in by_hash {
        // The databases count bytes from one.
        let (starts, takes) = (bodies.len() + 1, document.body.len());
        bodies.extend_from_slice(&document.body);
        rows.push(json!({
            "hash": hash, "starts": starts, "takes": takes, "size": document.size, "whole": i64::from(document.whole),
            "checksum": document.whole.then(|| checksum(&document.body)),
        }));
        summaries.extend(summary.map(|summary| {
            json!({ "hash": hash, "body": summary, "checksum": checksum(summary.as_bytes()) })
        }));
    }
    if rows.is_empty() {
        return Ok(());
    }
    let insert = query(dialect::insert_documents()).bind(list(&rows));
    connection.later(insert.bind(&*bodies)).await?;
    if !summaries.is_empty() {
        let insert = query(dialect::insert_summaries()).bind(list(&summaries));
        connection.later(insert).await?;
    }
    Ok(())
}

/// Checksum of a document (CRC-32), which shows whether it was changed by other programs.
pub(super) fn checksum(body: &[u8]) -> i64 {
    let mut crc = Crc::new();
    crc.update(body);
    crc.sum().into()
}

/// The text of `what`, if its checksum is the one that was `written` beside it.
pub(super) fn checked(
    what: impl fmt::Display,
    (text, written): (String, Option<i64>),
) -> Result<String, Damaged> {
    if written.is_some_and(|written| written != checksum(text.as_bytes())) {
        return Err(Damaged(what.to_string()));
    }
    Ok(text)
}

/// A document as it is kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Document {
    hash: String,
    gzip: bool,
    body: Bytes,
    /// That of the body when it was written; none where an earlier version wrote it.
    checksum: Option<i64>,
}

/// Name, encoding, body and checksum of a document, as they are read.
pub(super) type Columns = (String, String, Vec<u8>, Option<i64>);

/// The text that was read differs from the text that was written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the document {0} is damaged")]
pub struct Damaged(String);

impl Document {
    pub(super) fn kept((hash, encoding, body, checksum): Columns) -> Self {
        Self {
            hash,
            gzip: encoding == "gzip",
            body: body.into(),
            checksum,
        }
    }

    /// The bytes of a gzip file (RFC 1952), if it is kept as one.
    ///
    /// # Errors
    ///
    /// [`Damaged`], if its checksum is another one.
    pub fn gzip(&self) -> Result<Option<Bytes>, Damaged> {
        if self
            .checksum
            .is_some_and(|written| written != checksum(&self.body))
        {
            return Err(Damaged(self.hash.clone()));
        }
        Ok(self.gzip.then(|| self.body.clone()))
    }

    /// The number of its bytes as it is kept.
    pub fn packed_bytes(&self) -> usize {
        self.body.len()
    }

    /// The very text that was written.
    ///
    /// # Errors
    ///
    /// [`Damaged`], if its hash is another one.
    pub fn text(&self) -> Result<String, Damaged> {
        let damaged = || Damaged(self.hash.clone());
        let mut text = String::new();
        if self.gzip {
            let read = GzDecoder::new(&*self.body).read_to_string(&mut text);
            read.map_err(|_| damaged())?;
        } else {
            text = String::from_utf8(self.body.to_vec()).map_err(|_| damaged())?;
        }
        if sha256_hex(&text) == self.hash {
            Ok(text)
        } else {
            Err(damaged())
        }
    }
}

impl Store {
    /// A results document, if more of it was kept than its name.
    pub async fn document(&self, hash: &str) -> Result<Option<Document>, StoreError> {
        let found = query_as(
            "select hash, encoding, body, checksum from documents where hash = $1 and whole = 1",
        );
        let found = found.bind(hash).fetch_optional(&self.readers).await?;
        Ok(found.map(Document::kept))
    }

    /// The number of bytes of the text of a results document, if more of it was kept than its name.
    pub async fn document_bytes(&self, hash: &str) -> Result<Option<i64>, StoreError> {
        let size = query_scalar("select size from documents where hash = $1 and whole = 1");
        Ok(size.bind(hash).fetch_optional(&self.readers).await?)
    }

    /// The hash of the results document of a successful job of which only the statistics were kept: that of another one of the same client with
    /// the same input and solver.
    pub async fn document_of_equal(&self, id: Uuid) -> Result<Option<String>, StoreError> {
        let hash = query_scalar(
            "select hash from jobs asked
             join jobs equal on equal.client = asked.client and equal.input_hash = asked.input_hash and equal.solver_version = asked.solver_version
             join documents on hash = equal.document
             where asked.id = $1 and equal.status = 'successful' and whole = 1
             order by equal.sequence limit 1",
        )
        .bind(id.to_string())
        .fetch_optional(&self.readers)
        .await?;
        Ok(hash)
    }
}

/// Removes a document unless a job needs it.
pub(super) async fn forget_document(
    connection: &mut Connection,
    hash: &str,
) -> Result<(), sqlx::Error> {
    query(dialect::lock_document())
        .bind(hash)
        .execute(&mut *connection)
        .await?;
    query(
        "delete from documents where hash = $1 and not exists (select 1 from jobs where document = $1)",
    )
    .bind(hash)
    .execute(connection)
    .await?;
    Ok(())
}
