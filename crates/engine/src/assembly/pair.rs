//! A pair of gears ready for contact, of the parts that somebody provides.

use std::sync::Arc;

use super::pair_spec::cells_per_patch;
use super::{
    AssemblyError, CutGear, GearGrids, Inside, PairSpec, Parts, Probes, Spun, SpunSpec, WantedGear,
};
use crate::contact::PairModel;
use crate::gear::Member;
use crate::ring::blank::Hold;
use crate::run::Run;

impl PairSpec {
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

    /// Response of the gear `member` to its rotation, its bore held as `hold` says; `None` of one on a rigid blank.
    ///
    /// # Errors
    ///
    /// [`AssemblyError`].
    pub fn spun(
        &self,
        member: Member,
        hold: Hold,
        parts: &dyn Parts,
        run: &Run,
    ) -> Result<Option<Arc<Spun>>, AssemblyError> {
        let spec = SpunSpec::new(&self.gears[member.index()], hold);
        let spun = spec.map(|spec| parts.spun(&spec, run)).transpose();
        spun.map_err(|error| error.of(member))
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

    /// The model, and its unknowns before condensation, from the parts of `parts`.
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
