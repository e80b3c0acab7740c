//! The gears of a submission, and what is wrong with those that cannot be made.
//!
//! The document by its parts: `tip`, `relief`, `modification`, `deviation`, `material`, `blank` and `holes`. Then what prevents
//! a gear (`proportions`, `faults`, `blank_faults`), which fields could change (`field`), and the values that together would do (`repair`).

mod blank;
mod blank_faults;
mod deviation;
mod faults;
mod field;
mod holes;
mod material;
mod modification;
mod proportions;
mod relief;
mod repair;
#[cfg(test)]
mod tests;
mod tip;

use meshwright_engine::gear::{GearData, Rack, ToothDeviations};
use serde::Serialize;

pub use blank::{BlankDocument, WebDocument};
pub use deviation::{DeviationsDocument, EccentricityDocument};
pub use holes::{PatternDocument, SlotDocument};
pub use material::MaterialDocument;
pub use modification::{ModificationDocument, TableDocument};
pub use relief::{ReliefDocument, StartDocument};

use relief::ReliefEnd;
use tip::{EdgeDocument, TipCircle};

use super::quantity;
use super::schema::{self, documented};
use super::tree::{ObjectReader, OptionalObject};
use super::units::{Side, from_mm, from_um, rounded_inward};

/// A gear, in the reader's units, with every default filled in.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GearDocument {
    tooth_count: u32,
    pub(super) module_mm: f64,
    pub(super) pressure_angle_deg: f64,
    profile_shift: f64,
    #[serde(flatten)]
    tip_circle: TipCircle,
    dedendum_mm: f64,
    rack_tip_radius_mm: f64,
    tooth_thickness_deviation_um: f64,
    #[serde(flatten)]
    tip_edge: EdgeDocument,
    face_width_mm: f64,
    tip_relief: Option<ReliefDocument>,
    profile_modifications: Vec<ModificationDocument>,
    tooth_deviations: Option<DeviationsDocument>,
    material: MaterialDocument,
    blank: BlankDocument,
}

documented!(
    GearDocument,
    "Gear",
    [
        ReliefDocument,
        ModificationDocument,
        DeviationsDocument,
        MaterialDocument,
        BlankDocument
    ],
    schema::object(
        "Gear",
        "A spur gear as its drawing describes it.",
        vec![
            schema::number(&quantity::TOOTH_COUNT),
            schema::number(&quantity::MODULE),
            schema::number(&quantity::PRESSURE_ANGLE),
            schema::number(&quantity::PROFILE_SHIFT),
            schema::number(&quantity::ADDENDUM),
            schema::number(&quantity::TIP_DIAMETER),
            schema::number(&quantity::DEDENDUM),
            schema::number(&quantity::RACK_TIP_RADIUS),
            schema::number(&quantity::THICKNESS_DEVIATION),
            schema::number(&quantity::TIP_ROUNDING),
            schema::number(&quantity::TIP_CHAMFER),
            schema::number(&quantity::FACE_WIDTH),
            schema::optional_document::<ReliefDocument>(
                "tip_relief",
                "Tip relief",
                "Material taken off the loaded flanks near the tip, as a drawing usually gives it: the first of the profile modifications. Default: none."
            ),
            modification::list_property(),
            schema::optional_document::<DeviationsDocument>(
                "tooth_deviations",
                "Tooth deviations",
                "What the teeth deviate from each other by. The contact then repeats once a revolution. Default: nothing."
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
        let tip_circle = TipCircle::read(&mut reader, module_mm);
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
        let tooth_thickness_deviation_um = reader.number(&quantity::THICKNESS_DEVIATION, None);
        let tip_edge = EdgeDocument::read(&mut reader);
        let face_width_mm = reader.number(&quantity::FACE_WIDTH, None);
        let tip_relief = match reader.optional_object("tip_relief") {
            OptionalObject::Absent => Some(None),
            OptionalObject::Wrong => None,
            OptionalObject::Present(relief) => {
                ReliefDocument::read(relief, ReliefEnd::Tip).map(Some)
            }
        };
        let profile_modifications = modification::read_list(&mut reader);
        let tooth_deviations = match reader.optional_object("tooth_deviations") {
            OptionalObject::Absent => Some(None),
            OptionalObject::Wrong => None,
            OptionalObject::Present(deviations) => DeviationsDocument::read(deviations).map(Some),
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
            tip_circle: tip_circle?,
            dedendum_mm: dedendum_mm?,
            rack_tip_radius_mm: rack_tip_radius_mm?,
            tooth_thickness_deviation_um: tooth_thickness_deviation_um?,
            tip_edge: tip_edge?,
            face_width_mm: face_width_mm?,
            tip_relief: tip_relief?,
            profile_modifications: profile_modifications?,
            tooth_deviations: tooth_deviations?,
            material: material?,
            blank: blank?,
        })
    }

    /// The radius from which the addendum counts, in mm: the reference radius plus the profile shift.
    fn shifted_radius_mm(&self) -> f64 {
        self.module_mm * (f64::from(self.tooth_count) / 2.0 + self.profile_shift)
    }

    /// What the engine is told.
    fn data(&self) -> GearData {
        GearData {
            tooth_count: self.tooth_count,
            rack: Rack {
                module: from_mm(self.module_mm),
                pressure_angle: self.pressure_angle_deg.to_radians(),
                addendum: from_mm(self.tip_circle.addendum(self.shifted_radius_mm())),
                dedendum: from_mm(self.dedendum_mm),
                tip_radius: from_mm(self.rack_tip_radius_mm),
            },
            profile_shift: self.profile_shift,
            face_width: from_mm(self.face_width_mm),
            thickness_deviation: from_um(self.tooth_thickness_deviation_um),
            tip_edge: self.tip_edge.data(),
            modifications: self
                .tip_relief
                .iter()
                .map(ReliefDocument::data)
                .chain(
                    self.profile_modifications
                        .iter()
                        .map(ModificationDocument::data),
                )
                .collect(),
            deviations: self
                .tooth_deviations
                .as_ref()
                .map_or_else(ToothDeviations::default, DeviationsDocument::data),
            material: self.material.data(),
            blank: self.blank.data(),
        }
    }
}
