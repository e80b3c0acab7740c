//! The document of a submission.

use meshwright_engine::analysis::Method;

use crate::declare::{
    List, Number, Text, absent, document, flag, list, nested, number, text, word, words,
};
use crate::forces::{DynamicsQuestion, ForceTableQuestion};
use crate::modes::ModesQuestion;
use crate::pair::PairDocument;
use crate::problem::Code;
use crate::resolution::ResolutionDocument;
use crate::running::RunningDocument;

/// The most output torques of one submission.
pub const MOST_TORQUES: usize = 60;

/// The most tags of a job or a study, and the most characters of one.
pub(crate) const MOST_TAGS: (usize, usize) = (16, 64);

/// Use of a submission, which decides its limits of size.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Purpose {
    /// A job, which is queued.
    Job,
    /// A preview, for which a request waits.
    Preview {
        /// The most positions times torques.
        most_positions: u64,
    },
}

words! {
    /// The rows in which the load along the face is told.
    pub(crate) enum FaceRows {
        Mean = "mean": "the mean over the positions",
        Positions = "positions": "every position",
    }
}

document! {
    /// A request: a gear pair, torques, and the way to compute. Unknown fields are refused.
    pub(crate) struct SubmissionDocument as "Submission", "Submission" {
        /// How the curves are computed.
        pub(super) method: Method = word("Method"),
        /// The gears.
        pub(super) pair: PairDocument = nested(""),
        /// The torques T on the driven gear, each of which gives a curve; 0 is the limit of light load, the kinematic error of the flanks.
        /// The load on the line of action is T over the driven base radius; one that would deflect the teeth by more than about a quarter
        /// of a module is refused.
        pub(super) output_torques_n_m: Vec<f64> =
            list("Output torques", OUTPUT_TORQUE, MOST_TORQUES)
                .of("torques in N m", "torques", "fit in one submission")
                .not_empty(Code::OutOfRange, "give a torque")
                .unique("repeats a torque; each gives one curve"),
        /// The speed that turns orders into frequencies. It changes nothing else: what speed does to the gears is asked for by `running`.
        pub(super) driving_speed_rpm: Option<f64> = absent(
            number("Speed of the driving gear", "1/min", 1e-3, 1e6),
            "no frequencies beside the orders",
        ),
        /// How the pair runs: its speed, temperatures and press fits, and what they do to flanks and stresses.
        pub(super) running: Option<RunningDocument> =
            absent(nested("Running"), "at rest, as drawn"),
        /// Also computes the largest von Mises stress at the tensile root fillets and at the edges of the holes, position by position, and its place. The
        /// methods `flexible` and `three_dimensional` compute it; with another one it is refused.
        pub(super) stress: bool = flag("Stress", false),
        /// The rows in which three dimensions tell the load along the face.
        pub(super) face_load: FaceRows = word("Load along the face").or(FaceRows::Mean),
        /// Adds a table of the force between the gears over mesh position and approach to the results, for run-ups and other programs. It is computed over the
        /// true period, and its positions times its loads count as positions of the submission.
        pub(super) force_table: Option<ForceTableQuestion> =
            absent(nested("ForceTableRequest"), "no table"),
        /// Adds the motion of the gears over speed to each curve: run up and down, with resonances, contact loss and jumps. It needs a force table; the default
        /// one is computed if none is requested.
        pub(super) dynamics: Option<DynamicsQuestion> =
            absent(nested("DynamicsRequest"), "no run-up"),
        /// Whether results have the natural modes of both gears, and where the mesh meets them as they turn. The curves do not change.
        pub(super) modes: Option<ModesQuestion> = absent(nested("ModesRequest"), "no modes"),
        /// How finely and by which rules.
        pub(super) resolution: ResolutionDocument = nested("Resolution").or_defaults(),
        /// Short strings to find the job by. They do not change the result.
        pub(super) tags: Vec<String> = TAGS,
    }
}

/// A torque on the driven gear.
pub(crate) const OUTPUT_TORQUE: Number = number("Output torque", "N m", 1e-6, 1e8)
    .or_zero()
    .negative_is(Code::TorqueNotPositive);

/// Short strings to find jobs and studies by.
pub const TAGS: List<Text> = list("Tags", text("Tag", MOST_TAGS.1), MOST_TAGS.0)
    .of("short strings", "tags", "are kept")
    .too_many_is(Code::OutOfRange)
    .or_empty();
