//! The place of a gear in its pair.

/// One of the two gears of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Member {
    /// Gear 1, which drives.
    Driving,
    /// Gear 2, which is driven.
    Driven,
}

impl Member {
    /// Both, in the order in which pairs of values are kept.
    pub const BOTH: [Self; 2] = [Self::Driving, Self::Driven];

    /// The place of this gear in a pair of values: 0 driving, 1 driven.
    pub fn index(self) -> usize {
        match self {
            Self::Driving => 0,
            Self::Driven => 1,
        }
    }

    /// The other one.
    pub fn other(self) -> Self {
        match self {
            Self::Driving => Self::Driven,
            Self::Driven => Self::Driving,
        }
    }
}

impl std::fmt::Display for Member {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Driving => "driving",
            Self::Driven => "driven",
        })
    }
}

/// The teeth counter-clockwise, in the frame of `member`, from the tooth of one pair to that of the pair `pairs` later.
///
/// The next tooth counter-clockwise of the driving gear is ahead and meshes before, that of the driven gear is behind and
/// meshes after.
pub fn teeth_on(member: Member, pairs: i64) -> i64 {
    match member {
        Member::Driving => -pairs,
        Member::Driven => pairs,
    }
}
