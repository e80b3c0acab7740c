//! Faults of a gear by field, each with the bound beyond which it could be made.

use std::f64::consts::PI;

use meshwright_engine::gear::data::{LEAST_RIM, LEAST_TIP_THICKNESS};
use meshwright_engine::gear::{DeviationList, GearError, Helix};

use super::field::{Field, ReliefPlace};
use super::relief::{ReliefEnd, StartWay};
use super::{GearDocument, LEAST_RACK_TIP_RADIUS};
use crate::problem::Code;
use crate::units::{Side, from_mm, plain, to_mm, to_um};

/// Why a gear cannot be made, and the bound beyond which it could, in the unit of the field.
#[derive(Debug, Clone)]
pub(super) struct Fault {
    pub(super) field: Field,
    pub(super) code: Code,
    pub(super) detail: String,
    pub(super) bound: Option<(f64, Side)>,
    pub(super) cure: Option<f64>,
    pub(super) steps: u32,
}

impl Fault {
    pub(super) fn new(
        field: Field,
        code: Code,
        detail: String,
        bound: Option<(f64, Side)>,
    ) -> Self {
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
    pub(super) fn steps_after(&self, next: &Self) -> u32 {
        match (self.bound, next.bound) {
            (Some((before, _)), Some((now, _))) if (before - now).abs() <= 1e-6 * now.abs() => {
                self.steps + 1
            }
            _ => 0,
        }
    }
}

impl GearDocument {
    pub(super) fn fault(&self, error: &GearError, helix: Helix) -> Fault {
        let mm = |value: f64| plain(to_mm(value));
        match *error {
            // A rack so deep that it comes to a point, whatever its rounding.
            GearError::RackTipRadius { largest, .. }
                if to_mm(largest) < LEAST_RACK_TIP_RADIUS * self.module_mm =>
            {
                let rack = self.data(helix).rack;
                let (sin, cos) = rack.pressure_angle.sin_cos();
                let rounding = from_mm(LEAST_RACK_TIP_RADIUS * self.module_mm);
                let deepest =
                    to_mm((PI * rack.module / 4.0 - rounding * (1.0 - sin) / cos) * cos / sin);
                Fault::new(
                    self.root_field(),
                    Code::OutOfRange,
                    format!(
                        "At a pressure angle of {} deg a rack with a dedendum of {} mm comes to a point; at most {} mm leaves room for a rounding of {LEAST_RACK_TIP_RADIUS} modules.",
                        plain(self.pressure_angle_deg),
                        mm(rack.dedendum),
                        plain(deepest)
                    ),
                    Some(match self.root_diameter_mm {
                        Some(_) => (self.root_said(deepest, helix), Side::AtLeast),
                        None => (deepest, Side::AtMost),
                    }),
                )
            }
            GearError::RackTipRadius {
                tip_radius,
                largest,
            } => Fault::new(
                Field::of("", Self::rack_tip_radius_mm),
                Code::OutOfRange,
                format!(
                    "A rack tip rounding of {} mm does not fit; at most {} mm does.",
                    mm(tip_radius),
                    mm(largest)
                ),
                Some((to_mm(largest), Side::AtMost)),
            ),
            GearError::ProtuberanceBelowStock { amount, stock } => {
                Self::protuberance_below_stock(amount, stock)
            }
            GearError::ProtuberanceTooLarge { amount, largest } => {
                Self::protuberance_too_large(amount, largest)
            }
            GearError::ProtuberanceHeight {
                height,
                least,
                largest,
            } => Self::protuberance_height(height, [least, largest]),
            GearError::Undercut {
                generating_profile_shift,
                smallest,
            } => self.undercut_fault(helix, [generating_profile_shift, smallest]),
            GearError::PointedTip {
                thickness,
                largest_addendum,
            } => Fault::new(
                self.tip_field(),
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
                Some((self.tip_said(to_mm(largest_addendum), helix), Side::AtMost)),
            ),
            GearError::NoFlank {
                tip_radius,
                form_radius,
            } => Fault::new(
                self.tip_field(),
                Code::OutOfRange,
                format!(
                    "The tip radius {} mm leaves no flank above the form radius {} mm.",
                    mm(tip_radius),
                    mm(form_radius)
                ),
                Some((
                    self.tip_said(
                        to_mm(form_radius) - self.shifted_radius_mm(helix) + 0.1 * self.module_mm,
                        helix,
                    ),
                    Side::AtLeast,
                )),
            ),
            GearError::ReliefTooLong {
                modification,
                start_radius,
                form_radius,
                tip_radius,
            } => self.relief_fault(
                self.place_of(modification),
                start_radius,
                [form_radius, tip_radius],
            ),
            GearError::BoreTooLarge {
                bore_radius,
                largest,
            } => Fault::new(
                self.blank.core_field().0,
                Code::BoreTooLarge,
                format!(
                    "A {} of radius {} mm leaves less than {LEAST_RIM} module below the root circle; at most {} mm.",
                    match self.blank.shaft {
                        Some(_) => "shaft",
                        None => "bore",
                    },
                    mm(bore_radius),
                    mm(largest)
                ),
                Some((to_mm(largest), Side::AtMost)),
            ),
            GearError::TeethTooThick { deviation, largest } => {
                let detail = format!(
                    "Teeth thicker by {} um leave no space between their fillets; at most {} um.",
                    plain(to_um(deviation)),
                    plain(to_um(largest))
                );
                let bound = (largest, Side::AtMost);
                self.thickness_fault(helix, Code::TeethTooThick, detail, bound)
            }
            GearError::TipEdgeTooLarge { amount, largest } => Fault::new(
                self.tip_edge_field().0,
                Code::TipEdgeTooLarge,
                format!(
                    "Tip edges broken by {} mm leave no tip or no flank; at most {} mm.",
                    mm(amount),
                    mm(largest)
                ),
                Some((to_mm(largest), Side::AtMost)),
            ),
            // The lists were checked before; the difference is the engine's own rounding.
            GearError::TableDoesNotRise {
                modification,
                entry,
            } => Fault::new(
                self.place_of(modification).field(),
                Code::TableDoesNotRise,
                format!("Entry {entry} of the table does not stand beyond the one before it."),
                None,
            ),
            GearError::DeviationCount {
                list,
                given,
                needed,
            } => Fault::new(
                Field::whole(Self::tooth_deviations.name.to_owned()),
                Code::WrongLength,
                format!(
                    "The {} deviations are {given}; {needed} are needed, one for each tooth.",
                    match list {
                        DeviationList::Pitch => "pitch",
                        DeviationList::OtherFlankPitch => "pitch (other flank)",
                        DeviationList::ProfileSlope => "profile slope",
                        DeviationList::LeadSlope => "lead slope",
                    }
                ),
                None,
            ),
            GearError::HolesOverlap {
                holes, ligament, ..
            } => self.overlap_fault(holes, ligament),
            GearError::HolesBreachRim { hole, ligament, .. } => {
                self.breach_fault(Code::HolesBreachRim, hole, ligament)
            }
            GearError::HolesBreachBore { hole, ligament, .. } => {
                self.breach_fault(Code::HolesBreachBore, hole, ligament)
            }
            GearError::WebOutside {
                inner_radius,
                outer_radius,
                least,
                largest,
            } => self.web_fault([inner_radius, outer_radius], [least, largest]),
        }
    }

    /// A tool at the generating profile shift `x_e` leaves next to nothing of the teeth; at `smallest` it undercuts no flank.
    fn undercut_fault(&self, helix: Helix, [x_e, smallest]: [f64; 2]) -> Fault {
        let which = if self.profile_shift == x_e {
            "profile shift"
        } else {
            "generating profile shift"
        };
        let detail = format!(
            "{} teeth at {which} {} are undercut until hardly anything is left of them; a {which} of {} avoids it.",
            self.tooth_count,
            plain(x_e),
            plain(smallest)
        );
        let (field, bound) = self.depth_said(smallest, helix);
        let bound = bound.map(|bound| (bound, Side::AtLeast));
        Fault::new(field, Code::Undercut, detail, bound)
    }

    /// The radii at which a relief with its amount at `end` can start, of a flank between these radii.
    pub(super) fn relief_range(&self, end: ReliefEnd, [form, tip]: [f64; 2]) -> (f64, f64) {
        match end {
            ReliefEnd::Tip => (form, tip - self.least_relief()),
            ReliefEnd::Form => (form + self.least_relief(), tip),
        }
    }

    /// The relief at `place` starts at a radius outside its range on the flank between `ends`, all in meters.
    pub(super) fn relief_fault(
        &self,
        place: ReliefPlace,
        start_radius: f64,
        ends: [f64; 2],
    ) -> Fault {
        let start = self.relief(place).map(|relief| relief.start);
        let end = start.map_or(ReliefEnd::Tip, |start| start.end);
        let (lowest, highest) = self.relief_range(end, ends);
        let detail = format!(
            "The relief starts at radius {} mm; on this flank it can start from {} mm to {} mm.",
            plain(to_mm(start_radius)),
            plain(to_mm(lowest)),
            plain(to_mm(highest))
        );
        let r_b = from_mm(self.base_radius_mm());
        let roll = |radius: f64| (radius.powi(2) - r_b.powi(2)).max(0.0).sqrt();
        // The radius that is nearest, and on which side of it the flank is.
        let (nearest, side) = if start_radius > highest {
            (highest, Side::AtMost)
        } else {
            (lowest, Side::AtLeast)
        };
        let from_end = |tip: f64, form: f64| match end {
            ReliefEnd::Tip => (to_mm(tip), side.other()),
            ReliefEnd::Form => (to_mm(form), side),
        };
        let [form_radius, tip_radius] = ends;
        let bound = match start.map(|start| start.way) {
            Some(StartWay::RadialLength) => from_end(tip_radius - nearest, nearest - form_radius),
            Some(StartWay::RollLength) => from_end(
                roll(tip_radius) - roll(nearest),
                roll(nearest) - roll(form_radius),
            ),
            Some(StartWay::Diameter) | None => (to_mm(2.0 * nearest), side),
            Some(StartWay::RollAngle) => ((roll(nearest) / r_b).to_degrees(), side),
        };
        Fault::new(
            self.relief_start_field(place),
            Code::ReliefTooLong,
            detail,
            Some(bound),
        )
    }
}
