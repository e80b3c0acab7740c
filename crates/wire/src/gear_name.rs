//! The word for one of the two gears.

use meshwright_engine::gear::Member;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// One of the two gears.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
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

    /// The gear of a pair.
    pub fn member(self) -> Member {
        match self {
            Self::Driving => Member::Driving,
            Self::Driven => Member::Driven,
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
