//! The gears of a submission, and what is wrong with those that cannot be made.

use meshwright_engine::gear::spur::{LEAST_LIGAMENT, LEAST_RIM, LEAST_TIP_THICKNESS};
use meshwright_engine::gear::{
    Blank, GearData, GearError, HolePattern, Material, Rack, ReliefData, ReliefShape, ReliefStart,
    SpurGear, TipRelief,
};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use super::problem::{Code, FieldError};
use super::quantity::{self, Quantity};
use super::schema::{self, documented};
use super::tree::{Choice, Node, ObjectReader, OptionalObject, as_word};
use super::units::{Side, from_gpa, from_mm, from_um, plain, rounded_inward, to_mm};

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

/// A tip relief.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReliefDocument {
    amount_um: f64,
    #[serde(serialize_with = "as_word")]
    shape: ReliefShape,
    start: StartDocument,
}

documented!(
    ReliefDocument,
    "TipRelief",
    [StartDocument],
    schema::object(
        "Tip relief",
        "c(r) = amount ((r - r_s)/(r_a - r_s))^n, normal to the flank, in the radius however the start r_s is given.",
        vec![
            schema::number(&quantity::RELIEF_AMOUNT),
            schema::choice(
                "shape",
                "Shape",
                "How the relief grows towards the tip.",
                Some(ReliefShape::Linear)
            ),
            schema::document::<StartDocument>("start", true),
        ]
    )
);

impl Choice for ReliefShape {
    const OPTIONS: &'static [(&'static str, Self, &'static str)] = &[
        ("linear", Self::Linear, "in proportion to the radius, n = 1"),
        ("parabolic", Self::Parabolic, "with its square, n = 2"),
    ];
}

/// Where a relief starts: exactly one of four ways to say it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartDocument {
    way: StartWay,
    value: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum StartWay {
    RadialLength,
    RollLengthFromTip,
    Diameter,
    RollAngle,
}

impl StartWay {
    const ALL: [Self; 4] = [
        Self::RadialLength,
        Self::RollLengthFromTip,
        Self::Diameter,
        Self::RollAngle,
    ];

    fn quantity(self) -> &'static Quantity {
        match self {
            Self::RadialLength => &quantity::RELIEF_RADIAL_LENGTH,
            Self::RollLengthFromTip => &quantity::RELIEF_ROLL_LENGTH,
            Self::Diameter => &quantity::RELIEF_DIAMETER,
            Self::RollAngle => &quantity::RELIEF_ROLL_ANGLE,
        }
    }
}

documented!(
    StartDocument,
    "ReliefStart",
    [],
    schema::one_of(
        "Start of the relief",
        "Where the relief starts: exactly one of the four. A bare length is not accepted, because drawings mean different ones by it.",
        None,
        StartWay::ALL
            .iter()
            .map(|way| {
                let quantity = way.quantity();
                schema::object(
                    quantity.title,
                    quantity.description,
                    vec![schema::number(quantity)],
                )
            })
            .collect()
    )
);

impl Serialize for StartDocument {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1))?;
        map.serialize_entry(self.way.quantity().name, &self.value)?;
        map.end()
    }
}

/// An elastic material.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MaterialDocument {
    pub(super) youngs_modulus_gpa: f64,
    poisson_ratio: f64,
    density_kg_m3: f64,
}

documented!(
    MaterialDocument,
    "Material",
    [],
    schema::object(
        "Material",
        "An isotropic elastic material. Default: steel.",
        vec![
            schema::number(&quantity::YOUNGS_MODULUS),
            schema::number(&quantity::POISSON_RATIO),
            schema::number(&quantity::DENSITY),
        ]
    )
);

/// What carries the teeth.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlankDocument {
    bore_radius_mm: f64,
    holes: Option<HolesDocument>,
}

documented!(
    BlankDocument,
    "Blank",
    [HolesDocument],
    schema::object(
        "Blank",
        "What carries the teeth: everything between the bore and the root circle.",
        vec![
            schema::number(&quantity::BORE_RADIUS),
            schema::optional_document::<HolesDocument>(
                "holes",
                "Holes",
                "Equal round holes on a circle. Default: none."
            ),
        ]
    )
);

/// Equal round holes on a circle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HolesDocument {
    count: u32,
    circle_radius_mm: f64,
    radius_mm: f64,
    phase_deg: f64,
}

documented!(
    HolesDocument,
    "Holes",
    [],
    schema::object(
        "Holes",
        "Equal, evenly spaced round holes on a circle.",
        vec![
            schema::number(&quantity::HOLE_COUNT),
            schema::number(&quantity::HOLE_CIRCLE),
            schema::number(&quantity::HOLE_RADIUS),
            schema::number(&quantity::HOLE_PHASE),
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
            tip_relief: self.tip_relief.as_ref().map(ReliefDocument::data),
            material: Material {
                youngs_modulus: from_gpa(self.material.youngs_modulus_gpa),
                poisson_ratio: self.material.poisson_ratio,
                density: self.material.density_kg_m3,
            },
            blank: Blank {
                bore_radius: from_mm(self.blank.bore_radius_mm),
                holes: self.blank.holes.as_ref().map(HolesDocument::data),
            },
        }
    }

    /// The gear, if it can be made.
    ///
    /// # Errors
    ///
    /// Every field that has to change, each with a value such that all these values together make a gear, where there
    /// are such values.
    pub(super) fn to_gear(&self, pointer: &str) -> Result<SpurGear, Vec<FieldError>> {
        const MOST_REPAIRS: usize = 12;
        let mut repaired = self.clone();
        let mut faults: Vec<Fault> = Vec::new();
        for _ in 0..MOST_REPAIRS {
            let mut fault = match repaired.made() {
                Ok(gear) if faults.is_empty() => return Ok(gear),
                Ok(_) => return Err(self.told(pointer, faults)),
                Err(fault) => fault,
            };
            let index = faults.iter().position(|known| known.field == fault.field);
            let steps = index.map_or(0, |index| faults[index].steps_after(&fault));
            let cure = fault
                .bound
                .map(|(bound, side)| rounded_inward(bound, side, steps));
            let cure = cure.filter(|&value| repaired.accepts(fault.field, value));
            match index {
                Some(index) => {
                    let known = &mut faults[index];
                    (known.cure, known.bound, known.steps) = (cure, fault.bound, steps);
                }
                None => {
                    fault.cure = cure;
                    faults.push(fault.clone());
                }
            }
            match cure {
                Some(value) => repaired.set(fault.field, value),
                None => break,
            }
        }
        // No set of values was found that works together, so none is promised for the last of them.
        if let Some(last) = faults.last_mut() {
            last.cure = None;
        }
        Err(self.told(pointer, faults))
    }

    fn told(&self, pointer: &str, faults: Vec<Fault>) -> Vec<FieldError> {
        faults
            .into_iter()
            .map(|fault| {
                let advice = fault.cure.map_or_else(String::new, |cure| {
                    format!(
                        " {} would do.",
                        self.quantity(fault.field)
                            .map_or_else(|| plain(cure), |q| spoken(cure, q))
                    )
                });
                let place = format!("{pointer}/{}", self.pointer_within(fault.field));
                FieldError::new(place, fault.code, format!("{}{advice}", fault.detail))
                    .nearest(fault.cure)
            })
            .collect()
    }

    /// Makes the gear, or tells the first thing that prevents it.
    fn made(&self) -> Result<SpurGear, Fault> {
        self.check_proportions()?;
        let gear = SpurGear::new(self.data()).map_err(|error| self.fault(&error))?;
        // A relief that begins and ends at the tip is a step, which no grid and no contact search can follow.
        match gear.tip_relief().map(TipRelief::start_radius) {
            Some(start) if start > gear.tip_radius() - self.least_relief() => {
                Err(self.relief_fault(start, gear.form_radius(), gear.tip_radius()))
            }
            _ => Ok(gear),
        }
    }

    /// The least radial length of a relief, in meters.
    fn least_relief(&self) -> f64 {
        0.01 * from_mm(self.module_mm)
    }

    /// Bounds that depend on the other fields, so that nothing degenerate reaches the grids.
    fn check_proportions(&self) -> Result<(), Fault> {
        let m = self.module_mm;
        for (field, least, most) in [
            (Field::Addendum, 0.2, 2.0),
            (Field::Dedendum, 0.5, 2.5),
            (Field::RackTipRadius, 0.05, 2.0),
        ] {
            self.check_between(
                field,
                least * m,
                most * m,
                &format!("{least} and {most} modules"),
            )?;
        }
        // A bore or a hole that is a mere point has a logarithmically singular compliance.
        let least_bore = 0.05 * self.root_radius_mm();
        self.check_between(
            Field::Bore,
            least_bore,
            f64::INFINITY,
            "5 % of the root radius and more",
        )?;
        if self.blank.holes.is_some() {
            self.check_between(
                Field::HoleRadius,
                self.least_hole_mm(),
                f64::INFINITY,
                "1 % of the root radius and more",
            )?;
        }
        Ok(())
    }

    fn check_between(&self, field: Field, least: f64, most: f64, said: &str) -> Result<(), Fault> {
        let value = self.value(field);
        let bound = if value < least * (1.0 - 1e-12) {
            (least, Side::AtLeast)
        } else if value > most * (1.0 + 1e-12) {
            (most, Side::AtMost)
        } else {
            return Ok(());
        };
        let detail = format!("{} mm is outside {said}.", plain(value));
        Err(Fault::new(field, Code::OutOfRange, detail, Some(bound)))
    }

    fn least_hole_mm(&self) -> f64 {
        0.01 * self.root_radius_mm()
    }

    fn root_radius_mm(&self) -> f64 {
        self.module_mm * f64::from(self.tooth_count) / 2.0 - self.dedendum_mm
            + self.profile_shift * self.module_mm
    }

    fn fault(&self, error: &GearError) -> Fault {
        let mm = |value: f64| plain(to_mm(value));
        match *error {
            GearError::RackTipRadius {
                tip_radius,
                largest,
            } => Fault::new(
                Field::RackTipRadius,
                Code::OutOfRange,
                format!(
                    "A rack tip rounding of {} mm does not fit; at most {} mm does.",
                    mm(tip_radius),
                    mm(largest)
                ),
                Some((to_mm(largest), Side::AtMost)),
            ),
            GearError::Undercut {
                profile_shift,
                smallest,
            } => Fault::new(
                Field::ProfileShift,
                Code::Undercut,
                format!(
                    "{} teeth are undercut at profile shift {}; it takes at least {}.",
                    self.tooth_count,
                    plain(profile_shift),
                    plain(smallest)
                ),
                Some((smallest, Side::AtLeast)),
            ),
            GearError::PointedTip {
                thickness,
                largest_addendum,
            } => Fault::new(
                Field::Addendum,
                Code::PointedTip,
                if thickness < 0.0 {
                    format!(
                        "The flanks of a tooth cross below the tip circle; an addendum of at most {} mm avoids it.",
                        mm(largest_addendum)
                    )
                } else {
                    format!(
                        "The teeth are {} mm thick at the tip, less than {LEAST_TIP_THICKNESS} modules; an addendum of at most {} mm leaves enough.",
                        mm(thickness),
                        mm(largest_addendum)
                    )
                },
                Some((to_mm(largest_addendum), Side::AtMost)),
            ),
            GearError::NoFlank {
                tip_radius,
                form_radius,
            } => Fault::new(
                Field::Addendum,
                Code::OutOfRange,
                format!(
                    "The tip radius {} mm leaves no flank above the form radius {} mm.",
                    mm(tip_radius),
                    mm(form_radius)
                ),
                Some((
                    self.addendum_mm + to_mm(form_radius - tip_radius) + 0.1 * self.module_mm,
                    Side::AtLeast,
                )),
            ),
            GearError::ReliefTooLong {
                start_radius,
                form_radius,
                tip_radius,
            } => self.relief_fault(start_radius, form_radius, tip_radius),
            GearError::BoreTooLarge {
                bore_radius,
                largest,
            } => Fault::new(
                Field::Bore,
                Code::BoreTooLarge,
                format!(
                    "A bore of radius {} mm leaves less than {LEAST_RIM} module below the root circle; at most {} mm.",
                    mm(bore_radius),
                    mm(largest)
                ),
                Some((to_mm(largest), Side::AtMost)),
            ),
            GearError::HolesOverlap {
                ligament,
                largest_radius,
            } => self.hole_fault(Code::HolesOverlap, "between them", ligament, largest_radius),
            GearError::HolesBreachRim {
                ligament,
                largest_radius,
            } => self.hole_fault(
                Code::HolesBreachRim,
                "below the root circle",
                ligament,
                largest_radius,
            ),
            GearError::HolesBreachBore {
                ligament,
                largest_radius,
            } => self.hole_fault(
                Code::HolesBreachBore,
                "around the bore",
                ligament,
                largest_radius,
            ),
        }
    }

    fn relief_fault(&self, start_radius: f64, form_radius: f64, tip_radius: f64) -> Fault {
        let highest = tip_radius - self.least_relief();
        let detail = format!(
            "The relief starts at radius {} mm; on this flank it can start from {} mm to {} mm.",
            plain(to_mm(start_radius)),
            plain(to_mm(form_radius)),
            plain(to_mm(highest))
        );
        let r_b = from_mm(self.module_mm * f64::from(self.tooth_count) / 2.0)
            * self.pressure_angle_deg.to_radians().cos();
        let roll = |radius: f64| (radius.powi(2) - r_b.powi(2)).max(0.0).sqrt();
        // The radius that is nearest, and on which side of it the flank is.
        let (nearest, above) = if start_radius > highest {
            (highest, Side::AtMost)
        } else {
            (form_radius, Side::AtLeast)
        };
        let below = match above {
            Side::AtMost => Side::AtLeast,
            Side::AtLeast => Side::AtMost,
        };
        let way = self.tip_relief.as_ref().map(|relief| relief.start.way);
        let bound = match way {
            Some(StartWay::RadialLength) => (to_mm(tip_radius - nearest), below),
            Some(StartWay::RollLengthFromTip) => (to_mm(roll(tip_radius) - roll(nearest)), below),
            Some(StartWay::Diameter) | None => (to_mm(2.0 * nearest), above),
            Some(StartWay::RollAngle) => ((roll(nearest) / r_b).to_degrees(), above),
        };
        Fault::new(Field::ReliefStart, Code::ReliefTooLong, detail, Some(bound))
    }

    /// The radius of the holes is to blame, unless no radius would do: then it is their circle.
    fn hole_fault(&self, code: Code, place: &str, ligament: f64, largest_radius: f64) -> Fault {
        let least = to_mm(LEAST_LIGAMENT);
        let detail = if ligament < 0.0 {
            format!(
                "The holes leave nothing {place}: they cut {} mm too far.",
                plain(to_mm(-ligament))
            )
        } else {
            format!(
                "The holes leave {} mm {place}; at least {least} mm has to stay.",
                plain(to_mm(ligament))
            )
        };
        let largest = rounded_inward(to_mm(largest_radius), Side::AtMost, 0);
        if self.accepts(Field::HoleRadius, largest) && largest >= self.least_hole_mm() {
            return Fault::new(
                Field::HoleRadius,
                code,
                detail,
                Some((to_mm(largest_radius), Side::AtMost)),
            );
        }
        let missing = least - to_mm(ligament);
        let circle = self.value(Field::HoleCircle);
        let bound = match code {
            Code::HolesBreachRim => (circle - missing, Side::AtMost),
            Code::HolesBreachBore => (circle + missing, Side::AtLeast),
            _ => {
                let count = self.blank.holes.as_ref().map_or(1, |holes| holes.count);
                let half_angle = std::f64::consts::PI / f64::from(count);
                (
                    (self.value(Field::HoleRadius) + least / 2.0) / half_angle.sin(),
                    Side::AtLeast,
                )
            }
        };
        Fault::new(Field::HoleCircle, code, detail, Some(bound))
    }

    fn value(&self, field: Field) -> f64 {
        let holes = self.blank.holes.as_ref();
        match field {
            Field::ProfileShift => self.profile_shift,
            Field::Addendum => self.addendum_mm,
            Field::Dedendum => self.dedendum_mm,
            Field::RackTipRadius => self.rack_tip_radius_mm,
            Field::ReliefStart => self
                .tip_relief
                .as_ref()
                .map_or(0.0, |relief| relief.start.value),
            Field::Bore => self.blank.bore_radius_mm,
            Field::HoleCircle => holes.map_or(0.0, |holes| holes.circle_radius_mm),
            Field::HoleRadius => holes.map_or(0.0, |holes| holes.radius_mm),
        }
    }

    fn set(&mut self, field: Field, value: f64) {
        let holes = self.blank.holes.as_mut();
        match (field, holes, self.tip_relief.as_mut()) {
            (Field::ProfileShift, ..) => self.profile_shift = value,
            (Field::Addendum, ..) => self.addendum_mm = value,
            (Field::Dedendum, ..) => self.dedendum_mm = value,
            (Field::RackTipRadius, ..) => self.rack_tip_radius_mm = value,
            (Field::Bore, ..) => self.blank.bore_radius_mm = value,
            (Field::ReliefStart, _, Some(relief)) => relief.start.value = value,
            (Field::HoleCircle, Some(holes), _) => holes.circle_radius_mm = value,
            (Field::HoleRadius, Some(holes), _) => holes.radius_mm = value,
            (Field::ReliefStart, _, None) | (Field::HoleCircle | Field::HoleRadius, None, _) => {}
        }
    }

    fn quantity(&self, field: Field) -> Option<&'static Quantity> {
        Some(match field {
            Field::ProfileShift => &quantity::PROFILE_SHIFT,
            Field::Addendum => &quantity::ADDENDUM,
            Field::Dedendum => &quantity::DEDENDUM,
            Field::RackTipRadius => &quantity::RACK_TIP_RADIUS,
            Field::ReliefStart => self.tip_relief.as_ref()?.start.way.quantity(),
            Field::Bore => &quantity::BORE_RADIUS,
            Field::HoleCircle => &quantity::HOLE_CIRCLE,
            Field::HoleRadius => &quantity::HOLE_RADIUS,
        })
    }

    fn pointer_within(&self, field: Field) -> String {
        let name = self.quantity(field).map_or("", |quantity| quantity.name);
        let folder = match field {
            Field::ProfileShift | Field::Addendum | Field::Dedendum | Field::RackTipRadius => "",
            Field::ReliefStart => "tip_relief/start/",
            Field::Bore => "blank/",
            Field::HoleCircle | Field::HoleRadius => "blank/holes/",
        };
        format!("{folder}{name}")
    }

    /// Whether `value` is within the bounds of `field`.
    fn accepts(&self, field: Field, value: f64) -> bool {
        self.quantity(field)
            .is_some_and(|quantity| (quantity.bounds.0..=quantity.bounds.1).contains(&value))
    }
}

/// A value with its unit, as a sentence begins with it.
fn spoken(value: f64, quantity: &Quantity) -> String {
    match quantity.unit {
        "1" => plain(value),
        unit => format!("{} {unit}", plain(value)),
    }
}

/// The fields that may have to change to make a gear.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Field {
    ProfileShift,
    Addendum,
    Dedendum,
    RackTipRadius,
    ReliefStart,
    Bore,
    HoleCircle,
    HoleRadius,
}

/// Why a gear cannot be made, and the bound beyond which it could, in the unit of the field.
#[derive(Debug, Clone, PartialEq)]
struct Fault {
    field: Field,
    code: Code,
    detail: String,
    bound: Option<(f64, Side)>,
    cure: Option<f64>,
    steps: u32,
}

impl Fault {
    fn new(field: Field, code: Code, detail: String, bound: Option<(f64, Side)>) -> Self {
        Self {
            field,
            code,
            detail,
            bound,
            cure: None,
            steps: 0,
        }
    }

    /// How many units inward the next cure goes, where the field is still at fault after this one: a bound that has
    /// not moved was met only up to the last bits.
    fn steps_after(&self, next: &Self) -> u32 {
        match (self.bound, next.bound) {
            (Some((before, _)), Some((now, _))) if (before - now).abs() <= 1e-6 * now.abs() => {
                self.steps + 1
            }
            _ => 0,
        }
    }
}

impl ReliefDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let amount_um = reader.number(&quantity::RELIEF_AMOUNT, None);
        let shape = reader.choice("shape", Some(ReliefShape::Linear));
        let start = reader
            .needed("start")
            .and_then(|node| StartDocument::read(node, &reader));
        reader.finish();
        Some(Self {
            amount_um: amount_um?,
            shape: shape?,
            start: start?,
        })
    }

    fn data(&self) -> ReliefData {
        let value = self.start.value;
        ReliefData {
            amount: from_um(self.amount_um),
            shape: self.shape,
            start: match self.start.way {
                StartWay::RadialLength => ReliefStart::RadialLength(from_mm(value)),
                StartWay::RollLengthFromTip => ReliefStart::RollLengthFromTip(from_mm(value)),
                StartWay::Diameter => ReliefStart::Diameter(from_mm(value)),
                StartWay::RollAngle => ReliefStart::RollAngle(value.to_radians()),
            },
        }
    }
}

impl StartDocument {
    fn read(node: &Node, parent: &ObjectReader<'_>) -> Option<Self> {
        let pointer = parent.pointer_to("start");
        let mut reader = parent.object(node, pointer.clone())?;
        let mut found = Vec::new();
        let mut wrong = false;
        for way in StartWay::ALL {
            match reader.optional_number(way.quantity()) {
                Some(Some(value)) => found.push(Self { way, value }),
                Some(None) => {}
                None => wrong = true,
            }
        }
        let names: Vec<_> = StartWay::ALL
            .iter()
            .map(|way| way.quantity().name)
            .collect();
        let names = names.join(", ");
        let one = match (found.as_slice(), wrong) {
            ([one], false) => Some(*one),
            ([], false) => {
                let detail = format!("{pointer} needs exactly one of {names}; it has none.");
                reader.report(FieldError::new(pointer, Code::MissingField, detail));
                None
            }
            (several, false) => {
                let detail = format!(
                    "{pointer} needs exactly one of {names}; it has {}.",
                    several.len()
                );
                reader.report(FieldError::new(pointer, Code::OutOfRange, detail));
                None
            }
            (_, true) => None,
        };
        reader.finish();
        one
    }
}

impl MaterialDocument {
    const STEEL: Self = Self {
        youngs_modulus_gpa: 210.0,
        poisson_ratio: 0.3,
        density_kg_m3: 7850.0,
    };

    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let youngs_modulus_gpa = reader.number(&quantity::YOUNGS_MODULUS, None);
        let poisson_ratio = reader.number(&quantity::POISSON_RATIO, None);
        let density_kg_m3 = reader.number(&quantity::DENSITY, None);
        reader.finish();
        Some(Self {
            youngs_modulus_gpa: youngs_modulus_gpa?,
            poisson_ratio: poisson_ratio?,
            density_kg_m3: density_kg_m3?,
        })
    }
}

impl BlankDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let bore_radius_mm = reader.number(&quantity::BORE_RADIUS, None);
        let holes = match reader.optional_object("holes") {
            OptionalObject::Absent => Some(None),
            OptionalObject::Wrong => None,
            OptionalObject::Present(holes) => HolesDocument::read(holes).map(Some),
        };
        reader.finish();
        Some(Self {
            bore_radius_mm: bore_radius_mm?,
            holes: holes?,
        })
    }
}

impl HolesDocument {
    fn read(mut reader: ObjectReader<'_>) -> Option<Self> {
        let count = reader.count(&quantity::HOLE_COUNT);
        let circle_radius_mm = reader.number(&quantity::HOLE_CIRCLE, None);
        let radius_mm = reader.number(&quantity::HOLE_RADIUS, None);
        let phase_deg = reader.number(&quantity::HOLE_PHASE, None);
        reader.finish();
        Some(Self {
            count: count?,
            circle_radius_mm: circle_radius_mm?,
            radius_mm: radius_mm?,
            phase_deg: phase_deg?,
        })
    }

    fn data(&self) -> HolePattern {
        HolePattern {
            count: self.count,
            circle_radius: from_mm(self.circle_radius_mm),
            radius: from_mm(self.radius_mm),
            phase: self.phase_deg.to_radians(),
        }
    }
}
