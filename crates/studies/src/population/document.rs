//! The document of a population.

use meshwright_wire::declare::{
    EACH, Number, Text, absent, document, list, nested, number, tagged, text, word, words,
};
use meshwright_wire::draw::{CAPABILITY, CLASS, INSPECTED, SEED};

use crate::sample::points::Sampling;

/// The most varied fields. With two numbers for each gear's eccentricity behind them they are fewer than the axes of the points.
const MOST_VARIED: usize = 100;

/// The most members.
const MOST_MEMBERS: f64 = crate::MOST_DESIGNS as f64;

/// A field of the submission.
const PATH: Text = text("Path", 300);

words! {
    Sampling {
        Sobol = "sobol":
            "Sobol' points in 16 independent scramblings, whose means and percentiles settle sooner",
        Random = "random": "independent of each other",
    }
}

words! {
    /// Where the tool stands in members whose tooth thickness varies.
    pub(crate) enum MembersDepth {
        AsDrawn = "as_drawn":
            "as in the drawn gear, that with the middle of each law: root and form circle stay, and the flanks vary",
        ByThickness = "by_thickness":
            "as the thickness of each member says: a hob that stands deeper or less deep",
    }
}

document! {
    /// The design as it is made: members that are drawn from laws, each computed by itself. The same seed gives the same members on every machine.
    pub(crate) struct PopulationDocument as "Population", "Population" {
        /// The number of members.
        pub(crate) size: u32 = number("Size", "1", 2.0, MOST_MEMBERS),
        /// Seed of the members' random numbers.
        pub(crate) seed: u32 = SEED,
        /// How the members are spread. Single teeth are random in either way.
        pub(crate) sampling: Sampling = word("Sampling").or(Sampling::Sobol),
        /// The fields that vary, independently of each other. Default: none.
        pub(crate) vary: Vec<VariedDocument> = list("Varied fields", EACH, MOST_VARIED).or_empty(),
        /// Where the tool that cuts the root stands in members whose tooth thickness varies.
        pub(crate) generating_profile_shift: MembersDepth =
            word("Generating profile shift").or(MembersDepth::AsDrawn),
        /// How accurately teeth are made.
        pub(crate) accuracy: Option<AccuracyDocument> =
            absent(nested("Accuracy"), "the teeth of the base"),
    }
}

document! {
    /// How accurately the teeth of both gears are made; of a gear that is not named they are those of the base.
    pub(crate) struct AccuracyDocument as "Accuracy", "Accuracy" {
        /// Of the driving gear.
        pub(crate) driving: Option<GearAccuracy> =
            absent(nested("Driving gear"), "the teeth of the base"),
        /// Of the driven gear.
        pub(crate) driven: Option<GearAccuracy> =
            absent(nested("Driven gear"), "the teeth of the base"),
    }
}

document! {
    /// How accurately the teeth of a gear are made: each member has its own, as POST /v1/draw-deviations draws them.
    pub(crate) struct GearAccuracy as "GearAccuracy", "Accuracy of a gear" {
        /// The accuracy class A of ISO 1328-1:2013.
        pub(crate) iso_1328_class: u32 = CLASS,
        /// How many times three standard deviations of a deviation fit into its tolerance.
        pub(crate) capability: f64 = CAPABILITY,
        /// Draws the gears again that an inspector would reject: those beyond f_pT, beyond F_pT measured from the bore, beyond F_rT or beyond the tolerances of
        /// slopes.
        pub(crate) inspected: bool = INSPECTED,
    }
}

tagged! {
    /// A field and its law. Values of fields of whole numbers are rounded.
    pub(crate) enum VariedDocument as "VariedField", "Varied field" {
        /// The normal law; values below `low` or above `high` do not occur.
        Normal(NormalDocument) = "normal" as "NormalLaw", "Normal law",
        /// Every value between two as likely.
        Uniform(UniformDocument) = "uniform" as "UniformLaw", "Uniform law",
        /// Rising to a likeliest value and falling from it, linearly.
        Triangular(TriangularDocument) = "triangular" as "TriangularLaw", "Triangular law",
    }
}

document! {
    /// The normal law, cut off.
    pub(crate) struct NormalDocument as "NormalLawFields", "Normal law" {
        /// A JSON pointer to a number of the submission, such as /pair/center_distance_mm.
        pub(crate) path: String = PATH,
        /// The mean, in the unit of the field, before the law is cut off.
        pub(crate) mean: f64 = value("Mean"),
        /// The standard deviation, in the unit of the field, before the law is cut off.
        pub(crate) standard_deviation: f64 = number("Standard deviation", "", 1e-12, 1e9),
        /// The smallest value that is made; not above the mean.
        pub(crate) low: Option<f64> = absent(value("Smallest value"), "no limit"),
        /// The largest value that is made; not below the mean.
        pub(crate) high: Option<f64> = absent(value("Largest value"), "no limit"),
    }
}

document! {
    /// The uniform law.
    pub(crate) struct UniformDocument as "UniformLawFields", "Uniform law" {
        /// A JSON pointer to a number of the submission.
        pub(crate) path: String = PATH,
        /// The smallest value.
        pub(crate) low: f64 = value("Smallest value"),
        /// The largest value.
        pub(crate) high: f64 = value("Largest value"),
    }
}

document! {
    /// The triangular law.
    pub(crate) struct TriangularDocument as "TriangularLawFields", "Triangular law" {
        /// A JSON pointer to a number of the submission.
        pub(crate) path: String = PATH,
        /// The smallest value.
        pub(crate) low: f64 = value("Smallest value"),
        /// The likeliest value.
        pub(crate) mode: f64 = value("Likeliest value"),
        /// The largest value.
        pub(crate) high: f64 = value("Largest value"),
    }
}

/// A value of some field, in its unit.
const fn value(title: &'static str) -> Number {
    number(title, "", -1e9, 1e9)
}
