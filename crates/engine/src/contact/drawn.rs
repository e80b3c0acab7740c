//! What two flanks as drawn have of contact, whatever carries the teeth and however each of them deviates.
//!
//! Cells, the compliance of the teeth alone and the places where penetration is looked for hang on the flanks, the load and how long ago the
//! pair passed the pitch point. Models of one pair on other blanks, or with other deviations, share them.

use std::sync::Arc;

use super::facing::{Facing, View, nearer_tip};
use super::looks::{Carrying, Looks};
use super::memo::Memo;
use super::pair_cells::{PairCells, PairFlanks};
use super::patch::Extent;
use super::placement::Placement;
use crate::gear::Member;

/// What the cells of one pair, and the looks at them, may take, in bytes: two loads at forty positions a mesh period.
const MOST_BYTES: usize = 12 << 20;

/// What facings may take, in bytes.
const MOST_FACING_BYTES: usize = 2 << 20;

/// The steps in which the reach of a look grows: looks are the same whoever asks for them first.
const REACH_STEP: f64 = 3.0;

/// No look reaches less far beyond the least gap, in meters.
const LEAST_REACH: f64 = 1e-9;

/// What cells depend on: the bits of the phase, the gear on whose flank they lie, the bits of the load, the cells on a core, how far they are laid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct PlacedCells {
    phase: u64,
    seat: Member,
    load: u64,
    cells_per_patch: usize,
    extent: Extent,
}

/// The flanks of one pair as drawn, with what was found of them; shared between threads.
#[derive(Debug)]
pub struct DrawnFlanks {
    facings: Memo<(u64, Member), Option<Facing>>,
    cells: Memo<PlacedCells, Option<PairCells>>,
    looks: Memo<(PlacedCells, i32, Carrying), Looks>,
}

impl Default for DrawnFlanks {
    fn default() -> Self {
        Self {
            facings: Memo::new(MOST_FACING_BYTES, |facing| {
                size_of::<Facing>() + facing.as_ref().map_or(0, Facing::bytes)
            }),
            cells: Memo::new(MOST_BYTES, |cells| {
                size_of::<PairCells>() + cells.as_ref().map_or(0, PairCells::bytes)
            }),
            looks: Memo::new(MOST_BYTES, Looks::bytes),
        }
    }
}

/// A pair as drawn at one phase.
#[derive(Debug, Clone)]
pub(super) struct DrawnPair {
    /// How many mesh periods ago it passed the pitch point.
    pub(super) phase: f64,
    /// The gear from whose flank it is seen.
    pub(super) seat: Member,
    facing: Arc<Option<Facing>>,
}

impl DrawnPair {
    /// How its flanks face each other; `None` where they do not.
    pub(super) fn facing(&self) -> Option<&Facing> {
        Option::as_ref(&self.facing)
    }
}

impl DrawnFlanks {
    /// About how much memory is used, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + self.facings.bytes() + self.cells.bytes() + self.looks.bytes()
    }

    /// The pair of `flanks` at `phase`, seen from the gear whose tip is nearer.
    pub(super) fn pair(&self, flanks: &PairFlanks<'_>, phase: f64) -> DrawnPair {
        self.pair_on(flanks, phase, nearer_tip(flanks.pair, phase))
    }

    /// The pair of `flanks` at `phase`, seen from the flank of `seat`.
    pub(super) fn pair_on(&self, flanks: &PairFlanks<'_>, phase: f64, seat: Member) -> DrawnPair {
        let facing = self.facings.get((phase.to_bits(), seat), |_| {
            Facing::drawn_on(flanks.pair, phase, seat)
        });
        DrawnPair {
            phase,
            seat,
            facing,
        }
    }

    /// The cells of `pair`, laid so far; `None` where there is no room for any.
    pub(super) fn cells(
        &self,
        flanks: &PairFlanks<'_>,
        pair: &DrawnPair,
        load: f64,
        extent: Extent,
    ) -> Arc<Option<PairCells>> {
        self.cells.get(laid(flanks, pair, load, extent), |_| {
            let facing = pair.facing()?;
            PairCells::new(
                flanks,
                &view(flanks, pair.phase, facing),
                facing,
                load,
                extent,
            )
        })
    }

    /// The looks at the flanks of `pair` whose gap is within `reach`, and some beyond, at its `cells` laid so far, of which some are `carrying`;
    /// `least` is the least gap of all pairs.
    pub(super) fn looks(
        &self,
        flanks: &PairFlanks<'_>,
        (pair, facing): (&DrawnPair, &Facing),
        ((cells, load, extent), carrying): ((&PairCells, f64, Extent), &[bool]),
        (least, reach): (f64, f64),
    ) -> Arc<Looks> {
        let steps = ((reach - least).max(LEAST_REACH).ln() / REACH_STEP.ln()).ceil() as i32;
        let carrying = Carrying::of(carrying);
        let spec = (laid(flanks, pair, load, extent), steps, carrying);
        self.looks.get(spec, |_| {
            let reach = least + REACH_STEP.powi(steps);
            let view = view(flanks, pair.phase, facing);
            Looks::new(flanks, &view, facing, (cells, carrying), reach)
        })
    }
}

fn laid(flanks: &PairFlanks<'_>, pair: &DrawnPair, load: f64, extent: Extent) -> PlacedCells {
    PlacedCells {
        phase: pair.phase.to_bits(),
        seat: pair.seat,
        load: load.to_bits(),
        cells_per_patch: flanks.cells_per_patch,
        extent,
    }
}

fn view<'a>(flanks: &PairFlanks<'a>, phase: f64, facing: &Facing) -> View<'a> {
    View {
        placement: Placement::drawn(flanks.pair, phase),
        seat: facing.seat,
    }
}
