//! The mesh at one fraction of its period: all that positions whole mesh periods apart have in common.
//!
//! Gears without their blanks repeat with every mesh period: the same flanks face each other across the same gaps. What
//! differs is which teeth they belong to, and so how the blanks under them yield and how the teeth deviate. Cells and the compliance of the
//! teeth themselves are therefore found once for a fraction of the mesh period, and each period adds W V X Vᵀ Wᵀ.

use std::collections::{BTreeMap, VecDeque};

use super::cells::{ContactCells, Laid, Want};
use super::compliances::{Known, StatedCells};
use super::drawn::DrawnPair;
use super::facings::{Facings, Near};
use super::looks::Found;
use super::meeting::Standing;
use super::mesh_contact::{MeshCells, MeshContact};
use super::model::{MadePair, PositionError, WarmStart};
use super::patch::Extent;
use super::penetration::{Look, found};
use super::{ContactProblem, ContactSolution};

/// Pairs are solved together whose gap is within this much of what load brings together: a little more than touch.
const REACH: f64 = 1.1;

/// Compliances that a stage has at hand: those of a gear with as many unlike teeth as a hole pattern usually leaves, on a few sets of pairs.
const MOST_STATED: usize = 64;

/// What a guess of the reach leaves for the solution to move.
const GUESS: f64 = 1.2;

/// The mesh at one fraction of its period, under one load.
pub struct Stage<'a> {
    made: MadePair<'a>,
    load: f64,
    facings: Facings<'a>,
    /// The compliances met last.
    stated: VecDeque<Stated>,
    /// The pairs laid last, where every mesh period has the same.
    laid: Vec<Laid>,
}

/// A compliance, and what it depends on.
struct Stated {
    cells: StatedCells,
    known: Known,
}

/// Flanks may penetrate between cells by so much of what load brings them together.
const DEEP: f64 = 1e-3;

/// What pairs want beside the cells that they are given at first.
type Wanted = BTreeMap<i64, Extent>;

impl MadePair<'_> {
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
        let mut stage = Stage::new(self, eta, load)?;
        let (contact, ()) = stage.contact(eta.floor() as i64, warm, |_, _| ())?;
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
        Stage::new(self, eta, load)?.cells(eta.floor() as i64, warm)
    }
}

impl<'a> Stage<'a> {
    /// The mesh of `made` at the mesh position `eta` and whole mesh periods from there, under `load`.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if no flanks face each other.
    pub fn new(made: MadePair<'a>, eta: f64, load: f64) -> Result<Self, PositionError> {
        let facings = Facings::new(made, eta - eta.floor());
        Ok(Self {
            made,
            load,
            facings: facings.ok_or(PositionError::NoContact)?,
            stated: VecDeque::new(),
            laid: Vec::new(),
        })
    }

    /// The contact in mesh period `period`, summed up pair by pair, and what `keep` takes of it beside.
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

    /// What `tell` makes of the contact in mesh period `period`, of its cells and their solution.
    pub(super) fn contact_with<T>(
        &mut self,
        period: i64,
        warm: &mut WarmStart,
        tell: impl FnOnce(MeshContact, &ContactCells<'_>, &ContactSolution) -> T,
    ) -> Result<T, PositionError> {
        let load = self.load;
        self.solved(period, warm, |cells, _, solution, found| {
            tell(
                cells.mesh_contact(load, &solution, &found),
                cells,
                &solution,
            )
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

    /// Solves mesh period `period` and lets `answer` see the cells, the problem stated on them, its solution, and what penetrates.
    ///
    /// Gaps are those of flanks that just touch. Cells are laid on more pairs and about more hollows as far as the load brings them together,
    /// and on more of each flank, until nothing that faces penetrates beside them; and they are halved where it penetrates between them.
    fn solved<T>(
        &mut self,
        period: i64,
        warm: &mut WarmStart,
        answer: impl FnOnce(&ContactCells<'_>, ContactProblem, ContactSolution, Found) -> T,
    ) -> Result<T, PositionError> {
        let touch = self.facings.touch(period);
        let beyond = |delta: f64, factor: f64| touch + factor * (delta - touch).max(0.0);
        let mut reach = beyond(warm.transmission_error.unwrap_or(touch), GUESS);
        let mut wanted = Wanted::new();
        loop {
            let near = self.facings.within(period, reach);
            let cells = self.lay(&near, &wanted, (period, touch, reach))?;
            let problem = self.state(&cells)?;
            let solution = cells.solve(&problem, self.load, warm)?;
            let delta = solution.transmission_error;

            let needed = beyond(delta, REACH);
            if self.reaches_more(&near, period, (reach, needed)) {
                reach = beyond(delta, GUESS);
                continue;
            }
            let found = self.look(&cells, &solution);
            let wants = cells.wants(&solution, &found, DEEP * (delta - touch));
            if wants.is_empty() {
                *warm = cells.warm_start(&problem, &solution, self.load, warm);
                return Ok(answer(&cells, problem, solution, found));
            }
            for (pair, want) in wants {
                let is_first = !wanted.contains_key(&pair);
                let extent = wanted.entry(pair).or_default();
                match want {
                    // A contact that fits is first laid about.
                    Want::Room { moved } if is_first && moved != 0 => extent.moved = moved,
                    Want::Room { .. } => extent.widened += 1,
                    Want::Halves => extent.halved += 1,
                }
            }
        }
    }

    /// Cells on the pairs `near`, with the gaps of flanks of which the driven one lags by `touch`.
    fn lay(
        &mut self,
        near: &[Near],
        wanted: &Wanted,
        (period, touch, reach): (i64, f64, f64),
    ) -> Result<ContactCells<'a>, PositionError> {
        let mut pairs = Vec::with_capacity(near.len());
        for near in near {
            let wanted = wanted.get(&near.pair).copied().unwrap_or_default();
            let extent = Extent {
                hollows: near.hollows_within(reach),
                moved: near.moved(self.made, (period, self.load)) + wanted.moved,
                ..wanted
            };
            let known = |laid: &&Laid| (laid.pair, laid.extent) == (near.pair, extent);
            let laid = match self.laid.iter().find(known) {
                Some(laid) => Some(laid.clone()),
                None => self.laid_at(near, extent, (period, touch)),
            };
            pairs.extend(laid);
        }
        ContactCells::new(self.made, (self.facings.fraction(), period), pairs)
    }

    fn laid_at(
        &mut self,
        near: &Near,
        extent: Extent,
        (period, touch): (i64, f64),
    ) -> Option<Laid> {
        let model = self.made.model;
        let place = (self.facings.fraction(), period);
        let standing: Standing<'_> = near.standing(self.made, place, touch)?;
        let cells = model
            .drawn
            .cells(&model.flanks(), &near.drawn, self.load, extent);
        let laid = Laid::new(near, extent, cells, &standing, touch)?;
        if self.facings.are_as_drawn() {
            self.laid.push(laid.clone());
        }
        Some(laid)
    }

    /// Whether `needed` reaches pairs or hollows beyond those `near` within `reach`.
    fn reaches_more(&mut self, near: &[Near], period: i64, (reach, needed): (f64, f64)) -> bool {
        let more = self.facings.within(period, needed);
        more.len() > near.len()
            || more.iter().any(|more| {
                let known = near.iter().find(|near| near.pair == more.pair);
                known.is_none_or(|near| more.hollows_within(needed) > near.hollows_within(reach))
            })
    }

    /// The problem on `cells`. A compliance that was met before is not stated anew.
    fn state(&mut self, cells: &ContactCells<'_>) -> Result<ContactProblem, PositionError> {
        let pairs = cells.laid.iter();
        let pairs = pairs.map(|laid| {
            let DrawnPair { phase, seat, .. } = laid.drawn;
            (laid.pair, phase.to_bits(), seat, laid.extent)
        });
        let spec = StatedCells {
            load: self.load.to_bits(),
            pairs: pairs.collect(),
            teeth_like: cells.teeth_like(),
        };
        if let Some(stated) = self.stated.iter().find(|stated| stated.cells == spec) {
            return cells.problem(&stated.known);
        }
        let compliances = &self.made.model.compliances;
        let known = compliances.get(spec.clone(), || cells.compliance());
        let problem = cells.problem(&known)?;
        if self.stated.len() == MOST_STATED {
            self.stated.pop_front();
        }
        self.stated.push_back(Stated { cells: spec, known });
        Ok(problem)
    }

    /// What penetrates under `solution` on `cells`.
    fn look(&self, cells: &ContactCells<'_>, solution: &ContactSolution) -> Found {
        let model = self.made.model;
        let delta = solution.transmission_error;
        let as_drawn = (self.facings.least(), delta + self.facings.nearer());
        let looks: Vec<Look> = cells
            .ranges()
            .filter_map(|(laid, range)| {
                let drawn = (laid.cells(), self.load, laid.extent);
                let pair = (&laid.drawn, laid.drawn.facing()?);
                let carrying = &solution.active[range];
                let looks = model
                    .drawn
                    .looks(&model.flanks(), pair, (drawn, carrying), as_drawn);
                let place = (self.facings.fraction(), cells.period);
                Some(Look::new(looks, laid, self.made, place))
            })
            .collect();
        found(cells, &looks, solution)
    }
}
