//! From the document of a population to its laws and their faults.

use meshwright_wire::declare::{Choice as _, EACH, Errors, Kind as _, Location, Node};
use meshwright_wire::pointer::{NumberKind, Pointer};
use meshwright_wire::problem::Code;
use meshwright_wire::units::plain;

use super::document::{AccuracyDocument, PopulationDocument, VariedDocument};
use super::{GEARS, Population, Varied};
use crate::sample::law::Law;
use crate::sample::points::Points;

impl Population {
    /// Reads the population at `place` over `base`. Faults are reported there.
    pub(crate) fn read(
        node: &Node,
        base: Option<&Node>,
        place: &Location<'_>,
        errors: &Errors,
    ) -> Option<Self> {
        PopulationDocument::read(node, place, &EACH)?.made(base, place, errors)
    }
}

impl PopulationDocument {
    /// The population, if its laws can be drawn from.
    pub(crate) fn made(
        self,
        base: Option<&Node>,
        place: &Location<'_>,
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
            generating_profile_shift: self.generating_profile_shift,
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

    fn made(&self, place: &Location<'_>) -> Option<Varied> {
        let law = self.law(place);
        let (path, whole) = number_at(self.path(), &place.of("path"), Pointer::number_kind)?;
        Some(Varied {
            path,
            law: law?,
            whole,
        })
    }

    /// The law, if its numbers go together.
    fn law(&self, place: &Location<'_>) -> Option<Law> {
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
                rises(place, low, high)?;
                holds("mean", law.mean, low, high)?;
                Some(Law::Normal {
                    mean: law.mean,
                    standard_deviation: law.standard_deviation,
                    low,
                    high,
                })
            }
            Self::Uniform(law) => {
                rises(place, law.low, law.high)?;
                let (low, high) = (law.low, law.high);
                Some(Law::Uniform { low, high })
            }
            Self::Triangular(law) => {
                rises(place, law.low, law.high)?;
                holds("mode", law.mode, law.low, law.high)?;
                let (low, mode, high) = (law.low, law.mode, law.high);
                Some(Law::Triangular { low, mode, high })
            }
        }
    }
}

/// Refuses a `high` that stands beside `low` at `place` and is not above it.
pub(crate) fn rises(place: &Location<'_>, low: f64, high: f64) -> Option<()> {
    if low < high {
        return Some(());
    }
    let place = place.of("high");
    let (low, high) = (plain(low), plain(high));
    let detail = format!("{place} is {high}, not above low, which is {low}.");
    place.wrong(Code::OutOfRange, detail, None)
}

/// The field that `path` names, if it takes a number, of which `kind` tells the kind; and whether that is a whole one.
pub(crate) fn number_at(
    path: &str,
    place: &Location<'_>,
    kind: impl FnOnce(&Pointer) -> Result<NumberKind, (Code, String)>,
) -> Option<(Pointer, bool)> {
    let named = Pointer::parse(path).and_then(|pointer| {
        let kind = kind(&pointer)?;
        Ok((pointer, kind == NumberKind::Whole))
    });
    match named {
        Ok(named) => Some(named),
        Err((code, detail)) => place.wrong(code, detail, None),
    }
}
