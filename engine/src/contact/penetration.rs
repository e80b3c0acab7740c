//! Whether anything penetrates after the solution: a look at the whole flanks of all pairs in reach, cells or not.
//!
//! The solver knows only the cells that were laid. This looks at stretches across every end of a cell that carries and every kink, at others
//! spread over the rest of the flanks, and at tips that stand in a fillet, and asks for their gaps under the forces found: g = g_0 − δ w + u. Elastic bodies
//! give way where they are pressed, so that a stretch with g_0 > δ w stays open; of the others u is taken from the model. Stretches are as
//! wide as a cell, since pressures that are even over a cell close gaps in the mean over one.

use std::collections::BTreeMap;
use std::sync::Arc;

use faer::Mat;

use super::ContactSolution;
use super::cells::{ContactCells, Laid};
use super::drawn::Carrying;
use super::facing::{Facing, FlankRange, RangeEnd, View};
use super::half_plane::Entries;
use super::meeting::{Probe, Standing};
use super::model::{MadePair, PairModel};
use super::pair_cells::{PairCells, compliance};
use super::patch::{Cell, Patch, Stretch};
use crate::fem::dense::entries;
use crate::gear::Member;

/// Stretches spread over the flanks beside the cells.
const BESIDE: usize = 48;

/// What was found.
#[derive(Default)]
pub(super) struct Found {
    /// The largest penetration, in meters; zero if everything is open.
    pub(super) largest: f64,
    /// Pairs that penetrate beside their cells.
    pub(super) beside: Vec<i64>,
    /// How deep pairs penetrate between cells, which are wide beside the contact, or within one, about a kink.
    pub(super) between: BTreeMap<i64, f64>,
    /// Pairs in which the tip of one gear is pressed into the fillet of the other, and that other gear; cells do not follow there.
    pub(super) fillets: Vec<(i64, Member)>,
}

/// Where a stretch lies, and how its gap is told.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// Across the end of this cell and the beginning of the next: the gap is between theirs.
    Across(usize),
    /// Within a cell, about a kink.
    Kink,
    /// On the flanks, beside the cells.
    Beside,
    /// On the fillet of a gear, faced by the other's tip.
    Fillet(Member),
}

/// A stretch that may penetrate.
#[derive(Debug)]
struct Looked {
    place: Place,
    probe: Probe,
    /// What its mean gap is more than what `place` or `probe` tells.
    more: f64,
}

/// The stretches of one pair as drawn that may penetrate.
#[derive(Debug)]
pub(super) struct Looks {
    looked: Vec<Looked>,
    /// What unit forces on the cells of the pair do to each, with the interfaces held.
    held: Mat<f64>,
    /// W V of each gear.
    shapes: [Mat<f64>; 2],
}

/// The looks at one pair as it stands.
pub(super) struct Look<'a> {
    looks: Arc<Looks>,
    standing: Option<[Standing<'a>; 2]>,
}

impl<'a> Look<'a> {
    /// The `looks` at the pair `laid` in mesh period `period`.
    pub(super) fn new(
        looks: Arc<Looks>,
        laid: &Laid,
        made: MadePair<'a>,
        (fraction, period): (f64, i64),
    ) -> Self {
        let beside = |looked: &Looked| !matches!(looked.place, Place::Across(_));
        let needed = looks.looked.iter().any(beside);
        let standing = needed.then(|| {
            let seat = laid.cells().patch.seat;
            let (eta, n) = (fraction + period as f64, period + laid.pair);
            [seat, seat.other()]
                .map(|seat| made.standing(eta, n, laid.lag, (seat, laid.drawn.phase)))
        });
        Self { looks, standing }
    }

    /// The gap of each stretch under no load, and its arm about the driven axis.
    fn gaps(&self, cells: &PairCells, gaps: &[f64], arms: &[f64], lag: f64) -> Vec<(f64, f64)> {
        let told = |looked: &Looked| {
            let (gap, arm) = match (looked.place, &self.standing) {
                (Place::Across(i), _) => {
                    let [one, other] = [i, i + 1].map(|i| cells.patch.cells[i].width);
                    let between = |of: &[f64]| (one * of[i] + other * of[i + 1]) / (one + other);
                    (between(gaps), between(arms))
                }
                (place, Some([on_seat, on_mate])) => {
                    let fillet =
                        matches!(place, Place::Fillet(member) if member == cells.patch.seat);
                    let standing = if fillet { on_mate } else { on_seat };
                    let meeting = standing.meeting(&looked.probe);
                    (meeting.gap + lag * meeting.arms[1], meeting.arms[1])
                }
                (_, None) => (f64::INFINITY, 1.0),
            };
            (gap + looked.more, arm)
        };
        self.looks.looked.iter().map(told).collect()
    }
}

/// What penetrates under the forces of `solution` on `cells`, by their `looks`, pair by pair.
pub(super) fn found(
    cells: &ContactCells<'_>,
    looks: &[Look<'_>],
    solution: &ContactSolution,
) -> Found {
    let mut found = Found::default();
    let loads = cells.loads(&[&solution.forces]);
    for (look, (laid, range)) in looks.iter().zip(cells.ranges()) {
        let looks = &look.looks;
        if looks.looked.is_empty() {
            continue;
        }
        let moved = Member::BOTH.map(|member| cells.moved(member, laid.pair, &loads));
        let yielded = looks.yielded(&solution.forces[range], &moved);
        let arms: Vec<f64> = laid.arms.iter().map(|arms| arms[1]).collect();
        let gaps = look.gaps(laid.cells(), &laid.gaps, &arms, laid.lag);
        for ((looked, (gap, arm)), yielded) in looks.looked.iter().zip(gaps).zip(yielded) {
            let depth = solution.transmission_error * arm - gap - yielded;
            if depth <= 0.0 {
                continue;
            }
            found.largest = found.largest.max(depth);
            match looked.place {
                Place::Fillet(member) => found.fillets.push((laid.pair, member)),
                Place::Beside if !found.beside.contains(&laid.pair) => found.beside.push(laid.pair),
                Place::Beside => {}
                Place::Across(_) | Place::Kink => {
                    let deepest = found.between.entry(laid.pair).or_default();
                    *deepest = depth.max(*deepest);
                }
            }
        }
    }
    found
}

impl Looks {
    /// Those at the flanks of `facing`, seen by `view`, whose gap as drawn is within `reach`.
    pub(super) fn new(
        model: &PairModel,
        view: &View<'_>,
        facing: &Facing,
        (cells, carrying): (&PairCells, Carrying),
        reach: f64,
    ) -> Self {
        let mut looked: Vec<(Stretch, Place, f64)> = Vec::new();
        let patch = &cells.patch;
        let lay = |from: f64, to: f64| patch.stretch_between(view, &facing.kinks, from, to);
        let within = |stretch: &Stretch| stretch.cell.gap <= reach;
        for (i, pair) in patch.cells.windows(2).enumerate() {
            let apart = pair[0].stretch + 1 != pair[1].stretch;
            if apart || pair.iter().all(|cell| cell.gap > reach) {
                continue;
            }
            // Between two cells that are open the flanks are, but for a kink.
            let carries = carrying.holds(i) || carrying.holds(i + 1);
            let end = patch.ends_along[pair[1].stretch][0];
            if !carries && !facing.kinks.contains(&end) {
                continue;
            }
            let [from, at, to] = [0, 1, 2].map(|end| patch.ends_along[pair[0].stretch + end][0]);
            let across = lay(f64::midpoint(from, at), f64::midpoint(at, to));
            let [one, other] = [pair[0], pair[1]];
            let between =
                (one.width * one.gap + other.width * other.gap) / (one.width + other.width);
            looked.extend(
                across
                    .filter(within)
                    .map(|stretch| (stretch, Place::Across(i), stretch.cell.gap - between)),
            );
        }
        let half = 0.5 * patch.usual_width();
        let range = &facing.range;
        let (low, high) = (range.from + half, range.to - half);
        let about = |arc: f64| {
            let arc = arc.max(low).min(high);
            lay(arc - half, arc + half).map(|stretch| {
                let more = stretch.more;
                (stretch, more)
            })
        };
        let kinks = facing.kinks.iter().filter(|kink| {
            patch.covers(**kink) && patch.ends_along.iter().all(|end| end[0] != **kink)
        });
        let beside = (0..=BESIDE).map(|i| low + (high - low) * i as f64 / BESIDE as f64);
        let near = |arc: &f64| {
            let point = view.point(*arc);
            point.is_some_and(|point| point.sight.gap <= reach)
        };
        let places = kinks.map(|kink| (*kink, Place::Kink)).chain(
            beside
                .filter(|arc| !patch.covers(*arc) && near(arc))
                .map(|arc| (arc, Place::Beside)),
        );
        for (arc, place) in places {
            let stretch = about(arc).filter(|(stretch, _)| within(stretch));
            looked.extend(stretch.map(|(stretch, more)| (stretch, place, more)));
        }
        // A tip stands in a fillet where the other flank ends there.
        let mate = view.told_on_mate();
        let mates = (range.ends[0] == RangeEnd::Fillet)
            .then(|| mate.range())
            .flatten();
        for (view, range) in [(*view, Some(*range)), (mate, mates)] {
            let tip = range.and_then(|range| tip_in_fillet(&view, &range, patch, half));
            looked.extend(tip.filter(|(_, gap)| *gap <= reach).map(|(stretch, gap)| {
                let told = stretch.cell.gap - stretch.more;
                (stretch, Place::Fillet(view.seat.other()), gap - told)
            }));
        }
        Self::at(model, cells, looked)
    }

    /// Looks at the stretches `looked` beside `cells`.
    fn at(model: &PairModel, cells: &PairCells, looked: Vec<(Stretch, Place, f64)>) -> Self {
        let stretches: Vec<[f64; 2]> = looked.iter().map(|(stretch, ..)| stretch.along).collect();
        let here: Vec<Cell> = looked.iter().map(|(stretch, ..)| stretch.cell).collect();
        let (held, shapes) = compliance(model, &cells.patch, (&here, &stretches), Entries::All);
        Self {
            looked: looked
                .into_iter()
                .map(|(stretch, place, more)| Looked {
                    place,
                    probe: stretch.probe,
                    more,
                })
                .collect(),
            held,
            shapes,
        }
    }

    /// About how much memory they take, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let numbers = entries(&self.held) + self.shapes.iter().map(entries).sum::<usize>();
        size_of::<Self>() + size_of_val(self.looked.as_slice()) + size_of::<f64>() * numbers
    }

    /// u of each stretch under the `forces` on the cells of its pair, with the interfaces `moved`.
    fn yielded(&self, forces: &[f64], moved: &[Mat<f64>; 2]) -> Vec<f64> {
        let mut yielded = vec![0.0; self.looked.len()];
        let mut add = |rows: &Mat<f64>, column: &mut dyn Iterator<Item = f64>| {
            for (j, factor) in column.enumerate().filter(|(_, factor)| *factor != 0.0) {
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

/// The tip of the seat of `view` where it stands in the fillet of the other gear, and the gap there: it gives way about as the highest
/// place that faces the flank does.
fn tip_in_fillet(
    view: &View<'_>,
    range: &FlankRange,
    patch: &Patch,
    half: f64,
) -> Option<(Stretch, f64)> {
    let gap = view.tip_to_fillet(range)?;
    let stretch = patch.stretch_between(view, &[], range.to - 2.0 * half, range.to)?;
    Some((stretch, gap))
}
