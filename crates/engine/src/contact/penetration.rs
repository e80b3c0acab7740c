//! Whether anything penetrates after the solution: a look at the whole flanks of all pairs in reach, cells or not.
//!
//! The solver knows only the cells that were laid. This asks wherever else [`Looks`] look for the gap under the forces found: g = g_0 − δ w + u. Elastic
//! bodies give way where they are pressed, so that a stretch with g_0 > δ w stays open; of the others u is taken from the model.

use std::sync::Arc;

use super::ContactSolution;
use super::cells::{ContactCells, Laid};
use super::factor::dot;
use super::looks::{Found, Looked, Looks, Place};
use super::meeting::Meeting;
use super::model::MadePair;
use super::wide::wide;

/// The looks at one pair as it stands.
pub(super) struct Look {
    looks: Arc<Looks>,
    /// How flanks meet at the probes.
    met: [Vec<Meeting>; 2],
}

impl Look {
    /// The `looks` at the pair `laid` in mesh period `period`.
    pub(super) fn new(
        looks: Arc<Looks>,
        laid: &Laid,
        made: MadePair<'_>,
        (fraction, period): (f64, i64),
    ) -> Self {
        let seat = laid.cells().patch.seat;
        let met = [seat, seat.other()].map(|from| {
            let probes = &looks.probes[usize::from(from != seat)];
            if probes.is_empty() {
                return Vec::new();
            }
            let (eta, n) = (fraction + period as f64, period + laid.pair);
            let standing = made.standing(eta, n, laid.lag, (from, laid.drawn.phase));
            standing.meetings(probes)
        });
        Self { looks, met }
    }

    /// The stretches that may be closed, with their gap under no load and its arm about the driven axis. Between two cells that stay open flanks
    /// do so too, but for a kink.
    fn gaps<'a>(
        &'a self,
        laid: &'a Laid,
        active: &'a [bool],
    ) -> impl Iterator<Item = Option<(f64, f64)>> + 'a {
        let patch = &laid.cells().patch;
        let mut met = self.met.each_ref().map(|met| met.iter());
        let gap = move |looked: &Looked| match looked.place {
            Place::Across { at: i, kink } => {
                let closes = active[i] || active[i + 1] || kink;
                let [one, other] = [i, i + 1].map(|i| patch.cells[i].width);
                let between = |one_gap: f64, other_gap: f64| {
                    (one * one_gap + other * other_gap) / (one + other)
                };
                closes.then(|| {
                    (
                        between(laid.gaps[i], laid.gaps[i + 1]),
                        between(laid.arms[i][1], laid.arms[i + 1][1]),
                    )
                })
            }
            place => {
                let from_mate = place.seen_from(patch.seat) != Some(patch.seat);
                let meeting = met[usize::from(from_mate)].next()?;
                Some((meeting.gap + laid.lag * meeting.arms[1], meeting.arms[1]))
            }
        };
        let mut gap = gap;
        self.looks
            .looked
            .iter()
            .map(move |looked| gap(looked).map(|(gap, arm)| (gap + looked.more, arm)))
    }
}

/// What penetrates under the forces of `solution` on `cells`, by their `looks`, pair by pair.
pub(super) fn found(cells: &ContactCells<'_>, looks: &[Look], solution: &ContactSolution) -> Found {
    let mut found = Found::default();
    let interfaces = cells.interfaces_moved(&solution.forces);
    let pairs = cells.ranges().zip(interfaces);
    for (look, ((laid, range), moved)) in looks.iter().zip(pairs) {
        let looks = &look.looks;
        if looks.looked.is_empty() {
            continue;
        }
        // What the forces are, and how the interfaces move under them.
        let mut yielding = solution.forces[range.clone()].to_vec();
        yielding.extend(moved);
        let rows = looks.yields.chunks_exact(yielding.len());
        let gaps = look.gaps(laid, &solution.active[range]);
        for ((looked, row), gap) in looks.looked.iter().zip(rows).zip(gaps) {
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
            match looked.place {
                Place::Fillet(member) => found.fillets.push((laid.pair, member)),
                Place::Beside if !found.beside.contains(&laid.pair) => found.beside.push(laid.pair),
                Place::Beside => {}
                Place::Across { .. } | Place::Kink => {
                    let deepest = found.between.entry(laid.pair).or_default();
                    *deepest = depth.max(*deepest);
                }
            }
        }
    }
    found
}
