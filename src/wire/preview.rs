//! A preview: a submission whose results are wanted at once and kept by nobody.

use utoipa::openapi::schema::{ObjectBuilder, SchemaType, Type};

use super::pair::PairDocument;
use super::problem::{Code, FieldError, Problem};
use super::resolution::ResolutionDocument;
use super::schema::{self, documented};
use super::size::{MOST_VALUES, refuse_many_values};
use super::submission::{Purpose, Submission};
use super::tags::is_short_text;
use super::tree::{Errors, Node, ObjectReader};

/// The field beside those of the submission.
const PREVIEW_ID: &str = "preview_id";

/// The most characters of an id.
const LONGEST_ID: usize = 64;

/// A submission, and the word by which a newer preview replaces this one.
#[derive(Debug, Clone, PartialEq)]
pub struct Preview {
    /// What is asked.
    pub submission: Submission,
    /// What the client calls this series of previews; a newer one stops an older one of the same id.
    pub id: Option<String>,
}

documented!(
    Preview,
    "Preview",
    [PairDocument, ResolutionDocument],
    schema::object(
        "Preview",
        "What is asked, as for a job, and perhaps which older preview it replaces. Unknown fields are refused.",
        [(PREVIEW_ID, id_schema(), false)]
            .into_iter()
            .chain(Submission::properties())
            .collect(),
    )
);

fn id_schema() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
    let types: SchemaType = [Type::String, Type::Null].into_iter().collect();
    ObjectBuilder::new()
        .schema_type(types)
        .title(Some("Preview id"))
        .description(Some("A word of the client's choice, such as one for each open form. A newer preview with the same id stops the older one. It does not change the result. Default: none; nothing stops this preview and it stops no other."))
        .min_length(Some(1))
        .max_length(Some(LONGEST_ID))
        .default(Some(serde_json::Value::Null))
        .into()
}

impl Preview {
    /// Reads and checks a preview of at most so many positions times torques.
    ///
    /// # Errors
    ///
    /// As for [`Submission::parse`], with the bounds of a preview.
    pub fn parse(document: &[u8], most_positions: u64) -> Result<Self, Problem> {
        refuse_many_values(document, MOST_VALUES)?;
        let node = Node::parse(document)?;
        let errors = Errors::default();
        let read = || {
            let mut reader = ObjectReader::new(&node, String::new(), &errors)?;
            let id = read_id(&mut reader);
            // The same reader goes on, so that each half knows the fields of the other.
            let submission = Submission::read(reader, Purpose::Preview { most_positions }, &errors);
            Some(Self {
                submission: submission?,
                id: id?,
            })
        };
        match read() {
            Some(preview) if errors.count() == 0 => Ok(preview),
            _ => Err(errors.into_problem()),
        }
    }
}

/// The id, if there is one. `None` if what stands there is none.
fn read_id(reader: &mut ObjectReader<'_>) -> Option<Option<String>> {
    match reader.present(PREVIEW_ID) {
        None => Some(None),
        Some(Node::Text(id)) if is_short_text(id, LONGEST_ID) => Some(Some(id.clone())),
        Some(Node::Text(id)) => {
            let pointer = reader.pointer_to(PREVIEW_ID);
            let detail = format!(
                "{pointer} has {} characters; it has to have 1 to {LONGEST_ID}, none of them a control character.",
                id.chars().count()
            );
            reader.report(FieldError::new(pointer, Code::OutOfRange, detail));
            None
        }
        Some(other) => {
            reader.wrong_kind(PREVIEW_ID, other, "a text");
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::wire::examples;

    fn case_2() -> Value {
        let example = examples()
            .iter()
            .find(|example| example.name == "test-case-2")
            .expect("ships");
        serde_json::from_str(example.json).expect("JSON")
    }

    fn parse(document: &Value, most_positions: u64) -> Result<Preview, Problem> {
        Preview::parse(document.to_string().as_bytes(), most_positions)
    }

    #[test]
    fn an_id_stands_beside_the_submission_and_does_not_change_it() {
        let mut document = case_2();
        let submission = Submission::parse(document.to_string().as_bytes()).expect("valid");
        for (id, read) in [
            (Value::Null, None),
            (json!("form 7"), Some("form 7".to_owned())),
            (json!("ö".repeat(64)), Some("ö".repeat(64))),
        ] {
            document["preview_id"] = id;
            let preview = parse(&document, 4000).expect("valid");
            assert_eq!((preview.id, &preview.submission), (read, &submission));
            assert_eq!(preview.submission.input_hash(), submission.input_hash());
        }
        // A job has no use for it.
        let problem = Submission::parse(document.to_string().as_bytes()).expect_err("unknown");
        assert_eq!(problem.errors[0].pointer, "/preview_id");
    }

    #[test]
    fn every_error_has_the_pointer_that_it_has_in_the_document() {
        let mut document = case_2();
        document["preview_id"] = json!("");
        document["preview-id"] = json!("a");
        document["pair"]["driven"]["blank"]["holes"]["counts"] = json!(3);
        let problem = parse(&document, 4000).expect_err("wrong");
        let found: Vec<_> = problem
            .errors
            .iter()
            .map(|error| (error.pointer.as_str(), error.code))
            .collect();
        assert_eq!(
            found,
            [
                ("/preview_id", Code::OutOfRange),
                ("/pair/driven/blank/holes/counts", Code::UnknownField),
                ("/preview-id", Code::UnknownField),
            ]
        );
        for wrong in [json!(7), json!(["a"]), json!("a".repeat(65)), json!("a\nb")] {
            document = case_2();
            document["preview_id"] = wrong;
            assert_eq!(
                parse(&document, 4000).expect_err("wrong").errors[0].pointer,
                "/preview_id"
            );
        }
    }

    #[test]
    fn a_preview_is_smaller_than_a_job() {
        // Five mesh periods of 40 positions at one torque.
        assert!(parse(&case_2(), 200).is_ok());
        let problem = parse(&case_2(), 199).expect_err("too large");
        let error = &problem.errors[0];
        assert_eq!(
            (error.pointer.as_str(), error.code, error.nearest),
            (
                "/resolution/positions_per_mesh_period",
                Code::TooLarge,
                Some(39.0)
            )
        );
        for said in ["200 positions", "199", "POST /v1/jobs"] {
            assert!(error.detail.contains(said), "{}", error.detail);
        }
    }
}
