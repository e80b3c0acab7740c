//! Warnings to read with the numbers.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use meshwright_engine::analysis::{
    FEW_POSITIONS, FormulaQuantity, FormulaRange, PLANE_RIM, PLANE_WEB, Warning,
};
use meshwright_engine::gear::Member;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

pub use super::gear_name::GearName;
use super::results::{CrossingDocument, ModeDocument};
use super::units::{Side, plain, rounded_to_unit, significant, to_mm, to_mpa, to_n_per_mm, to_um};

/// A warning: the result stands, but with something to know.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Warning, title = "Warning")]
pub struct WarningDocument {
    /// The stable code.
    pub code: WarningCode,
    /// The warning with its numbers.
    pub detail: String,
    /// The gear, where it concerns one: `driving` or `driven`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gear: Option<GearName>,
    /// The number behind it, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The unit of that number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<Cow<'static, str>>,
    /// Values that would help, by the paths of their fields in a submission, ready to be taken over.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schema(required = false)]
    pub changes: BTreeMap<String, f64>,
    /// Where the service has a guide that says more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guide: Option<Cow<'static, str>>,
}

/// The stable code of a warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(title = "Warning code")]
pub enum WarningCode {
    /// The teeth fit without any backlash; only the loaded flanks are solved.
    ZeroBacklash,
    /// Module or pressure angle of the gears differ in printed digits only; the value with more digits is taken for both.
    PrintedDigits,
    /// The tips of a gear stand nearer to the root circle of the other one than the racks leave them, by more than 0.05 modules: nobody shortened them.
    SmallTipClearance,
    /// Undercut ends a flank before the mate's tip does: the path of contact is shorter.
    UndercutShortensPath,
    /// The material around the holes is thinner than one module.
    ThinLigament,
    /// A web or its rim is thinner than a plane model can stand for.
    WebOutsidePlaneModel,
    /// The motion grows without bound at some speeds.
    MotionUnbounded,
    /// The motion is largest at the lowest or the highest speed asked for: beyond it may be more.
    MotionAtEndOfSpeeds,
    /// The motion loads the mesh beyond the force table, which goes on straight there.
    LoadBeyondForceTable,
    /// Rims and teeth have inertia outside the webs that carry them, which the motion takes to stand on the hubs.
    RimInertiaOnHub,
    /// Orders of the mesh meet natural modes of a gear within the speeds asked.
    ModesMet,
    /// A tip corner carries load off the line of action.
    TipCornerContact,
    /// The contact reaches the fillet of a gear, where it is not followed.
    ContactReachesFillet,
    /// The face widths differ by more than a plane model can stand for.
    FaceWidthsDiffer,
    /// The contact presses harder than materials bear in proportion.
    ContactBeyondElasticity,
    /// The largest contact pressure stands at a kink of a profile modification, which a run-in would round.
    PressureAtKink,
    /// Too few positions a mesh period: the orders of its higher multiples are wrong, and extremes of the stiffness may be missed.
    FewPositions,
    /// The span is not whole true periods.
    PartialSpan,
    /// A formula is used outside the range for which it was published.
    FormulaRange,
    /// The method does not see the holes that the drawing has.
    HolesNotSeen,
    /// A gear comes loose from the shaft that it is pressed onto.
    FitComesLoose,
    /// The projected decomposition leaves out too much of the effect of the holes.
    ProjectionDoubtful,
    /// The decomposition leaves out too much of how the holed blanks turn.
    DecompositionDoubtful,
}

/// Writes the code as it stands on the wire.
impl fmt::Display for WarningCode {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.serialize(formatter)
    }
}

impl WarningDocument {
    /// The document of `warning`.
    pub fn of(warning: &Warning) -> Self {
        use WarningCode as Code;
        let mut changes = BTreeMap::new();
        let (code, gear, number, detail) = match *warning {
            Warning::ZeroBacklash { moved_back } => (
                Code::ZeroBacklash,
                None,
                None,
                // A tenth of a nanometer is rounding of our own.
                if moved_back < 1e-10 {
                    "The nominal backlash is zero; only the loaded flanks are solved.".to_owned()
                } else {
                    format!(
                        "The backlash is {} um short of zero, no more than the last printed digits explain: the other flanks are taken so much farther back, and the backlash is zero. Only the loaded flanks are solved.",
                        plain(significant(to_um(moved_back), 2))
                    )
                },
            ),
            Warning::SmallTipClearance {
                member,
                clearance,
                of_racks,
                shortened,
            } => {
                let sentence = small_clearance(member, [clearance, of_racks]);
                let clearance = to_mm(clearance);
                let advice = match shortened {
                    None => {
                        "A larger dedendum of the other gear or a smaller addendum leaves more."
                            .to_owned()
                    }
                    Some((shortening, diameters)) => {
                        let [driving, driven] = diameters.map(tip_diameter);
                        changes = Member::BOTH
                            .map(|member| format!("/pair/{member}/tip_diameter_mm"))
                            .into_iter()
                            .zip([driving, driven])
                            .collect();
                        format!(
                            "Gear programs shorten the tips of both gears by {} mm so that the clearance of the racks stays; their tip diameters are {driving} mm and {driven} mm then.",
                            plain(significant(to_mm(shortening), 4)),
                        )
                    }
                };
                (
                    Code::SmallTipClearance,
                    Some(member),
                    Some((clearance, "mm")),
                    format!("{sentence} {advice}"),
                )
            }
            Warning::UndercutShortensPath {
                member,
                roll_length,
            } => (
                Code::UndercutShortensPath,
                Some(member),
                Some((to_mm(roll_length), "mm")),
                format!(
                    "The rack undercuts the teeth of the {member} gear: their flanks begin above where the tips of the other gear would touch them first, and the unloaded path of contact loses {} mm of roll. The corner at which they begin carries under load; more profile shift avoids it.",
                    plain(significant(to_mm(roll_length), 3))
                ),
            ),
            Warning::ThinLigament { member, ligament } => (
                Code::ThinLigament,
                Some(member),
                Some((to_mm(ligament), "mm")),
                format!(
                    "The holes of the {member} gear leave {} mm, less than one module; stresses there are high.",
                    plain(to_mm(ligament))
                ),
            ),
            Warning::WebOutsidePlaneModel { member, web, rim } => (
                Code::WebOutsidePlaneModel,
                Some(member),
                Some((web, "1")),
                outside_plane(member, web, rim),
            ),
            Warning::MotionUnbounded { speeds } => {
                let [low, high] = speeds.map(|speed| plain((60.0 * speed).round()));
                let detail = format!(
                    "Between {low} and {high} 1/min the motion grows without bound: the mesh stiffness pumps it more than damping takes from it. It is told until it is a thousand times the static deflection. More damping, more relief or some backlash limits it."
                );
                (Code::MotionUnbounded, None, None, detail)
            }
            Warning::MotionAtEndOfSpeeds {
                speed,
                is_lowest,
                peak_to_peak,
            } => {
                let at = plain((60.0 * speed).round());
                let end = if is_lowest { "lowest" } else { "highest" };
                let largest = to_um(peak_to_peak);
                let detail = format!(
                    "The motion is largest at {at} 1/min, the {end} speed asked for: {} um peak to peak. Beyond it may be more; ask for speeds on the other side of it.",
                    plain(significant(largest, 3))
                );
                (
                    Code::MotionAtEndOfSpeeds,
                    None,
                    Some((largest, "um")),
                    detail,
                )
            }
            Warning::LoadBeyondForceTable {
                speeds,
                ratio,
                largest_output_torque,
            } => {
                let [low, high] = speeds.map(|speed| plain((60.0 * speed).round()));
                let [times, largest, wanted] = [
                    ratio,
                    largest_output_torque,
                    1.1 * ratio * largest_output_torque,
                ]
                .map(|value| plain(significant(value, 3)));
                let detail = format!(
                    "Between {low} and {high} 1/min the force between the gears reaches {times} times the largest load of the force table, that of {largest} N m. Beyond it the table goes on straight, so that force and motion are not what they are there. A table for /force_table/largest_output_torque_n_m {wanted} reaches so far."
                );
                (Code::LoadBeyondForceTable, None, Some((ratio, "1")), detail)
            }
            Warning::RimInertiaOnHub {
                natural_frequency,
                of_rims,
            } => {
                let [used, estimate] =
                    [natural_frequency, of_rims].map(|hertz| plain(significant(hertz, 4)));
                let detail = format!(
                    "The run-up has the inertia of rims and teeth on the hubs, so that its natural frequency is {used} Hz. With the inertia where it is, outside the webs, it is about {estimate} Hz: speeds of resonances are off by as much."
                );
                (Code::RimInertiaOnHub, None, Some((of_rims, "Hz")), detail)
            }
            Warning::TipCornerContact {
                member,
                largest_share,
            } => (
                Code::TipCornerContact,
                Some(member),
                Some((100.0 * largest_share, "%")),
                format!(
                    "The tip corner of the {member} gear touches off the line of action and carries up to {} % of the load; more tip relief avoids it.",
                    plain((1000.0 * largest_share).round() / 10.0)
                ),
            ),
            Warning::ContactReachesFillet { member } => (
                Code::ContactReachesFillet,
                Some(member),
                None,
                format!(
                    "The contact reaches the fillet of the {member} gear, where it is not followed; a larger center distance or a smaller torque avoids it."
                ),
            ),
            Warning::FaceWidthsDiffer { ratio } => (
                Code::FaceWidthsDiffer,
                None,
                Some((ratio, "1")),
                format!(
                    "One face is {} times as wide as the other: away from the contact each gear is taken for a plate of its own width, which makes the wider one too stiff.",
                    plain(ratio)
                ),
            ),
            Warning::ContactBeyondElasticity {
                member,
                pressure,
                limit,
            } => (
                Code::ContactBeyondElasticity,
                Some(member),
                Some((to_mpa(pressure), "MPa")),
                format!(
                    "The contact pressure comes to {} MPa, and the material of the {member} gear stays elastic up to about {} MPa: 1.67 times its yield strength, or where that is not given a part of its Young's modulus.",
                    plain(to_mpa(pressure).round()),
                    plain(significant(to_mpa(limit), 3))
                ),
            ),
            Warning::PressureAtKink {
                member,
                diameter,
                pressure,
            } => (
                Code::PressureAtKink,
                Some(member),
                Some((to_mpa(pressure), "MPa")),
                format!(
                    "The largest contact pressure, {} MPa, stands at a kink of the profile of the {member} gear, at a diameter of {} mm: a running-in rounds the kink and lowers the pressure. A parabolic relief has none.",
                    plain(to_mpa(pressure).round()),
                    plain(significant(to_mm(diameter), 6))
                ),
            ),
            Warning::FewPositions {
                positions,
                open: Some(open),
            } => (
                Code::FewPositions,
                None,
                Some((f64::from(positions), "positions")),
                format!(
                    "{positions} positions a mesh period, and those that were solved between them, leave the peak-to-peak of the transmission error open by about {} % of it, by their own estimate. More positions find it.",
                    plain(significant(100.0 * open, 2))
                ),
            ),
            Warning::FewPositions {
                positions,
                open: None,
            } => (
                Code::FewPositions,
                None,
                Some((f64::from(positions), "positions")),
                format!(
                    "{positions} positions a mesh period tell mesh harmonics up to the {}th at most, and the upper ones wrongly where a pair takes up or leaves the load between two of them; between so few the stiffness may have extremes that are not found. Orders and the peak-to-peak of the stiffness want {FEW_POSITIONS} or more.",
                    positions / 2
                ),
            ),
            Warning::PartialSpan { span, period } => (
                Code::PartialSpan,
                None,
                Some((f64::from(span), "mesh periods")),
                format!(
                    "The span of {span} mesh periods is not whole true periods of {period}: statistics are partial, and there is no spectrum."
                ),
            ),
            Warning::FormulaRange(found) => {
                let (value, unit, detail) = out_of_range(&found);
                (
                    Code::FormulaRange,
                    found.member,
                    Some((value, unit)),
                    detail,
                )
            }
            Warning::HolesNotSeen => (
                Code::HolesNotSeen,
                None,
                None,
                "This method does not see holes: its curves are those of solid blanks.".to_owned(),
            ),
            Warning::FitComesLoose { member, speed } => (
                Code::FitComesLoose,
                Some(member),
                Some((significant(60.0 * speed, 4), "1/min")),
                format!(
                    "The {member} gear comes loose from the shaft that it is pressed onto: from {} 1/min of the driving gear on, the mean pressure of the fit is gone. At speed its bore is taken to be free.",
                    plain(significant(60.0 * speed, 4))
                ),
            ),
            Warning::ProjectionDoubtful {
                error,
                part_of_mean,
                part_of_peak_to_peak,
            } => (
                Code::ProjectionDoubtful,
                None,
                Some((to_um(error), "um")),
                format!(
                    "Where holes or deviations let teeth touch earlier or later the projected method is up to {} um off the exact transmission error, {} % of its mean and {} % of its peak-to-peak; flexible and three_dimensional are exact.",
                    plain(significant(to_um(error), 3)),
                    plain(significant(100.0 * part_of_mean, 2)),
                    plain(significant(100.0 * part_of_peak_to_peak, 2))
                ),
            ),
            Warning::DecompositionDoubtful {
                error,
                part_of_peak_to_peak,
            } => (
                Code::DecompositionDoubtful,
                None,
                Some((to_um(error), "um")),
                format!(
                    "One harmonic for each holed blank leaves up to {} um of the exact transmission error, {} % of its peak-to-peak: what the holes do changes from tooth to tooth, as where they stand near the roots. The flexible method is exact.",
                    plain(significant(to_um(error), 3)),
                    plain(significant(100.0 * part_of_peak_to_peak, 2))
                ),
            ),
        };
        Self {
            code,
            detail,
            gear: gear.map(GearName::from),
            value: number.map(|(value, _)| value),
            unit: number.map(|(_, unit)| unit.into()),
            changes,
            guide: code.guide().map(Cow::from),
        }
    }
}

impl WarningDocument {
    /// Where the mesh meets `modes` of `gear`, crossing by crossing, if it does.
    pub(super) fn of_crossings(gear: GearName, modes: &[ModeDocument]) -> Option<Self> {
        let mut crossings: Vec<(&ModeDocument, &CrossingDocument)> = modes
            .iter()
            .flat_map(|mode| mode.crossings.iter().map(move |crossing| (mode, crossing)))
            .collect();
        crossings.sort_by(|(_, one), (_, other)| {
            one.driving_speed_rpm.total_cmp(&other.driving_speed_rpm)
        });
        let (_, first) = crossings.first()?;
        let named = crossings.iter().map(|(mode, crossing)| {
            format!(
                "{} at {} 1/min ({} Hz, n = {}, {}, {})",
                crossing.label,
                plain(significant(crossing.driving_speed_rpm, 4)),
                plain(significant(mode.frequency_hz, 4)),
                mode.nodal_diameters,
                mode.direction.words(),
                crossing.wave.word()
            )
        });
        let named: Vec<String> = named.collect();
        Some(Self {
            code: WarningCode::ModesMet,
            value: Some(first.driving_speed_rpm),
            unit: Some("1/min".into()),
            detail: format!(
                "Within the speeds asked the mesh meets natural modes of the {} gear: {}.",
                gear.word(),
                named.join("; ")
            ),
            gear: Some(gear),
            changes: BTreeMap::new(),
            guide: WarningCode::ModesMet.guide().map(Cow::from),
        })
    }

    /// That `value`, with its unit, is taken for `member`, which says fewer of its digits.
    pub(super) fn of_digits(
        member: Member,
        (value, unit): (f64, &'static str),
        detail: String,
    ) -> Self {
        Self {
            code: WarningCode::PrintedDigits,
            detail,
            gear: Some(member.into()),
            value: Some(value),
            unit: Some(unit.into()),
            changes: BTreeMap::new(),
            guide: None,
        }
    }
}

impl WarningCode {
    /// Where the service says more of it.
    fn guide(self) -> Option<&'static str> {
        match self {
            Self::WebOutsidePlaneModel => Some("/guides/is-my-thin-web-all-right"),
            Self::MotionUnbounded
            | Self::MotionAtEndOfSpeeds
            | Self::LoadBeyondForceTable
            | Self::RimInertiaOnHub
            | Self::ModesMet => Some("/guides/will-it-rattle-or-whine"),
            Self::FitComesLoose => Some("/guides/what-speed-does-to-my-holes"),
            _ => None,
        }
    }
}

/// The value of `found` in the reader's unit, that unit, and the sentence about it.
fn out_of_range(found: &FormulaRange) -> (f64, &'static str, String) {
    let (to_unit, unit): (fn(f64) -> f64, _) = match found.quantity {
        FormulaQuantity::RootHalfAngle => (f64::to_degrees, "deg"),
        FormulaQuantity::LineLoad => (to_n_per_mm, "N/mm"),
        _ => (|value| value, "1"),
    };
    // Four digits are more than a formula's range has.
    let numbers =
        [found.value, found.least, found.greatest].map(|value| significant(to_unit(value), 4));
    let [value, least, greatest] = numbers.map(plain);
    let whose = found
        .member
        .map_or("the pair".to_owned(), |member| format!("the {member} gear"));
    let range = match found.quantity {
        FormulaQuantity::RadiusRatio => format!(
            "root radii of {least} to {greatest} times the bore radius; that of {whose} is {value} times"
        ),
        FormulaQuantity::RootHalfAngle => format!(
            "teeth that span {least} to {greatest} deg to each side at the root circle; those of {whose} span {value} deg"
        ),
        FormulaQuantity::BodyFunction(name) => {
            format!(
                "bodies with {least} to {greatest} for its function {name}; {whose} has {value}"
            )
        }
        FormulaQuantity::ShiftDifference => {
            format!("pinions with at least the profile shift of their wheel; x1 - x2 is {value}")
        }
        FormulaQuantity::ShiftSum => {
            format!("profile shifts x1 + x2 of {least} to {greatest}; here the sum is {value}")
        }
        FormulaQuantity::LineLoad => format!(
            "a tangential force of at least {least} N/mm of face width; the least torque gives {value} N/mm, where the standard lowers the stiffness and this method does not"
        ),
    };
    let formula = found.quantity.formula().to_string();
    let (first, rest) = formula.split_at(1);
    let sentence = format!("{}{rest} was published for {range}.", first.to_uppercase());
    (numbers[0], unit, sentence)
}

/// How little room the tips of a gear have.
fn small_clearance(member: Member, [clearance, of_racks]: [f64; 2]) -> String {
    let other = member.other();
    let mm = |length: f64| plain(significant(to_mm(length), 4));
    let racks = mm(of_racks);
    if clearance < 0.0 {
        format!(
            "The tips of the {member} gear reach {} mm below the root circle of the {other} gear; the racks leave a clearance of {racks} mm.",
            mm(-clearance)
        )
    } else {
        format!(
            "The tips of the {member} gear clear the root circle of the {other} gear by {} mm; the racks leave {racks} mm.",
            mm(clearance)
        )
    }
}

/// A tip diameter in mm as drawings have it, no larger than this one in meters.
fn tip_diameter(diameter: f64) -> f64 {
    rounded_to_unit(to_mm(diameter), Side::AtMost, 0, -3)
}

/// Advice about a web with `web` times the thickness of the face width, under a rim of `rim` modules.
fn outside_plane(member: Member, web: f64, rim: f64) -> String {
    let [[web_plane, web_none], [rim_plane, rim_none]] = [PLANE_WEB, PLANE_RIM];
    let advice = if web < web_none || rim < rim_none {
        "no plane will do; the three-dimensional method (three_dimensional) does"
    } else {
        "compare two such gears by these numbers, and ask the method three_dimensional for the numbers themselves"
    };
    format!(
        "The web of the {member} gear is {} times as thick as its face is wide, its rim {} modules: {advice}. A plane stands for webs from {web_plane} times the face width and rims from {rim_plane} modules on.",
        plain(significant(web, 3)),
        plain(significant(rim, 3)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{example, parse, with};

    fn document(quantity: FormulaQuantity, member: Option<Member>, value: f64) -> WarningDocument {
        let [least, greatest] = match quantity {
            FormulaQuantity::RootHalfAngle => [0.01, 0.12],
            _ => [100e3, f64::INFINITY],
        };
        WarningDocument::of(&Warning::FormulaRange(FormulaRange {
            quantity,
            member,
            value,
            least,
            greatest,
        }))
    }

    #[test]
    fn a_formula_outside_its_range_is_told_with_its_number_in_the_readers_unit() {
        let warning = document(FormulaQuantity::RootHalfAngle, Some(Member::Driven), 0.13);
        assert_eq!(
            warning.detail,
            "The gear body of Sainsot, Velex and Duverger was published for teeth that span 0.573 to 6.875 deg to each side at the root circle; those of the driven gear span 7.448 deg."
        );
        assert_eq!(
            (warning.gear, warning.value, warning.unit.as_deref()),
            (Some(GearName::Driven), Some(7.448), Some("deg"))
        );
    }

    #[test]
    fn a_web_that_a_plane_does_not_stand_for_is_told_with_the_figures_of_the_guide() {
        let warned = |thickness_mm: f64, outer_radius_mm: f64| {
            let changes = [
                ("/pair/driven/blank/holes", serde_json::Value::Null),
                ("/pair/driven/blank/web/thickness_mm", thickness_mm.into()),
                (
                    "/pair/driven/blank/web/outer_radius_mm",
                    outer_radius_mm.into(),
                ),
            ];
            let submission = parse(&with(example("web"), &changes));
            let warnings = crate::validate(&submission.expect("valid")).warnings;
            let found = warnings
                .into_iter()
                .find(|warning| warning.code == WarningCode::WebOutsidePlaneModel);
            found.map(|warning| warning.detail)
        };
        // A face of 20 mm, a root radius of 47.5 mm, module 2 mm: the limits are 8 mm and 4 mm, 40.5 mm and 43.5 mm.
        assert_eq!(warned(8.0, 40.5), None);
        assert_eq!(warned(20.0, 43.0), None, "no web");
        let thin = warned(7.2, 40.5).expect("below 0.4");
        assert!(
            thin.contains("0.36 times") && thin.contains("compare two"),
            "{thin}"
        );
        let rim = warned(8.0, 42.2).expect("2.65 modules");
        assert!(
            rim.contains("2.65 modules") && rim.contains("compare two"),
            "{rim}"
        );
        for (thickness, radius) in [(3.9, 40.5), (8.0, 43.6)] {
            assert!(
                warned(thickness, radius)
                    .expect("far outside")
                    .contains("three-dimensional")
            );
        }
    }

    #[test]
    fn what_a_run_up_leaves_open_is_told_with_its_numbers() {
        let beyond = WarningDocument::of(&Warning::LoadBeyondForceTable {
            speeds: [80.0, 90.5],
            ratio: 1.0402,
            largest_output_torque: 230.0,
        });
        assert_eq!(
            (beyond.value, beyond.unit.as_deref()),
            (Some(1.0402), Some("1"))
        );
        for said in [
            "Between 4800 and 5430 1/min",
            "1.04 times the largest load of the force table, that of 230 N m",
            "/force_table/largest_output_torque_n_m 263",
        ] {
            assert!(beyond.detail.contains(said), "{said}: {}", beyond.detail);
        }
        let rims = WarningDocument::of(&Warning::RimInertiaOnHub {
            natural_frequency: 3975.97,
            of_rims: 5251.56,
        });
        assert_eq!(
            (rims.value, rims.unit.as_deref()),
            (Some(5251.56), Some("Hz"))
        );
        assert!(rims.detail.contains("is 3976 Hz") && rims.detail.contains("about 5252 Hz"));
        let end = WarningDocument::of(&Warning::MotionAtEndOfSpeeds {
            speed: 8000.0 / 60.0,
            is_lowest: false,
            peak_to_peak: 40.751e-6,
        });
        let said = "largest at 8000 1/min, the highest speed asked for: 40.8 um";
        assert!(end.detail.contains(said), "{}", end.detail);
        for warning in [beyond, rims, end] {
            assert_eq!(
                warning.guide.as_deref(),
                Some("/guides/will-it-rattle-or-whine")
            );
        }
    }

    #[test]
    fn few_positions_are_warned_of_before_anything_is_computed() {
        let warned = |positions: u32| {
            let changes = [(
                "/resolution",
                serde_json::json!({ "positions_per_mesh_period": positions }),
            )];
            let submission = parse(&with(example("web"), &changes));
            let warnings = crate::validate(&submission.expect("valid")).warnings;
            let mut found = warnings.into_iter();
            found.find(|warning| warning.code == WarningCode::FewPositions)
        };
        let few = warned(10).expect("10 are few");
        assert_eq!(
            (few.value, few.unit.as_deref()),
            (Some(10.0), Some("positions"))
        );
        for said in ["up to the 5th", "the peak-to-peak of the stiffness"] {
            assert!(few.detail.contains(said), "{}", few.detail);
        }
        assert_eq!(warned(20), None);
    }

    #[test]
    fn a_kink_under_the_largest_pressure_is_told_with_its_gear_and_diameter() {
        let warning = WarningDocument::of(&Warning::PressureAtKink {
            member: Member::Driving,
            diameter: 102e-3,
            pressure: 1.2345e9,
        });
        assert_eq!(warning.gear, Some(GearName::Driving));
        assert!(warning.detail.contains("1235 MPa") || warning.detail.contains("1234 MPa"));
        assert!(warning.detail.contains("102 mm"), "{}", warning.detail);
    }

    #[test]
    fn a_low_line_load_is_one_of_the_pair() {
        let warning = document(FormulaQuantity::LineLoad, None, 12.5e3);
        assert!(warning.detail.starts_with(
            "The single stiffness of ISO 6336-1 was published for a tangential force of at least 100 N/mm"
        ));
        assert_eq!(
            (warning.gear, warning.value, warning.unit.as_deref()),
            (None, Some(12.5), Some("N/mm"))
        );
    }
}
