//! The pair of a submission, and what is wrong with gears that cannot mesh.

use meshwright_engine::gear::{GearPair, GearPairError, Member, SpurGear};

use super::declare::{Errors, document, nested, number};
use super::gear::GearDocument;
use super::problem::{Code, FieldError};
use super::units::{Side, from_mm, plain, rounded_inward, to_mm};

document! {
    /// Two spur gears at a center distance, the first driving the second.
    pub struct PairDocument as "Pair", "Gear pair" {
        /// The operating center distance, not the reference one. Teeth have to reach each other with a contact ratio of at least one,
        /// without negative backlash and without interference.
        center_distance_mm: f64 = number("Center distance", "mm", 0.5, 20_000.0),
        /// Gear 1, which drives.
        pub(super) driving: GearDocument = nested(""),
        /// Gear 2, which is driven.
        pub(super) driven: GearDocument = nested(""),
    }
}

impl PairDocument {
    /// The pair, if its gears can be made and mesh; what prevents it is reported to `errors`.
    pub(super) fn to_pair(&self, errors: &Errors) -> Option<GearPair> {
        let made =
            |gear: &GearDocument, member: Member| match gear.to_gear(&format!("/pair/{member}")) {
                Ok(gear) => Some(gear),
                Err(faults) => {
                    faults.into_iter().for_each(|fault| errors.push(fault));
                    None
                }
            };
        let mismatches = self.mismatches();
        let matched = mismatches.is_empty();
        mismatches
            .into_iter()
            .for_each(|mismatch| errors.push(mismatch));
        let driving = made(&self.driving, Member::Driving);
        let driven = made(&self.driven, Member::Driven);
        let (driving, driven) = (driving?, driven?);
        if !matched {
            return None;
        }
        match GearPair::new(
            driving.clone(),
            driven.clone(),
            from_mm(self.center_distance_mm),
        ) {
            Ok(pair) => Some(pair),
            Err(error) => {
                self.told(&driving, &driven, &error)
                    .into_iter()
                    .for_each(|told| errors.push(told));
                None
            }
        }
    }

    fn told(
        &self,
        driving: &SpurGear,
        driven: &SpurGear,
        error: &GearPairError,
    ) -> Option<FieldError> {
        let mm = |value: f64| plain(to_mm(value));
        let a = plain(self.center_distance_mm);
        let nearest =
            |bound: f64, side: Side| nearest_distance(driving, driven, to_mm(bound), side);
        let (code, detail, nearest) = match *error {
            GearPairError::ModuleMismatch { .. } | GearPairError::PressureAngleMismatch { .. } => {
                return self.mismatches().into_iter().next();
            }
            GearPairError::TeethDoNotReach {
                tip_radii, largest, ..
            } => (
                Code::TeethDoNotReach,
                format!(
                    "The center distance {a} mm is not less than the tip radii together ({} mm)",
                    mm(tip_radii)
                ),
                nearest(largest, Side::AtMost),
            ),
            GearPairError::ContactRatioBelowOne {
                contact_ratio,
                largest,
            } => (
                Code::ContactRatioBelowOne,
                format!(
                    "At the center distance {a} mm the contact ratio is {}",
                    plain(contact_ratio)
                ),
                nearest(largest, Side::AtMost),
            ),
            GearPairError::NegativeBacklash { backlash, smallest } => (
                Code::NegativeBacklash,
                if backlash.is_finite() {
                    let worst = if deviates(driving) || deviates(driven) {
                        " at the worst of the deviations"
                    } else {
                        ""
                    };
                    format!(
                        "At the center distance {a} mm the normal backlash is {} mm{worst}",
                        mm(backlash)
                    )
                } else {
                    format!(
                        "The center distance {a} mm is not more than the base radii together: there is no line of action"
                    )
                },
                nearest(smallest, Side::AtLeast),
            ),
            GearPairError::Interference { member, smallest } => (
                Code::Interference,
                format!(
                    "At the center distance {a} mm the tips of the {} gear reach below the flanks of the {member} gear",
                    member.other()
                ),
                nearest(smallest, Side::AtLeast),
            ),
        };
        let advice = match (nearest, code) {
            (Some(most), Code::TeethDoNotReach | Code::ContactRatioBelowOne) => {
                format!("; continuous meshing needs at most {} mm.", plain(most))
            }
            (Some(least), _) => format!("; it takes at least {} mm.", plain(least)),
            (None, _) => "; these two gears mesh at no center distance.".to_owned(),
        };
        let error = FieldError::new(
            "/pair/center_distance_mm",
            code,
            format!("{detail}{advice}"),
        );
        Some(error.nearest(nearest))
    }

    /// What has to be the same in both gears and is not.
    fn mismatches(&self) -> Vec<FieldError> {
        let (driving, driven) = (&self.driving, &self.driven);
        let mut errors = Vec::new();
        if driving.module_mm != driven.module_mm {
            let detail = format!(
                "The driven gear has module {} mm, the driving gear {} mm; gears that mesh have the same.",
                plain(driven.module_mm),
                plain(driving.module_mm)
            );
            errors.push(
                FieldError::new("/pair/driven/module_mm", Code::ModuleMismatch, detail)
                    .nearest(driving.module_mm),
            );
        }
        if driving.pressure_angle_deg != driven.pressure_angle_deg {
            let detail = format!(
                "The driven gear has pressure angle {} deg, the driving gear {} deg; gears that mesh have the same.",
                plain(driven.pressure_angle_deg),
                plain(driving.pressure_angle_deg)
            );
            errors.push(
                FieldError::new(
                    "/pair/driven/pressure_angle_deg",
                    Code::PressureAngleMismatch,
                    detail,
                )
                .nearest(driving.pressure_angle_deg),
            );
        }
        errors
    }
}

/// Whether the teeth of `gear` take from the backlash what its drawing leaves.
fn deviates(gear: &SpurGear) -> bool {
    !gear.deviations().is_none()
}

/// The first center distance in mm, from `bound` inward in units of the fifth digit, at which the gears mesh.
fn nearest_distance(driving: &SpurGear, driven: &SpurGear, bound: f64, side: Side) -> Option<f64> {
    const MOST_STEPS: u32 = 3;
    (0..MOST_STEPS)
        .map(|steps| rounded_inward(bound, side, steps))
        .find(|&distance| GearPair::new(driving.clone(), driven.clone(), from_mm(distance)).is_ok())
}
