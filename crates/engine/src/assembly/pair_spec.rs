//! Specification of a pair of gears ready for contact.

use super::FaceResolution;
use super::gear::GearSpec;
use super::interface::interface_radius;
use super::teeth::TeethSpec;
use crate::contact::ContactSolver;
use crate::gear::{GearPair, Member, PairDeviations, SolidPair};
use crate::grid::GridLevel;

/// The blanks that take part in a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blanks {
    /// Both, as drawn.
    Flexible,
    /// Blanks without holes; holed ones are rigid inside R_w (paper: wh).
    HoledRigid,
    /// As [`Blanks::HoledRigid`], but the holed blank of one gear takes part.
    OnlyHoledOf(Member),
}

impl Blanks {
    /// True if the blank of `member` takes part although it has holes.
    fn take_holed(self, member: Member) -> bool {
        match self {
            Self::Flexible => true,
            Self::HoledRigid => false,
            Self::OnlyHoledOf(other) => other == member,
        }
    }
}

/// Modeling of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modeling {
    /// The grid level.
    pub level: GridLevel,
    /// The interface radii R_w asked for, in meters; `None` for the default of the gear. A gear without holes has its default.
    pub interface_radii: [Option<f64>; 2],
    /// How far apart, in teeth, loaded teeth of one gear are coupled.
    pub farthest: usize,
    /// The contact solver.
    pub solver: ContactSolver,
}

/// Specification of a model of a pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairSpec {
    pub(super) gears: [GearSpec; 2],
    pub(super) flanks: GearPair,
    pub(super) level: GridLevel,
    pub(super) solver: ContactSolver,
}

impl PairSpec {
    /// `pair` with those of its blanks that take part.
    pub fn new(pair: &GearPair, blanks: Blanks, modeling: &Modeling) -> Self {
        let &Modeling {
            level,
            interface_radii,
            farthest,
            solver,
        } = modeling;
        let gears = Member::BOTH.map(|member| {
            let gear = pair.gear(member);
            let radius = interface_radius(gear, interface_radii[member.index()]);
            if gear.holes().is_empty() || blanks.take_holed(member) {
                GearSpec::on_own_blank(gear, radius, level, farthest)
            } else {
                GearSpec::on_rigid_blank(gear, radius, level)
            }
        });
        Self {
            gears,
            flanks: pair.without_blanks().as_drawn(),
            level,
            solver,
        }
    }

    /// Specification of its contact without the blanks.
    pub(super) fn drawn(&self) -> FlanksSpec {
        FlanksSpec {
            pair: self.flanks.clone(),
            teeth: self.gears.each_ref().map(|gear| gear.teeth.clone()),
        }
    }
}

/// Specification of the contact of flanks, for any support and any deviations of their teeth.
#[derive(Debug, Clone, PartialEq)]
pub struct FlanksSpec {
    /// The pair as drawn, without its blanks.
    pub pair: GearPair,
    /// The teeth of the driving and of the driven gear.
    pub teeth: [TeethSpec; 2],
}

/// Specification of the contact along faces of a pair as drawn, for any deviations of its teeth.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceContactsSpec {
    /// The pair as drawn.
    pub pair: SolidPair,
    /// How finely its gears are resolved along their faces.
    pub resolution: FaceResolution,
    /// Slices into which the common face is cut.
    pub slices: usize,
}

/// Specification of the contacts of a pair at some positions.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactsSpec {
    /// The transmitted load F in N.
    pub load: f64,
    /// The mesh positions η.
    pub positions: Vec<f64>,
    /// The drawn pair.
    pub pair: PairSpec,
    /// Deviations of its teeth.
    pub deviations: PairDeviations,
}

/// Contact cells in one patch.
pub(crate) fn cells_per_patch(level: GridLevel) -> usize {
    match level {
        GridLevel::Coarse => 24,
        GridLevel::Standard => 40,
        GridLevel::Fine => 80,
    }
}
