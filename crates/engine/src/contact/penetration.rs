//! Check for penetration under a solution: the whole flanks of all pairs in reach, cells or not.
//!
//! The solver knows only the cells that were placed. On all [`CheckedStretches`] this takes the gap under the forces found: g = g_0 − δ w + u. Elastic
//! bodies give way where they are pressed, so that a stretch with g_0 > δ w stays open; of the others u is taken from the model.

use std::sync::Arc;

use super::ContactSolution;
use super::cells::{ContactCells, PlacedCells};
use super::checked::{CheckedKind, CheckedStretch, CheckedStretches, Penetration};
use super::factor::dot;
use super::model::{DeviatingPair, MeshPosition};
use crate::touch::meeting::GapAndArms;
use crate::wide::wide;

/// The checked stretches of one pair as it stands.
pub(super) struct PlacedStretches {
    checked: Arc<CheckedStretches>,
    /// Gaps and arms at the points.
    met: [Vec<GapAndArms>; 2],
}

impl PlacedStretches {
    /// The stretches `checked` of the pair `placed` at a mesh position of `deviating`.
    pub(super) fn new(
        checked: Arc<CheckedStretches>,
        placed: &PlacedCells,
        deviating: DeviatingPair<'_>,
        at: MeshPosition,
    ) -> Self {
        let primary = placed.cells().patch.primary;
        let met = [primary, primary.other()].map(|from| {
            let flank_points = &checked.flank_points[usize::from(from != primary)];
            if flank_points.is_empty() {
                return Vec::new();
            }
            let n = at.period + placed.pair;
            let pose = deviating.pose(at.eta(), n, placed.lag, (from, placed.drawn.phase));
            pose.gaps_and_arms(flank_points)
        });
        Self { checked, met }
    }

    /// The stretches that may be closed, with their gap under no load and its arm about the driven axis. Between two cells that stay open flanks
    /// do so too, but for a kink.
    fn gaps<'a>(
        &'a self,
        placed: &'a PlacedCells,
        active: &'a [bool],
    ) -> impl Iterator<Item = Option<(f64, f64)>> + 'a {
        let patch = &placed.cells().patch;
        let mut met = self.met.each_ref().map(|met| met.iter());
        let gap = move |checked: &CheckedStretch| match checked.place {
            CheckedKind::Across { at: i, kink } => {
                let closes = active[i] || active[i + 1] || kink;
                let [one, other] = [i, i + 1].map(|i| patch.cells[i].width);
                let between = |one_gap: f64, other_gap: f64| {
                    (one * one_gap + other * other_gap) / (one + other)
                };
                closes.then(|| {
                    (
                        between(placed.gaps[i], placed.gaps[i + 1]),
                        between(placed.arms[i][1], placed.arms[i + 1][1]),
                    )
                })
            }
            place => {
                let from_mate = place.seen_from(patch.primary) != Some(patch.primary);
                let at = met[usize::from(from_mate)].next()?;
                Some((at.gap + placed.lag * at.arms[1], at.arms[1]))
            }
        };
        let mut gap = gap;
        let stretches = self.checked.stretches.iter();
        stretches.map(move |checked| gap(checked).map(|(gap, arm)| (gap + checked.more, arm)))
    }
}

/// Penetration under the forces of `solution` on `cells`, on the stretches that are `checked` pair by pair.
pub(super) fn penetration(
    cells: &ContactCells<'_>,
    checked: &[PlacedStretches],
    solution: &ContactSolution,
) -> Penetration {
    let mut found = Penetration::default();
    let interfaces = cells.interfaces_moved(&solution.forces);
    let pairs = cells.ranges().zip(interfaces);
    for (of_pair, ((placed, range), moved)) in checked.iter().zip(pairs) {
        let checked = &of_pair.checked;
        if checked.stretches.is_empty() {
            continue;
        }
        // The forces, and the motion of the interfaces under them.
        let mut yielding = solution.forces[range.clone()].to_vec();
        yielding.extend(moved);
        let rows = checked.yields.chunks_exact(yielding.len());
        let gaps = of_pair.gaps(placed, &solution.active[range]);
        for ((stretch, row), gap) in checked.stretches.iter().zip(rows).zip(gaps) {
            let Some((gap, arm)) = gap else {
                continue;
            };
            let closed = solution.transmission_error * arm - gap;
            if closed <= 0.0 {
                continue;
            }
            let depth = closed - wide(|| dot(row, &yielding));
            if depth <= 0.0 {
                continue;
            }
            found.largest = found.largest.max(depth);
            match stretch.place {
                CheckedKind::Fillet(member) => found.fillets.push((placed.pair, member)),
                CheckedKind::Beside if !found.beside.contains(&placed.pair) => {
                    found.beside.push(placed.pair)
                }
                CheckedKind::Beside => {}
                CheckedKind::Across { .. } | CheckedKind::Kink => {
                    let deepest = found.between.entry(placed.pair).or_default();
                    *deepest = depth.max(*deepest);
                }
            }
        }
    }
    found
}
