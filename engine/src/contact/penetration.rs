//! Whether anything penetrates after the solution: a look at the whole flanks of all pairs in reach, cells or not.
//!
//! The solver knows only the cells that were laid. This looks at stretches spread over both flanks of every pair, from the fillet
//! to the tip, and asks for their gaps under the forces found: g = g_0 − δ w + u. Elastic bodies give way where
//! they are pressed, so that a stretch with g_0 > δ w stays open; of the others u is taken from the model. Stretches are as
//! wide as a cell, since pressures that are even over a cell close gaps in the mean over one.

use std::sync::Arc;

use faer::Mat;

use super::ContactSolution;
use super::cells::ContactCells;
use super::facing::Facing;
use super::half_plane::in_row;
use super::model::PairModel;
use super::pair_cells::PairCells;
use super::patch::{Cell, Patch};
use crate::fem::dense::entries;
use crate::gear::Member;

/// Stretches on the flank of the seat and on that of its mate.
const STRETCHES: [usize; 2] = [32, 16];

/// What was found.
#[derive(Default)]
pub(super) struct Found {
    /// The largest penetration of the flanks, in meters; zero if everything is open.
    pub(super) largest: f64,
    /// Pairs that penetrate beside their patches.
    pub(super) beside: Vec<i64>,
    /// Pairs in which the tip of one gear is pressed into the fillet of the other, and that other gear; cells do not follow there.
    pub(super) fillets: Vec<(i64, Member)>,
}

/// Where a stretch lies.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// Where there are cells.
    OnPatch,
    /// On the flanks, beside the cells.
    Beside,
    /// On the fillet of a gear, faced by the other's tip.
    Fillet(Member),
}

/// The stretches of one pair that may penetrate, at one fraction of the mesh period.
#[derive(Debug)]
pub(super) struct Stretches {
    /// As cells, and where they lie.
    stretches: Vec<(Cell, Place)>,
    /// What unit forces on the cells of the pair do to each, with the interfaces held.
    held: Mat<f64>,
    /// W V of each gear.
    shapes: [Mat<f64>; 2],
}

/// What penetrates under the forces of `solution` on `cells`, by their `stretches`, pair by pair.
pub(super) fn found(
    model: &PairModel,
    period: i64,
    cells: &ContactCells<'_>,
    stretches: &[Arc<Stretches>],
    solution: &ContactSolution,
) -> Found {
    let mut found = Found::default();
    let loads = cells.loads(&[&solution.forces]);
    for (looks, (pair, range)) in stretches.iter().zip(cells.ranges()) {
        if looks.stretches.is_empty() {
            continue;
        }
        let number = pair.patch.pair;
        let moved = Member::BOTH.map(|member| cells.moved(member, number, &loads));
        let yielded = looks.yielded(&solution.forces[range], &moved);
        let teeth = model.pair.teeth(period + number);
        for ((cell, place), yielded) in looks.stretches.iter().zip(yielded) {
            let depth = solution.transmission_error * cell.arm
                - cell.gap_between(&model.pair, teeth)
                - yielded;
            if depth <= 0.0 {
                continue;
            }
            match place {
                Place::Fillet(member) => found.fillets.push((number, *member)),
                Place::OnPatch => found.largest = found.largest.max(depth),
                Place::Beside => {
                    found.largest = found.largest.max(depth);
                    if !found.beside.contains(&number) {
                        found.beside.push(number);
                    }
                }
            }
        }
    }
    found
}

impl Stretches {
    /// Those over both flanks of `facing` whose gap as drawn is within `reach`.
    pub(super) fn new(
        model: &PairModel,
        pair: &PairCells,
        facing: &Facing<'_>,
        reach: f64,
    ) -> Self {
        let patch = &pair.patch;
        let mut found = Vec::new();
        on_flanks(facing, patch, reach, &mut found);
        let arcs: Vec<f64> = found
            .iter()
            .map(|(cell, _)| {
                let flank = model.pair.gear(patch.seat).flank();
                flank.arc_length(cell.roll_lengths[patch.seat.index()])
            })
            .collect();
        let first = patch.from + 0.5 * patch.cell_width;
        let mut held = Mat::zeros(found.len(), patch.cells.len());
        for (i, arc) in arcs.iter().enumerate() {
            let row = in_row(
                &patch.near_fields,
                first - arc,
                patch.cell_width,
                held.ncols(),
            );
            for (j, near) in row.into_iter().enumerate() {
                held[(i, j)] = near;
            }
        }
        let shapes = [0, 1].map(|gear| {
            let flank = &model.gears[gear].flank;
            let on_flank =
                |cell: &Cell| flank.point(cell.roll_lengths[gear], cell.directions[gear]);
            let here: Vec<_> = found.iter().map(|(cell, _)| on_flank(cell)).collect();
            let there: Vec<_> = patch.cells.iter().map(on_flank).collect();
            held += flank.smooth_compliance(&here, &there);
            flank.shapes_at(&here)
        });
        Self {
            stretches: found,
            held,
            shapes,
        }
    }

    /// About how much memory they take, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let numbers = entries(&self.held) + self.shapes.iter().map(entries).sum::<usize>();
        size_of::<Self>() + size_of_val(self.stretches.as_slice()) + size_of::<f64>() * numbers
    }

    /// u of each stretch under the `forces` on the cells of its pair, with the interfaces `moved`.
    fn yielded(&self, forces: &[f64], moved: &[Mat<f64>; 2]) -> Vec<f64> {
        let mut yielded = vec![0.0; self.stretches.len()];
        let mut add = |rows: &Mat<f64>, column: &mut dyn Iterator<Item = f64>| {
            for (j, factor) in column.enumerate() {
                for (sum, entry) in yielded.iter_mut().zip(rows.col_as_slice(j)) {
                    *sum += entry * factor;
                }
            }
        };
        add(&self.held, &mut forces.iter().copied());
        for (shapes, moved) in self.shapes.iter().zip(moved) {
            add(shapes, &mut moved.col_as_slice(0).iter().copied());
        }
        yielded
    }
}

/// Adds to `found` the stretches over both flanks of `facing`, as wide as the cells of `patch`, whose gap is within `reach`.
fn on_flanks(facing: &Facing<'_>, patch: &Patch, reach: f64, found: &mut Vec<(Cell, Place)>) {
    let half = 0.5 * patch.cell_width;
    let (from, to) = patch.reach();
    let flank = facing.gears().gear(patch.seat).flank();
    for (view, count) in [
        (Some(*facing), STRETCHES[0]),
        (facing.told_on_mate(), STRETCHES[1]),
    ] {
        let Some(view) = view else { continue };
        let (low, high) = (view.range.from + half, view.range.to - half);
        for i in 0..=count {
            let arc = low + (high - low) * i as f64 / count as f64;
            if view.point(arc).is_some_and(|point| point.gap <= reach) {
                found.extend(view.cell(arc, patch.cell_width).map(|cell| {
                    let on_seat = flank.arc_length(cell.roll_lengths[patch.seat.index()]);
                    let on_patch = (from..=to).contains(&on_seat);
                    (
                        cell,
                        if on_patch {
                            Place::OnPatch
                        } else {
                            Place::Beside
                        },
                    )
                }));
            }
        }
        // Below the flank of the other gear the tip gives way about as the lowest place that faces it does.
        if let Some(gap) = view.tip_to_fillet().filter(|gap| *gap <= reach) {
            let lowest = view.cell(high, patch.cell_width);
            let place = Place::Fillet(view.seat.other());
            found.extend(lowest.map(|cell| (Cell { gap, ..cell }, place)));
        }
    }
}
