//! Contact data of two flanks as drawn, for any support and any deviations of the teeth.
//!
//! Cells, the compliance of the teeth alone and the places where penetration is looked for depend on the flanks, the load and how long ago the
//! pair passed the pitch point. Models of one pair on other blanks, or with other deviations, share them.

use std::sync::Arc;

use super::checked::{Carrying, CheckedStretches};
use super::memo::Memo;
use super::pair_cells::{CellsSpec, PairCells, PairFlanks};
use super::patch::Extent;
use crate::gear::Member;
use crate::touch::gap_profile::{GapProfile, nearer_tip};
use crate::touch::placement::Pose;

/// Limit of cells, and of the stretches that are checked beside them, in bytes each: two loads at forty positions a mesh period.
const MOST_BYTES: usize = 12 << 20;

/// Limit of facings in bytes.
const MOST_FACING_BYTES: usize = 2 << 20;

/// The factor by which the gap within which stretches are checked grows, so that these do not depend on the first request. It bounds the needless checks, and
/// changes no digit of a contact that penetrates nowhere.
const REACH_STEP: f64 = 3.0;

/// Stretches are checked at least so far beyond the least gap, in meters.
const LEAST_REACH: f64 = 1e-9;

/// The flanks of one pair as drawn, with their computed data; shared between threads.
#[derive(Debug)]
pub struct DrawnFlanks {
    facings: Memo<(u64, Member), Option<GapProfile>>,
    cells: Memo<CellsSpec, Option<PairCells>>,
    checked: Memo<(CellsSpec, i32, Carrying), CheckedStretches>,
}

impl Default for DrawnFlanks {
    fn default() -> Self {
        Self {
            facings: Memo::new(MOST_FACING_BYTES, |facing| {
                size_of::<GapProfile>() + facing.as_ref().map_or(0, GapProfile::bytes)
            }),
            cells: Memo::new(MOST_BYTES, |cells| {
                size_of::<PairCells>() + cells.as_ref().map_or(0, PairCells::bytes)
            }),
            checked: Memo::new(MOST_BYTES, CheckedStretches::bytes),
        }
    }
}

/// A pair as drawn at one phase.
#[derive(Debug, Clone)]
pub(super) struct DrawnPair {
    /// How many mesh periods ago it passed the pitch point.
    pub(super) phase: f64,
    /// The gear from whose flank it is seen.
    pub(super) primary: Member,
    facing: Arc<Option<GapProfile>>,
}

impl DrawnPair {
    /// How its flanks face each other; `None` where they do not.
    pub(super) fn facing(&self) -> Option<&GapProfile> {
        Option::as_ref(&self.facing)
    }
}

impl DrawnFlanks {
    /// About how much memory is used, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.facings.bytes() + self.cells.bytes() + self.checked.bytes()
    }

    /// The pair of `flanks` at `phase`, seen from the gear whose tip is nearer.
    pub(super) fn pair(&self, flanks: &PairFlanks<'_>, phase: f64) -> DrawnPair {
        self.pair_on(flanks, phase, nearer_tip(flanks.pair, phase))
    }

    /// The pair of `flanks` at `phase`, seen from the flank of `primary`.
    pub(super) fn pair_on(
        &self,
        flanks: &PairFlanks<'_>,
        phase: f64,
        primary: Member,
    ) -> DrawnPair {
        let facing = self.facings.get((phase.to_bits(), primary), |_| {
            GapProfile::drawn_on(flanks.pair, phase, primary)
        });
        DrawnPair {
            phase,
            primary,
            facing,
        }
    }

    /// The cells of `pair` for `load`; `None` where there is no room for any.
    pub(super) fn cells(
        &self,
        flanks: &PairFlanks<'_>,
        pair: &DrawnPair,
        load: f64,
        extent: Extent,
    ) -> Arc<Option<PairCells>> {
        let spec = CellsSpec {
            phase: pair.phase.to_bits(),
            primary: pair.primary,
            load: load.to_bits(),
            cells_per_patch: flanks.cells_per_patch,
            extent,
        };
        self.cells.get(spec, |&spec| {
            let facing = pair.facing()?;
            PairCells::new(flanks, &view(flanks, pair.phase, facing), facing, spec)
        })
    }

    /// The stretches of the flanks of `pair` beside or between its `cells` on which penetration is looked for: those whose gap is within `reach`, and some
    /// beyond. The contact on the cells is `active`; `least` is the least gap of all pairs.
    pub(super) fn checked(
        &self,
        flanks: &PairFlanks<'_>,
        pair: &DrawnPair,
        cells: &PairCells,
        active: &[bool],
        [least, reach]: [f64; 2],
    ) -> Option<Arc<CheckedStretches>> {
        let facing = pair.facing()?;
        let steps = ((reach - least).max(LEAST_REACH).ln() / REACH_STEP.ln()).ceil() as i32;
        let carrying = Carrying::of(active);
        let spec = (cells.spec, steps, carrying);
        Some(self.checked.get(spec, |_| {
            let reach = least + REACH_STEP.powi(steps);
            let view = view(flanks, pair.phase, facing);
            CheckedStretches::new(flanks, &view, facing, (cells, carrying), reach)
        }))
    }
}

fn view<'a>(flanks: &PairFlanks<'a>, phase: f64, facing: &GapProfile) -> Pose<'a> {
    Pose::drawn(flanks.pair, phase, facing.primary)
}
