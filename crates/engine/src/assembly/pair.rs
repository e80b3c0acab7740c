//! A pair of gears ready for contact: which blanks take part, and the rules of contact.

use super::interface::interface_radius;
use super::{
    AssemblyError, CutGear, FlanksSpec, GearGrids, GearSpec, Inside, Parts, Probes, WantedGear,
};
use crate::contact::{ContactSolver, PairModel};
use crate::gear::{GearPair, Member};
use crate::grid::GridLevel;
use crate::run::Run;

/// Which blanks take part in a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Blanks {
    /// Both, as drawn.
    Flexible,
    /// Those without holes; holed ones are rigid inside R_w (paper: wh).
    HoledRigid,
    /// As [`Blanks::HoledRigid`], but the holed blank of one gear takes part.
    OnlyHoledOf(Member),
}

/// How a pair is modeled.
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

/// What a model of a pair depends on.
#[derive(Debug, Clone, PartialEq)]
pub struct PairSpec {
    gears: [GearSpec; 2],
    flanks: GearPair,
    level: GridLevel,
    solver: ContactSolver,
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

    /// The grids of the gear `member`.
    ///
    /// # Errors
    ///
    /// [`AssemblyError`].
    pub fn grids(&self, member: Member) -> Result<GearGrids, AssemblyError> {
        let spec = &self.gears[member.index()];
        spec.grids().map_err(|error| error.of(member))
    }

    /// The inside of the gear `member` on its `grids`, asked for `probes`.
    ///
    /// # Errors
    ///
    /// [`AssemblyError`].
    pub fn inside(
        &self,
        member: Member,
        grids: &GearGrids,
        probes: &Probes,
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<Inside, AssemblyError> {
        let spec = &self.gears[member.index()];
        Inside::new(spec, grids, probes, parts, run).map_err(|error| error.of(member))
    }

    /// The gear `member` cut at its interface circle.
    ///
    /// # Errors
    ///
    /// [`AssemblyError`].
    pub fn cut(
        &self,
        member: Member,
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<CutGear, AssemblyError> {
        let spec = &self.gears[member.index()];
        CutGear::new(spec, parts, run).map_err(|error| error.of(member))
    }

    /// What its contact depends on but for the blanks.
    fn drawn(&self) -> FlanksSpec {
        FlanksSpec {
            pair: self.flanks.clone(),
            teeth: self.gears.each_ref().map(|gear| gear.teeth.clone()),
        }
    }

    /// The model, and its unknowns before condensation, of what `parts` provides.
    ///
    /// # Errors
    ///
    /// [`AssemblyError`].
    pub fn model(&self, parts: &dyn Parts, run: &Run) -> Result<(PairModel, u64), AssemblyError> {
        let [driving, driven] = Member::BOTH.map(|member| WantedGear {
            member,
            spec: self.gears[member.index()].clone(),
        });
        // Equal gears are one part.
        let equal = driving.spec == driven.spec;
        let wanted = if equal {
            vec![driving]
        } else {
            vec![driving, driven]
        };
        let gears = parts.gears(&wanted, run)?;
        let gears = [0, if equal { 0 } else { 1 }].map(|g| &gears[g]);
        let model = PairModel {
            pair: self.flanks.clone(),
            gears: gears.map(|gear| gear.model.clone()),
            cells_per_patch: cells_per_patch(self.level),
            solver: self.solver,
            run: run.clone(),
            drawn: parts.flanks(&self.drawn()),
            compliances: parts.compliances(self),
        };
        let unknowns = gears.iter().map(|gear| gear.degrees_of_freedom).sum();
        Ok((model, unknowns))
    }
}

impl Blanks {
    /// Whether the blank of `member` takes part if it has holes.
    fn take_holed(self, member: Member) -> bool {
        match self {
            Self::Flexible => true,
            Self::HoledRigid => false,
            Self::OnlyHoledOf(other) => other == member,
        }
    }
}

/// Contact cells in one patch.
pub(crate) fn cells_per_patch(level: GridLevel) -> usize {
    match level {
        GridLevel::Coarse => 24,
        GridLevel::Standard => 40,
        GridLevel::Fine => 80,
    }
}
