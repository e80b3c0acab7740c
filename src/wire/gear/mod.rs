//! The gears of a submission, and what is wrong with those that cannot be made.
//!
//! The document by its parts: [`relief`], [`material`], [`blank`]. Then what prevents a gear (`faults`), which fields could
//! change (`field`), and the values that together would do (`repair`).

mod blank;
mod faults;
mod field;
mod material;
mod relief;
mod repair;

use meshwright_engine::gear::{GearData, ModificationData, Rack, TipEdge, ToothDeviations};
use serde::Serialize;

pub use blank::{BlankDocument, HolesDocument};
pub use material::MaterialDocument;
pub use relief::{ReliefDocument, StartDocument};

use super::quantity;
use super::schema::{self, documented};
use super::tree::{ObjectReader, OptionalObject};
use super::units::{Side, from_mm, rounded_inward};

/// A gear, in the reader's units, with every default filled in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GearDocument {
    tooth_count: u32,
    pub(super) module_mm: f64,
    pub(super) pressure_angle_deg: f64,
    profile_shift: f64,
    addendum_mm: f64,
    dedendum_mm: f64,
    rack_tip_radius_mm: f64,
    face_width_mm: f64,
    tip_relief: Option<ReliefDocument>,
    material: MaterialDocument,
    blank: BlankDocument,
}

documented!(
    GearDocument,
    "Gear",
    [ReliefDocument, MaterialDocument, BlankDocument],
    schema::object(
        "Gear",
        "A spur gear as its drawing describes it.",
        vec![
            schema::number(&quantity::TOOTH_COUNT),
            schema::number(&quantity::MODULE),
            schema::number(&quantity::PRESSURE_ANGLE),
            schema::number(&quantity::PROFILE_SHIFT),
            schema::number(&quantity::ADDENDUM),
            schema::number(&quantity::DEDENDUM),
            schema::number(&quantity::RACK_TIP_RADIUS),
            schema::number(&quantity::FACE_WIDTH),
            schema::optional_document::<ReliefDocument>(
                "tip_relief",
                "Tip relief",
                "Material taken off the loaded flanks near the tip. Default: none."
            ),
            schema::document::<MaterialDocument>("material", false),
            schema::document::<BlankDocument>("blank", true),
        ]
    )
);

/// The rounding of a rack's tip where none is given: `usual`, or the largest that fits between its flanks. In mm and degrees.
fn usual_tip_radius(usual: f64, module: f64, pressure_angle: f64, dedendum: f64) -> f64 {
    let rack = Rack {
        module,
        pressure_angle: pressure_angle.to_radians(),
        addendum: module,
        dedendum,
        tip_radius: usual,
    };
    let largest = rack.largest_tip_radius();
    if usual <= largest {
        usual
    } else {
        rounded_inward(largest, Side::AtMost, 0)
    }
}

impl GearDocument {
    /// Reads a gear; what is wrong is reported to the reader's errors.
    pub(super) fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let tooth_count = reader.count(&quantity::TOOTH_COUNT);
        let module_mm = reader.number(&quantity::MODULE, None);
        let pressure_angle_deg = reader.number(&quantity::PRESSURE_ANGLE, None);
        let profile_shift = reader.number(&quantity::PROFILE_SHIFT, None);
        let addendum_mm = reader.number(&quantity::ADDENDUM, module_mm);
        let dedendum_mm = reader.number(&quantity::DEDENDUM, module_mm);
        let given = reader.present(quantity::RACK_TIP_RADIUS.name).is_some();
        let mut rack_tip_radius_mm = reader.number(&quantity::RACK_TIP_RADIUS, module_mm);
        if !given
            && let (Some(radius), Some(module), Some(angle), Some(dedendum)) = (
                rack_tip_radius_mm,
                module_mm,
                pressure_angle_deg,
                dedendum_mm,
            )
        {
            rack_tip_radius_mm = Some(usual_tip_radius(radius, module, angle, dedendum));
        }
        let face_width_mm = reader.number(&quantity::FACE_WIDTH, None);
        let tip_relief = match reader.optional_object("tip_relief") {
            OptionalObject::Absent => Some(None),
            OptionalObject::Wrong => None,
            OptionalObject::Present(relief) => ReliefDocument::read(relief).map(Some),
        };
        let material = match reader.optional_object("material") {
            OptionalObject::Absent => Some(MaterialDocument::STEEL),
            OptionalObject::Wrong => None,
            OptionalObject::Present(material) => MaterialDocument::read(material),
        };
        let blank = reader.needed_object("blank").and_then(BlankDocument::read);
        reader.finish();
        Some(Self {
            tooth_count: tooth_count?,
            module_mm: module_mm?,
            pressure_angle_deg: pressure_angle_deg?,
            profile_shift: profile_shift?,
            addendum_mm: addendum_mm?,
            dedendum_mm: dedendum_mm?,
            rack_tip_radius_mm: rack_tip_radius_mm?,
            face_width_mm: face_width_mm?,
            tip_relief: tip_relief?,
            material: material?,
            blank: blank?,
        })
    }

    /// What the engine is told.
    fn data(&self) -> GearData {
        GearData {
            tooth_count: self.tooth_count,
            rack: Rack {
                module: from_mm(self.module_mm),
                pressure_angle: self.pressure_angle_deg.to_radians(),
                addendum: from_mm(self.addendum_mm),
                dedendum: from_mm(self.dedendum_mm),
                tip_radius: from_mm(self.rack_tip_radius_mm),
            },
            profile_shift: self.profile_shift,
            face_width: from_mm(self.face_width_mm),
            thickness_deviation: 0.0,
            tip_edge: TipEdge::Sharp,
            modifications: self
                .tip_relief
                .iter()
                .map(|relief| ModificationData::TipRelief(relief.data()))
                .collect(),
            deviations: ToothDeviations::default(),
            material: self.material.data(),
            blank: self.blank.data(),
        }
    }
}
