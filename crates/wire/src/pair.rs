//! The pair of a submission, and faults of gears that cannot mesh.

use meshwright_engine::gear::printed::{differ_in_digits_only, last_unit};
use meshwright_engine::gear::{
    Alignment, GearPair, GearPairError, Helix, Member, SolidPair, SolidPairError, SpurGear,
};

use super::declare::{Errors, absent, document, nested, number};
use super::gear::{GearDocument, LeadModificationDocument};
use super::problem::{Code, FieldError};
use super::units::{
    Side, from_mm, from_um, plain, rounded_inward, rounded_to_unit, significant, to_mm,
};
use super::warning::WarningDocument;

document! {
    /// Two spur or helical gears at a center distance, the first driving the second.
    pub struct PairDocument as "Pair", "Gear pair" {
        /// The operating center distance, not the reference one. Teeth have to reach each other with a contact ratio of at least one, without negative backlash
        /// and without interference. A negative backlash within the last digits of printed numbers counts as zero.
        center_distance_mm: f64 = number("Center distance", "mm", 0.5, 52_500.0),
        /// The helix angle at the reference circle: positive where the driving gear is right-handed and the driven one left-handed. Module,
        /// pressure angle, rack and profile shift are those of the normal section then. Other than 0 it needs three dimensions.
        helix_angle_deg: f64 =
            number("Helix angle", "deg", -45.0, 45.0).or(0.0) => in_three_dimensions,
        /// Where the mid plane of the driven face stands from that of the driving one; +z is the side from which the driving gear is seen
        /// to turn counter-clockwise. Other than 0 it needs three dimensions.
        axial_offset_mm: f64 =
            number("Axial offset", "mm", -2_000.0, 2_000.0).or(0.0) => in_three_dimensions,
        /// How the axes stand askew over the common face. It needs three dimensions.
        misalignment_um: Option<MisalignmentDocument> =
            absent(nested("Misalignment"), "none") => in_three_dimensions,
        /// Gear 1, which drives.
        pub driving: GearDocument = nested(""),
        /// Gear 2, which is driven.
        pub driven: GearDocument = nested(""),
    }
}

document! {
    /// How the axes stand askew: by how much the flanks open from the -z end of the common face to its +z end.
    pub struct MisalignmentDocument as "Misalignment", "Misalignment" {
        /// By how much the axes are farther apart, in their plane; along the line of action it is times the sine of the working pressure
        /// angle.
        in_plane_um: f64 = number(
            "Misalignment in the plane of the axes",
            "um",
            -1_000.0,
            1_000.0,
        )
        .or(0.0),
        /// By how much they pass each other, across their plane, positive where the loaded flanks open; along the line of action it is
        /// times the cosine of the working pressure angle.
        out_of_plane_um: f64 = number(
            "Misalignment out of the plane of the axes",
            "um",
            -1_000.0,
            1_000.0,
        )
        .or(0.0),
    }
}

impl PairDocument {
    /// The cosine of the helix angle at the base circles: sin β_b = sin β cos α_n.
    fn cos_base_helix(&self) -> f64 {
        let sin = self.helix_angle_deg.to_radians().sin();
        let sin = sin * self.driving.pressure_angle_deg.to_radians().cos();
        (1.0 - sin * sin).sqrt()
    }

    /// The gear `member`.
    pub fn gear(&self, member: Member) -> &GearDocument {
        match member {
            Member::Driving => &self.driving,
            Member::Driven => &self.driven,
        }
    }

    /// The gear `member`, to be changed.
    pub fn gear_mut(&mut self, member: Member) -> &mut GearDocument {
        match member {
            Member::Driving => &mut self.driving,
            Member::Driven => &mut self.driven,
        }
    }

    /// The helix of the gear `member`.
    pub fn helix(&self, member: Member) -> Helix {
        let beta = self.helix_angle_deg.to_radians();
        Helix::right(match member {
            Member::Driving => beta,
            Member::Driven => -beta,
        })
    }

    /// Refuses the fields that a plane `method` does not support.
    pub(super) fn refuse_three_dimensions(&self, method: &str, errors: &Errors) {
        let number =
            |value: f64, name: &str| (value != 0.0).then(|| (format!("/pair/{name}"), Some(0.0)));
        let askew = self.misalignment_um.as_ref().filter(|misalignment| {
            misalignment.in_plane_um != 0.0 || misalignment.out_of_plane_um != 0.0
        });
        let own = [
            // Without its helix it would be another pair: the method is the choice.
            number(self.helix_angle_deg, Self::helix_angle_deg.name)
                .map(|(pointer, _)| (pointer, None)),
            number(self.axial_offset_mm, Self::axial_offset_mm.name),
            askew.map(|_| (format!("/pair/{}", Self::misalignment_um.name), None)),
        ];
        let of_gears = [&self.driving, &self.driven].into_iter().zip(Member::BOTH);
        let of_gears =
            of_gears.flat_map(|(gear, member)| gear.beyond_the_plane(&format!("/pair/{member}")));
        for (pointer, nearest) in own.into_iter().flatten().chain(of_gears) {
            let detail = format!(
                "{pointer} is not known to the plane, in which {method} computes. The method three_dimensional knows it."
            );
            errors.push(
                FieldError::new(pointer, Code::NeedsThreeDimensions, detail).nearest(nearest),
            );
        }
    }

    /// The pair along its faces, if its gears can be made and mesh; faults are reported to `errors`.
    pub(super) fn to_solid_pair(&self, growth: f64, errors: &Errors) -> Option<SolidPair> {
        let [driving, driven] = self.made(errors, |gear, member| {
            gear.to_solid(&format!("/pair/{member}"), self.helix(member))
        })?;
        let sections = [driving.section().clone(), driven.section().clone()];
        let gears = [driving, driven];
        let overlap_ratio = SolidPair::overlap_of(&gears, from_mm(self.axial_offset_mm));
        let askew = self.misalignment_um.as_ref();
        let alignment = Alignment {
            axial_offset: from_mm(self.axial_offset_mm),
            in_plane: askew.map_or(0.0, |askew| from_um(askew.in_plane_um)),
            out_of_plane: askew.map_or(0.0, |askew| from_um(askew.out_of_plane_um)),
        };
        let pair = SolidPair::new(
            gears,
            [self.driving.leads(), self.driven.leads()],
            growth * from_mm(self.center_distance_mm),
            alignment,
        );
        let found = match pair {
            Ok(pair) => return Some(pair),
            Err(SolidPairError::Section(error)) => self.refused(
                [&sections[0], &sections[1]],
                (overlap_ratio, growth),
                &error,
            ),
            Err(SolidPairError::FacesDoNotOverlap {
                axial_offset,
                nearest,
            }) => {
                let pointer = format!("/pair/{}", Self::axial_offset_mm.name);
                let side = if nearest < 0.0 {
                    Side::AtLeast
                } else {
                    Side::AtMost
                };
                let nearest = rounded_inward(to_mm(nearest), side, 0);
                let detail = format!(
                    "{pointer} is {} mm, which leaves less than a tenth of the narrower face in common; {} mm leaves so much.",
                    plain(to_mm(axial_offset)),
                    plain(nearest)
                );
                let error = FieldError::new(pointer, Code::FacesDoNotOverlap, detail);
                Some(error.nearest(nearest))
            }
            Err(SolidPairError::TeethWindAround {
                member,
                teeth,
                total_contact_ratio,
                narrower,
                nearest,
            }) => {
                let pointer = format!("/pair/{narrower}/{}", GearDocument::face_width_mm.name);
                let nearest = rounded_inward(to_mm(nearest), Side::AtMost, 0);
                let detail = format!(
                    "The total contact ratio is {}, and the {member} gear has {teeth} teeth: nearly all are in mesh at once, some of them twice. A common face of {} mm leaves two out of it.",
                    plain(significant(total_contact_ratio, 4)),
                    plain(nearest)
                );
                let error = FieldError::new(pointer, Code::OutOfRange, detail);
                Some(error.nearest(nearest))
            }
            Err(SolidPairError::Lead { member, error }) => {
                let pointer = format!("/pair/{member}/lead_modifications");
                Some(LeadModificationDocument::fault(&pointer, &error))
            }
            // Both hands come from one angle.
            Err(SolidPairError::HelixMismatch { .. }) => None,
        };
        errors.report(Err(found))
    }

    /// The pair, if its gears can be made and mesh; faults are reported to `errors`. Its center distance is `growth` times the cold one.
    pub(super) fn to_pair(&self, growth: f64, errors: &Errors) -> Option<GearPair> {
        let [driving, driven] = self.made(errors, |gear, member| {
            gear.to_gear(&format!("/pair/{member}"), Helix::STRAIGHT)
        })?;
        let (one, other) = (driving.clone(), driven.clone());
        let distance = growth * from_mm(self.center_distance_mm);
        let pair = GearPair::new(one, other, distance);
        let refused = |error| self.refused([&driving, &driven], (0.0, growth), &error);
        errors.report(pair.map_err(refused))
    }

    /// Why `gears` of so much overlap cannot mesh at a center distance that has grown by `growth`.
    fn refused(
        &self,
        gears: [&SpurGear; 2],
        (overlap_ratio, growth): (f64, f64),
        error: &GearPairError,
    ) -> Option<FieldError> {
        if growth == 1.0 {
            return self.field_error(gears, overlap_ratio, error);
        }
        let warm = Self {
            center_distance_mm: growth * self.center_distance_mm,
            ..self.clone()
        };
        let error = warm.field_error(gears, overlap_ratio, error)?;
        let detail = format!("In lengths of the warm gears: {}", error.detail);
        Some(FieldError::new("/running", error.code, detail))
    }

    /// Both gears, if they can be made and could mesh; faults are reported to `errors`.
    fn made<G>(
        &self,
        errors: &Errors,
        make: impl Fn(&GearDocument, Member) -> Result<G, Vec<FieldError>>,
    ) -> Option<[G; 2]> {
        let mismatches = self.mismatches();
        let Self {
            driving, driven, ..
        } = &self.with_all_digits();
        let matched = errors.report(if mismatches.is_empty() {
            Ok(())
        } else {
            Err(mismatches)
        });
        let driving = errors.report(make(driving, Member::Driving));
        let driven = errors.report(make(driven, Member::Driven));
        matched?;
        Some([driving?, driven?])
    }

    fn field_error(
        &self,
        [driving, driven]: [&SpurGear; 2],
        overlap_ratio: f64,
        error: &GearPairError,
    ) -> Option<FieldError> {
        let mm = |value: f64| plain(to_mm(value));
        let a = plain(self.center_distance_mm);
        let is_backlash = matches!(error, GearPairError::NegativeBacklash { .. });
        let nearest = |bound: f64, side: Side| {
            let ends = (to_mm(bound), side);
            nearest_distance([driving, driven], overlap_ratio, ends, is_backlash)
        };
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
                    "At the center distance {a} mm the {}contact ratio is {}",
                    if overlap_ratio > 0.0 { "total " } else { "" },
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
                        mm(backlash * self.cos_base_helix())
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
            // The digits of such a distance are those that matter.
            (Some(least), Code::NegativeBacklash) => format!("; it takes at least {least} mm."),
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

    /// Fields that have to be equal in both gears and are written differently.
    fn unlike(&self) -> impl Iterator<Item = Unlike> {
        let of_both = |value: fn(&GearDocument) -> f64| [value(&self.driving), value(&self.driven)];
        let same = [
            Unlike {
                what: "module",
                unit: GearDocument::module_mm.spec.unit,
                code: Code::ModuleMismatch,
                name: GearDocument::module_mm.name,
                values: of_both(|gear| gear.module_mm),
            },
            Unlike {
                what: "pressure angle",
                unit: GearDocument::pressure_angle_deg.spec.unit,
                code: Code::PressureAngleMismatch,
                name: GearDocument::pressure_angle_deg.name,
                values: of_both(|gear| gear.pressure_angle_deg),
            },
        ];
        same.into_iter()
            .filter(|Unlike { values, .. }| values[0] != values[1])
    }

    /// Faults of fields that have to be equal in both gears.
    fn mismatches(&self) -> Vec<FieldError> {
        let different = self.unlike().filter(|unlike| unlike.taken().is_none());
        let refusals = different.map(|unlike| {
            let Unlike {
                what,
                unit,
                code,
                name,
                values: [driving, driven],
            } = unlike;
            // All digits, because those that differ may be the last.
            let detail = format!(
                "The driven gear has {what} {driven} {unit}, the driving gear {driving} {unit}; gears that mesh have the same."
            );
            FieldError::new(format!("/pair/driven/{name}"), code, detail).nearest(driving)
        });
        refusals.collect()
    }

    /// The same pair with module and pressure angle as the gear has them that says more of their digits.
    fn with_all_digits(&self) -> Self {
        let mut pair = self.clone();
        for unlike in self.unlike() {
            let Some((value, _)) = unlike.taken() else {
                continue;
            };
            for gear in [&mut pair.driving, &mut pair.driven] {
                match unlike.code {
                    Code::ModuleMismatch => gear.module_mm = value,
                    _ => gear.pressure_angle_deg = value,
                }
            }
        }
        pair
    }

    /// Of module and pressure angle which value is taken for a gear that says fewer digits of it.
    pub(super) fn digits_taken(&self) -> Vec<WarningDocument> {
        let taken = self.unlike().filter_map(|unlike| {
            let (value, member) = unlike.taken()?;
            let Unlike {
                what, unit, values, ..
            } = unlike;
            let detail = format!(
                "The {member} gear has {what} {} {unit}, the {} gear {value} {unit}: one value but for the digits printed; {value} {unit} is taken for both.",
                values[member.index()],
                member.other()
            );
            Some(WarningDocument::of_digits(member, (value, unit), detail))
        });
        taken.collect()
    }
}

/// A number that is not written alike in both gears.
struct Unlike {
    what: &'static str,
    unit: &'static str,
    code: Code,
    name: &'static str,
    values: [f64; 2],
}

impl Unlike {
    /// The value with more digits, where the two differ in nothing else, and the gear that has fewer.
    fn taken(&self) -> Option<(f64, Member)> {
        let [driving, driven] = self.values;
        if !differ_in_digits_only(driving, driven) {
            return None;
        }
        Some(if last_unit(driven) < last_unit(driving) {
            (driven, Member::Driving)
        } else {
            (driving, Member::Driven)
        })
    }
}

/// True if the teeth of `gear` reduce the backlash of its drawing.
fn deviates(gear: &SpurGear) -> bool {
    !gear.deviations().is_none()
}

/// The first center distance in mm, from the bound inward in units of the fifth digit, at which the gears mesh. Where the `backlash` decides, the
/// unit is a tenth of a micrometer, which is less than printed digits leave open.
fn nearest_distance(
    gears: [&SpurGear; 2],
    overlap_ratio: f64,
    (bound, side): (f64, Side),
    backlash: bool,
) -> Option<f64> {
    const MOST_STEPS: u32 = 3;
    let rounded = |steps| {
        if backlash {
            rounded_to_unit(bound, side, steps, -4)
        } else {
            rounded_inward(bound, side, steps)
        }
    };
    let meshes = |distance: f64| {
        let [driving, driven] = gears.map(SpurGear::clone);
        GearPair::overlapping(driving, driven, from_mm(distance), overlap_ratio).is_ok()
    };
    (0..MOST_STEPS)
        .map(rounded)
        .find(|&distance| meshes(distance))
}
