//! The gears of a submission, and the faults of those that cannot be made.
//!
//! The document by its parts: `tip`, `relief`, `modification`, `thickness`, `deviation`, `traces`, `lead`, `material`, `blank`, `holes` and `openings`;
//! `solid` is the gear along its axis. Then the faults of a gear (`proportions`, `faults`, `blank_faults`), the fields that could change (`field`), and values
//! that would do together (`repair`).

mod blank;
mod blank_faults;
mod blank_openings;
mod deviation;
mod faults;
mod field;
mod holes;
mod lead;
mod material;
mod modification;
mod openings;
mod proportions;
mod protuberance;
mod relief;
mod repair;
mod solid;
#[cfg(test)]
mod tests;
mod thickness;
mod traces;

use meshwright_engine::gear::{GearData, Helix, Member, Rack, TipEdge, ToothDeviations};

pub use blank::{BlankDocument, HubDocument, ShaftDocument, WebDocument};
pub use deviation::{DeviationsDocument, EccentricityDocument};
pub(super) use holes::MOST_HOLES;
pub use holes::{HolesDocument, PatternDocument, SlotDocument};
pub use lead::{
    EndReliefDocument, LeadCrowningDocument, LeadModificationDocument, LeadSlopeDocument,
    LeadTableDocument,
};
pub use material::MaterialDocument;
pub(super) use modification::MOST_ENTRIES;
pub use modification::{CrowningDocument, ModificationDocument, SlopeDocument, TableDocument};
pub use openings::{Point, SideDocument, SpokesDocument};
pub use protuberance::ProtuberanceDocument;
pub use relief::{ReliefEnd, RootReliefDocument, StartDocument, StartWay, TipReliefDocument};
pub use thickness::{BallsDocument, SpanDocument, ThinnedBy};
pub use traces::{LeadTracesDocument, ProfileTracesDocument};

use super::declare::{
    EACH, Errors, Kind as _, Location, Node, ObjectReader, absent, document, list, nested, number,
    unless, word, words,
};
use super::units::{Side, from_mm, rounded_inward};

/// The most profile modifications of one gear, beside its tip relief.
pub(super) const MOST_MODIFICATIONS: usize = 16;

words! {
    Member {
        Driving = "driving": "gear 1, which drives",
        Driven = "driven": "gear 2, which is driven",
    }
}

document! {
    /// A spur or helical gear as its drawing describes it.
    pub struct GearDocument as "Gear", "Gear" {
        /// The number of teeth Z. Few teeth without profile shift are undercut. Internal gears, whose number is negative by some programs, are not
        /// computed.
        tooth_count: u32 = number("Number of teeth", "1", 4.0, 1_000.0).negative_means(INTERNAL),
        /// The module m, the same for both gears. Where they differ in printed digits only, that with more digits is taken for both.
        pub(super) module_mm: f64 = number("Module", "mm", 0.1, 50.0),
        /// The pressure angle of the basic rack, the same for both gears but for printed digits.
        pub(super) pressure_angle_deg: f64 = number("Pressure angle", "deg", 10.0, 40.0).or(20.0),
        /// The profile shift x in modules, positive outward.
        profile_shift: f64 = number("Profile shift coefficient", "1", -2.5, 2.5).or(0.0),
        /// The tip radius is the reference radius plus the addendum plus the profile shift; tips are not shortened. Between 0.2 and 2
        /// modules.
        addendum_mm: Option<f64> = unless(
            &["tip_diameter_mm"],
            number("Addendum of the basic rack", "mm", 0.02, 100.0).or_modules(1.0),
        ),
        /// The diameter of the tip circle, said instead of the addendum, which it then decides: the same bounds hold for that.
        tip_diameter_mm: Option<f64> =
            absent(number("Tip diameter", "mm", 0.1, 52_500.0), "the addendum decides"),
        /// The root radius is the reference radius less the dedendum plus the generating profile shift: the dedendum and the tip rounding are those of the tool,
        /// and move with it. Between 0.5 and 2.5 modules.
        dedendum_mm: Option<f64> = unless(
            &["root_diameter_mm"],
            number("Dedendum of the basic rack", "mm", 0.05, 125.0).or_modules(USUAL_DEDENDUM),
        ),
        /// The diameter of the root circle, said instead of the dedendum, which it then decides: the same bounds hold for that.
        root_diameter_mm: Option<f64> =
            absent(number("Root diameter", "mm", 0.1, 52_500.0), "the dedendum decides").left_out(),
        /// The radius of the rack's tip rounding, which generates the fillet. At least 0.05 modules, and it has to fit between the
        /// rack's flanks; where the default does not, the largest that does is taken.
        rack_tip_radius_mm: f64 = number("Tip rounding of the basic rack", "mm", 0.005, 50.0)
            .or_modules(0.38)
            .fitted(usual_tip_radius),
        /// The hob that cuts before grinding, where it has a protuberance: the root is as it leaves it.
        protuberance: Option<ProtuberanceDocument> = absent(
            nested("Protuberance"),
            "the rack of the ground flanks cuts the root",
        )
        .left_out(),
        /// How much thicker the teeth are than the rack leaves them at the profile shift, as a transverse arc on the reference circle; negative is thinner and
        /// gives backlash. Half a module to either side, and a space has to be left between fillets. A drawing may say the thickness in another way;
        /// at most one of them is given.
        tooth_thickness_deviation_um: Option<f64> = unless(
            &["tooth_thickness_deviation_normal_um", "span_measurement", "ball_measurement"],
            number("Deviation of the tooth thickness", "um", -25_000.0, 25_000.0).or(0.0),
        ),
        /// A_sn: the same as an arc in the normal section, as drawings of helical gears say it.
        tooth_thickness_deviation_normal_um: Option<f64> = absent(
            number("Deviation of the tooth thickness (normal section)", "um", -25_000.0, 25_000.0),
            "said in another way",
        )
        .not_beside(&["tooth_thickness_deviation_um", "span_measurement", "ball_measurement"])
        .left_out(),
        /// W_k: the thickness by a span over several teeth.
        span_measurement: Option<SpanDocument> =
            absent(nested("Span measurement"), "said in another way")
                .not_beside(&[
                    "tooth_thickness_deviation_um",
                    "tooth_thickness_deviation_normal_um",
                    "ball_measurement",
                ])
                .left_out(),
        /// M_dK: the thickness by a size over two balls.
        ball_measurement: Option<BallsDocument> =
            absent(nested("Ball measurement"), "said in another way")
                .not_beside(&[
                    "tooth_thickness_deviation_um",
                    "tooth_thickness_deviation_normal_um",
                    "span_measurement",
                ])
                .left_out(),
        /// How the teeth became thinner, or thicker, than the rack leaves them at the profile shift x. It decides the generating profile shift x_E, at which the
        /// tool cut the root; the tip circle stays at x.
        thinned_by: ThinnedBy = word("Thinned by").or(ThinnedBy::Hob),
        /// The generating profile shift x_E of the tool that cut the root, where it is known by itself: a gear program prints it, or the tool of the first step stood
        /// elsewhere than the thickness says. Fillet, root circle and form circle follow from it. Results say it of each gear.
        generating_profile_shift: Option<f64> = absent(
            number("Generating profile shift coefficient", "1", -4.0, 4.0),
            "as thinned_by says",
        )
        .left_out(),
        /// The radius of an arc between flank and tip circle, tangent to both, on both flanks alike: 0, or at least 0.01 modules.
        tip_rounding_mm: Option<f64> = absent(
            number("Rounding of the tip edges", "mm", 0.001, 50.0).or_zero(),
            "sharp edges",
        )
        .not_beside(&["tip_chamfer_mm"]),
        /// How far below the tip circle a cut at 45 deg begins, on both flanks alike: 0, or at least 0.01 modules.
        tip_chamfer_mm: Option<f64> = absent(
            number("Chamfer of the tip edges", "mm", 0.001, 50.0).or_zero(),
            "sharp edges",
        ),
        /// The width of the gear. Contact is on the smaller of the two widths; each body has its own.
        face_width_mm: f64 = number("Face width", "mm", 0.1, 2_000.0),
        /// Material taken off the loaded flanks near the tip, as a drawing usually gives it: the first of the profile modifications.
        tip_relief: Option<TipReliefDocument> = absent(nested("Tip relief"), "none"),
        /// Material removed from the loaded flanks beside the tip relief; they add up. Default: none.
        profile_modifications: Vec<ModificationDocument> =
            list("Profile modifications", EACH, MOST_MODIFICATIONS).or_empty().or_null(),
        /// Material removed from the loaded flanks along the face; they add up. They need three dimensions. Default: none.
        pub(super) lead_modifications: Vec<LeadModificationDocument> =
            list("Lead modifications", EACH, MOST_MODIFICATIONS).or_empty().or_null()
                => in_three_dimensions,
        /// Deviations of the teeth from each other. The contact then repeats once a revolution.
        tooth_deviations: Option<DeviationsDocument> =
            absent(nested("Tooth deviations"), "nothing"),
        /// Material of teeth and blank. Default: steel.
        pub(crate) material: MaterialDocument = nested("Material").or_defaults(),
        /// The blank.
        blank: BlankDocument = EACH,
    }
}

/// The dedendum of a rack where none is given, in modules.
const USUAL_DEDENDUM: f64 = 1.25;

/// The least rounding of a rack's tip, in modules.
const LEAST_RACK_TIP_RADIUS: f64 = 0.05;

/// Meaning of a negative number of teeth in other programs.
const INTERNAL: &str =
    "an internal gear, and internal gears are not computed: both gears have outer teeth here";

/// The rounding of a rack's tip where none is given: `usual`, or the largest that fits between its flanks. In mm.
fn usual_tip_radius(usual: f64, gear: &ObjectReader<'_>) -> f64 {
    let read = |name| gear.number(name);
    let (Some(module), Some(angle)) = (
        read(GearDocument::module_mm.name),
        read(GearDocument::pressure_angle_deg.name),
    ) else {
        return usual;
    };
    // A root diameter decides the dedendum together with the thickness; the usual one stands for it.
    let dedendum = read(GearDocument::dedendum_mm.name).unwrap_or(USUAL_DEDENDUM * module);
    let rack = Rack {
        module,
        pressure_angle: angle.to_radians(),
        addendum: module,
        dedendum,
        tip_radius: usual,
        protuberance: None,
    };
    let largest = rack.largest_tip_radius();
    if usual <= largest {
        usual
    } else {
        // Where none fits it is the dedendum that is too large.
        rounded_inward(largest, Side::AtMost, 0).max(LEAST_RACK_TIP_RADIUS * module)
    }
}

impl GearDocument {
    /// The same gear with teeth that do not deviate.
    pub fn without_deviations(self) -> Self {
        Self {
            tooth_deviations: None,
            ..self
        }
    }

    /// Gives it other teeth.
    pub fn set_deviations(&mut self, deviations: DeviationsDocument) {
        self.tooth_deviations = Some(deviations);
    }

    /// The gear that `node` is, if it can be read.
    pub fn at(node: &Node) -> Option<Self> {
        let errors = Errors::default();
        let read = Self::read(node, &Location::root(&errors), &EACH);
        errors.settle(read).ok()
    }

    /// The radius from which the addendum counts, in mm: the reference radius plus the profile shift.
    fn shifted_radius_mm(&self, helix: Helix) -> f64 {
        let half = f64::from(self.tooth_count) / 2.0;
        if helix.angle == 0.0 {
            self.module_mm * (half + self.profile_shift)
        } else {
            self.module_mm * (half / helix.angle.cos() + self.profile_shift)
        }
    }

    /// The radius from which the dedendum counts, in mm: the reference radius plus the generating profile shift.
    fn generated_radius_mm(&self, helix: Helix) -> f64 {
        let further = self.tool_shift(helix) - self.profile_shift;
        self.shifted_radius_mm(helix) + further * self.module_mm
    }

    /// The dedendum in mm, however the root circle is said.
    fn dedendum(&self, helix: Helix) -> f64 {
        match self.root_diameter_mm {
            Some(diameter) => self.generated_radius_mm(helix) - diameter / 2.0,
            None => self.dedendum_mm.unwrap_or(USUAL_DEDENDUM * self.module_mm),
        }
    }

    /// Value of the field of the root circle for another dedendum, in mm.
    fn root_said(&self, dedendum: f64, helix: Helix) -> f64 {
        match self.root_diameter_mm {
            Some(_) => 2.0 * (self.generated_radius_mm(helix) - dedendum),
            None => dedendum,
        }
    }

    /// The radii of tip and root circle, in mm, as the drawing means them.
    pub fn tip_and_root_mm(&self, helix: Helix) -> [f64; 2] {
        [
            self.shifted_radius_mm(helix) + self.addendum(helix),
            self.generated_radius_mm(helix) - self.dedendum(helix),
        ]
    }

    /// The addendum in mm, however the tip circle is said.
    fn addendum(&self, helix: Helix) -> f64 {
        match self.tip_diameter_mm {
            Some(diameter) => diameter / 2.0 - self.shifted_radius_mm(helix),
            None => self.addendum_mm.unwrap_or(self.module_mm),
        }
    }

    /// Value of the field of the tip circle for another addendum, in mm.
    fn tip_said(&self, addendum: f64, helix: Helix) -> f64 {
        match self.tip_diameter_mm {
            Some(_) => 2.0 * (self.shifted_radius_mm(helix) + addendum),
            None => addendum,
        }
    }

    /// The gear of the engine, of the normal section where the teeth have a `helix`.
    fn data(&self, helix: Helix) -> GearData {
        GearData {
            tooth_count: self.tooth_count,
            rack: Rack {
                module: from_mm(self.module_mm),
                pressure_angle: self.pressure_angle_deg.to_radians(),
                addendum: from_mm(self.addendum(helix)),
                dedendum: from_mm(self.dedendum(helix)),
                tip_radius: from_mm(self.rack_tip_radius_mm),
                protuberance: self.protuberance.as_ref().map(ProtuberanceDocument::data),
            },
            profile_shift: self.profile_shift,
            face_width: from_mm(self.face_width_mm),
            thickness_deviation: self.thickness_deviation(helix).unwrap_or(0.0),
            tool_depth: self.tool_depth(),
            tip_edge: match (self.tip_rounding_mm, self.tip_chamfer_mm) {
                (Some(radius), _) if radius > 0.0 => TipEdge::Rounded(from_mm(radius)),
                (None, Some(depth)) if depth > 0.0 => TipEdge::Chamfered(from_mm(depth)),
                _ => TipEdge::Sharp,
            },
            modifications: self
                .tip_relief
                .iter()
                .map(|relief| relief.relief().data())
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
