//! The mesh at one fraction of its period: all that positions whole mesh periods apart have in common.
//!
//! Gears without their blanks repeat with every mesh period: the same flanks face each other across the same gaps. What
//! differs is which teeth they belong to, and so how the blanks under them yield. Gaps, cells and the compliance of the
//! teeth themselves are therefore found once for a fraction of the mesh period, and each period adds W V X Vᵀ Wᵀ.

use std::collections::VecDeque;
use std::sync::Arc;

use super::cells::{ContactCells, MeshCells, MeshContact};
use super::drawn::DrawnStage;
use super::facings::Facings;
use super::model::{PairModel, PositionError, WarmStart};
use super::penetration::{Found, Stretches, found};
use super::{ContactProblem, ContactSolution};

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
    drawn: Arc<DrawnStage>,
    /// The pairs whose patches were widened, and how often.
    widened: Vec<(i64, i32)>,
    /// The problems stated last.
    stated: VecDeque<Stated>,
}

/// A problem, and what its compliance depends on.
struct Stated {
    pairs: Vec<i64>,
    teeth_like: [usize; 2],
    problem: ContactProblem,
}

impl<'a> Stage<'a> {
    /// The mesh of `model` at the mesh position `eta` and whole mesh periods from there, under `load`.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if no flanks face each other.
    pub fn new(model: &'a PairModel, eta: f64, load: f64) -> Result<Self, PositionError> {
        let home = eta.floor();
        let fraction = eta - home;
        let facings = Facings::new(&model.pair, fraction, home as i64);
        Ok(Self {
            model,
            load,
            facings: facings.ok_or(PositionError::NoContact)?,
            // Eccentric gears stand elsewhere in every mesh period.
            drawn: if model.pair.is_concentric() {
                model.drawn.stage(fraction, load, model.cells_per_patch)
            } else {
                Arc::default()
            },
            widened: Vec::new(),
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
        let drawn = &self.drawn;
        let touch = facings.touch(period);
        let beyond = |delta: f64, factor: f64| touch + factor * (delta - touch).max(0.0);
        let mut reach = beyond(warm.transmission_error.unwrap_or(touch), GUESS);
        loop {
            let near = facings.within(period, reach);
            let widened = |pair: i64| {
                let known = self.widened.iter().find(|known| known.0 == pair);
                known.map_or(0, |known| known.1)
            };
            let pairs = near.iter().filter_map(|(i, _)| {
                let facing = &facings.all()[*i];
                drawn.cells(model, facing, load, widened(facing.pair))
            });
            let cells = ContactCells::new(model, period, pairs.collect())?;
            let problem = state(&mut self.stated, &cells)?;
            let solution = cells.solve(&problem, load, warm)?;
            let delta = solution.transmission_error;
            if facings.within(period, beyond(delta, REACH)).len() > near.len() {
                reach = beyond(delta, GUESS);
                continue;
            }
            let as_drawn = (facings.least(), delta + facings.nearer());
            let looks = cells.pairs.iter().filter_map(|pair| {
                let facing = facings.of_pair(pair.patch.pair)?;
                let laid = (&**pair, widened(facing.pair));
                Some(drawn.stretches(model, facing, laid, as_drawn))
            });
            let looks: Vec<Arc<Stretches>> = looks.collect();
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
                match self.widened.iter_mut().find(|known| known.0 == pair) {
                    Some((_, times)) => *times += 1,
                    None => self.widened.push((pair, 1)),
                }
                self.stated.retain(|stated| !stated.pairs.contains(&pair));
            }
        }
    }
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
