//! How large a study may be, found before anything of it is kept or expanded.

use meshwright_wire::problem::{Code, FieldError, Problem};
use meshwright_wire::size::{MOST_VALUES, Values, refuse_many_values};
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::MOST_DESIGNS;

/// The most values of the whole document: a hundred thousand designs with seven changes each.
const MOST_VALUES_OF_ALL: u64 = 1_000_000;

/// The most values that are looked at when each design is checked against the base: a hundred thousand designs of a base with
/// two hundred, which no usual one has, or fewer of a larger one.
const MOST_WORK: u64 = 20_000_000;

/// Refuses a document with too many designs or values, or too much work. It keeps none, so that ten million of them cost no
/// memory, and a bomb costs no more than to read it once.
pub(super) fn refuse_too_many(document: &[u8]) -> Result<(), Problem> {
    // Ignored values have no size, and a list of them takes no memory.
    #[derive(Deserialize)]
    struct Counted {
        #[serde(default)]
        base: Values,
        #[serde(default)]
        axes: Vec<CountedAxis>,
        #[serde(default)]
        designs: Vec<IgnoredAny>,
    }
    #[derive(Deserialize)]
    struct CountedAxis {
        #[serde(default)]
        values: Vec<IgnoredAny>,
    }

    impl Counted {
        /// Fault of a base that is too large for its designs.
        fn work(&self) -> Option<FieldError> {
            let lengths = || self.axes.iter().map(|axis| axis.values.len());
            let combined = lengths().fold(1, |total: usize, values| {
                total.saturating_mul(values.max(1))
            });
            let variants = lengths()
                .sum::<usize>()
                .max(self.designs.len())
                .max(combined);
            // Too many combinations are refused with their number, when the axes are read.
            let variants = if combined > MOST_DESIGNS { 1 } else { variants };
            too_much_work(self.base.0, variants as u64)
        }
    }

    // A document of another form is refused later, with its place.
    if let Ok(counted) = serde_json::from_slice::<Counted>(document) {
        let long = counted
            .axes
            .iter()
            .position(|axis| axis.values.len() > MOST_DESIGNS);
        let error = match long {
            Some(i) => Some(too_many(
                counted.axes.iter().fold(1, |total: u128, axis| {
                    total.saturating_mul(axis.values.len().max(1) as u128)
                }),
                &format!("/axes/{i}/values"),
            )),
            None if counted.designs.len() > MOST_DESIGNS => {
                Some(too_many(counted.designs.len() as u128, "/designs"))
            }
            None => counted.work(),
        };
        if let Some(error) = error {
            return Err(Problem::of_fields(vec![error]));
        }
    }
    refuse_many_values(document, MOST_VALUES_OF_ALL)
}

/// That so many designs are too many.
pub(super) fn too_many(total: u128, pointer: &str) -> FieldError {
    let detail = format!(
        "The study has {total} designs; at most {MOST_DESIGNS} are taken. Nothing was expanded."
    );
    FieldError::new(pointer, Code::TooLarge, detail).nearest(MOST_DESIGNS as f64)
}

/// That a base of so many values is no submission for its size alone, or that its check in every variant would take seconds.
fn too_much_work(values: u64, variants: u64) -> Option<FieldError> {
    if values > MOST_VALUES {
        let detail = format!(
            "/base has {values} values; a submission has at most {MOST_VALUES}. Nothing was expanded."
        );
        let error = FieldError::new("/base", Code::TooLarge, detail);
        return Some(error.nearest(MOST_VALUES as f64));
    }
    let fitting = MOST_WORK / values.max(1);
    (variants > fitting).then(|| {
        let detail = format!(
            "/base has {values} values, which {variants} variants would repeat; with a base of this size at most {fitting} are taken. Nothing was expanded."
        );
        FieldError::new("/base", Code::TooLarge, detail).nearest(fitting as f64)
    })
}
