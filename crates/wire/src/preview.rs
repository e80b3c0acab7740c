//! A preview: a submission whose results are wanted at once and kept by nobody.

use super::declare::{
    Declared, Errors, Location, Node, Object as _, ObjectReader, Optional, Text, absent, object,
    text, utoipa_schema,
};
use super::problem::Problem;
use super::size::{MOST_VALUES, refuse_many_values};
use super::submission::{Purpose, Submission, SubmissionDocument, places};

/// The field beside those of the submission.
const PREVIEW_ID: Declared<Optional<Text>> = Declared::new(
    "preview_id",
    "A word of the client's choice, such as one for each open form. A newer preview with the same id stops the older one. It does not change the result.",
    absent(
        text("Preview id", 64),
        "none; nothing stops this preview and it stops no other",
    ),
);

/// A submission, and the word by which a newer preview replaces this one.
#[derive(Debug, Clone, PartialEq)]
pub struct Preview {
    /// The submission.
    pub submission: Submission,
    /// The client's name for this series of previews; a newer one stops an older one of the same id.
    pub id: Option<String>,
}

impl utoipa::PartialSchema for Preview {
    fn schema() -> utoipa::openapi::RefOr<utoipa::openapi::Schema> {
        let about = "A submission, as for a job, and perhaps the older preview that it replaces. Unknown fields are refused.";
        let mut properties = vec![PREVIEW_ID.property::<Option<String>>()];
        properties.extend(SubmissionDocument::properties());
        utoipa_schema(object("Preview", about, properties))
    }
}

impl utoipa::ToSchema for Preview {
    fn schemas(schemas: &mut Vec<(String, utoipa::openapi::RefOr<utoipa::openapi::Schema>)>) {
        <Submission as utoipa::ToSchema>::schemas(schemas);
    }
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
            let mut reader = ObjectReader::new(&node, Location::root(&errors))?;
            let id = PREVIEW_ID.read::<Option<String>>(&mut reader);
            // The same reader goes on, so that each half knows the fields of the other.
            let submission = Submission::read(reader, Purpose::Preview { most_positions }, &errors);
            Some(Self {
                submission: submission?,
                id: id?,
            })
        };
        let read = read();
        errors.mended(places::pointing).settle(read)
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::problem::Code;
    use crate::testing::{self, example};

    fn case_2() -> Value {
        example("test-case-2")
    }

    fn parse(document: &Value, most_positions: u64) -> Result<Preview, Problem> {
        Preview::parse(document.to_string().as_bytes(), most_positions)
    }

    #[test]
    fn an_id_stands_beside_the_submission_and_does_not_change_it() {
        let mut document = case_2();
        let submission = testing::parse(&document).expect("valid");
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
        let problem = testing::parse(&document).expect_err("unknown");
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
