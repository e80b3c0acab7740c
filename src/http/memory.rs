//! The memory for what clients send, while it comes and while it is read.

use std::time::Duration;

use tokio::time::timeout;

use crate::compute::{Budget, Part};
use crate::wire::{Code, Problem};

/// So long a request waits for memory, at most.
const LONGEST_WAIT: Duration = Duration::from_secs(90);

/// A document of no more bytes waits for no memory. What comes of it is bounded by the connections, which have buffers of that size
/// anyway, and what is made of it by the few that are read at the same time.
pub(super) const SMALL: usize = 64 << 10;

/// What is made of a document takes so many times its size beside it, for its texts.
const TIMES_ITS_SIZE: u64 = 3;

/// And so many bytes for each of its values, with what a study makes of them.
const FOR_A_VALUE: u64 = 150;

/// The memory for what clients send. What a client sends comes as slowly as it likes, so the bytes have a memory of their own, of which
/// no client has so much that there is none for the next. Only what has come is read, in the memory for that, which is free
/// again as soon as the processor is done.
#[derive(Debug, Clone)]
pub struct ReadingMemory {
    bytes: Budget,
    made: Budget,
}

impl ReadingMemory {
    /// So many bytes in all.
    pub fn of(most: u64) -> Self {
        let bytes = most / 4;
        Self {
            bytes: Budget::leaving_as_much(bytes),
            made: Budget::of(most - bytes),
        }
    }

    /// The memory for a document of `client` of so many bytes, before there is any of it; none where it is small.
    ///
    /// # Errors
    ///
    /// `overloaded`, after a while.
    pub(super) async fn for_bytes(
        &self,
        client: &str,
        length: usize,
    ) -> Result<Option<Part>, Problem> {
        if length <= SMALL {
            return Ok(None);
        }
        part(&self.bytes, client, length as u64).await
    }

    /// The memory for what is made of `document`; none where it is small.
    ///
    /// # Errors
    ///
    /// `overloaded`, after a while.
    pub(super) async fn to_read(
        &self,
        client: &str,
        document: &[u8],
    ) -> Result<Option<Part>, Problem> {
        if document.len() <= SMALL {
            return Ok(None);
        }
        part(&self.made, client, weight(document)).await
    }
}

async fn part(budget: &Budget, client: &str, amount: u64) -> Result<Option<Part>, Problem> {
    let part = timeout(LONGEST_WAIT, budget.take(client, amount)).await;
    part.map(Some).map_err(|_| {
        let detail = "More is sent at once than is read. Try again in a moment.";
        Problem::new(Code::Overloaded, detail)
    })
}

/// What is made of a document takes so many bytes, about. Every value of JSON but the first stands behind one of three signs, and every
/// element of XML behind a fourth, so their number is known without reading them: texts that have such signs are told as larger than
/// they are.
fn weight(document: &[u8]) -> u64 {
    let is_sign = |byte: &&u8| matches!(byte, b',' | b'[' | b'{' | b'<');
    let values = document.iter().filter(is_sign).count() as u64;
    TIMES_ITS_SIZE * document.len() as u64 + FOR_A_VALUE * values
}
