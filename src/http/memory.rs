//! The memory for the bodies of requests and answers, while they exist, and for the values made of them.

use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, Bytes, to_bytes};
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use http_body::Body as _;
use meshwright_connections::{Budget, Connection, Part};
use meshwright_wire::{Code, Problem};
use tokio::time::timeout;

use super::problem::{Refusal, internal};

/// Longest time that a request waits for memory.
const LONGEST_WAIT: Duration = Duration::from_secs(90);

/// A document of at most this many bytes waits for no memory. Its answer is bounded by the connections, which have buffers of that size anyway. The memory of
/// its values is bounded by the number of documents parsed at the same time.
pub(super) const SMALL: usize = 64 << 10;

/// An answer of no more bytes is bounded by the connections as well.
pub(super) const SMALL_ANSWER: usize = 16 << 10;

/// Memory of the texts of a document, beside its bytes, in multiples of its size.
const TIMES_ITS_SIZE: u64 = 3;

/// Bytes for each value of a document, including those that a study makes of it.
const FOR_A_VALUE: u64 = 150;

/// A line of a drawing takes so many bytes, in lists that grow twofold, beside its share of the lines and arcs.
const FOR_A_LINE: u64 = 40;

/// The memory for bodies, in three budgets. A client sends and reads as slowly as it likes: the bytes of requests and those of answers
/// have a budget each, of which no client has so much that there is none for the next. A document is read only when it has come, in
/// the memory for that, which is free again as soon as the processor is done.
#[derive(Debug, Clone)]
pub struct BodyMemory {
    sent: Budget,
    made: Budget,
    answers: Budget,
}

impl BodyMemory {
    /// Limits in bytes: `sent` for requests, `answers` for answers.
    pub fn of(sent: u64, answers: u64) -> Self {
        let bytes = sent / 4;
        Self {
            sent: Budget::leaving_as_much(bytes),
            made: Budget::of(sent - bytes),
            answers: Budget::leaving_as_much(answers),
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
        part(&self.sent, client, length as u64).await
    }

    /// The memory for the values of `document`, by its weight; `None` for a small one.
    ///
    /// # Errors
    ///
    /// `overloaded`, after a while.
    pub(super) async fn to_read(
        &self,
        client: &str,
        document: &[u8],
        weigh: fn(&[u8]) -> u64,
    ) -> Result<Option<Part>, Problem> {
        if document.len() <= SMALL {
            return Ok(None);
        }
        part(&self.made, client, weigh(document)).await
    }

    /// Refuses an answer of so many bytes that there is never memory for it.
    ///
    /// # Errors
    ///
    /// `too_large`.
    pub(super) fn check_answer(&self, bytes: u64) -> Result<(), Problem> {
        let most = self.most_answers();
        if bytes <= most {
            return Ok(());
        }
        let [bytes, most] = [bytes, most].map(|bytes| bytes.div_ceil(1_000_000));
        let detail = format!(
            "The file has up to {bytes} MB; all answers at the same time may have {most} MB here. A coarser grid or fewer teeth take less."
        );
        Err(Problem::new(Code::TooLarge, detail))
    }

    /// The memory for all answers together, in bytes.
    pub fn most_answers(&self) -> u64 {
        self.answers.most()
    }

    /// Holds a file that was made for `client` on a thread of the engine, as long as somebody `is_wanted`. Where there is no memory for it, `give_way` is asked for
    /// some as long as it gives any.
    pub(super) fn hold_file(
        &self,
        client: &str,
        bytes: Vec<u8>,
        is_wanted: impl Fn() -> bool,
        give_way: impl Fn() -> bool,
    ) -> Held {
        let size = bytes.len() as u64;
        let part = loop {
            match self.answers.try_take(client, size) {
                None if give_way() => {}
                None => break self.answers.take_on_thread(client, size, is_wanted),
                part => break part,
            }
        };
        AnswerMemory(part).hold(bytes)
    }

    /// The memory for an answer to `client` while it is made and until it has left: at most so many bytes.
    ///
    /// # Errors
    ///
    /// `overloaded`, after a while.
    pub(super) async fn for_answer(
        &self,
        client: &str,
        most: u64,
    ) -> Result<AnswerMemory, Problem> {
        if most <= SMALL_ANSWER as u64 {
            return Ok(AnswerMemory(None));
        }
        part(&self.answers, client, most).await.map(AnswerMemory)
    }
}

async fn part(budget: &Budget, client: &str, amount: u64) -> Result<Option<Part>, Problem> {
    let part = timeout(LONGEST_WAIT, budget.take(client, amount)).await;
    part.map(Some).map_err(|_| overloaded())
}

fn overloaded() -> Problem {
    let detail = "More is sent and read at once than there is memory for. Try again in a moment.";
    Problem::new(Code::Overloaded, detail)
}

/// The memory for an answer, or for a piece of one.
#[derive(Debug, Default)]
pub(super) struct AnswerMemory(Option<Part>);

impl AnswerMemory {
    /// The bytes of the answer. The memory is held, as much as they take, until the last of them was handed to the system.
    pub(super) fn hold(self, bytes: impl AsRef<[u8]> + Send + 'static) -> Held {
        let Some(mut part) = self.0 else {
            return Held(Bytes::from_owner(bytes));
        };
        part.shrink(bytes.as_ref().len() as u64);
        Held(Bytes::from_owner(Owner { bytes, _part: part }))
    }
}

impl AnswerMemory {
    /// The same of an answer that is here whole.
    ///
    /// # Errors
    ///
    /// `internal_error` where it is not.
    pub(super) async fn hold_body(self, answer: Response) -> Result<Response, Refusal> {
        let (parts, body) = answer.into_parts();
        let bytes = to_bytes(body, usize::MAX).await;
        let bytes = self.hold(bytes.map_err(|_| internal())?).0;
        let mut answer = Response::from_parts(parts, bytes.into());
        answer.extensions_mut().insert(Counted);
        Ok(answer)
    }
}

struct Owner<B> {
    bytes: B,
    _part: Part,
}

impl<B: AsRef<[u8]>> AsRef<[u8]> for Owner<B> {
    fn as_ref(&self) -> &[u8] {
        self.bytes.as_ref()
    }
}

/// Bytes of an answer that hold their memory.
#[derive(Debug)]
pub(super) struct Held(pub(super) Bytes);

impl IntoResponse for Held {
    fn into_response(self) -> Response {
        let mut response = Body::from(self.0).into_response();
        response.extensions_mut().insert(Counted);
        response
    }
}

/// Marks an answer whose body needs no memory or holds its own.
#[derive(Debug, Clone)]
pub(super) struct Counted;

/// Lets every other answer hold the memory for its body until that has left, or refuses it where there is none.
pub(super) async fn hold(
    State(memory): State<BodyMemory>,
    request: Request,
    next: Next,
) -> Response {
    let connection = request.extensions().get::<Arc<Connection>>().cloned();
    let mut response = next.run(request).await;
    let size = response.body().size_hint().exact();
    let Some(size) = size.filter(|size| *size > SMALL_ANSWER as u64) else {
        return response;
    };
    if response.extensions_mut().remove::<Counted>().is_some() {
        return response;
    }
    let client = connection.map_or_else(String::new, |connection| connection.client());
    let Some(part) = memory.answers.try_take(&client, size) else {
        return Refusal::from(overloaded()).into_response();
    };
    let held = AnswerMemory(Some(part)).hold_body(response).await;
    held.unwrap_or_else(IntoResponse::into_response)
}

/// Estimate in bytes of the memory for the values of a document. Every value of JSON but the first follows one of three characters, and every element of XML
/// follows a fourth. Their number is known without parsing. Texts with such characters are overestimated.
pub(super) fn weight(document: &[u8]) -> u64 {
    let is_sign = |byte: &&u8| matches!(byte, b',' | b'[' | b'{' | b'<');
    let values = document.iter().filter(is_sign).count() as u64;
    TIMES_ITS_SIZE * document.len() as u64 + FOR_A_VALUE * values
}

/// Estimate in bytes of the memory for the groups of a drawing: two lines each.
pub(super) fn weight_of_lines(document: &[u8]) -> u64 {
    let lines = document.iter().filter(|byte| **byte == b'\n').count() as u64;
    TIMES_ITS_SIZE * document.len() as u64 + FOR_A_LINE * lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_weighs_what_its_values_take_however_few_bytes_they_have() {
        let count = 10_000;
        let numbers = format!("[{}0]", "0,".repeat(count));
        let values = count * size_of::<serde_json::Value>();
        assert!(weight(numbers.as_bytes()) > values as u64);
        // A text has no values in it.
        let text = format!("[\"{}\"]", "a".repeat(2 * count));
        assert!(weight(text.as_bytes()) < values as u64);
    }

    #[tokio::test]
    async fn an_answer_holds_as_much_memory_as_it_has_bytes_until_the_last_of_them_has_left() {
        let memory = BodyMemory::of(1 << 20, 1 << 20);
        let free = || memory.answers.free();
        let answer = memory.for_answer("a", 600 << 10).await.unwrap();
        assert_eq!(free(), 424 << 10);
        let bytes = answer.hold(vec![0_u8; 100 << 10]).0;
        assert_eq!(free(), 924 << 10);
        let rest = bytes.slice(50..60);
        drop(bytes);
        assert_eq!(free(), 924 << 10, "some of it is still here");
        drop(rest);
        assert_eq!(free(), 1 << 20);
    }
}
