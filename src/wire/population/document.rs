//! The document of a population, and what is wrong with one.

use meshwright_engine::gear::Member;
use meshwright_sample::law::Law;
use meshwright_sample::points::{Points, Sampling};

use super::{GEARS, Population, Varied};
use crate::wire::declare::{
    Choice as _, Errors, Kind as _, Nested, Node, Number, Place, Text, absent, document, list,
    nested, number, tagged, text, word, words,
};
use crate::wire::draw::{CAPABILITY, CLASS, SEED};
use crate::wire::pointer::{NumberKind, Pointer};
use crate::wire::problem::Code;
use crate::wire::units::plain;

/// The most varied fields. With two numbers for each gear's eccentricity behind them they are fewer than the axes of the points.
const MOST_VARIED: usize = 100;

/// The most members.
const MOST_MEMBERS: f64 = crate::wire::study::MOST_DESIGNS as f64;

/// A field of the submission.
const PATH: Text = text("Path", 300);

words! {
    Sampling {
        Sobol = "sobol": "Sobol' points in 16 independent scramblings, whose means and percentiles settle sooner",
        Random = "random": "independent of each other",
    }
}

document! {
    /// The design as it is made: members that are drawn from laws, each computed by itself. The same seed gives the same members on every machine.
    pub(in crate::wire) struct PopulationDocument as "Population", "Population" {
        /// The number of members.
        size: u32 = number("Size", "1", 2.0, MOST_MEMBERS),
        /// What the members are drawn from.
        seed: u32 = SEED,
        /// How the members are spread. Single teeth are random in either way.
        sampling: Sampling = word("Sampling").or(Sampling::Sobol),
        /// The fields that vary, independently of each other. Default: none.
        vary: Vec<VariedDocument> = list("Varied fields", EACH, MOST_VARIED).or_empty(),
        /// How accurately teeth are made.
        accuracy: Option<AccuracyDocument> = absent(nested("Accuracy"), "the teeth of the base"),
    }
}

document! {
    /// How accurately the teeth of both gears are made; of a gear that is not named they are those of the base.
    pub(in crate::wire) struct AccuracyDocument as "Accuracy", "Accuracy" {
        /// Of the driving gear.
        driving: Option<GearAccuracy> = absent(nested("Driving gear"), "the teeth of the base"),
        /// Of the driven gear.
        driven: Option<GearAccuracy> = absent(nested("Driven gear"), "the teeth of the base"),
    }
}

document! {
    /// How accurately the teeth of a gear are made: each member has its own, as POST /v1/draw-deviations draws them.
    pub(in crate::wire) struct GearAccuracy as "GearAccuracy", "Accuracy of a gear" {
        /// The accuracy class A of ISO 1328-1:2013.
        pub(super) iso_1328_class: u32 = CLASS,
        /// How many times three standard deviations of a deviation fit into its tolerance.
        pub(super) capability: f64 = CAPABILITY,
    }
}

tagged! {
    /// A field and the law that it follows. What is drawn for a field of whole numbers is rounded.
    pub(in crate::wire) enum VariedDocument as "VariedField", "Varied field" {
        /// The normal law; what lies below `low` or above `high` is not made.
        Normal(NormalDocument) = "normal" as "NormalLaw", "Normal law",
        /// Every value between two as likely.
        Uniform(UniformDocument) = "uniform" as "UniformLaw", "Uniform law",
        /// Rising to a likeliest value and falling from it, linearly.
        Triangular(TriangularDocument) = "triangular" as "TriangularLaw", "Triangular law",
    }
}

document! {
    /// The normal law, cut off.
    pub(in crate::wire) struct NormalDocument as "NormalLawFields", "Normal law" {
        /// A JSON pointer to a number of the submission, such as /pair/center_distance_mm.
        path: String = PATH,
        /// The mean, in the unit of the field, before the law is cut off.
        mean: f64 = value("Mean"),
        /// The standard deviation, in the unit of the field, before the law is cut off.
        standard_deviation: f64 = number("Standard deviation", "", 1e-12, 1e9),
        /// The smallest value that is made; not above the mean.
        low: Option<f64> = absent(value("Smallest value"), "no limit"),
        /// The largest value that is made; not below the mean.
        high: Option<f64> = absent(value("Largest value"), "no limit"),
    }
}

document! {
    /// The uniform law.
    pub(in crate::wire) struct UniformDocument as "UniformLawFields", "Uniform law" {
        /// A JSON pointer to a number of the submission.
        path: String = PATH,
        /// The smallest value.
        low: f64 = value("Smallest value"),
        /// The largest value.
        high: f64 = value("Largest value"),
    }
}

document! {
    /// The triangular law.
    pub(in crate::wire) struct TriangularDocument as "TriangularLawFields", "Triangular law" {
        /// A JSON pointer to a number of the submission.
        path: String = PATH,
        /// The smallest value.
        low: f64 = value("Smallest value"),
        /// The likeliest value.
        mode: f64 = value("Likeliest value"),
        /// The largest value.
        high: f64 = value("Largest value"),
    }
}

const EACH: Nested = nested("");

/// A value of some field, in its unit.
const fn value(title: &'static str) -> Number {
    number(title, "", -1e9, 1e9)
}

impl Population {
    /// Reads the population that stands at `place` over `base`. What is wrong is reported there.
    pub(in crate::wire) fn read(
        node: &Node,
        base: Option<&Node>,
        place: &Place<'_>,
        errors: &Errors,
    ) -> Option<Self> {
        PopulationDocument::read(node, place, &EACH)?.made(base, place, errors)
    }
}

impl PopulationDocument {
    /// The population, if its laws can be drawn from.
    pub(in crate::wire) fn made(
        self,
        base: Option<&Node>,
        place: &Place<'_>,
        errors: &Errors,
    ) -> Option<Population> {
        let before = errors.count();
        let accuracy = match self.accuracy {
            Some(AccuracyDocument { driving, driven }) => [driving, driven],
            None => [None, None],
        };
        if self.vary.is_empty() && accuracy.iter().all(Option::is_none) {
            let place = place.of("vary");
            let detail = format!(
                "Nothing differs between the members: name a field in {place}, or the accuracy of a gear."
            );
            return place.wrong(Code::MissingField, detail, None);
        }
        for gear in GEARS {
            let deviations = ["pair", gear.word(), "tooth_deviations"];
            let stand = base.and_then(|base| base.at(&deviations));
            if accuracy[gear as usize].is_some() && stand.is_some_and(|node| *node != Node::Null) {
                let place = place.of("accuracy").of(gear.word());
                let detail = format!(
                    "{place} draws teeth, and the base has teeth of its own in /{}; leave out one of the two.",
                    deviations.join("/")
                );
                place.wrong::<()>(Code::ConflictingFields, detail, None);
            }
        }
        let mut varied: Vec<Varied> = Vec::new();
        for (i, document) in self.vary.iter().enumerate() {
            let place = place.of("vary").of(&i.to_string());
            let Some(one) = document.made(&place) else {
                continue;
            };
            let path = &one.path;
            let drawn = GEARS.into_iter().find(|gear| {
                let deviations = ["pair", gear.word(), "tooth_deviations"];
                accuracy[*gear as usize].is_some() && path.starts_with(&deviations)
            });
            let place = place.of("path");
            if let Some(gear) = drawn {
                let detail = format!(
                    "{} lies in the teeth of the {gear} gear, which accuracy draws.",
                    path.text()
                );
                place.wrong::<()>(Code::ConflictingFields, detail, None);
            }
            if let Some(j) = varied.iter().position(|earlier| earlier.path == *path) {
                let detail = format!("{} has a law already, that of item {j}.", path.text());
                place.wrong::<()>(Code::OutOfRange, detail, None);
            }
            varied.push(one);
        }
        (errors.count() == before).then_some(Population {
            size: self.size,
            points: Points {
                sampling: self.sampling,
                seed: self.seed,
            },
            varied,
            accuracy,
        })
    }
}

impl VariedDocument {
    fn path(&self) -> &str {
        match self {
            Self::Normal(law) => &law.path,
            Self::Uniform(law) => &law.path,
            Self::Triangular(law) => &law.path,
        }
    }

    fn made(&self, place: &Place<'_>) -> Option<Varied> {
        let law = self.law(place);
        let (path, whole) = number_at(self.path(), &place.of("path"))?;
        Some(Varied {
            path,
            law: law?,
            whole,
        })
    }

    /// The law, if its numbers go together.
    fn law(&self, place: &Place<'_>) -> Option<Law> {
        let rises = |low: f64, high: f64| {
            if low < high {
                return Some(());
            }
            let place = place.of("high");
            let detail = format!(
                "{place} is {}, not above low, which is {}.",
                plain(high),
                plain(low)
            );
            place.wrong(Code::OutOfRange, detail, None)
        };
        let holds = |name: &str, value: f64, low: f64, high: f64| {
            if low <= value && value <= high {
                return Some(());
            }
            let place = place.of(name);
            let detail = format!(
                "{place} is {}; it has to lie from low, {}, to high, {}.",
                plain(value),
                plain(low),
                plain(high)
            );
            place.wrong(Code::OutOfRange, detail, Some(value.clamp(low, high)))
        };
        match self {
            Self::Normal(law) => {
                let low = law.low.unwrap_or(f64::NEG_INFINITY);
                let high = law.high.unwrap_or(f64::INFINITY);
                rises(low, high)?;
                holds("mean", law.mean, low, high)?;
                Some(Law::Normal {
                    mean: law.mean,
                    standard_deviation: law.standard_deviation,
                    low,
                    high,
                })
            }
            Self::Uniform(law) => {
                rises(law.low, law.high)?;
                let (low, high) = (law.low, law.high);
                Some(Law::Uniform { low, high })
            }
            Self::Triangular(law) => {
                rises(law.low, law.high)?;
                holds("mode", law.mode, law.low, law.high)?;
                let (low, mode, high) = (law.low, law.mode, law.high);
                Some(Law::Triangular { low, mode, high })
            }
        }
    }
}

/// The field of a submission that `path` names, if it takes a number, and whether that is a whole one.
fn number_at(path: &str, place: &Place<'_>) -> Option<(Pointer, bool)> {
    let named = Pointer::parse(path).and_then(|pointer| {
        let kind = pointer.number_kind()?;
        Ok((pointer, kind == NumberKind::Whole))
    });
    match named {
        Ok(named) => Some(named),
        Err((code, detail)) => place.wrong(code, detail, None),
    }
}

/// The gear's number among two.
const _: () = assert!(Member::Driving as usize == 0 && Member::Driven as usize == 1);
