//! Errors as RFC 9457 problem documents with stable codes.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

macro_rules! codes {
    ($($name:ident $slug:literal $status:literal $title:literal $explanation:literal)*) => {
        /// The stable code of a problem.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
        #[serde(rename_all = "snake_case")]
        #[schema(title = "Code")]
        pub enum Code { $(#[doc = $title] $name,)* }

        impl Code {
            /// Every code.
            pub const ALL: &[Code] = &[$(Code::$name,)*];

            /// The last part of the problem's type: the code with hyphens.
            pub fn slug(self) -> &'static str { match self { $(Code::$name => $slug,)* } }

            /// Its word in documents and numbers.
            pub fn word(self) -> String { self.slug().replace('-', "_") }

            /// The HTTP status that it answers with.
            pub fn status(self) -> u16 { match self { $(Code::$name => $status,)* } }

            /// Title of the kind of problem.
            pub fn title(self) -> &'static str { match self { $(Code::$name => $title,)* } }

            /// A paragraph on its meaning and on what to do.
            pub fn explanation(self) -> &'static str { match self { $(Code::$name => $explanation,)* } }
        }
    };
}

codes! {
    MalformedJson "malformed-json" 400 "The body is not well-formed JSON"
        "The body could not be read as one JSON document: a syntax error, text after its end, nesting deeper than 128 levels, a number beyond double precision, or one key twice in one object. The detail names the place. Send one JSON object, UTF-8."
    MissingField "missing-field" 422 "A needed field is missing"
        "A field without a default is absent. A submission needs method, pair.center_distance_mm, output_torques_n_m and for each gear tooth_count, module_mm, face_width_mm and blank.bore_radius_mm; everything else has a default."
    WrongType "wrong-type" 422 "A field has the wrong type"
        "The field is there, but is not the kind of value that is read here: a number in quotes, a fraction where a count is wanted, null where a value is needed, or a word that is not among the choices. The detail says what is expected."
    UnknownField "unknown-field" 422 "A field is not known"
        "The document has a field that is not read. It is refused rather than passed over, because a misspelled optional field would silently be computed with its default. The detail names the nearest known field."
    OutOfRange "out-of-range" 422 "A value is out of range"
        "The value is outside the bounds that the schema at /openapi.json states for the field, or outside those that the other fields leave for it. nearest is the closest value that is accepted."
    ConflictingFields "conflicting-fields" 422 "Two fields exclude each other"
        "Two fields are given of which one stands in place of the other, such as addendum_mm and tip_diameter_mm, or tip_rounding_mm and tip_chamfer_mm. Which of them is meant cannot be known; leave one out, or send null for it."
    WrongLength "wrong-length" 422 "A list has the wrong length"
        "The list has not as many numbers as it needs: the deviations of teeth need one for each tooth, the values of a profile table one for each of its places. The detail says how many; nearest is that number."
    TableDoesNotRise "table-does-not-rise" 422 "A profile table does not rise"
        "The places of a profile table have to rise from entry to entry, from the root of the flank to its tip, by at least 0.0001 modules. The pointer names the first entry that does not stand beyond the one before it; nearest is the least value that would."
    PitchDoesNotClose "pitch-does-not-close" 422 "Single pitch deviations do not close"
        "Once around the gear the single pitch deviations lead back to the first tooth, so that their sum has to be zero within 0.01 um. The detail says by how much it is not, and what to take from each. pitch_cumulative_um has no such condition."
    TeethTooThick "teeth-too-thick" 422 "The teeth are too thick"
        "Teeth thicker by this deviation leave no space between their fillets at the root. nearest is the largest deviation, rounded down, that leaves one."
    TipEdgeTooLarge "tip-edge-too-large" 422 "The tip edge is broken by too much"
        "Rounding or chamfer of the two flanks of a tooth meet, or leave no involute. nearest is the largest value, rounded down, that leaves a tip and a flank."
    TeethDoNotReach "teeth-do-not-reach" 422 "The teeth do not reach each other"
        "The center distance is not less than the two tip radii together, so no tooth ever touches another. Table 1 of Benaicha et al. (2021) prints such a distance for test case 3: 118.5 mm, where the tip radii sum to 118.0 mm; 114.5 mm is what its other numbers agree with. nearest is the largest distance, rounded down, at which one pair always carries the load."
    ContactRatioBelowOne "contact-ratio-below-one" 422 "The contact ratio is below one"
        "The teeth reach each other, but the path of contact is shorter than the base pitch: between one pair and the next nothing would carry the load. nearest is the largest center distance, rounded down, at which the contact ratio is at least one."
    NegativeBacklash "negative-backlash" 422 "The backlash is negative"
        "At this center distance the teeth are thicker than the spaces that they enter, at least at the worst of them: pitch and slope deviations that stand out, and eccentricity, take from the backlash. nearest is the smallest distance, rounded up, without negative backlash; less profile shift helps as well. Zero backlash is accepted with a warning, and so is what the last printed digits of distance, profile shifts and module explain."
    Interference "interference" 422 "A tip enters a fillet"
        "The tips of one gear reach below the involute flank of the other, into its fillet or root, where the motion would not be conjugate. nearest is the smallest center distance, rounded up, that avoids it; a shorter addendum helps as well."
    Undercut "undercut" 422 "The flank is undercut"
        "The generating rack cuts so far into the teeth near the base circle that next to nothing of them is left. Less undercut is computed. nearest is the smallest profile shift coefficient, rounded up, that avoids all of it; more teeth or a larger pressure angle help as well."
    PointedTip "pointed-tip" 422 "The teeth are pointed"
        "The two flanks of a tooth meet, or leave less than 0.05 modules between them, at the tip circle. nearest is the largest addendum, rounded down, that leaves enough; less profile shift helps as well."
    ModuleMismatch "module-mismatch" 422 "The modules differ"
        "Gears that mesh have the same module. nearest is the module of the driving gear."
    PressureAngleMismatch "pressure-angle-mismatch" 422 "The pressure angles differ"
        "Gears that mesh have the same pressure angle of their basic rack. nearest is the pressure angle of the driving gear."
    HolesOverlap "holes-overlap" 422 "The holes overlap"
        "Two holes, or the two ends of a slot, leave less than 0.5 mm of material between them. nearest is the largest hole radius, slot width or slot angle, rounded down, that fits, or the circle radius if none would do; fewer holes or a larger circle help as well."
    HolesBreachRim "holes-breach-rim" 422 "The holes breach the rim"
        "The holes leave less than 0.5 mm of material below the root circle. nearest is the largest hole radius, rounded down, that fits, or the circle radius if no radius would do."
    HolesBreachBore "holes-breach-bore" 422 "The holes breach the bore"
        "The holes leave less than 0.5 mm of material around the bore. nearest is the largest hole radius, rounded down, that fits, or the circle radius if no radius would do."
    SpokesDoNotFit "spokes-do-not-fit" 422 "The spokes do not fit"
        "Neighboring spokes overlap at the hub ring, their fillets leave no room for each other, or the rim begins where the hub ring ends. nearest is the width, the fillet radius or the radius of the rim that would do."
    OutlineUnsound "outline-unsound" 422 "The outline is no region"
        "A loop of the outline crosses or touches itself, runs the wrong way or around the axis, encloses nothing, or has a corner that is too sharp; or it is a bore with another radius than blank.bore_radius_mm. The pointer and the detail say which loop, and which side. Loops of openings run clockwise."
    WebOutsideBlank "web-outside-blank" 422 "The web does not lie within the blank"
        "The web has to begin at the bore or outside of it, and to end at least half a module below the root circle, so that a rim carries the teeth. nearest is the radius nearest to the one given."
    HubDoesNotFit "hub-does-not-fit" 422 "The hub does not fit"
        "The hub has to be at least as wide as the web that stands on it, to end between the bore and the rim, and to lie within the face or around it. nearest is the value nearest to the one given that would do."
    WebBeyondFace "web-beyond-face" 422 "The web stands out of the face"
        "Moved by its offset the web stands out of the face. nearest is the offset nearest to the one given that keeps it inside; a web that is thicker than the face is wide has none."
    HoleAcrossEdge "hole-across-edge" 422 "A hole crosses the edge of a web or a hub"
        "In three dimensions each hole has to lie between two edges, and all of them between the same: in the web, in the hub, or in the rim. The detail says between which radii."
    FacesDoNotOverlap "faces-do-not-overlap" 422 "The faces do not overlap"
        "The axial offset leaves less than a tenth of the narrower face in common. nearest is the largest offset to the same side that leaves so much."
    NeedsThreeDimensions "needs-three-dimensions" 422 "The plane does not know this"
        "A helix angle, lead modifications and slopes, a misalignment, an axial offset, a hub of its own width and a web beside the middle of the face are known in three dimensions alone: the method three_dimensional takes them. nearest is the value that the plane takes."
    QuantityNotTold "quantity-not-told" 422 "The quantity is not computed"
        "The submission does not compute a quantity that is requested, or that a goal or a bound of a search needs: its method does not have it, a part of the true period has no orders, or its field is not set. The detail names the change that would compute it. Every design would keep a bound on a quantity that is not computed."
    NotInThreeDimensions "not-in-three-dimensions" 422 "Not computed in three dimensions"
        "The method three_dimensional does not compute this yet; a plane method does. Leave the field out, or choose another method."
    BoreTooLarge "bore-too-large" 422 "The bore is too large"
        "The bore leaves less than one module of material below the root circle. nearest is the largest bore radius, rounded down, that fits."
    ReliefTooLong "relief-too-long" 422 "A relief starts outside the flank"
        "A tip relief has to start on the involute: above the form radius, where the fillet ends, and at least 0.01 modules below the tip circle. A root relief has to start at least 0.01 modules above the form circle, and not above the tip circle. nearest is the start nearest to the one given, said in the same way."
    TorqueNotPositive "torque-not-positive" 422 "A torque is not positive"
        "The output torque loads the driven gear against the motion and must not be negative; 0 is light load, the limit that gives the kinematic error. Reversed load is the mirrored pair."
    TooLarge "too-large" 422 "The work asked for is too large"
        "A submission may have at most 60 torques and 20,000 positions, 200,000 with a projected method on teeth that do not deviate, a preview fewer, counted as mesh periods times positions per mesh period times torques. A preview may take no longer than previews.time_limit_seconds by the estimate of /v1/validate. The detail says how many were asked for and what would fit: fewer positions, fewer torques or a shorter span. A project may have 1,000,000 bytes, and a client 200 of them. /v1/limits has the limits."
    ModelRefused "model-refused" 422 "The model has no pair that can be taken"
        "The body is no REXS model, or none of its cylindrical stages is a pair of external gears that can be computed. The errors say why of each, with its component and attribute; the pointer of an error is that of the submission that would come of the stage, and empty where none does."
    DrawingRefused "drawing-refused" 422 "The drawing has no outline that can be taken"
        "The body is no DXF in text, or what is drawn bounds no openings of a blank. The detail says why, with the entities, their layers and lines: loops that are open, entities that are not read, one loop inside another, or another center than the axis."
    NotConverged "not-converged" 422 "The contact did not converge"
        "The contact solver did not meet its tolerance at a position, which the detail names with the residual gap, or no flanks came near each other there. A larger gap tolerance, another penalty or the active set helps where the augmented Lagrangian was asked for."
    NoFormula "no-formula" 422 "A formula does not hold for this pair"
        "The load distribution takes its compliances from published formulas. One of them is so far outside its range that it gives no positive compliance; the detail says which. Another choice under resolution.load_distribution may hold, and the flexible method knows no such bounds. Where a formula is outside its range and still gives a compliance, there are results, with the warning formula_range."
    DiscretizationFailed
        "discretization-failed" 422 "A gear could not be divided into elements"
        "The finite-element grid of a gear, or a factorization on it, failed; the detail says where. Proportions far from the usual do that: very thin ligaments, very small holes. Another grid level may help."
    TimeLimit "time-limit" 422 "The time limit was reached"
        "The work took longer than one job may. Fewer positions, fewer torques or a coarser grid take less time; /v1/validate estimates it."
    PreviewTimeLimit "preview-time-limit" 503 "The preview took too long"
        "The preview was expected to be computed in time and was not, because the machine has much else to do or the estimate was too low. Send the request again after the time in Retry-After, or submit a job, which has more time. A preview whose estimate is above the limit is too_large."
    Stopped "stopped" 409 "The work was stopped"
        "The work was told to stop before it was done, and there is no result."
    NoDesignComputed "no-design-computed" 422 "No design could be computed"
        "The study came to its end without any results: none of its designs could be built or computed. Each row of its table has its own problem."
    ResultNotReady "result-not-ready" 404 "The result is not ready"
        "The job is waiting or running. Ask again after the time in Retry-After, or follow its events."
    ResultsNotKept "results-not-kept" 410 "Only the statistics were kept"
        "The job computes a design of a study that keeps statistics only (\"keep\": \"statistics\"); they stand in the table of the study, and the curves are gone. To have them, submit the design alone: send what GET /v1/jobs/{id} has under submission to POST /v1/jobs."
    JobNotFound "job-not-found" 404 "There is no such job"
        "No job of yours has this identifier; it may have been deleted, or have been kept as long as the service keeps jobs that have ended."
    StudyNotFound "study-not-found" 404 "There is no such study"
        "No study of yours has this identifier; it may have been deleted, or have been kept as long as the service keeps studies that have ended."
    WebhookNotFound "webhook-not-found" 404 "There is no such webhook"
        "No webhook of yours has this identifier; it may have been deleted."
    ProjectNotFound "project-not-found" 404 "There is no such project"
        "No project of yours has this identifier; it may have been deleted."
    PreconditionFailed "precondition-failed" 412 "The project was changed since it was read"
        "Somebody has changed the project since the answer whose ETag stands in If-Match. Nothing was changed. Get it again, decide which of the two stays, and send that with the new ETag."
    PreconditionRequired "precondition-required" 428 "The change has no If-Match"
        "A project is changed or deleted with If-Match and the ETag of the answer that was read, so that nobody's change is lost."
    WebhookDisabled "webhook-disabled" 409 "The webhook is disabled"
        "Nobody took its messages for a day and a half, or its receiver answered 410. POST to its `enable` address takes it up again."
    WebhookRefused "webhook-refused" 422 "The webhook is not taken"
        "Webhooks are off here, the address is not among those that the operator allows, it is not a public one, or you have as many as one client may."
    NotFound "not-found" 404 "There is nothing here"
        "The address, or the item of its query, does not exist. /openapi.json lists the addresses."
    MethodNotAllowed "method-not-allowed" 405 "The method is not allowed here"
        "The address exists, but does not take this HTTP method. The Allow header lists those that it takes."
    UnsupportedMediaType "unsupported-media-type" 415 "The media type is not supported"
        "Bodies are read as application/json; models of gearboxes as application/xml, application/json or application/zip."
    InvalidParameter "invalid-parameter" 400 "A parameter or header is not understood"
        "A query parameter, a path part or a header has a value that cannot be read. The detail names it and says what is expected."
    HostNotAllowed "host-not-allowed" 421 "The service has another name"
        "The Host of the request is no name of this service. It is refused because a page on a foreign name could otherwise speak to a service on its visitor's own machine. The operator can allow a name."
    Unauthorized "unauthorized" 401 "The request has no valid key"
        "This service asks for a key, or for a token of its operator's identity provider, and the request has none or one that is not known or has ended. Send it as Authorization: Bearer KEY."
    Forbidden "forbidden" 403 "This is not allowed to you"
        "The key or token is known, but may not do this."
    JobRunning "job-running" 409 "The job has not ended"
        "A job can be deleted only after it has ended. Cancel it first."
    JobFinished "job-finished" 409 "The job has ended"
        "A job that has ended can no longer be cancelled."
    JobFailed "job-failed" 409 "The job failed"
        "The job ended without a result; its problem says why."
    JobDismissed "job-dismissed" 409 "The job was dismissed"
        "The job was cancelled and has no result."
    AttemptsExhausted "attempts-exhausted" 500 "The job was lost too often"
        "The service ended three times while it worked on this job and no other, and does not try again. Tell the operator: the job may be what ended it."
    IdempotencyConflict "idempotency-conflict" 422 "The idempotency key belongs to another submission"
        "The Idempotency-Key was sent before with a different body. Use a new key for a new submission."
    QueueFull "queue-full" 503 "The queue is full"
        "More jobs are waiting than the service accepts. Nothing was stored; send the request again after the time in Retry-After."
    PreviewsFull "previews-full" 503 "Too many previews at once"
        "The service computes as many previews, or files of jobs, as it takes at the same time. Send the request again after the time in Retry-After. One that replaces an older one, by the same preview_id, is not refused for that."
    PreviewSuperseded "preview-superseded" 409 "A newer preview took the place of this one"
        "The client sent another preview with the same preview_id before this one was computed. The newer one is answered; this one is not computed to its end."
    ClientQueueFull "client-queue-full" 429 "Too many jobs of yours wait"
        "More jobs of yours wait than one client may have in the queue, so that others find room. Nothing was stored; send the request again when some of yours have ended."
    RateLimited "rate-limited" 429 "Too many requests"
        "More requests came from you than the service accepts. Send the request again after the time in Retry-After."
    PayloadTooLarge "payload-too-large" 413 "The body is too large"
        "The body is larger than the limit in /v1/limits."
    RequestTimeout "request-timeout" 408 "The request took too long"
        "The body of the request came too slowly. It is safe to send it again with the same Idempotency-Key."
    ServerTimeout "server-timeout" 503 "The service took too long"
        "The service did not answer in time, by its own fault. It is safe to send the request again with the same Idempotency-Key after the time in Retry-After."
    Overloaded "overloaded" 503 "Too much at once"
        "More requests of this kind came at once than the service works on. Nothing was stored; send the request again after the time in Retry-After."
    StorageUnavailable "storage-unavailable" 503 "Nothing can be stored now"
        "The disk of the service is full, or its database is locked or cannot be reached. Jobs that were taken are safe and go on when it is over; nothing new is taken meanwhile. Send the request again after the time in Retry-After."
    IdentityProviderUnavailable "identity-provider-unavailable" 503 "Tokens cannot be checked now"
        "The identity provider whose tokens this service takes gives no keys now, so that the token of the request cannot be checked. Keys of the service are taken as before. Send the request again after the time in Retry-After."
    Unavailable "unavailable" 503 "The service is shutting down"
        "The service is about to stop and takes no new work. Nothing was stored; send the request again after the time in Retry-After."
    DocumentDamaged "document-damaged" 500 "A stored document is damaged"
        "The text in the database differs from the text that was written: its checksum is another one. Nothing of it is served. The operator finds it in the log and can restore a backup; a job submitted again is computed anew once the damaged one is deleted."
    InternalError "internal-error" 500 "The service failed"
        "Something went wrong that is not your doing. It has been logged under the request's identifier, which the operator can look up."
}

/// Fault of one field of a document.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Field error")]
pub struct FieldError {
    /// Where the field is: a JSON pointer (RFC 6901) into the submitted document.
    #[schema(example = "/pair/center_distance_mm")]
    pub pointer: String,
    /// The stable code.
    pub code: Code,
    /// The fault with its numbers, in the field's own unit.
    pub detail: String,
    /// The nearest value that is accepted, in the field's own unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(example = 115.56)]
    pub nearest: Option<f64>,
}

impl FieldError {
    /// An error of the field at `pointer`.
    pub fn new(pointer: impl Into<String>, code: Code, detail: impl Into<String>) -> Self {
        Self {
            pointer: pointer.into(),
            code,
            detail: detail.into(),
            nearest: None,
        }
    }

    /// The same, with the nearest value that is accepted.
    pub fn nearest(mut self, nearest: impl Into<Option<f64>>) -> Self {
        self.nearest = nearest.into();
        self
    }
}

/// A problem document (RFC 9457), served as `application/problem+json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(title = "Problem")]
pub struct Problem {
    /// Where the kind of problem is explained.
    #[serde(rename = "type")]
    #[schema(example = "/problems/teeth-do-not-reach")]
    pub type_: String,
    /// Title of the kind of problem.
    pub title: String,
    /// The HTTP status.
    #[schema(minimum = 400, maximum = 599)]
    pub status: u16,
    /// The fault in this case.
    pub detail: String,
    /// The stable code.
    pub code: Code,
    /// The fault of each field of the input.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<FieldError>,
    /// The request or job that met it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<String>)]
    pub instance: Option<Box<str>>,
}

impl Problem {
    /// A problem of the kind `code`, with the fault in this case.
    pub fn new(code: Code, detail: impl Into<String>) -> Self {
        Self {
            type_: format!("/problems/{}", code.slug()),
            title: code.title().to_owned(),
            status: code.status(),
            detail: detail.into(),
            code,
            errors: Vec::new(),
            instance: None,
        }
    }

    /// The problem of a document whose fields have `errors`; its kind is that of the first of them.
    pub fn of_fields(errors: Vec<FieldError>) -> Self {
        let (code, detail) = match errors.as_slice() {
            [] => (Code::InternalError, String::new()),
            [only] => (only.code, only.detail.clone()),
            [first, ..] => (
                first.code,
                format!(
                    "{} fields are wrong; the first: {}",
                    errors.len(),
                    first.detail
                ),
            ),
        };
        Self {
            errors,
            ..Self::new(code, detail)
        }
    }

    /// The document as JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("a problem is strings and finite numbers")
    }
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.title, self.detail)
    }
}

impl std::error::Error for Problem {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slug_is_the_code_with_hyphens_and_every_code_is_explained() {
        for &code in Code::ALL {
            let name = serde_json::to_value(code).expect("a word");
            assert_eq!(name, code.word());
            assert_eq!(code.word().replace('_', "-"), code.slug());
            assert!((400..600).contains(&code.status()));
            assert!(code.explanation().len() > code.title().len());
        }
    }

    #[test]
    fn a_problem_survives_the_wire() {
        let error = FieldError::new("/a", Code::OutOfRange, "too far").nearest(115.56);
        let problem = Problem::of_fields(vec![error]);
        let json = problem.to_json();
        assert!(json.contains(r#""nearest":115.56"#), "{json}");
        assert_eq!(
            serde_json::from_str::<Problem>(&json).expect("reads back"),
            problem
        );
    }
}
