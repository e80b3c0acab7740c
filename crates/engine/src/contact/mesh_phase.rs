//! The mesh at one fraction of its period: all that positions whole mesh periods apart have in common.
//!
//! Gears without their blanks repeat with every mesh period: the same flanks face each other across the same gaps. Only the teeth differ, and with them the
//! compliance of the blanks under them and their deviations. Cells and the compliance of the teeth themselves are therefore computed once for a fraction of the
//! mesh period, and each period adds W V X Vᵀ Wᵀ.

use std::collections::BTreeMap;

use super::cells::{ContactCells, PlacedCells, Refinement};
use super::checked::Penetration;
use super::compliances::ComplianceKey;
use super::facings::{PairGap, PairsInReach};
use super::mesh_contact::{MeshCells, MeshContact};
use super::model::{DeviatingPair, PositionError, WarmStart};
use super::patch::Extent;
use super::penetration::{PlacedStretches, penetration};
use super::{ContactProblem, ContactSolution};

/// Part of the approach by the load, beyond it, within which pairs are solved together: a little more than touch. A guess of their reach has it twice, so that
/// the solution may move on and the search for pairs in reach ends.
const MARGIN: f64 = 0.1;
const REACH: f64 = 1.0 + MARGIN;
const GUESS: f64 = 1.0 + 2.0 * MARGIN;

/// The mesh at one fraction of its period, under one load.
pub struct MeshPhase<'a> {
    deviating: DeviatingPair<'a>,
    load: f64,
    facings: PairsInReach<'a>,
    /// The cells placed last, if every mesh period has the same.
    placed: Vec<PlacedCells>,
}

/// Penetration allowed between cells, relative to the approach by the load.
const DEEP: f64 = 1e-3;

/// The flanks that touch in a mesh period before δ is `delta`. The first of them do at `touch`.
#[derive(Clone, Copy)]
struct Reach {
    period: i64,
    touch: f64,
    delta: f64,
}

/// How far the cells of pairs reach beyond those that they are given at first.
type Extents = BTreeMap<i64, Extent>;

impl DeviatingPair<'_> {
    /// The contact at mesh position `eta` under `load`, summed up pair by pair.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn contact(
        self,
        eta: f64,
        load: f64,
        warm: &mut WarmStart,
    ) -> Result<MeshContact, PositionError> {
        let mut phase = MeshPhase::new(self, eta, load)?;
        let (contact, ()) = phase.contact(eta.floor() as i64, warm, |_, _| ())?;
        Ok(contact)
    }

    /// The contact at mesh position `eta` under `load`, cell by cell.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn cells(
        self,
        eta: f64,
        load: f64,
        warm: &mut WarmStart,
    ) -> Result<MeshCells, PositionError> {
        MeshPhase::new(self, eta, load)?.cells(eta.floor() as i64, warm)
    }
}

impl<'a> MeshPhase<'a> {
    /// The mesh of `deviating` at the mesh position `eta` and whole mesh periods from there, under `load`.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if no flanks face each other.
    pub fn new(deviating: DeviatingPair<'a>, eta: f64, load: f64) -> Result<Self, PositionError> {
        let facings = PairsInReach::new(deviating, eta - eta.floor());
        Ok(Self {
            deviating,
            load,
            facings: facings.ok_or(PositionError::NoContact)?,
            placed: Vec::new(),
        })
    }

    /// The contact in mesh period `period`, summed up pair by pair, and the value that `keep` takes of it.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn contact<T>(
        &mut self,
        period: i64,
        warm: &mut WarmStart,
        keep: impl FnOnce(&ContactCells<'_>, &ContactSolution) -> T,
    ) -> Result<(MeshContact, T), PositionError> {
        self.contact_with(period, warm, |contact, cells, solution| {
            (contact, keep(cells, solution))
        })
    }

    /// Value of `summary` for the contact in mesh period `period`, from its cells and their solution.
    pub(super) fn contact_with<T>(
        &mut self,
        period: i64,
        warm: &mut WarmStart,
        summary: impl FnOnce(MeshContact, &ContactCells<'_>, &ContactSolution) -> T,
    ) -> Result<T, PositionError> {
        self.solved(period, warm, |cells, _, solution, contact| {
            summary(contact, cells, &solution)
        })
    }

    /// The contact in mesh period `period`, cell by cell.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn cells(mut self, period: i64, warm: &mut WarmStart) -> Result<MeshCells, PositionError> {
        self.solved(period, warm, |cells, problem, solution, _| {
            cells.mesh_cells(problem, solution)
        })
    }

    /// Solves mesh period `period` and lets `answer` see the cells, the problem stated on them, its solution, and its summary.
    ///
    /// Gaps are those of flanks that just touch. Cells are added on more pairs, about more minima and on more of each flank until no flanks penetrate
    /// beside them. They are halved where flanks penetrate between them.
    fn solved<T>(
        &mut self,
        period: i64,
        warm: &mut WarmStart,
        answer: impl FnOnce(&ContactCells<'_>, ContactProblem, ContactSolution, MeshContact) -> T,
    ) -> Result<T, PositionError> {
        let touch = self.facings.touch(period);
        let beyond = |delta: f64, factor: f64| touch + factor * (delta - touch).max(0.0);
        let mut reach = Reach {
            period,
            touch,
            delta: beyond(warm.transmission_error.unwrap_or(touch), GUESS),
        };
        let mut extents = Extents::new();
        loop {
            let near = self.facings.within(period, reach.delta);
            let cells = self.place_all(&near, &extents, reach)?;
            let problem = self.state(&cells)?;
            let solution = cells.solve(&problem, self.load, warm)?;
            let delta = solution.transmission_error;

            let needed = beyond(delta, REACH);
            if self.reaches_more(&near, reach, needed) {
                reach.delta = beyond(delta, GUESS);
                continue;
            }
            let penetration = self.penetration(&cells, &solution);
            let refinements = cells.refinements(&solution, &penetration, DEEP * (delta - touch));
            if refinements.is_empty() {
                *warm = cells.warm_start(&problem, &solution, self.load, warm);
                let contact = MeshContact {
                    touch,
                    ..cells.mesh_contact(self.load, (&problem, &solution), &penetration)?
                };
                let module = self.deviating.model.pair.driving().data().rack.module;
                contact.check(module)?;
                return Ok(answer(&cells, problem, solution, contact));
            }
            for (pair, refinement) in refinements {
                let is_first = !extents.contains_key(&pair);
                let extent = extents.entry(pair).or_default();
                match refinement {
                    // If the contact fits, its cells are moved before they are widened.
                    Refinement::Widen { moved } if is_first && moved != 0 => extent.moved = moved,
                    Refinement::Widen { .. } => extent.widened += 1,
                    Refinement::Halve => extent.halved += 1,
                }
            }
        }
    }

    /// Cells on the pairs `near`, with the gaps of flanks that just touch.
    fn place_all(
        &mut self,
        near: &[PairGap],
        extents: &Extents,
        reach: Reach,
    ) -> Result<ContactCells<'a>, PositionError> {
        let mut pairs = Vec::with_capacity(near.len());
        for near in near {
            let asked = extents.get(&near.pair).copied().unwrap_or_default();
            let extent = Extent {
                minima: near.minima_within(reach.delta),
                moved: near.moved(self.deviating, (reach.period, self.load)) + asked.moved,
                ..asked
            };
            let known = |placed: &&PlacedCells| (placed.pair, placed.extent) == (near.pair, extent);
            let placed = match self.placed.iter().find(known) {
                Some(placed) => Some(placed.clone()),
                None => self.place(near, extent, reach),
            };
            pairs.extend(placed);
        }
        ContactCells::new(self.deviating, self.facings.at(reach.period), pairs)
    }

    fn place(&mut self, near: &PairGap, extent: Extent, reach: Reach) -> Option<PlacedCells> {
        let model = self.deviating.model;
        let at = self.facings.at(reach.period);
        let pose = near.pose(self.deviating, at, reach.touch)?;
        let cells = model
            .drawn
            .cells(&model.flanks(), &near.drawn, self.load, extent);
        let placed = PlacedCells::new(near, extent, cells, &pose, reach.touch)?;
        if self.facings.are_as_drawn() {
            self.placed.push(placed.clone());
        }
        Some(placed)
    }

    /// True if a δ of `needed` reaches pairs or minima beyond those `near` within `reach`.
    fn reaches_more(&mut self, near: &[PairGap], reach: Reach, needed: f64) -> bool {
        let more = self.facings.within(reach.period, needed);
        more.len() > near.len()
            || more.iter().any(|more| {
                let known = near.iter().find(|near| near.pair == more.pair);
                known
                    .is_none_or(|near| more.minima_within(needed) > near.minima_within(reach.delta))
            })
    }

    /// The problem on `cells`. A compliance that was met before is not stated anew.
    fn state(&self, cells: &ContactCells<'_>) -> Result<ContactProblem, PositionError> {
        let pairs = cells.placed.iter();
        let spec = ComplianceKey {
            pairs: pairs
                .map(|placed| (placed.pair, placed.cells().spec))
                .collect(),
            teeth_like: cells.teeth_like(),
        };
        let compliances = &self.deviating.model.compliances;
        cells.problem(&compliances.get(spec, || cells.compliance()))
    }

    /// Penetration under `solution` on `cells`.
    fn penetration(&self, cells: &ContactCells<'_>, solution: &ContactSolution) -> Penetration {
        let model = self.deviating.model;
        let delta = solution.transmission_error;
        let as_drawn = [self.facings.least(), delta + self.facings.nearer()];
        let checked = cells.ranges().filter_map(|(placed, range)| {
            let (drawn, active) = (&placed.drawn, &solution.active[range]);
            let flanks = model.flanks();
            let checked = model
                .drawn
                .checked(&flanks, drawn, placed.cells(), active, as_drawn);
            Some(PlacedStretches::new(
                checked?,
                placed,
                self.deviating,
                cells.at,
            ))
        });
        penetration(cells, &checked.collect::<Vec<_>>(), solution)
    }
}
