//! The ranges for which formulas were published, and values outside them.

use crate::gear::Member;

/// A formula of the load distribution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Formula {
    /// The tooth of Weber and Banaschek.
    WeberBanaschek,
    /// The gear body of Weber and Banaschek.
    HalfPlane,
    /// The gear body of Sainsot, Velex and Duverger.
    Sainsot,
    /// The single stiffness of ISO 6336-1.
    Iso6336,
}

impl std::fmt::Display for Formula {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::WeberBanaschek => "the tooth of Weber and Banaschek",
            Self::HalfPlane => "the half plane of Weber and Banaschek",
            Self::Sainsot => "the gear body of Sainsot, Velex and Duverger",
            Self::Iso6336 => "the single stiffness of ISO 6336-1",
        })
    }
}

/// A number that the range of a formula is given for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FormulaQuantity {
    /// r_f/r_bore of a gear, of Sainsot's body.
    RadiusRatio,
    /// Half the angle in rad that a tooth spans at its root circle, of Sainsot's body.
    RootHalfAngle,
    /// A value of one of the functions L, M, P and Q of Sainsot's body.
    BodyFunction(char),
    /// The profile shift x_1 − x_2 that the pinion has beyond the wheel, of ISO's single stiffness.
    ShiftDifference,
    /// The sum x_1 + x_2 of the profile shifts, of ISO's single stiffness.
    ShiftSum,
    /// The tangential force over the face width in N/m, of ISO's single stiffness.
    LineLoad,
}

impl FormulaQuantity {
    /// The formula whose range it belongs to.
    pub fn formula(self) -> Formula {
        match self {
            Self::RadiusRatio | Self::RootHalfAngle | Self::BodyFunction(_) => Formula::Sainsot,
            Self::ShiftDifference | Self::ShiftSum | Self::LineLoad => Formula::Iso6336,
        }
    }
}

/// A number outside the range for which a formula was published. The formula's value is used all the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormulaRange {
    /// Quantity outside.
    pub quantity: FormulaQuantity,
    /// The gear that it is of; `None` for the pair.
    pub member: Option<Member>,
    /// Its value, in SI units.
    pub value: f64,
    /// The lower end of the range; −∞ where there is none.
    pub least: f64,
    /// The upper end of the range; ∞ where there is none.
    pub greatest: f64,
}

impl FormulaRange {
    /// `value` of `quantity`, if it lies outside of `least` to `greatest`.
    pub(super) fn outside(
        quantity: FormulaQuantity,
        member: Option<Member>,
        value: f64,
        (least, greatest): (f64, f64),
    ) -> Option<Self> {
        let found = Self {
            quantity,
            member,
            value,
            least,
            greatest,
        };
        (!(least..=greatest).contains(&value)).then_some(found)
    }
}
