//! What a reader should know beside the numbers.

use meshwright_engine::analysis::Warning;
use meshwright_engine::gear::Member;
use serde::Serialize;
use utoipa::ToSchema;

use super::units::{plain, to_mm, to_mpa};

/// A warning: the result stands, but with something to know.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[schema(as = Warning, title = "Warning")]
pub struct WarningDocument {
    /// The stable code.
    pub code: WarningCode,
    /// What it is, with the numbers.
    pub detail: String,
    /// The gear, where it concerns one: `driving` or `driven`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gear: Option<GearName>,
    /// The number behind it, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The unit of that number.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
}

/// The stable code of a warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(title = "Warning code")]
pub enum WarningCode {
    /// The teeth fit without any backlash; only the loaded flanks are solved.
    ZeroBacklash,
    /// The material around the holes is thinner than one module.
    ThinLigament,
    /// A tip corner carries load off the line of action.
    TipCornerContact,
    /// The contact reaches the fillet of a gear, where it is not followed.
    ContactReachesFillet,
    /// The face widths differ by more than a plane model can stand for.
    FaceWidthsDiffer,
    /// The contact presses harder than materials bear in proportion.
    ContactBeyondElasticity,
    /// The span is not whole true periods.
    PartialSpan,
    /// Formulas are used outside the range for which they were published.
    FormulaRange,
    /// The method does not see the holes that the drawing has.
    HolesNotSeen,
}

/// One of the two gears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(title = "Gear name")]
pub enum GearName {
    /// Gear 1, which drives.
    Driving,
    /// Gear 2, which is driven.
    Driven,
}

impl GearName {
    /// Its word on the wire.
    pub fn word(self) -> &'static str {
        match self {
            Self::Driving => "driving",
            Self::Driven => "driven",
        }
    }

    /// The gear that a word names.
    pub fn of_word(word: &str) -> Option<Self> {
        [Self::Driving, Self::Driven]
            .into_iter()
            .find(|gear| gear.word() == word)
    }
}

impl From<Member> for GearName {
    fn from(member: Member) -> Self {
        match member {
            Member::Driving => Self::Driving,
            Member::Driven => Self::Driven,
        }
    }
}

impl WarningDocument {
    /// The document of `warning`.
    pub fn of(warning: &Warning) -> Self {
        let new = |code, detail: String| Self {
            code,
            detail,
            gear: None,
            value: None,
            unit: None,
        };
        match *warning {
            Warning::ZeroBacklash => new(
                WarningCode::ZeroBacklash,
                "The nominal backlash is zero; only the loaded flanks are solved.".to_owned(),
            ),
            Warning::ThinLigament { member, ligament } => Self {
                gear: Some(member.into()),
                value: Some(to_mm(ligament)),
                unit: Some("mm"),
                ..new(
                    WarningCode::ThinLigament,
                    format!(
                        "The holes of the {member} gear leave {} mm, less than one module; stresses there are high.",
                        plain(to_mm(ligament))
                    ),
                )
            },
            Warning::TipCornerContact {
                member,
                largest_share,
            } => Self {
                gear: Some(member.into()),
                value: Some(100.0 * largest_share),
                unit: Some("%"),
                ..new(
                    WarningCode::TipCornerContact,
                    format!(
                        "The tip corner of the {member} gear touches off the line of action and carries up to {} % of the load; more tip relief avoids it.",
                        plain((1000.0 * largest_share).round() / 10.0)
                    ),
                )
            },
            Warning::ContactReachesFillet { member } => Self {
                gear: Some(member.into()),
                ..new(
                    WarningCode::ContactReachesFillet,
                    format!(
                        "The contact reaches the fillet of the {member} gear, where it is not followed; a larger center distance or a smaller torque avoids it."
                    ),
                )
            },
            Warning::FaceWidthsDiffer { ratio } => Self {
                value: Some(ratio),
                unit: Some("1"),
                ..new(
                    WarningCode::FaceWidthsDiffer,
                    format!(
                        "One face is {} times as wide as the other: away from the contact each gear is taken for a plate of its own width, which makes the wider one too stiff.",
                        plain(ratio)
                    ),
                )
            },
            Warning::ContactBeyondElasticity {
                pressure,
                youngs_modulus,
            } => Self {
                value: Some(to_mpa(pressure)),
                unit: Some("MPa"),
                ..new(
                    WarningCode::ContactBeyondElasticity,
                    format!(
                        "The contact pressure comes to {} MPa, {} % of Young's modulus: no material stays elastic there.",
                        plain(to_mpa(pressure).round()),
                        plain((1000.0 * pressure / youngs_modulus).round() / 10.0)
                    ),
                )
            },
            Warning::PartialSpan { span, period } => Self {
                value: Some(f64::from(span)),
                unit: Some("mesh periods"),
                ..new(
                    WarningCode::PartialSpan,
                    format!(
                        "The span of {span} mesh periods is not whole true periods of {period}: statistics are partial, and there is no spectrum."
                    ),
                )
            },
            Warning::FormulaRange { member } => Self {
                gear: Some(member.into()),
                ..new(
                    WarningCode::FormulaRange,
                    format!(
                        "The {member} gear lies outside the range for which the formulas were published."
                    ),
                )
            },
            Warning::HolesNotSeen => new(
                WarningCode::HolesNotSeen,
                "This method does not see holes: its curves are those of solid blanks.".to_owned(),
            ),
        }
    }
}
