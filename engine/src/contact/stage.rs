//! The mesh at one fraction of its period: all that positions whole mesh periods apart have in common.
//!
//! Gears without their blanks repeat with every mesh period: the same flanks face each other across the same gaps. What
//! differs is which teeth they belong to, and so how the blanks under them yield. Gaps, cells and the compliance of the
//! teeth themselves are therefore found once for a fraction of the mesh period, and each period adds W V X Vᵀ Wᵀ.

use super::cells::{ContactCells, MeshCells, MeshContact};
use super::facing::Facing;
use super::model::{PairModel, PositionError, WarmStart};
use super::penetration::{Found, Penetration};
use super::{ContactProblem, ContactSolution};
use crate::gear::GearPair;

/// By how much patches are widened at a time where the contact does not fit inside them.
const WIDENING: f64 = 1.5;

/// Pairs are solved together whose gap is within this much of δ: a little more than touch.
const REACH: f64 = 1.1;

/// What a guess of the reach leaves for the solution to move.
const GUESS: f64 = 1.2;

/// The mesh at one fraction of its period, under one load.
pub struct Stage<'a> {
    model: &'a PairModel,
    load: f64,
    facings: Facings<'a>,
    /// The cells that have been laid so far: one entry at most stages.
    layouts: Vec<Layout>,
}

struct Layout {
    widening: f64,
    cells: ContactCells,
    penetration: Option<Penetration>,
}

impl<'a> Stage<'a> {
    /// The mesh of `model` at `fraction` of its period under `load`.
    ///
    /// # Errors
    ///
    /// [`PositionError::NoContact`] if no flanks face each other.
    pub fn new(model: &'a PairModel, fraction: f64, load: f64) -> Result<Self, PositionError> {
        Ok(Self {
            model,
            load,
            facings: Facings::new(&model.pair, fraction).ok_or(PositionError::NoContact)?,
            layouts: Vec::new(),
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
        keep: impl FnOnce(&ContactCells, &ContactSolution) -> T,
    ) -> Result<(MeshContact, T), PositionError> {
        let Solved {
            layout,
            solution,
            found,
            ..
        } = self.solve(period, warm)?;
        let cells = &self.layouts[layout].cells;
        let contact = cells.mesh_contact(self.model, period, self.load, &solution, &found);
        Ok((contact, keep(cells, &solution)))
    }

    /// The contact in mesh period `period`, cell by cell.
    ///
    /// # Errors
    ///
    /// [`PositionError`].
    pub fn cells(mut self, period: i64, warm: &mut WarmStart) -> Result<MeshCells, PositionError> {
        let Solved {
            layout,
            problem,
            solution,
            ..
        } = self.solve(period, warm)?;
        let cells = self.layouts.swap_remove(layout).cells;
        Ok(cells.into_mesh_cells(period, problem, solution))
    }

    /// The solution in one period and the cells on which it was found.
    ///
    /// Cells are laid on more pairs, and patches widened, until nothing that faces penetrates beside them.
    fn solve(&mut self, period: i64, warm: &mut WarmStart) -> Result<Solved, PositionError> {
        let guess = warm.transmission_error.map_or(0.0, |delta| GUESS * delta);
        let mut pairs = self.facings.within(guess);
        let mut widening = 1.0;
        loop {
            let index = self.lay(pairs, widening)?;
            let Layout {
                cells, penetration, ..
            } = &mut self.layouts[index];
            let (problem, solution) = cells.solve(self.model, period, self.load, warm)?;
            let delta = solution.transmission_error;
            if cells.pair_count() < self.facings.within(REACH * delta) {
                pairs = self.facings.within(GUESS * delta);
                continue;
            }
            let points = match penetration.take() {
                Some(points) if points.reach() >= delta => points,
                _ => Penetration::new(self.model, cells, self.facings.all(), GUESS * delta),
            };
            let found = points.of(self.model, cells, period, &solution);
            *penetration = Some(points);
            if cells.can_widen() && (found.beside > 0.0 || cells.overflows(&solution.active)) {
                widening *= WIDENING;
                continue;
            }
            *warm = cells.warm_start(&solution);
            return Ok(Solved {
                layout: index,
                problem,
                solution,
                found,
            });
        }
    }

    /// Where cells on at least `pairs` pairs, widened by `widening`, are laid.
    fn lay(&mut self, pairs: usize, widening: f64) -> Result<usize, PositionError> {
        let enough =
            |layout: &Layout| layout.cells.pair_count() >= pairs && layout.widening == widening;
        if let Some(index) = self.layouts.iter().position(enough) {
            return Ok(index);
        }
        let facings = &self.facings.all()[..pairs];
        self.layouts.push(Layout {
            widening,
            cells: ContactCells::new(self.model, facings, self.load, widening)?,
            penetration: None,
        });
        Ok(self.layouts.len() - 1)
    }
}

struct Solved {
    layout: usize,
    problem: ContactProblem,
    solution: ContactSolution,
    /// What penetrates over the whole flanks of all pairs.
    found: Found,
}

/// The pairs whose flanks face each other at one fraction of the mesh period, by rising gap; numbered from the reference pair of the
/// period. They are looked for outward from the path of contact, as far as is asked.
struct Facings<'a> {
    gears: &'a GearPair,
    fraction: f64,
    found: Vec<Facing<'a>>,
    /// The next pairs to look at, before and after those found, and the gap of the last one there.
    frontier: [Frontier; 2],
}

struct Frontier {
    next: i64,
    step: i64,
    last_gap: f64,
}

impl<'a> Facings<'a> {
    /// The pairs on the path of contact and those beside it; `None` if no flanks face each other at all.
    fn new(gears: &'a GearPair, fraction: f64) -> Option<Self> {
        let (s_a, s_e) = gears.path_of_contact();
        // Pair n touches at the roll length of η − n periods.
        let periods = |s: f64| (s - gears.roll_length_of(0.0)) / gears.base_pitch();
        let first = (fraction - periods(s_e)).floor() as i64;
        let last = (fraction - periods(s_a)).ceil() as i64;
        let mut found: Vec<Facing<'a>> = (first..=last)
            .filter_map(|n| Facing::of(gears, fraction, n))
            .collect();
        let frontier = |last: i64, step| Frontier {
            next: last + step,
            step,
            last_gap: found
                .iter()
                .find(|facing| facing.pair == last)
                .map_or(f64::INFINITY, |facing| facing.gap),
        };
        let frontier = [frontier(first, -1), frontier(last, 1)];
        found.sort_by(|a, b| a.gap.total_cmp(&b.gap));
        (!found.is_empty()).then_some(Self {
            gears,
            fraction,
            frontier,
            found,
        })
    }

    /// The number of pairs whose gap is within `reach`; at least the one that touches first.
    fn within(&mut self, reach: f64) -> usize {
        // Beyond the path of contact gaps grow from pair to pair.
        for frontier in &mut self.frontier {
            while frontier.last_gap <= reach {
                let facing = Facing::of(self.gears, self.fraction, frontier.next);
                frontier.last_gap = facing.map_or(f64::INFINITY, |facing| facing.gap);
                frontier.next += frontier.step;
                if let Some(facing) = facing {
                    let place = self.found.partition_point(|known| known.gap <= facing.gap);
                    self.found.insert(place, facing);
                }
            }
        }
        let count = self.found.partition_point(|facing| facing.gap <= reach);
        count.max(1)
    }

    fn all(&self) -> &[Facing<'a>] {
        &self.found
    }
}
