//! The document of a submission, read field by field.

use meshwright_engine::analysis::Method;
use serde::Serialize;

use crate::wire::pair::PairDocument;
use crate::wire::problem::{Code, FieldError};
use crate::wire::quantity::{self, MOST_TORQUES};
use crate::wire::resolution::ResolutionDocument;
use crate::wire::tags;
use crate::wire::tree::{Node, ObjectReader, as_word};

/// The document of a submission, in the reader's units, with every default filled in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Document {
    #[serde(serialize_with = "as_word")]
    pub(super) method: Method,
    pub(super) pair: PairDocument,
    pub(super) output_torques_n_m: Vec<f64>,
    pub(super) driving_speed_rpm: Option<f64>,
    pub(super) stress: bool,
    pub(super) resolution: ResolutionDocument,
    pub(super) tags: Vec<String>,
}

impl Document {
    /// Reads every field by itself; whether they go together is not looked at.
    pub(super) fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let method = reader.choice::<Method>("method", None);
        let pair = reader.needed_object("pair").and_then(PairDocument::read);
        let output_torques_n_m = Self::read_torques(&mut reader);
        let driving_speed_rpm = reader.optional_number(&quantity::DRIVING_SPEED);
        let stress = reader.flag("stress", false);
        let resolution = ResolutionDocument::read(reader.optional_object("resolution"));
        let tags = tags::read(&mut reader);
        reader.finish();
        Some(Self {
            method: method?,
            pair: pair?,
            output_torques_n_m: output_torques_n_m?,
            driving_speed_rpm: driving_speed_rpm?,
            stress: stress?,
            resolution: resolution?,
            tags: tags?,
        })
    }

    fn read_torques(reader: &mut ObjectReader<'_>) -> Option<Vec<f64>> {
        let name = quantity::OUTPUT_TORQUE.name;
        let node = reader.needed(name)?;
        let pointer = reader.pointer_to(name);
        let Node::List(items) = node else {
            reader.wrong_kind(name, node, "a list of torques in N m");
            return None;
        };
        if items.is_empty() {
            reader.report(FieldError::new(
                &*pointer,
                Code::OutOfRange,
                format!("{pointer} is empty; give a torque."),
            ));
            return None;
        }
        if items.len() > MOST_TORQUES {
            let detail = format!(
                "{pointer} has {} torques; at most {MOST_TORQUES} fit in one submission.",
                items.len()
            );
            reader.report(
                FieldError::new(&*pointer, Code::TooLarge, detail).nearest(MOST_TORQUES as f64),
            );
            return None;
        }
        let torques: Vec<_> = items
            .iter()
            .enumerate()
            .map(|(i, item)| {
                reader.checked_number(item, &format!("{pointer}/{i}"), &quantity::OUTPUT_TORQUE)
            })
            .collect();
        for (i, torque) in torques.iter().enumerate() {
            if torque.is_some() && torques[..i].contains(torque) {
                let pointer = format!("{pointer}/{i}");
                let detail = format!("{pointer} repeats a torque; each gives one curve.");
                reader.report(FieldError::new(pointer, Code::OutOfRange, detail));
            }
        }
        torques.into_iter().collect()
    }
}
