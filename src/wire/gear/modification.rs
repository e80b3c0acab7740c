//! Profile modifications: what is taken off the flanks beside the tip relief; several add up.

use meshwright_engine::gear::{ModificationData, TablePlaces};
use serde::Serialize;
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{Schema, SchemaType, Type};

use super::relief::{ReliefDocument, ReliefEnd, RootStart};
use super::tip::either;
use crate::wire::problem::{Code, FieldError};
use crate::wire::quantity::{self, MOST_MODIFICATIONS, MOST_TABLE_ENTRIES, Quantity};
use crate::wire::schema::{self, Property, documented};
use crate::wire::tree::{Choice, ObjectReader};
use crate::wire::units::{Side, from_mm, from_um, plain, rounded_inward};

/// One modification of the loaded flanks.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ModificationDocument {
    /// A relief that grows towards the tip circle.
    TipRelief(ReliefDocument),
    /// A relief that grows towards the form circle.
    RootRelief(ReliefDocument),
    /// A parabola in the roll length, nothing midway.
    Crowning {
        /// What is taken off at both ends.
        amount_um: f64,
    },
    /// In proportion to the roll length, nothing at the form circle.
    Slope {
        /// What is taken off at the tip circle.
        amount_um: f64,
    },
    /// As measured or computed elsewhere.
    Table(TableDocument),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    TipRelief,
    RootRelief,
    Crowning,
    Slope,
    Table,
}

impl Choice for Kind {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        (
            "tip_relief",
            Self::TipRelief,
            "grows from its start towards the tip circle",
        ),
        (
            "root_relief",
            Self::RootRelief,
            "grows from its start towards the form circle",
        ),
        (
            "crowning",
            Self::Crowning,
            "a parabola in the roll length, nothing midway between form circle and tip circle",
        ),
        (
            "slope",
            Self::Slope,
            "linear in the roll length, nothing at the form circle",
        ),
        (
            "table",
            Self::Table,
            "linear between entries, the first and the last held beyond them",
        ),
    ];
}

documented!(
    ModificationDocument,
    "ProfileModification",
    [
        TipReliefKind,
        RootReliefKind,
        CrowningKind,
        SlopeKind,
        TableKind
    ],
    schema::one_of(
        "Profile modification",
        "What is taken off every loaded flank, normal to it. Taken off is positive.",
        None,
        vec![
            schema::reference::<TipReliefKind>(),
            schema::reference::<RootReliefKind>(),
            schema::reference::<CrowningKind>(),
            schema::reference::<SlopeKind>(),
            schema::reference::<TableKind>(),
        ]
    )
);

/// Names each kind of modification in the contract, so that generators of clients need not.
macro_rules! kinds {
    ($($name:ident $word:literal $kind:ident [$($part:ty),*])*) => {$(
        enum $name {}

        documented!($name, $word, [$($part),*], Kind::$kind.schema());
    )*};
}

kinds! {
    TipReliefKind "TipReliefModification" TipRelief []
    RootReliefKind "RootReliefModification" RootRelief [RootStart]
    CrowningKind "CrowningModification" Crowning []
    SlopeKind "SlopeModification" Slope []
    TableKind "TableModification" Table []
}

impl Kind {
    /// An object of this kind.
    fn schema(self) -> RefOr<Schema> {
        let meaning = Self::OPTIONS
            .iter()
            .find(|(_, kind, _)| *kind == self)
            .map_or("", |(.., meaning)| meaning);
        let kind = schema::word("Kind", "What the modification is.", self.word());
        let properties = [("kind", kind, true)].into_iter().chain(self.properties());
        // Generators of clients name types by their titles, and a tip relief stands in the contract by itself.
        let title = format!("{} modification", self.word().replace('_', " "));
        schema::object(&title, &format!("{meaning}."), properties.collect())
    }
}

impl Kind {
    /// What the schema says of the fields beside the kind.
    fn properties(self) -> Vec<Property> {
        match self {
            Self::TipRelief => ReliefDocument::properties(ReliefEnd::Tip),
            Self::RootRelief => ReliefDocument::properties(ReliefEnd::Form),
            Self::Crowning => vec![schema::number(&quantity::CROWNING_AMOUNT)],
            Self::Slope => vec![schema::number(&quantity::SLOPE_AMOUNT)],
            Self::Table => {
                // Too few are told with the number that is needed.
                let lengths = (0, MOST_TABLE_ENTRIES);
                vec![
                    schema::numbers(&quantity::TABLE_ROLL_LENGTH, lengths, false),
                    schema::numbers(&quantity::TABLE_DIAMETER, lengths, false),
                    schema::numbers(&quantity::TABLE_REMOVED, lengths, true),
                ]
            }
        }
    }
}

/// The schema of the list of a gear.
pub(super) fn list_property() -> Property {
    let list = schema::list(
        "Profile modifications",
        "What is taken off the loaded flanks beside the tip relief; they add up. Default: none.",
        schema::reference::<ModificationDocument>(),
        (0, MOST_MODIFICATIONS),
    );
    // Null is as good as absent.
    let list = list.schema_type(SchemaType::from_iter([Type::Array, Type::Null]));
    (
        "profile_modifications",
        list.default(Some(serde_json::json!([]))).into(),
        false,
    )
}

/// Reads the list of a gear.
pub(super) fn read_list(reader: &mut ObjectReader<'_>) -> Option<Vec<ModificationDocument>> {
    let items = reader.objects("profile_modifications", MOST_MODIFICATIONS)?;
    // All of them are read, so that all that is wrong is told.
    let read: Vec<_> = items.into_iter().map(ModificationDocument::read).collect();
    read.into_iter().collect()
}

impl ModificationDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let read = match reader.choice::<Kind>("kind", None)? {
            Kind::TipRelief => {
                ReliefDocument::read_fields(&mut reader, ReliefEnd::Tip).map(Self::TipRelief)
            }
            Kind::RootRelief => {
                ReliefDocument::read_fields(&mut reader, ReliefEnd::Form).map(Self::RootRelief)
            }
            Kind::Crowning => reader
                .number(&quantity::CROWNING_AMOUNT, None)
                .map(|amount_um| Self::Crowning { amount_um }),
            Kind::Slope => reader
                .number(&quantity::SLOPE_AMOUNT, None)
                .map(|amount_um| Self::Slope { amount_um }),
            Kind::Table => TableDocument::read(&mut reader).map(Self::Table),
        };
        reader.finish();
        read
    }

    /// The relief that it is, if it is one.
    pub(super) fn relief(&self) -> Option<&ReliefDocument> {
        match self {
            Self::TipRelief(relief) | Self::RootRelief(relief) => Some(relief),
            _ => None,
        }
    }

    pub(super) fn relief_mut(&mut self) -> Option<&mut ReliefDocument> {
        match self {
            Self::TipRelief(relief) | Self::RootRelief(relief) => Some(relief),
            _ => None,
        }
    }

    /// The table that it is, if it is one.
    pub(super) fn table(&self) -> Option<&TableDocument> {
        match self {
            Self::Table(table) => Some(table),
            _ => None,
        }
    }

    /// Takes nothing off, if it is a table.
    pub(super) fn empty_table(&mut self) {
        if self.table().is_some() {
            *self = Self::Slope { amount_um: 0.0 };
        }
    }

    /// What the engine is told.
    pub(super) fn data(&self) -> ModificationData {
        match self {
            Self::TipRelief(relief) | Self::RootRelief(relief) => relief.data(),
            Self::Crowning { amount_um } => ModificationData::Crowning {
                amount: from_um(*amount_um),
            },
            Self::Slope { amount_um } => ModificationData::Slope {
                amount: from_um(*amount_um),
            },
            Self::Table(table) => table.data(),
        }
    }
}

/// The fewest entries of a table.
const LEAST_ENTRIES: usize = 2;

/// The least step from entry to entry of a table, in modules: a shorter one is a step in the flank.
const LEAST_STEP: f64 = 1e-4;

/// What is taken off, place by place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TableDocument {
    #[serde(flatten)]
    places: Places,
    removed_um: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq)]
enum Places {
    RollLengths(Vec<f64>),
    Diameters(Vec<f64>),
}

impl Places {
    fn values(&self) -> &[f64] {
        match self {
            Self::RollLengths(values) | Self::Diameters(values) => values,
        }
    }

    fn quantity(&self) -> &'static Quantity {
        match self {
            Self::RollLengths(_) => &quantity::TABLE_ROLL_LENGTH,
            Self::Diameters(_) => &quantity::TABLE_DIAMETER,
        }
    }
}

impl Serialize for Places {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let (lengths, diameters) = match self {
            Self::RollLengths(values) => (Some(values), None),
            Self::Diameters(values) => (None, Some(values)),
        };
        either(
            serializer,
            (quantity::TABLE_ROLL_LENGTH.name, lengths),
            (quantity::TABLE_DIAMETER.name, diameters),
        )
    }
}

impl TableDocument {
    fn read(reader: &mut ObjectReader<'_>) -> Option<Self> {
        let (lengths, diameters) = (&quantity::TABLE_ROLL_LENGTH, &quantity::TABLE_DIAMETER);
        reader.conflict(lengths.name, diameters.name);
        let names = [lengths.name, diameters.name];
        let roll_lengths = reader.optional_numbers(lengths, MOST_TABLE_ENTRIES);
        let diameters = reader.optional_numbers(diameters, MOST_TABLE_ENTRIES);
        let removed = reader.needed_numbers(&quantity::TABLE_REMOVED, MOST_TABLE_ENTRIES);
        let places = match (roll_lengths?, diameters?) {
            (Some(values), None) => Places::RollLengths(values),
            (None, Some(values)) => Places::Diameters(values),
            (Some(_), Some(_)) => return None,
            (None, None) => {
                reader.missing_one_of(&names);
                return None;
            }
        };
        Some(Self {
            places,
            removed_um: removed?,
        })
    }

    /// What is wrong with it on a gear of `module` over the base circle, both in mm, as the list at `pointer` has it.
    pub(super) fn faults(&self, pointer: &str, module: f64, base_radius: f64) -> Vec<FieldError> {
        let length = self.length_fault(pointer);
        let places = self.place_faults(pointer, LEAST_STEP * module, base_radius);
        length.into_iter().chain(places).collect()
    }

    fn length_fault(&self, pointer: &str) -> Option<FieldError> {
        let (name, places) = (self.places.quantity().name, self.places.values().len());
        let (at, given, needed) = if places < LEAST_ENTRIES {
            (name, places, LEAST_ENTRIES)
        } else if self.removed_um.len() != places {
            (quantity::TABLE_REMOVED.name, self.removed_um.len(), places)
        } else {
            return None;
        };
        let each = if at == name {
            "a table has at least so many"
        } else {
            "one for each place"
        };
        let pointer = format!("{pointer}/{at}");
        let detail = format!("{pointer} has {given} numbers; {needed} are needed, {each}.");
        Some(FieldError::new(pointer, Code::WrongLength, detail).nearest(needed as f64))
    }

    /// The first diameter that is below the base circle, where there is no flank that it could name, and each entry that does not
    /// stand beyond the one before it; each with a value such that all of them together make a table.
    fn place_faults(&self, pointer: &str, step: f64, base_radius: f64) -> Vec<FieldError> {
        const ROUNDING: f64 = 1e-9;
        let name = self.places.quantity().name;
        let mut faults = Vec::new();
        let mut floor = match &self.places {
            Places::RollLengths(_) => 0.0,
            Places::Diameters(_) => 2.0 * base_radius,
        };
        for (i, &value) in self.places.values().iter().enumerate() {
            if value >= floor * (1.0 - ROUNDING) {
                floor = value + step;
                continue;
            }
            let nearest = rounded_inward(floor, Side::AtLeast, 0);
            let pointer = format!("{pointer}/{name}/{i}");
            let (code, what) = if i == 0 {
                (
                    Code::OutOfRange,
                    "below the base circle, where there is no flank",
                )
            } else {
                (
                    Code::TableDoesNotRise,
                    "not beyond the entry before it by 0.0001 modules",
                )
            };
            let detail = format!(
                "{pointer} is {} mm, {what}; at least {} mm.",
                plain(value),
                plain(nearest)
            );
            faults.push(FieldError::new(pointer, code, detail).nearest(nearest));
            floor = nearest + step;
        }
        faults
    }

    fn data(&self) -> ModificationData {
        let meters: fn(&Vec<f64>) -> Vec<f64> =
            |values| values.iter().copied().map(from_mm).collect();
        ModificationData::Table {
            places: match &self.places {
                Places::RollLengths(values) => TablePlaces::RollLengths(meters(values)),
                Places::Diameters(values) => TablePlaces::Diameters(meters(values)),
            },
            removed: self.removed_um.iter().copied().map(from_um).collect(),
        }
    }
}
