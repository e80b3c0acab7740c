//! The mesh at one fraction of its period: all that positions whole mesh periods apart have in common.
//!
//! Gears without their blanks repeat with every mesh period: the same flanks face each other across the same gaps. What
//! differs is which teeth they belong to, and so how the blanks under them yield. Gaps, cells and the compliance of the
//! teeth themselves are therefore found once for a fraction of the mesh period, and each period adds W V X Vᵀ Wᵀ.

use std::collections::VecDeque;

use super::cells::{ContactCells, MeshCells, MeshContact};
use super::facing::Facing;
use super::facings::Facings;
use super::model::{PairModel, PositionError, WarmStart};
use super::pair_cells::PairCells;
use super::penetration::{Found, Stretches, found};
use super::{ContactProblem, ContactSolution};

/// By how much patches are widened at a time where the contact does not fit inside them.
const WIDENING: f64 = 1.5;

/// Pairs are solved together whose gap is within this much of what load brings together: a little more than touch.
const REACH: f64 = 1.1;

/// Problems that a stage keeps: those of a gear with as many unlike teeth as a hole pattern usually leaves, on a few sets of pairs.
const MOST_STATED: usize = 64;

/// What a guess of the reach leaves for the solution to move.
const GUESS: f64 = 1.2;

/// The mesh at one fraction of its period, under one load.
pub struct Stage<'a> {
    model: &'a PairModel,
    load: f64,
    facings: Facings<'a>,
    /// The cells that have been laid so far, of each pair.
    laid: Vec<Laid>,
    /// Where penetration was looked for, on each of them.
    looks: Vec<Look>,
    /// The problems stated last.
    stated: VecDeque<Stated>,
}

/// The cells of one pair, and how wide they were laid.
struct Laid {
    widening: f64,
    cells: PairCells,
}

/// A problem, and what its compliance depends on.
struct Stated {
    pairs: Vec<i64>,
    teeth_like: [usize; 2],
    problem: ContactProblem,
}

/// The stretches of one pair whose gap as drawn is within `reach`.
struct Look {
    pair: i64,
    reach: f64,
    stretches: Stretches,
}

impl<'a> Stage<'a> {
    /// The mesh of `model` at the mesh position `eta` and whole mesh periods from there, under `load`.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if no flanks face each other.
    pub fn new(model: &'a PairModel, eta: f64, load: f64) -> Result<Self, PositionError> {
        let home = eta.floor();
        Ok(Self {
            model,
            load,
            facings: Facings::new(&model.pair, eta - home, home as i64)
                .ok_or(PositionError::NoContact)?,
            laid: Vec::new(),
            looks: Vec::new(),
            stated: VecDeque::new(),
        })
    }

    /// The contact in mesh period `period`, summed up pair by pair, and what `keep` takes of it beside. Eccentric gears stand elsewhere in
    /// any other period than that of the stage's own position.
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
        let load = self.load;
        self.solved(period, warm, |cells, _, solution, found| {
            let contact = cells.mesh_contact(load, &solution, &found);
            (contact, keep(cells, &solution))
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
    /// Cells are laid on more pairs, and patches widened, until nothing that faces penetrates beside them.
    fn solved<T>(
        &mut self,
        period: i64,
        warm: &mut WarmStart,
        answer: impl FnOnce(&ContactCells<'_>, ContactProblem, ContactSolution, Found) -> T,
    ) -> Result<T, PositionError> {
        let (model, load, facings) = (self.model, self.load, &mut self.facings);
        let touch = facings.touch(period);
        let beyond = |delta: f64, factor: f64| touch + factor * (delta - touch).max(0.0);
        let mut reach = beyond(warm.transmission_error.unwrap_or(touch), GUESS);
        loop {
            let near = facings.within(period, reach);
            let places: Vec<usize> = near
                .iter()
                .filter_map(|(i, _)| lay(&mut self.laid, model, &facings.all()[*i], load))
                .collect();
            let pairs = places.iter().map(|place| &self.laid[*place].cells);
            let cells = ContactCells::new(model, period, pairs.collect())?;
            let problem = state(&mut self.stated, &cells)?;
            let solution = cells.solve(&problem, load, warm)?;
            let delta = solution.transmission_error;
            if facings.within(period, beyond(delta, REACH)).len() > near.len() {
                reach = beyond(delta, GUESS);
                continue;
            }
            let as_drawn = delta + facings.nearer();
            for pair in &cells.pairs {
                look(
                    &mut self.looks,
                    model,
                    pair,
                    facings,
                    as_drawn,
                    beyond(delta, GUESS),
                );
            }
            let looks: Vec<&Stretches> = cells
                .pairs
                .iter()
                .filter_map(|pair| self.looks.iter().find(|look| look.pair == pair.patch.pair))
                .map(|look| &look.stretches)
                .collect();
            let found = found(model, period, &cells, &looks, &solution);
            let wider: Vec<i64> = cells
                .ranges()
                .filter(|(pair, range)| {
                    let beside = found.beside.contains(&pair.patch.pair);
                    pair.can_widen() && (beside || pair.overflows(&solution.active[range.clone()]))
                })
                .map(|(pair, _)| pair.patch.pair)
                .collect();
            if wider.is_empty() {
                *warm = cells.warm_start(&solution);
                return Ok(answer(&cells, problem, solution, found));
            }
            for pair in wider {
                widen(&mut self.laid, model, facings, pair, load);
                self.looks.retain(|look| look.pair != pair);
                self.stated.retain(|stated| !stated.pairs.contains(&pair));
            }
        }
    }
}

/// Where in `laid` the cells of `facing` are, laid now if they never were; `None` where there is no room for any.
fn lay(laid: &mut Vec<Laid>, model: &PairModel, facing: &Facing<'_>, load: f64) -> Option<usize> {
    let known = laid
        .iter()
        .position(|laid| laid.cells.patch.pair == facing.pair);
    if known.is_some() {
        return known;
    }
    laid.push(Laid {
        widening: 1.0,
        cells: PairCells::new(model, facing, load, 1.0)?,
    });
    Some(laid.len() - 1)
}

/// The problem on `cells`; of those `stated` before, one whose compliance is the same is told with other gaps.
fn state(
    stated: &mut VecDeque<Stated>,
    cells: &ContactCells<'_>,
) -> Result<ContactProblem, PositionError> {
    let pairs: Vec<i64> = cells.pairs.iter().map(|pair| pair.patch.pair).collect();
    let teeth_like = cells.teeth_like();
    let before = stated
        .iter()
        .find(|stated| stated.teeth_like == teeth_like && stated.pairs == pairs)
        .map(|stated| &stated.problem);
    let known = before.is_some();
    let problem = cells.problem(before)?;
    if !known {
        if stated.len() == MOST_STATED {
            stated.pop_front();
        }
        stated.push_back(Stated {
            pairs,
            teeth_like,
            problem: problem.clone(),
        });
    }
    Ok(problem)
}

/// Lays the cells of `pair` anew, wider.
fn widen(laid: &mut [Laid], model: &PairModel, facings: &Facings<'_>, pair: i64, load: f64) {
    let known = laid.iter_mut().find(|laid| laid.cells.patch.pair == pair);
    if let (Some(laid), Some(facing)) = (known, facings.of_pair(pair)) {
        laid.widening *= WIDENING;
        if let Some(cells) = PairCells::new(model, facing, load, laid.widening) {
            laid.cells = cells;
        }
    }
}

/// Sees to it that `looks` has the stretches of `pair` whose gap as drawn is within `least`; those of a new look within `reach` and what
/// deviations may add to it.
fn look(
    looks: &mut Vec<Look>,
    model: &PairModel,
    pair: &PairCells,
    facings: &Facings<'_>,
    least: f64,
    reach: f64,
) {
    let number = pair.patch.pair;
    let known = looks.iter().position(|look| look.pair == number);
    if known.is_some_and(|place| looks[place].reach >= least) {
        return;
    }
    if let Some(facing) = facings.of_pair(number) {
        if let Some(place) = known {
            looks.swap_remove(place);
        }
        // Other teeth may want more; looking once for all of them costs less than looking again.
        let reach = reach + facings.spread() + facings.nearer();
        looks.push(Look {
            pair: number,
            reach,
            stretches: Stretches::new(model, pair, facing, reach),
        });
    }
}
