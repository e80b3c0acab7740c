//! What the teeth of a gear deviate from each other by, as measured.

use meshwright_engine::gear::{Eccentricity, ToothDeviations};
use serde::Serialize;

use super::tip::either;
use crate::wire::problem::{Code, FieldError};
use crate::wire::quantity::{self, Quantity};
use crate::wire::schema::{self, documented};
use crate::wire::tree::{ObjectReader, OptionalObject};
use crate::wire::units::{from_um, plain};

/// The most teeth that deviations are given for. How few are too few depends on the gear, which says so.
const MOST_TEETH: usize = quantity::TOOTH_COUNT.bounds.1 as usize;

/// How far the sum of all single pitch deviations may be from zero, in um.
const CLOSURE: f64 = 0.01;

/// What the teeth of a gear deviate by.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviationsDocument {
    #[serde(flatten)]
    pitch: Pitch,
    profile_slope_um: Option<Vec<f64>>,
    eccentricity: Option<EccentricityDocument>,
}

documented!(
    DeviationsDocument,
    "ToothDeviations",
    [EccentricityDocument],
    schema::object(
        "Tooth deviations",
        "What the teeth of a gear deviate from each other by. Positive is towards the mate, so that contact is earlier.",
        vec![
            schema::numbers(&quantity::PITCH_CUMULATIVE, (0, MOST_TEETH), false),
            schema::numbers(&quantity::PITCH_SINGLE, (0, MOST_TEETH), false),
            schema::numbers(&quantity::PROFILE_SLOPES, (0, MOST_TEETH), false),
            schema::optional_document::<EccentricityDocument>(
                "eccentricity",
                "Eccentricity",
                "The gear's own axis beside the axis of rotation. Default: none."
            ),
        ]
    )
);

/// The pitch, said in one of two ways or not at all.
#[derive(Debug, Clone, PartialEq)]
enum Pitch {
    Cumulative(Option<Vec<f64>>),
    Single(Vec<f64>),
}

impl Serialize for Pitch {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (cumulative, single) = match self {
            Self::Cumulative(values) => (values.as_ref(), None),
            Self::Single(values) => (None, Some(values)),
        };
        either(
            serializer,
            (quantity::PITCH_CUMULATIVE.name, cumulative),
            (quantity::PITCH_SINGLE.name, single),
        )
    }
}

/// The gear's own axis beside the axis of rotation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EccentricityDocument {
    amount_um: f64,
    phase_deg: f64,
}

documented!(
    EccentricityDocument,
    "Eccentricity",
    [],
    schema::object(
        "Eccentricity",
        "The gear's own axis beside the axis of rotation.",
        vec![
            schema::number(&quantity::ECCENTRICITY_AMOUNT),
            schema::number(&quantity::ECCENTRICITY_PHASE),
        ]
    )
);

impl EccentricityDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let amount_um = reader.number(&quantity::ECCENTRICITY_AMOUNT, None);
        let phase_deg = reader.number(&quantity::ECCENTRICITY_PHASE, None);
        reader.finish();
        Some(Self {
            amount_um: amount_um?,
            phase_deg: phase_deg?,
        })
    }
}

impl DeviationsDocument {
    pub(super) fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let (of_cumulative, of_single) = (&quantity::PITCH_CUMULATIVE, &quantity::PITCH_SINGLE);
        let conflict = reader.conflict(of_cumulative.name, of_single.name);
        let cumulative = reader.optional_numbers(of_cumulative, MOST_TEETH);
        let single = reader.optional_numbers(of_single, MOST_TEETH);
        let slopes = reader.optional_numbers(&quantity::PROFILE_SLOPES, MOST_TEETH);
        let eccentricity = match reader.optional_object("eccentricity") {
            OptionalObject::Absent => Some(None),
            OptionalObject::Wrong => None,
            OptionalObject::Present(object) => EccentricityDocument::read(object).map(Some),
        };
        reader.finish();
        let pitch = match single? {
            Some(single) => Pitch::Single(single),
            None => Pitch::Cumulative(cumulative?),
        };
        Some(Self {
            pitch,
            profile_slope_um: slopes?,
            eccentricity: eccentricity?,
        })
        .filter(|_| !conflict)
    }

    /// Its lists, each with what it is.
    fn lists(&self) -> impl Iterator<Item = (&'static Quantity, &[f64])> {
        let pitch: (_, Option<&[f64]>) = match &self.pitch {
            Pitch::Cumulative(values) => (&quantity::PITCH_CUMULATIVE, values.as_deref()),
            Pitch::Single(values) => (&quantity::PITCH_SINGLE, Some(values)),
        };
        let slopes = (&quantity::PROFILE_SLOPES, self.profile_slope_um.as_deref());
        [pitch, slopes]
            .into_iter()
            .filter_map(|(quantity, values)| Some((quantity, values?)))
    }

    /// What is wrong with it on a gear of so many teeth and of `module` mm, which has it at `pointer`.
    pub(super) fn faults(&self, pointer: &str, tooth_count: u32, module: f64) -> Vec<FieldError> {
        let wrong_length = self
            .lists()
            .filter(|(_, values)| values.len() != tooth_count as usize)
            .map(|(quantity, values)| {
                let pointer = format!("{pointer}/{}", quantity.name);
                let detail = format!(
                    "{pointer} has {} numbers; {tooth_count} are needed, one for each tooth.",
                    values.len()
                );
                FieldError::new(pointer, Code::WrongLength, detail).nearest(f64::from(tooth_count))
            });
        let faults: Vec<_> = wrong_length.collect();
        if !faults.is_empty() {
            return faults;
        }
        let large = self.too_large(pointer, module);
        large
            .into_iter()
            .chain(self.does_not_close(pointer))
            .collect()
    }

    /// What deviates by more than a quarter of a module: a search among neighboring flanks means nothing there.
    fn too_large(&self, pointer: &str, module: f64) -> Option<FieldError> {
        const LARGEST: f64 = 0.25;
        let most = 1e3 * LARGEST * module;
        let listed = self.lists().flat_map(|(quantity, values)| {
            let place = |i| format!("{}/{i}", quantity.name);
            let each = values.iter().enumerate();
            each.map(move |(i, value)| (place(i), *value))
        });
        let eccentricity = self.eccentricity.map(|eccentricity| {
            let place = format!("eccentricity/{}", quantity::ECCENTRICITY_AMOUNT.name);
            (place, eccentricity.amount_um)
        });
        let (place, value) = listed
            .chain(eccentricity)
            .find(|(_, value)| value.abs() > most)?;
        let pointer = format!("{pointer}/{place}");
        let detail = format!(
            "{pointer} is {} um, more than a quarter of a module; at most {} um.",
            plain(value),
            plain(most)
        );
        let error = FieldError::new(pointer, Code::OutOfRange, detail);
        Some(error.nearest(most.copysign(value)))
    }

    fn does_not_close(&self, pointer: &str) -> Option<FieldError> {
        let Pitch::Single(values) = &self.pitch else {
            return None;
        };
        let sum: f64 = values.iter().sum();
        // Rounding of a sum of hundreds of numbers is no gap.
        if sum.abs() <= CLOSURE * (1.0 + 1e-6) {
            return None;
        }
        let pointer = format!("{pointer}/{}", quantity::PITCH_SINGLE.name);
        let detail = format!(
            "{pointer} sums to {} um, and once around it has to be zero within {CLOSURE} um; {} um less in each of the {} closes it.",
            plain(sum),
            plain(sum / values.len() as f64),
            values.len()
        );
        Some(FieldError::new(pointer, Code::PitchDoesNotClose, detail))
    }

    /// What the engine is told.
    pub(super) fn data(&self) -> ToothDeviations {
        let meters = |values: &[f64]| values.iter().copied().map(from_um).collect();
        ToothDeviations {
            cumulative_pitch: match &self.pitch {
                Pitch::Cumulative(values) => meters(values.as_deref().unwrap_or_default()),
                Pitch::Single(values) => summed(values).into_iter().map(from_um).collect(),
            },
            profile_slope: meters(self.profile_slope_um.as_deref().unwrap_or_default()),
            eccentricity: self.eccentricity.map(|eccentricity| Eccentricity {
                amount: from_um(eccentricity.amount_um),
                direction: eccentricity.phase_deg.to_radians(),
            }),
        }
    }
}

/// The cumulative deviations of single ones, from the last tooth: that of tooth i is the sum of those up to it.
fn summed(single: &[f64]) -> Vec<f64> {
    let sums = single.iter().scan(0.0, |sum, deviation| {
        *sum += deviation;
        Some(*sum)
    });
    sums.collect()
}
