//! Whether anything penetrates after the solution: a look at the whole flanks of all pairs in reach, cells or not.
//!
//! The solver knows only the cells that were laid. This looks at stretches across every end of a cell that carries and every kink, at others
//! spread over the rest of the flanks, and at tips that stand in a fillet, and asks for their gaps under the forces found: g = g_0 − δ w + u. Elastic bodies
//! give way where they are pressed, so that a stretch with g_0 > δ w stays open; of the others u is taken from the model. Stretches are as
//! wide as a cell, since pressures that are even over a cell close gaps in the mean over one.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::ContactSolution;
use super::cells::{ContactCells, Laid};
use super::drawn::Carrying;
use super::facing::{Facing, FlankRange, RangeEnd, View};
use super::factor::dot;
use super::half_plane::Entries;
use super::meeting::{Meeting, Probes};
use super::model::{MadePair, PairModel};
use super::pair_cells::{PairCells, compliance};
use super::patch::{Cell, Patch, Stretch};
use super::wide::wide;
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
    /// Across the end of the cell `at` and the beginning of the next, perhaps at a kink: the gap is between theirs.
    Across { at: usize, kink: bool },
    /// Within a cell, about a kink.
    Kink,
    /// On the flanks, beside the cells.
    Beside,
    /// On the fillet of a gear, faced by the other's tip.
    Fillet(Member),
}

impl Place {
    /// The gear from whose flank its gap is told on a pair laid on `seat`; `None` where that is known from cells.
    fn seen_from(self, seat: Member) -> Option<Member> {
        match self {
            Self::Across { .. } => None,
            Self::Fillet(member) => Some(member.other()),
            Self::Kink | Self::Beside => Some(seat),
        }
    }
}

/// A stretch that may penetrate.
#[derive(Debug)]
struct Looked {
    place: Place,
    /// What its mean gap is more than what `place` or its probe tells.
    more: f64,
}

/// The stretches of one pair as drawn that may penetrate.
#[derive(Debug)]
pub(super) struct Looks {
    looked: Vec<Looked>,
    /// Those whose gap is told by a probe: as the seat of the pair sees them, and as its mate does.
    probes: [Probes; 2],
    /// Row by row what unit forces on the cells of the pair do to each with the interfaces held, and W V of each gear.
    yields: Vec<f64>,
}

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
            let carries = carrying.holds(i) || carrying.holds(i + 1);
            let kink = facing.kinks.contains(&patch.ends_along[pair[1].stretch][0]);
            if !carries && !kink {
                continue;
            }
            let place = Place::Across { at: i, kink };
            let [from, at, to] = [0, 1, 2].map(|end| patch.ends_along[pair[0].stretch + end][0]);
            let across = lay(f64::midpoint(from, at), f64::midpoint(at, to));
            let [one, other] = [pair[0], pair[1]];
            let between =
                (one.width * one.gap + other.width * other.gap) / (one.width + other.width);
            looked.extend(
                across
                    .filter(within)
                    .map(|stretch| (stretch, place, stretch.cell.gap - between)),
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
        let [one, other] = &shapes;
        let width = held.ncols() + one.ncols() + other.ncols();
        let mut yields = vec![0.0; looked.len() * width];
        let columns =
            [&held, one, other].map(|part| (0..part.ncols()).map(|j| part.col_as_slice(j)));
        for (j, column) in columns.into_iter().flatten().enumerate() {
            for (row, entry) in yields.chunks_exact_mut(width).zip(column) {
                row[j] = *entry;
            }
        }
        let mut probes = [Probes::default(), Probes::default()];
        for (stretch, place, _) in &looked {
            if let Some(from) = place.seen_from(cells.patch.seat) {
                probes[usize::from(from != cells.patch.seat)].push(&stretch.probe);
            }
        }
        Self {
            yields,
            probes,
            looked: looked
                .into_iter()
                .map(|(_, place, more)| Looked { place, more })
                .collect(),
        }
    }

    /// About how much memory they take, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let probes: usize = self.probes.iter().map(Probes::bytes).sum();
        size_of::<Self>() + size_of_val(&*self.looked) + probes + size_of_val(&*self.yields)
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
